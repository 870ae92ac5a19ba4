"""Compiled runs and batches: the pure path's equations, accuracy, endings; their refusals."""

import math
import re
import sys
from dataclasses import dataclass, fields, replace
from functools import partial
from math import pi
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from analysis import (
    CENTRED_DISK,
    LAWS,
    MODELS,
    POSSIBLE_SETS,
    ConstraintSet,
    Ensemble,
    FrictionLaw,
    Level,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    Table,
    ToleranceError,
    Trajectory,
    formulations,
    simulate,
    simulate_many,
)
from analysis.problem.elementary import hypot
from analysis.problem.quantities import LOADS
from analysis.problem.variations import changed
from analysis.simulation import request
from analysis.simulation.compiled import library
from analysis.simulation.compiled.ensemble import integrate, simulate_compiled
from analysis.simulation.compiled.library import CannotCompileError
from analysis.simulation.request import Request
from tests.bodies import COMPOSED, EGG, ELLIPSE, TIPPE_TOP, Egg
from tests.helpers import (
    angles_apart,
    assert_close,
    model,
    mostly_slow,
    not_none,
    random_scenario,
    reaching,
    refusals,
)
from tests.scenes import JAMMING, LOADED
from tests.wayward_law import Answering
from validation.comparison.differences import ending_error

pytest.importorskip("heyoka", reason="heyoka has wheels for Linux alone")

TIMES = np.linspace(0.0, 0.6, 121)


