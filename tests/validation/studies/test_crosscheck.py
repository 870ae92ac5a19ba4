"""Engine against in-house equations, for any scenario."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import inf, nan, pi
from typing import Any

import numpy as np
import pandas as pd
import pytest

import mbs_models
from analysis import (
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    STEEL_DISK,
    ConstraintSet,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    Trajectory,
)
from analysis.data.checks import Array
from analysis.mechanics import penalty, recorded
from mbs_models import Scene
from tests.helpers import failing, not_none
from validation.kit.limits import holds
from validation.page.content import Content
from validation.run import run
from validation.studies import comparisons, crosscheck
from validation.studies.crosscheck import Check
from validation.studies.stability.eigenvalue_check import distance

SLOPE = Table(inclination=2 * pi / 180, downhill=0.7)
SCENARIO = Scenario()
FAST = Start(spin=100.0, beta=1.0)
"""Ends where the contact would pull."""


@pytest.fixture(autouse=True)
def forget() -> None:
    comparisons.reference.cache_clear()


def failed(checks: list[Check]) -> list[Check]:
    return [check for check in checks if check.verdict is not True]


@pytest.mark.parametrize("constraints", [MODELS[1], MODELS[4], POSSIBLE_SETS[-1]], ids=" + ".join)
def test_every_formulation_of_a_set_agrees(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    best, *others = mbs_models.formulations(scenario)
    checks = crosscheck.check_formulation(scenario, best, states=10, end=0.1)
    for formulation in others:
        checks += crosscheck.check_formulation(scenario, formulation, states=10, end=None)
    assert failed(checks) == []


SCENARIOS = {
    "slope, load contact": Scenario(table=SLOPE, friction=SmoothCoulomb(load="contact")),
    "slope, penalty": Scenario(contact=PenaltyContact.damped(1e5, STEEL_DISK), table=SLOPE),
}


@pytest.mark.parametrize("name", SCENARIOS)
def test_other_tables_and_contacts_agree(name: str) -> None:
    scenario = SCENARIOS[name]
    for check in crosscheck.check_scenario(scenario, states=5, end=0.05):
        # A leaning table and a compliant contact have no spectra of spinning.
        if check.quantity.startswith("eigenvalues"):
            assert str(check.verdict).startswith("not defined: ")
        else:
            assert check.verdict is True, check


def test_drop_is_compared_through_its_impacts(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = Scenario.rest(start=Start(height=5e-3))
    checks = crosscheck.check_formulation(scenario, "floating-lie", states=2, end=0.2)
    assert [check.verdict for check in checks[:3]] == [True] * 3
    assert checks[2].detail == "over 0.2 s"
    monkeypatch.setattr(penalty.YieldingTable, "touch", pushing(penalty.YieldingTable.touch))
    difference, _ = comparisons.rest_difference(Scene(scenario), 0.2)
    assert not_none(difference) > comparisons.REST_LIMIT


@pytest.mark.parametrize(
    ("scenario", "over"),
    [
        (Scenario(start=FAST), "over 0.01587 s, where contact would pull"),
        # Shortly before it lies flat.
        (Scenario(constraints=MODELS[4], start=Start(spin=5.0, beta=0.5)), "over 0.06118 s"),
    ],
)
def test_motions_are_compared_as_far_as_there_are_some(scenario: Scenario, over: str) -> None:
    for formulation in mbs_models.formulations(scenario)[:2]:
        found, detail = comparisons.motion_difference(Scene(scenario, formulation), 2.0)
        assert holds(found, comparisons.ANGLE_LIMIT)
        assert detail == over


def driving(friction_of: Any) -> Any:
    return lambda **kind: lambda *given: tuple(-part for part in friction_of(**kind)(*given))


def pushing(touch: Any) -> Any:
    def backwards(self: penalty.YieldingTable, moving: Any) -> penalty.Touch:
        found: penalty.Touch = touch(self, moving)
        return found._replace(slip=tuple(-part for part in found.slip))

    return backwards


WRONG: dict[str, tuple[Any, str, Callable[[Any], Any], Scenario]] = {
    "friction": (recorded, "friction_of", driving, SCENARIO),
    "penalty": (penalty.YieldingTable, "touch", pushing, SCENARIOS["slope, penalty"]),
}
"""Where the in-house equations get a wrong sign, and how; in which scenario it is seen."""


@pytest.mark.parametrize("name", WRONG)
def test_wrong_sign_on_one_side_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    owner, function, change, scenario = WRONG[name]
    recorded.formula.cache_clear()
    monkeypatch.setattr(owner, function, change(getattr(owner, function)))
    formulation = mbs_models.formulations(scenario)[0]
    checks = crosscheck.check_formulation(scenario, formulation, states=5, end=0.05)
    recorded.formula.cache_clear()
    wrong = [each for each in checks if re.search("accelerations|motion in", each.quantity)]
    assert [check.verdict for check in wrong] == [False, False]


def altered(monkeypatch: pytest.MonkeyPatch, change: Callable[..., Trajectory]) -> None:
    """Let the engine's motions be compared as something else; the in-house ones stay."""

    def other(scenario: Scenario, times: Any, **how: Any) -> Trajectory:
        made = partial(run, scenario, times, **how)
        return made() if how.get("source") == "in-house" else change(made)

    monkeypatch.setattr(comparisons, "run", other)


def test_motions_that_end_otherwise_do_not_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    altered(monkeypatch, lambda made: made(allow_pulling=True))
    difference, detail = comparisons.motion_difference(Scene(Scenario(start=FAST)), 0.02)
    assert difference == inf
    assert detail.startswith("engine runs through; in-house ended at t = 0.0158")


