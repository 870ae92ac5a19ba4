"""Friction laws: their closed properties, and those of one's own, right or wrong, in all uses."""

import json
import re
import sys
from dataclasses import dataclass, replace
from functools import partial
from math import hypot, inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import (
    LAWS,
    AnisotropicCoulomb,
    Ensemble,
    FrictionLaw,
    Level,
    LubricatedCoulomb,
    PowerLawCoulomb,
    Scenario,
    SmoothCoulomb,
    Stribeck,
    TanhCoulomb,
    Trajectory,
    ViscousFriction,
    load_run,
    outcomes,
    simulate,
    simulate_many,
)
from analysis.mechanics.recorded import any_contact_force
from analysis.problem.choices import SOURCES, Source
from analysis.problem.elementary import sqrt
from analysis.problem.user_modules import foreign_names
from analysis.simulation.energies import energies
from analysis.stability.critical import critical_speeds
from mbs_models.friction import law_force
from tests.bodies import TIPPE_TOP
from tests.calls import ROOT, printed, python, refusal, run
from tests.helpers import angles_apart, model, not_none, refusals
from tests.sweeps import sweep
from tests.wayward_law import EXITS, EXITS_AT_ONCE, Answering, Own, Pushing, Wayward
from validation.run import run as simulated
from validation.run import run_to_rest
from validation.sweeps.case import run_chunk

SHIPPED: list[FrictionLaw] = [kind() for kind in LAWS.values()]
SPEEDS = (0.0, 1e-9, 1e-5, 0.99e-5, 1.01e-5, 1e-3, 0.03, 0.1, 0.4, 3.0, 50.0)


def name(law: FrictionLaw) -> str:
    return type(law).__name__


@pytest.mark.parametrize("law", SHIPPED, ids=name)
def test_both_sides_write_the_same_law(law: FrictionLaw) -> None:
    engine = law_force(law)
    assert engine != law.force
    for speed in SPEEDS:
        for turn, load in ((0.3, 1.0), (2.0, 4.3), (4.0, 0.02)):
            slip = speed * np.cos(turn), speed * np.sin(turn)
            assert engine(*slip, load) == pytest.approx(law.force(*slip, load), rel=2e-14)


def test_laws_are_the_papers_where_they_have_to_be_and_have_their_full_force() -> None:
    equal = (
        Stribeck(static=0.3, kinetic=0.3),
        AnisotropicCoulomb(along=0.3, across=0.3),
        PowerLawCoulomb(exponent=1.0),
        LubricatedCoulomb(film=0.0),
    )
    for law in equal:
        found, papers = law.force(0.2, -0.7, 3.0), SmoothCoulomb().force(0.2, -0.7, 3.0)
        assert found == pytest.approx(papers, rel=1e-15)
    # To both sides of where its series ends.
    for slip in (9e-6, 1.1e-5, 0.1):
        whole = 0.3 * np.tanh(slip / 0.1) / slip
        assert TanhCoulomb().per_speed(slip) == pytest.approx(whole, rel=1e-14)
    assert Stribeck().per_speed(1e9) * 1e9 == pytest.approx(0.3)
    assert Stribeck().gradient * Stribeck().smoothing == pytest.approx(0.45)
    assert ViscousFriction().per_speed(7.0) == ViscousFriction().viscosity
    assert PowerLawCoulomb().force(0.0, 1e9, 8.0)[1] == pytest.approx(-0.3 * 8.0 ** (2 / 3))
    assert LubricatedCoulomb().force(2.0, 0.0, 0.0) == pytest.approx((-0.2, 0.0))


@pytest.mark.parametrize("coefficient", [0.0, 1e-6, 0.3])
def test_friction_is_there_however_weak_it_is(coefficient: float) -> None:
    law = SmoothCoulomb(coefficient=coefficient)
    assert Scenario(friction=law).rubs == law.is_on == (coefficient > 0.0)