def drawn(constraints: ConstraintSet, law: FrictionLaw, *, products: float = 0.0) -> Scenario:
    """Start of a random disk on a leaning table."""
    return random_scenario(constraints, 12, law, products)[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shared(Egg):
    """One that says what its surface depends on."""

    SURFACE: ClassVar[tuple[str, ...]] = ("waist",)


SHARED = Shared(**{each.name: getattr(EGG, each.name) for each in fields(EGG)})

MOVING = Start(beta=1.9, gamma=0.5, spin=-7.0, beta_rate=1.0, gamma_rate=9.0, x_rate=0.3)
ROUGH = [SmoothCoulomb(load=load, coefficient=0.2, smoothing=0.5) for load in LOADS]
REDUCED_OF = [replace(drawn(MODELS[4], law()), table=Table()) for law in LAWS.values()]
SYSTEMS = [
    *(each for each in REDUCED_OF if each.friction.is_simple),
    replace(REDUCED_OF[0], friction=SmoothCoulomb(coefficient=0.0)),
    replace(REDUCED_OF[0], friction=Answering(says=lambda speed: 0.3 / hypot(0.1, speed))),
    drawn(MODELS[1], SmoothCoulomb(), products=0.1),
    *(Scenario(disk=each, start=MOVING) for each in (TIPPE_TOP, ELLIPSE, SHARED)),
    *(drawn(held, law) for held in POSSIBLE_SETS for law in ROUGH),
]
QUICK = [each for each in SYSTEMS if each.model in (1, 4)]


@pytest.mark.parametrize("scenario", mostly_slow(SYSTEMS, QUICK))
def test_compiled_equations_are_the_pure_ones(scenario: Scenario) -> None:
    # The reduced ones where there are any.
    formulation = formulations(scenario)[-1]
    run_of = partial(simulate, scenario, [2.0, 2.05, 2.1], formulation=formulation)
    run, pure = run_of(method="taylor", local_tolerance=1e-11), run_of(local_tolerance=1e-13)
    for name in ("coordinates", "rates", "multipliers"):
        assert_close(getattr(run, name), getattr(pure, name), relative=1e-10)
    assert "heyoka" in run.versions
    assert run.method["method"] == "taylor"


HERE = sys.modules[__name__]

OUTSIDE = 0.8
"""A number of a module, of which what is one's own may make use."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Slim(Egg):
    SURFACE: ClassVar[tuple[str, ...] | None] = ()

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Any:  # noqa: ARG002
        one_like: Any = SimpleNamespace(radius=self.radius, waist=OUTSIDE)
        return Egg.lowest_point(one_like, up)


class Inner(Slim):
    """One that reads it in a generator, and from a module."""

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Any:  # noqa: ARG002
        (waist,) = (HERE.OUTSIDE for _ in "x")
        one_like: Any = SimpleNamespace(radius=self.radius, waist=waist)
        return Egg.lowest_point(one_like, up)


class Alone(Slim):
    SURFACE = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Rubbing(FrictionLaw):
    finest_speed: float = 0.1

    def per_speed(self, speed: float) -> float:
        return OUTSIDE / (0.1 + speed)


class Turned:
    """A condition with a number that may be set."""

    least = 0.0

    def __call__(self, state: State) -> float:
        return state.coordinates[4] - self.least


def test_code_is_made_anew_where_a_number_that_is_no_field_has_changed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = {each.name: getattr(EGG, each.name) for each in fields(EGG)}
    run = partial(simulate, times=[0.0, 0.1, 0.2], local_tolerance=1e-12)
    turned, number = Turned(), 0.0
    outer = Answering(says=lambda speed: number / (0.1 + speed))
    for number in (0.8, 0.6):
        monkeypatch.setattr(HERE, "OUTSIDE", number)
        turned.least = 0.4 * number
        bodies = [kind(**told | {"waist": number}) for kind in (Egg, Slim, Inner, Alone)]
        egg, slim, inner, alone = (Scenario(disk=each, start=MOVING) for each in bodies)
        rubbing = [SmoothCoulomb(coefficient=number), Rubbing()]
        rubbing += [Answering(says=lambda speed: OUTSIDE / (0.1 + speed)), outer]
        usual, *others = (replace(REDUCED_OF[0], friction=each) for each in rubbing)
        pairs = [(egg, other) for other in (slim, inner, alone)]
        pairs += [(usual, other) for other in others]
        for expected, scenario in pairs:
            is_alone = scenario is alone
            found = run(scenario) if is_alone else run(scenario, method="taylor")
            assert_close(found.coordinates, run(expected).coordinates, relative=1e-9)
        for condition in (turned, turned.__call__, partial(Turned.__call__, turned)):
            run_to = partial(run, usual, stop_when=condition)
            end = not_none(run_to(method="taylor").ending)
            assert end.time == pytest.approx(not_none(run_to().ending).time)


def test_slip_that_nearly_stops_on_its_way_costs_no_accuracy() -> None:
    # A step across the least slip is wrong by 1.4e-4 rad in Model 1, and its size shows nothing.
    start = Start(beta=2.46639969, gamma=-1.83591463, spin=58.7337034, beta_rate=0.835966986)
    scenario = model(1, start=start)
    times = np.linspace(0.0, 2.0, 21)
    pure = simulate(scenario, times, local_tolerance=1e-12)
    run = simulate(scenario, times, method="taylor", local_tolerance=1e-9)
    assert angles_apart(run, pure) < 1e-7


def test_slip_that_begins_at_none_takes_the_sign_it_comes_to() -> None:
    # Of these, rounding leaves the slip at the start on either side of zero.
    scenario = Scenario(constraints=("contact", "no-slip-along"))
    for gamma in np.linspace(-0.9, 0.9, 10):
        begun = replace(scenario, start=Start(beta=1.9, gamma=gamma, spin=7.5))
        run = simulate(begun, [0.0, 0.1, 0.2], method="taylor")
        assert angles_apart(run, simulate(begun, run.times)) < 2e-8


@pytest.mark.parametrize("level", [1, 3])
def test_a_motion_that_never_slips_is_not_held_up_at_the_kink(level: Level) -> None:
    # Slip in two directions, or in one.
    spinning = model(level, disk=CENTRED_DISK)
    how: dict[str, Any] = {"method": "taylor", "local_tolerance": 1e-9, "time_limit": 10.0}
    run = simulate(spinning, [0.0, 1.0], **how)
    assert run.ending is None
    first, last = run.coordinates
    np.testing.assert_allclose(last - first, (0, 0, 0, 40, 0, 0), atol=1e-12)


def never(_: State) -> float:
    return 1.0


def test_compiled_run_ends_where_the_pure_one_does() -> None:
    pulling = model(1, start=Start(spin=200.0))
    for scenario, formulation, stop_when, reason in (
        (pulling, None, (), "contact would pull"),
        (model(4), "reduced", "inverted", "inverted"),
        (model(4, start=Start(beta=1.0, gamma=pi / 2, spin=0.0)), "reduced", (), "flat"),
        # What stays as it is, as the spin of the reduced system does, ends no run.
        (
            model(4, start=Start(alpha=0.3)), "reduced",
            [reaching("alpha_rate", 39.0), never, reaching("alpha", 30.3)], "alpha 30.3",
        ),
    ):  # fmt: skip
        how: dict[str, Any] = {"formulation": formulation, "stop_when": stop_when}
        times = np.linspace(0.0, 2.0, 201)
        pure = simulate(scenario, times, **how, local_tolerance=1e-12)
        run = simulate(scenario, times, **how, method="taylor", local_tolerance=1e-12)
        ending = not_none(run.ending)
        assert (ending.reason, ending.time) == (reason, run.times[-1])
        assert ending_error(run, pure) < 1e-10
        assert abs(ending.value) < 1e-8
        assert reason != "alpha 30.3" or ending.time == pytest.approx(30.0 / 40.0, abs=1e-9)
        assert run.times.size == pure.times.size


def test_events_of_any_size_leave_the_motion_as_it_is() -> None:
    start = Start(spin=33.0, beta=1.2, gamma=-1.1)
    sliding = Scenario(constraints=("contact", "no-slip-along"), start=start)
    free, heavy = Scenario(start=start), changed(sliding, {"disk.density": 7.7e12})

    def never(state: State) -> float:
        return 1e9 * (state.coordinates[4] + 5.0)

    times = np.linspace(0.0, 0.6, 31)
    for scenario, same in ((sliding, sliding), (sliding, heavy), (free, free)):
        truth = simulate(scenario, times, tolerance=1e-9)
        run = simulate(same, times, method="taylor", stop_when=never)
        assert angles_apart(run, truth) < 2e-8


def test_a_motion_of_the_moon_of_a_moon_is_the_same_slowly() -> None:
    def slowed(factor: float) -> Any:
        law = SmoothCoulomb(smoothing=0.1 / factor, load="contact")
        start = Start(spin=45.0 / factor, beta=1.3, gamma=-1.2)
        table = Table(gravity=9.81 / factor**2)
        times = np.linspace(0.0, 1.2, 25) * factor
        run = simulate(Scenario(friction=law, table=table, start=start), times, method="taylor")
        return run.coordinates[:, 4:]

    np.testing.assert_allclose(slowed(500.0), slowed(1.0), rtol=0.0, atol=2e-8)


def branching(speed: float) -> float:
    """What asks how large a number is, which a symbol cannot tell."""
    return 0.3 / (max(speed, 0.01) + 0.1)


BRANCHING = Answering(says=branching, finest_speed=0.01)


def fast(state: State) -> float:
    return 1.0 - math.hypot(*state.rates)


REDUCED: dict[str, Any] = {"formulation": "reduced"}
PENALTY = Scenario(contact=PenaltyContact(stiffness=1e5))


taylor = partial(simulate, times=TIMES, method="taylor")
# By this kind of error, many runs know whom to run otherwise.
test_what_cannot_be_compiled_is_refused_in_one_line = refusals(
    {
        "cannot express .* law Answering": partial(
            taylor, model(4, friction=BRANCHING), **REDUCED
        ),
        "cannot express stop_when 'fast'": partial(taylor, model(4), stop_when=fast, **REDUCED),
        "knows the ideal contact alone": partial(taylor, PENALTY),
        "takes bodies with a SURFACE, got a Egg": partial(taylor, Scenario(disk=EGG)),
        "more than 4 constraint forces, got Model 4": partial(taylor, model(4, disk=COMPOSED)),
        r"sqrt\(g r\) of 0.001 m/s or more, got 0.000212": partial(
            taylor, Scenario(table=Table(gravity=1e-6))
        ),
        "takes no allow_pulling where": partial(
            taylor, Scenario(friction=LOADED), allow_pulling=True
        ),
    },
    CannotCompileError,
)


def test_without_heyoka_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    library.heyoka.cache_clear()
    monkeypatch.setitem(sys.modules, "heyoka", None)
    message = r"^method 'taylor' needs heyoka, .*: pip install 'tippedisk\[fast\]'$"
    with pytest.raises(ValueError, match=message):
        simulate(model(4), TIMES, method="taylor")


def test_state_that_is_not_finite_ends_a_compiled_run_and_no_other_of_its_batch() -> None:
    how = Request(TIMES, formulation="reduced", method="taylor", local_tolerance=1e-12)
    (part,), _ = simulate_compiled([model(4), model(4, start=Start(spin=35.0))], how)
    part.group.starts[0, 2] = np.nan
    found, failures = integrate(part.group, TIMES, np.array([0, 1]), 1e-12, 1.0)
    assert list(failures) == [0]
    assert "no longer finite" in str(failures[0])
    assert_close(found.states[1], part.runs.states[1], 1e-10)


def test_a_contact_that_jams_ends_a_member_and_not_the_others() -> None:
    spins = Ensemble(scenario=JAMMING, fields={"y_rate": np.array((-3.0, 0.0, -2.9))})
    runs = simulate_many(spins, TIMES, method="taylor", tolerance=1e-6)
    assert list(runs.failures) == [0, 2]
    message = r"taylor stopped after t = 0\.013\d* s, where the contact jams"
    assert all(re.match(message, str(error)) for error in runs.failures.values())
    assert_close(runs[1].coordinates, simulate(runs[1].scenario, TIMES).coordinates, 1e-6)
    with pytest.raises(ArithmeticError, match="contact jams"):
        simulate(JAMMING, TIMES, method="DOP853", tolerance=1e-6)


def test_time_limit_ends_a_compiled_run() -> None:
    told: list[tuple[float, float]] = []
    how = REDUCED | {"method": "taylor", "progress": lambda *each: told.append(each)}
    run = simulate(model(4), TIMES, time_limit=1e-9, local_tolerance=1e-12, **how)
    assert not_none(run.ending).reason == "time limit"
    (only,) = told
    assert only == pytest.approx((run.times[-1], TIMES[-1]))


def test_estimates_cover_the_time_at_which_a_condition_ends_a_member() -> None:
    spins = Ensemble(scenario=model(4), fields={"spin": np.array((36.0, 40.0, 44.0))})
    how: dict[str, Any] = {"formulation": "reduced", "stop_when": "inverted", "method": "taylor"}
    ends = [0.0, 1.0]
    runs = simulate_many(spins, ends, **how, tolerance=1e-3)
    coarse, fine = (
        simulate_many(spins, ends, **how, local_tolerance=x).ends for x in (1e-6, 1e-9)
    )
    assert np.all(np.abs(coarse - fine) > 1e-12)
    fastest = np.array([np.max(np.abs(run.rates[-1, 4:])) for run in runs])
    assert np.all(fastest > 4.0)
    assert np.all(runs.error_estimates > 2.0 * fastest * np.abs(coarse - fine))


def test_members_that_taylor_takes_to_no_tolerance_run_with_dop853(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(request, "COMPILED_TOLERANCES", (1e-6, 1e-6))
    spins = Ensemble(scenario=model(4), fields={"spin": np.array([30.0, 40.0])})
    how: dict[str, Any] = {"formulation": "reduced", "tolerance": 1e-9}
    listed, arrays = (simulate_many(each, TIMES, **how) for each in (list(spins), spins))
    for number, member in enumerate(spins):
        alone = simulate(member, TIMES, **how)
        for outcome in (listed[number], arrays[number]):
            assert isinstance(outcome, Trajectory)
            assert outcome.method == alone.method
            np.testing.assert_array_equal(outcome.coordinates, alone.coordinates)
    insisting = simulate_many(list(spins), TIMES, **how, method="taylor")
    assert all(isinstance(outcome, ToleranceError) for outcome in insisting)


def test_bodies_of_a_kind_run_in_one_batch() -> None:
    fields = {"other_radius": np.array([0.03, 0.04]), "long_axis": np.array([0.2, 1.0])}
    start = Start(beta=2.0, gamma=0.5, spin=20.0)
    ensemble = Ensemble(scenario=Scenario(disk=ELLIPSE, start=start), fields=fields)
    runs = simulate_many(ensemble, [0.0, 0.1, 0.2], method="taylor", local_tolerance=1e-12)
    assert len(runs.compiled) == 1
    for run, scenario in zip(runs, ensemble, strict=True):
        assert angles_apart(run, simulate(scenario, run.times)) < 1e-8


def test_members_of_a_batch_pull_when_they_do_alone() -> None:
    fields = {"spin": np.array([40.0, 60.0]), "beta_rate": np.array([2.0, 25.0])}
    ensemble = Ensemble(scenario=model(4), fields=fields)
    how = REDUCED | {"allow_pulling": True, "local_tolerance": 1e-12}
    runs = simulate_many(ensemble, TIMES, method="taylor", **how)
    for run, scenario in zip(runs, ensemble, strict=True):
        pure = simulate(scenario, TIMES, **how)
        np.testing.assert_allclose(run.pulling, pure.pulling, rtol=0.0, atol=1e-9)
    assert runs[1].pulling