@pytest.mark.parametrize(("seconds", "agree"), [(0.0, True), (1e-6, False)])
def test_motion_that_ends_later_in_the_same_state_does_not_agree(
    seconds: float, agree: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(made: Callable[[], Trajectory]) -> Trajectory:
        found = made()
        ending = replace(not_none(found.ending), time=not_none(found.ending).time + seconds)
        return replace(found, times=found.times + seconds, ending=ending)

    altered(monkeypatch, late)
    difference, _ = comparisons.motion_difference(Scene(Scenario(start=FAST)), 0.1)
    assert holds(difference, comparisons.ANGLE_LIMIT) is agree


def test_a_motion_that_runs_out_of_time_is_no_disagreement(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    altered(monkeypatch, lambda made: made(time_limit=1e-9))
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


def singular(_: Array) -> Array:
    raise ArithmeticError("singular")


def accelerations(states: int, scenario: Scenario = SCENARIO) -> Check:
    return crosscheck.check_formulation(scenario, "euler-tree", states=states, end=None)[0]


@pytest.mark.parametrize("how", [lambda a: nan * a, singular], ids=["nan", "singular"])
def test_one_state_without_a_number_on_one_side_is_no_agreement(
    how: Callable[[Array], Array], monkeypatch: pytest.MonkeyPatch
) -> None:
    right, calls = mbs_models.acceleration, iter(range(1000))

    def acceleration(*arguments: Any) -> tuple[Array, Array]:
        found, forces = right(*arguments)
        return (how(found), forces) if next(calls) == 2 else (found, forces)

    assert accelerations(3).verdict is True
    monkeypatch.setattr(mbs_models, "acceleration", acceleration)
    assert accelerations(3).verdict is False


def test_states_without_a_solution_on_either_side_are_not_counted() -> None:
    found = accelerations(20, Scenario(friction=SmoothCoulomb(coefficient=1e3, load="contact")))
    assert 0 < not_none(found.counted) < 20
    assert f"at {found.counted} of 20 random states" in found.detail
    assert accelerations(20).detail == "relative, at 20 random states"
    assert accelerations(0).verdict is False


VALUES = np.array([1.0 + 2.0j, 1.0 - 2.0j, -3.0])


@pytest.mark.parametrize("found", [VALUES[:2], np.append(VALUES, -5.0), nan * VALUES])
def test_eigenvalues_that_one_side_lacks_are_no_agreement(
    found: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert distance(VALUES[::-1], VALUES) == 0.0
    assert distance(found, VALUES) == distance(found[:0], VALUES[:0]) == inf
    monkeypatch.setattr(mbs_models, "eigenvalues", lambda _: found)
    assert comparisons.eigenvalue_difference(Scene(), MOTIONS[0])[0] == inf


# --- The study ----------------------------------------------------------------------------------


@cache
def compared() -> pd.DataFrame:
    """Rows of the study, with a difference that a measurement of two states has found."""
    checks = crosscheck.check_formulation(Scenario(), "floating", states=2, end=0.01)
    rows = [
        {"case": label, "kind": case.kind, **check._asdict(), "formulation": formulation}
        | ({"counted": crosscheck.STATES[case.kind]} if check.counted else {})
        for label, case in crosscheck.cases().items()
        for formulation in mbs_models.formulations(case.scenario)
        for check in checks
        if case.end is not None or "motion" not in check.quantity
        if case.kind != crosscheck.OTHERS or "eigenvalues" not in check.quantity
    ]
    return pd.DataFrame(rows)


def present(rows: pd.DataFrame, apart: float | None = 1e-8) -> Content:
    turned = pd.DataFrame({"turned": [1.0, apart and 1.0 + apart]})
    return crosscheck.present({"crosscheck": rows, "tippe-top": turned})


def fails(rows: pd.DataFrame, apart: float | None = 1e-8) -> set[str]:
    return failing(present(rows, apart).checks)


def test_study_compares_every_model_load_formulation_and_set() -> None:
    content = present(compared())
    assert not fails(compared())
    models, sets = (pd.DataFrame(content.tables[name]) for name in ("models", "sets"))
    assert len(models) == 25
    assert list(sets["case"]) == [" + ".join(each) for each in POSSIBLE_SETS]
    assert content.verdicts[0].answer == "yes"


@pytest.mark.parametrize(("row", "wrong"), [(0, 1e-4), (30, nan), (-1, None)])
def test_one_difference_that_is_too_large_or_none_fails(row: int, wrong: float | None) -> None:
    rows = compared().reset_index(drop=True)
    rows.loc[rows.index[row], "difference"] = wrong
    assert len(fails(rows)) == 1
    assert present(rows).verdicts[0].answer == "no"


def test_comparison_that_was_not_made_fails() -> None:
    rows = compared()
    assert fails(rows.iloc[1:]) == {"crosscheck: accelerations, the paper's models, scenes"}
    fewer = rows.assign(counted=rows["counted"] - 1)
    assert len(fails(fewer)) == 3


@pytest.mark.parametrize("apart", [2e-7, nan, None])
def test_a_tippe_top_that_turns_over_later_or_not_at_all_fails(apart: float | None) -> None:
    assert fails(compared(), apart) == {"tippe top: turned over, in s"}


def test_a_tippe_top_turns_over_in_house() -> None:
    assert crosscheck.turn_over("in-house")[0]["turned"] == pytest.approx(1.228924, abs=1e-6)