def test_anisotropic_friction_takes_the_most_power_from_the_slip() -> None:
    law = AnisotropicCoulomb(along=0.5, across=0.2, smoothing=1e-9)
    turns = np.linspace(0.0, 2.0 * np.pi, 721)
    ellipse = np.array((0.5 * np.cos(turns), 0.2 * np.sin(turns)))
    for slip in ((1.0, 0.0), (0.3, 0.8), (-0.6, 0.1)):
        power = np.dot(law.force(*slip, 1.0), slip)
        assert power == pytest.approx(-np.max(slip @ ellipse), rel=2e-5)


def test_contact_force_is_the_least_that_friction_under_it_calls_for_or_there_is_none() -> None:
    # Each newton of friction across adds three, or one and a half, to the normal force.
    slip = (0.0, 9.0)
    steep = PowerLawCoulomb(coefficient=0.5, load="contact", exponent=2.0)
    with pytest.raises(ArithmeticError, match="is what friction under it calls for"):
        any_contact_force(steep.force, 1.0, 0.0, -3.0, *slip)
    per_square = -1.5 * steep.force(*slip, 1.0)[1]
    least, _ = np.sort(np.roots((per_square, -1.0, 0.1)))
    assert any_contact_force(steep.force, 0.1, 0.0, -1.5, *slip) == pytest.approx(least, rel=1e-13)
    # One that pulls rubs with no load, though friction would call for its own.
    alone = PowerLawCoulomb(coefficient=0.5, load="contact", exponent=0.5)
    assert any_contact_force(alone.force, -0.1, 0.0, -1.5, *slip) == -0.1

    # No other load is tried, for which a law of one's own may have no force.
    def silent(_along: float, _across: float, load: float) -> tuple[float, float]:
        return 0.0, 0.0 / (load == 0.0)

    assert any_contact_force(silent, -0.1, 0.0, -1.5, *slip) == -0.1


@pytest.mark.parametrize("coefficient", [0.5, 1e3, 1e8])
def test_contact_force_is_found_however_strong_friction_is(coefficient: float) -> None:
    law = PowerLawCoulomb(coefficient=coefficient, load="contact", exponent=0.5)
    load = any_contact_force(law.force, 1.0, 0.0, -3.0, 0.0, 9.0)
    assert load == pytest.approx(1.0 - 3.0 * law.force(0.0, 9.0, load)[1], rel=1e-12)


def test_file_runs_no_module_that_it_names() -> None:
    with foreign_names(), pytest.raises(ValueError, match="'this:Law' must be imported first"):
        LAWS.made(law="this:Law")
    assert "this" not in sys.modules


@dataclass(frozen=True, slots=True, kw_only=True)
class Silent(FrictionLaw):
    finest_speed: Any = 0.1

    @dataclass(frozen=True, slots=True, kw_only=True)
    class Inner(Own):
        """A law in a class, with a table of numbers."""

        steps: tuple[tuple[float, float], ...] = ((0.1, 0.3), (1.0, 0.2))


def test_a_law_in_a_class_is_stored_and_read_again() -> None:
    scenario = Scenario(friction=Silent.Inner())
    assert Scenario.from_values(scenario.values()) == scenario
    # A file knows no tuples.
    assert Scenario.from_values(json.loads(json.dumps(scenario.values()))) == scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Bristles(FrictionLaw):
    """A law of one's own with a number that is declared."""

    smoothing: float
    finest_speed = 0.1


