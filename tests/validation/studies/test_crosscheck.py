"""Engine against in-house equations, for any scenario."""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    LAWS,
    MODELS,
    POSSIBLE_SETS,
    STEEL_DISK,
    ConstraintSet,
    Dissipation,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.mechanics import newton_euler, penalty, recorded
from analysis.mechanics.constraints import Direction
from analysis.mechanics.vectors import scaled
from mbs_models import Formulation, Scene
from tests.helpers import mostly_slow, not_none
from validation.run import run
from validation.studies import comparisons, crosscheck
from validation.studies.crosscheck import Check

SLOPE = Table(inclination=2 * pi / 180, downhill=0.7)
FAST = Start(spin=100.0, beta=1.0)
"""Ends where the contact would pull."""

CHECK = Check(quantity="q", formulation="floating", criterion=1.0, difference=0.5, detail="how")


def failed(checks: list[Check]) -> list[Check]:
    return [check for check in checks if check.verdict is not True]


@pytest.mark.parametrize(
    "constraints",
    mostly_slow(POSSIBLE_SETS, (MODELS[1], MODELS[4], POSSIBLE_SETS[-1])),
    ids=" + ".join,
)
def test_every_possible_set_agrees(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    best, *others = mbs_models.formulations(scenario)
    checks = crosscheck.check_formulation(scenario, best, states=10, end=0.1)
    for formulation in others:
        checks += crosscheck.check_formulation(scenario, formulation, states=10, end=None)
    assert failed(checks) == []


def test_worst_formulation_stands_for_a_set(monkeypatch: pytest.MonkeyPatch) -> None:
    def check(_: Scenario, formulation: Formulation, **_options: object) -> list[Check]:
        return [replace(CHECK, formulation=formulation, difference=len(formulation) / 10)]

    monkeypatch.setattr(crosscheck, "check_formulation", check)
    (worst,) = crosscheck.check_set(MODELS[2])
    assert worst.formulation == "floating-lie"


SCENARIOS = {
    "slope": Scenario(table=SLOPE),
    "slope, Model 3": Scenario(constraints=MODELS[3], table=SLOPE),
    "slope, load contact": Scenario(table=SLOPE, friction=SmoothCoulomb(load="contact")),
    "slope, penalty": Scenario(contact=PenaltyContact.damped(1e5, STEEL_DISK), table=SLOPE),
    "moon": Scenario(table=Table(gravity=1.62)),
    **{name: Scenario(friction=law()) for name, law in LAWS.items()},
    "rolling resistance": Scenario.rest(
        dissipation=Dissipation(rolling_dry=1e-3, rolling_viscous=1e-3, pivoting=5e-5)
    ),
}


@pytest.mark.parametrize("name", mostly_slow(SCENARIOS, ("slope, load contact", "slope, penalty")))
def test_other_tables_laws_and_contacts_agree(name: str) -> None:
    scenario = SCENARIOS[name]
    checks = crosscheck.check_scenario(scenario, states=5, end=0.05)
    # A leaning table and a compliant contact have no spectra of spinning, and nothing else lacks.
    spins = scenario.table.is_horizontal and scenario.contact is None
    for check in checks:
        if spins or not check.quantity.startswith("eigenvalues"):
            assert check.verdict is True, check
        else:
            assert str(check.verdict).startswith("not defined: ")


@pytest.mark.slow
@pytest.mark.parametrize("constraints", POSSIBLE_SETS[2::4], ids=" + ".join)
def test_other_sets_than_the_paper_agree_over_two_seconds(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    assert failed(crosscheck.check_scenario(scenario, states=300)) == []


def test_drop_is_compared_through_its_impacts(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = Scenario.rest(start=Start(height=5e-3))
    checks = crosscheck.check_formulation(scenario, "floating-lie", states=2, end=0.2)
    assert [check.verdict for check in checks[:3]] == [True] * 3
    assert checks[2].detail == "over 0.2 s"
    assert bent("penalty", monkeypatch).contact is not None
    difference, _ = comparisons.rest_difference(Scene(scenario), 0.2)
    assert not_none(difference) > comparisons.REST_LIMIT


def test_ending_where_the_contact_would_pull_is_compared() -> None:
    for formulation in mbs_models.formulations(Scenario(start=FAST)):
        scene = Scene(Scenario(start=FAST), formulation)
        difference, detail = comparisons.motion_difference(scene, 2.0)
        assert not_none(difference) < comparisons.ANGLE_LIMIT
        assert detail == "over 0.01587 s, where contact would pull"


def test_motion_is_compared_up_to_shortly_before_the_disk_lies_flat() -> None:
    scenario = Scenario(constraints=MODELS[4], start=Start(spin=5.0, beta=0.5))
    difference, detail = comparisons.motion_difference(Scene(scenario), 2.0)
    assert not_none(difference) < comparisons.ANGLE_LIMIT
    assert detail == "over 0.06118 s"


def bent(name: str, monkeypatch: pytest.MonkeyPatch) -> Scenario:
    """Scenario in which one sign of the in-house equations is wrong."""
    if name == "gyroscopic forces":
        free = newton_euler.free_acceleration

        def backwards(disk: Any, gravity: Any, moving: Any) -> Any:
            linear, turning = free(disk, gravity, moving._replace(spin=-moving.spin))
            return linear, scaled(-1.0, turning)

        monkeypatch.setattr(newton_euler, "free_acceleration", backwards)
    if name == "friction":
        per_load = newton_euler.friction

        def driving(*given: Any) -> Any:
            force, moment, _ = per_load(*given)
            return Direction(scaled(-1.0, force), scaled(-1.0, moment))

        monkeypatch.setattr(newton_euler, "friction", driving)
    if name == "slope":
        numbers = recorded.numbers
        monkeypatch.setattr(
            recorded,
            "numbers",
            lambda scenario: (*(found := numbers(scenario))[:7], -found[7], found[8]),
        )
        return Scenario(table=SLOPE)
    if name == "penalty":
        touch = penalty.YieldingTable.touch

        def wrong(self: penalty.YieldingTable, moving: Any) -> penalty.Touch:
            found = touch(self, moving)
            return found._replace(slip=tuple(-part for part in found.slip))

        monkeypatch.setattr(penalty.YieldingTable, "touch", wrong)
        return Scenario(contact=PenaltyContact.damped(1e5, STEEL_DISK))
    return Scenario()


@pytest.mark.parametrize("name", ["gyroscopic forces", "friction", "slope", "penalty"])
def test_wrong_sign_on_one_side_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def forget() -> None:
        comparisons.reference.cache_clear()
        recorded.formula.cache_clear()

    forget()
    scenario = bent(name, monkeypatch)
    formulation = mbs_models.formulations(scenario)[0]
    checks = crosscheck.check_formulation(scenario, formulation, states=5, end=0.05)
    forget()
    for check in checks:
        if check.quantity == "accelerations" or "motion" in check.quantity:
            assert check.verdict is False
        if check.quantity.startswith("eigenvalues") and name not in {"slope", "penalty"}:
            assert check.verdict is False


def test_motions_that_end_otherwise_do_not_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(Scenario(start=FAST))

    def let(scenario: Scenario, times: object, **options: object) -> object:
        pulls = options.get("source") != "in-house"
        return run(scenario, times, allow_pulling=pulls, **options)  # type: ignore[arg-type]

    comparisons.reference.cache_clear()
    monkeypatch.setattr("validation.studies.comparisons.run", let)
    difference, detail = comparisons.motion_difference(scene, 0.02)
    assert difference == np.inf
    assert detail.startswith("engine runs through; in-house ended at t = 0.0158")


def test_a_motion_that_runs_out_of_time_is_no_disagreement(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def late(scenario: Scenario, times: object, **options: object) -> object:
        limit = {} if options.get("source") == "in-house" else {"time_limit": 1e-9}
        return run(scenario, times, **(options | limit))  # type: ignore[arg-type]

    comparisons.reference.cache_clear()
    monkeypatch.setattr("validation.studies.comparisons.run", late)
    difference, detail = comparisons.motion_difference(Scene(), 0.02)
    assert difference is None
    assert "time limit" in detail


def test_random_states_meet_the_constraints_and_use_every_freedom() -> None:
    rng = np.random.default_rng(0)
    for constraints in POSSIBLE_SETS:
        scenario = Scenario(constraints=constraints)
        states = [comparisons.random_state(scenario, rng) for _ in range(30)]
        for state in states:
            assert replace(scenario, start=state).initial_state == state
        values = np.array([state.vector for state in states])
        # Coordinates and rates vary in as many directions as the constraints leave.
        held = 2 * ("fixed-cog" in constraints)
        slips = ("no-slip-along" in constraints) + ("no-slip-across" in constraints)
        assert np.all(np.ptp(values[:, [3, 4, 5, 9]], axis=0) > 1.0)
        free = np.sum(np.ptp(values[:, [6, 7, 10, 11]], axis=0) > 0.1)
        assert free >= 4 - held - slips


def test_verdicts_are_yes_no_or_why_not() -> None:
    check, other = CHECK, replace(CHECK, difference=2.0)
    missing = replace(check, difference=None, detail="why")
    assert [each.verdict for each in (check, other, missing)] == [True, False, "not defined: why"]
    rows = crosscheck.table([check, other, missing]).rows
    assert [row[-1] for row in rows] == [True, False, "not defined"]
    overview = crosscheck.overview(
        "name",
        "title",
        ("case",),
        {("a",): [check], ("b",): [other], ("c",): [missing]},
    )
    assert [row[-1] for row in overview.rows] == [True, False, "not defined: why"]


def test_section_holds_every_model_load_formulation_and_set() -> None:
    jobs = [*crosscheck.jobs(), *crosscheck.shipped()]
    section = crosscheck.section({job.key: [CHECK] for job in jobs})
    confirmed, models, sets = section.tables
    assert [row[-1] for row in confirmed.rows] == [True] * 4 + [None]
    assert len(models.rows) == 2 * (3 * 4) + 1
    assert [row[0] for row in sets.rows] == [" + ".join(each) for each in POSSIBLE_SETS]
    assert all(row[-1] is True for table in (models, sets) for row in table.rows)