SLOPE = r"friction law '.*:Answering': slope of force at no slip must"
PUSHED = r"friction law '.*:Pushing': Pushing.force\(0\.0955, 0\.0296, 0\.1\) must"
ALONG = AnisotropicCoulomb(load="contact")
REFUSED: dict[str, dict[str, Any]] = {
    f"{SLOPE} be a finite": {"friction": Answering(says=lambda _: nan)},
    f"{SLOPE} not be negative, got -3": {"friction": Answering(says=lambda _: -3.0)},
    rf"{SLOPE} lie from 0 to 1e\+12": {"friction": Answering(says=lambda _: 1e300)},
    ":Pushing': slope of force": {"friction": Pushing(says=lambda x, y, n: (n * x, n * y))},
    "Answering': ZeroDivisionError: ": {"friction": Answering(says=lambda speed: 1.0 / speed)},
    "finest_speed must be positive, got 0": {"friction": Answering(says=abs, finest_speed=0.0)},
    f"{PUSHED} be against the slip if IS_ISOTROPIC": {
        "friction": Pushing(says=lambda x, y, n: (-n * x, n * y))
    },
    f"{PUSHED} double with the load if IS_PROPORTIONAL": {
        "friction": Pushing(says=lambda x, y, n: (-n * n * x, -n * n * y))
    },
    r"Pushing.force\(.*\) must hold along, across, got": {
        "friction": Pushing(says=lambda x, y, n: (-n * x, -n * y, n))
    },
    "^friction law '[^']*:Silent' must say per_speed or force": {"friction": Silent()},
    # There may be no edge that has a direction.
    "must be isotropic unless the body": {"friction": ALONG, "contact": Scenario.rest().contact},
    "be isotropic unless the body is a": {"friction": ALONG, "disk": TIPPE_TOP},
}

test_what_is_no_friction_or_not_what_it_says_is_refused_before_anything_runs = refusals(
    {
        "^smoothing must lie from 1e-12": lambda: Bristles(smoothing=-1.0),
        # What a law divides by.
        "^along must be positive, got 0": lambda: AnisotropicCoulomb(along=0.0),
        "^across must be positive, got 0": lambda: AnisotropicCoulomb(across=0.0),
        "^reference_load must be positive, got 0": lambda: PowerLawCoulomb(reference_load=0.0),
        **{message: partial(Scenario, **fields) for message, fields in REFUSED.items()},
    }
)


@pytest.mark.slow
def test_command_line_takes_a_law_of_ones_own(folder: Path) -> None:
    text = (ROOT / "docs" / "extending.md").read_text()
    begin = text.index("from dataclasses import dataclass\nfrom analysis import FrictionLaw")
    (folder / "rough.py").write_text(text[begin : text.index("```", begin)])
    law = "--law=rough:SquareRoot"
    # Without the working directory on its path, as an installed command is.
    tippedisk = partial(python, "-P", "-m", "validation", folder=folder)
    assert tippedisk("simulate", f"{law},coefficient=0.2", "--end=0.1", "--out=own.npz").stdout
    with pytest.raises(ValueError, match="'rough:SquareRoot' must be imported first"):
        load_run("own.npz", Trajectory)
    # A stored run executes nothing: its law comes from the file of a scenario, or from --law.
    assert "must be imported first" in refusal("scenario own.npz")
    again = printed("scenario own.npz", law)
    assert 'law = "rough:SquareRoot"' in again
    assert "coefficient = 0.2" in again
    (folder / "own.toml").write_text(again)
    assert printed("scenario own.toml") == again
    printed("show own.npz", law, "--plot=own.png")
    cases = ("law=tanh,rough:SquareRoot", "--scenario=own.toml", "--end=0.1", "--workers=1")
    assert tippedisk("sweep", *cases, "--out=laws.db").stdout == "laws.db: 2 cases\n"


# --- Laws and conditions of one's own that are none or end the program --------------------------

WAYWARD = "--law tests.wayward_law:Wayward,coefficient={}"

CALLS = (
    "simulate --out new.npz --end 0.1",
    "rest --out new.npz --end 0.01 --source in-house",
    "sweep spin=30,31 --end 0.01 --workers 1 --out new.db",
)


SAID = {
    "--law exits_on_import:Law": "--law: friction law 'exits_on_import:Law' cannot be loaded: "
    "SystemExit: , in line 2 of exits_on_import.py",
    WAYWARD.format(EXITS_AT_ONCE): "law:Wayward' cannot be made: SystemExit",
    "--stop-when exits_on_import:Law": "--stop-when: stop_when 'exits_on_import:Law' cannot be lo",
    "--stop-when os:getcwd": "--stop-when: stop_when getcwd must say a number of a State: Type",
}
"""What a module, a law or a function of one's own that is none is refused with."""


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("option", SAID)
def test_what_is_no_law_or_condition_is_refused(call: str, option: str, folder: Path) -> None:
    (folder / "exits_on_import.py").write_text("import sys\nsys.exit()\n")
    assert SAID[option] in refusal(call, option)
    assert not [*folder.glob("new*")]


@pytest.mark.parametrize("call", CALLS[:2])
def test_a_law_that_exits_where_the_disk_slips_is_no_success(
    call: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(call, WAYWARD.format(EXITS)) == 70
    assert "SystemExit" in capsys.readouterr().err
    assert not [*folder.glob("new*")]


def drag(along: float, across: float, load: float) -> tuple[float, float]:
    """Grows with the square of slip, and has no slope where there is none."""
    size = -3.0 * load * hypot(along, across)
    return size * along, size * across


@pytest.mark.parametrize("level", [1, 4])
def test_friction_without_a_slope_at_no_slip_rubs_by_every_way_alike(level: Level) -> None:
    law, times = Answering(says=lambda speed: 3.0 * speed), np.linspace(0.0, 1.0, 101)
    scenario = model(level, friction=law)
    assert scenario.rubs
    truth = simulated(replace(scenario, friction=Pushing(says=drag)), times, source="in-house")
    hows: list[dict[str, Any]] = [{"source": "engine"}, {"method": "taylor"}, {"method": "DOP853"}]
    for how in [*hows, *[{"formulation": "reduced"}] * (level == 4)]:
        found = simulated(scenario, times, **({"source": "in-house"} | how))
        assert np.max(np.abs(found.coordinates - truth.coordinates)) < 1e-7
    total = np.sum(energies(scenario, truth.coordinates, truth.rates), axis=0)
    assert total[-1] < total[0] - 0.01 or level == 4
    # In Model 4, whose spin is held, it shows in the angles.
    smooth = replace(scenario, friction=SmoothCoulomb(coefficient=0.0))
    assert angles_apart(truth, simulated(smooth, times, source="in-house")) > 0.01
    assert "at little slip: undamped" in not_none(critical_speeds(scenario).reason)


def test_a_case_whose_law_exits_is_a_row_that_says_so() -> None:
    law = Wayward(coefficient=EXITS)
    (row,) = run_chunk(sweep("spin=30,31", scenario=Scenario(friction=law)), [0])
    assert (row["status"], row["reason"]) == ("failed", "SystemExit 3")


@pytest.mark.parametrize("said", [inf, -1.0])
@pytest.mark.parametrize("source", SOURCES)
def test_a_law_that_says_no_number_where_the_disk_slips_is_blamed(
    source: Source, said: float
) -> None:
    law = Answering(says=lambda speed: said if speed > 0.05 else 3.0)
    runs = (
        partial(simulated, Scenario(friction=law), [0.0, 0.1]),
        partial(run_to_rest, Scenario.rest(friction=law), 0.1),
    )
    for each in runs:
        at = r"^Answering.force\(0\.0955, 0\.0296, 0\.1\)(\[along\])? must"
        with pytest.raises(ValueError, match=at):
            each(source=source)


def below_a_tenth(speed: float) -> float:
    return 0.3 / (speed + 0.1) + 0.0 * sqrt(0.01 - speed)


LIST: Any = partial(simulate_many, times=[0.0, 0.1], workers=1)


@pytest.mark.parametrize(
    ("says", "why"),
    [
        (below_a_tenth, r"'tests.wayward_law:Answering': force\(0.09\S*, 0.02\S*, 0.1\) fails: V"),
        (lambda _: -1.0, "must not drive the slip"),
    ],
)
def test_a_law_is_tried_where_the_disk_slips_before_a_run_that_is_compiled_too(
    says: Any, why: str
) -> None:
    scenario = Scenario(friction=Answering(says=lambda v: 3.0 if v == 0.0 else says(v)))
    with pytest.raises(ValueError, match=r"friction|force") as caught:
        simulate(scenario, [0.0, 0.1])
    one = Ensemble(scenario=scenario, fields={"spin": np.array([30.0])})
    for each in ([caught.value], LIST([scenario]), LIST(one)):
        (row,) = outcomes(each).rows()
        assert row["status"] == "refused"
        assert re.search(why, str(row["reason"]))
