"""Engine against in-house equations, for any scenario."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import cos, inf, nan, sin
from typing import Any
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest

import analysis
import mbs_models
from analysis import (
    CENTRED_DISK,
    MOTIONS,
    POSSIBLE_SETS,
    ConstraintSet,
    Dissipation,
    FlatError,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Trajectory,
)
from analysis.motion.endings import TIME_LIMIT, Ending
from analysis.problem.choices import SOURCES
from mbs_models import Scene
from tests.faults import GONE, Rows, faults
from tests.helpers import failing, model, not_none, planted
from tests.scenes import JAMMING
from validation.run import run
from validation.studies import comparisons, crosscheck
from validation.studies.comparisons import Comparison, compare_scene, distance

PULLING = Scene(Scenario(start=Start(spin=100.0, beta=1.0)))
"""Ends where the contact would pull."""


@pytest.fixture(autouse=True)
def forget() -> None:
    comparisons.reference.cache_clear()


@pytest.mark.parametrize(
    ("scenario", "end"),
    [(Scenario(), 0.05), (Scenario.rest(start=Start(height=5e-3)), 0.2)],
    ids=["ideal", "drop"],
)
def test_one_side_that_rubs_a_little_less_is_found_even_through_impacts(
    scenario: Scenario, end: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def told() -> list[bool | None]:
        accelerations, _, motion, *_ = compare_scene(Scene(scenario), states=20, end=end)
        assert motion.detail == f"over {end:g} s"
        return [accelerations.agrees, motion.agrees]

    def other(side: Any, scenario: Scenario, *given: Any, **how: Any) -> Any:
        law: Any = scenario.friction
        smooth = replace(law, coefficient=0.299)
        return side(replace(scenario, friction=smooth), *given, **how)

    assert told() == [True, True]
    comparisons.reference.cache_clear()
    for owner, name in (
        (comparisons, "accelerations"),
        (analysis, "simulate"),
        (analysis, "simulate_to_rest"),
    ):
        monkeypatch.setattr(owner, name, partial(other, getattr(owner, name)))
    assert told() == [False, False]


def test_motions_have_to_end_alike_and_running_out_of_time_is_no_disagreement(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def told(
        change: Callable[[Trajectory], Trajectory] = lambda found: found, slow: str = ""
    ) -> Any:
        def other(*given: Any, **how: Any) -> Trajectory:
            source = how.get("source", "engine")
            found = run(*given, **how | ({"time_limit": 1e-9} if source == slow else {}))
            return change(found) if source == "engine" else found

        monkeypatch.setattr(comparisons, "run", other)
        found = comparisons.compare_motions(PULLING, 0.1)
        return found.difference, found.detail, found.lasting

    def late(found: Trajectory) -> Trajectory:
        ending = replace(not_none(found.ending), time=not_none(found.ending).time + 1e-6)
        return replace(found, times=found.times + 1e-6, ending=ending)

    (right, detail, _), (wrong, *_) = told(), told(late)
    assert detail == "over 0.01587 s, where contact would pull"
    assert right < comparisons.ANGLE_LIMIT < wrong
    difference, detail, _ = told(lambda found: replace(found, ending=None))
    assert difference == inf
    assert "engine runs through; in-house ended at" in detail

    def limited(found: Trajectory) -> Trajectory:
        """A motion that has come as far as a time limit let it."""
        ending = Ending(reason=TIME_LIMIT, time=float(found.times[-1]), value=1.0)
        return replace(found, ending=ending)

    cases: list[Any] = [told(limited)]
    for side in SOURCES:
        comparisons.reference.cache_clear()
        cases.append(told(slow=side))
    for difference, detail, over in cases:
        assert difference is over is None
        assert re.match("(engine ended at .*)?time limit", detail)


def test_random_states_meet_the_constraints_and_use_every_freedom() -> None:
    rng = np.random.default_rng(0)
    for constraints in POSSIBLE_SETS:
        scenario = Scenario(constraints=constraints)
        states = [comparisons.random_state(scenario, rng) for _ in range(30)]
        assert all(replace(scenario, start=each).initial_state == each for each in states)
        varied = np.ptp([state.vector for state in states], axis=0)
        assert np.all(varied[[3, 4, 5, 9]] > 1.0)
        slips = ("no-slip-along" in constraints) + ("no-slip-across" in constraints)
        lost = 2 * ("fixed-cog" in constraints) + slips
        assert np.sum(varied[[6, 7, 10, 11]] > 0.1) >= 4 - lost
    soft = Scenario(contact=PenaltyContact(stiffness=1e5))
    states = [comparisons.random_state(soft, rng) for _ in range(30)]
    heights = [
        each.coordinates[2] - soft.disk.radius * sin(each.coordinates[4]) for each in states
    ]
    # In contact and out of it, by some of the depth at rest, and on the way down and up.
    depth = soft.weight / 1e5
    assert -2.5 * depth < min(heights) < -depth < 0.0 < max(heights) < 2.5 * depth
    moving = [
        each.rates[2] - soft.disk.radius * cos(each.coordinates[4]) * each.rates[4]
        for each in states
    ]
    assert min(moving) < -5e-3 < 5e-3 < max(moving)


def accelerations(states: int, **fields: Any) -> Comparison:
    return next(compare_scene(Scene(Scenario(**fields), "euler-tree"), states=states, end=None))


@pytest.mark.parametrize(
    "singular",
    [Mock(return_value=(np.full(6, nan), np.ones(1))), Mock(side_effect=ArithmeticError)],
)
def test_one_state_without_a_number_on_one_side_is_no_agreement(
    singular: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    right, calls = mbs_models.acceleration, iter(range(3))

    def acceleration(*given: Any) -> Any:
        return right(*given) if next(calls) < 2 else singular()

    assert accelerations(3).agrees
    monkeypatch.setattr(mbs_models, "acceleration", acceleration)
    assert accelerations(3).agrees is False


def test_accelerations_that_all_but_vanish_agree() -> None:
    held = ("contact", "fixed-cog", "no-slip-along", "no-slip-across")
    # The slowest of these states is the 693rd.
    assert accelerations(700, constraints=held).agrees


def test_motions_are_compared_until_shortly_before_the_disk_lies_flat() -> None:
    falling = Scene(model(4, start=Start(spin=5.0, beta=0.5)))
    found = comparisons.compare_motions(falling, 2.0)
    assert found.agrees
    assert found.detail == "over 0.06118 s, as the disk lies flat at 0.07648 s"


def test_motions_are_compared_until_before_the_disk_jams() -> None:
    found = comparisons.compare_motions(Scene(JAMMING), 0.2)
    assert found.agrees
    why = (
        "over 0.002 s; over 0.2 s: no in-house motion to compare with: singular index-1 system of"
    )
    assert found.detail.startswith(why)


@pytest.mark.slow
def test_a_run_that_fails_nearly_flat_is_no_disagreement(monkeypatch: pytest.MonkeyPatch) -> None:
    dropped = Scenario(start=Start(spin=0.0, beta=0.5))
    for formulation in ("euler-tree", "floating-lie"):
        found = comparisons.compare_motions(Scene(dropped, formulation), 0.1)
        assert found.agrees
        assert not_none(found.lasting) == pytest.approx(0.06, abs=0.005)

    def flat(scenario: Scenario, times: Any, **how: Any) -> Trajectory:
        if how.get("source") == "in-house" or times[-1] < 0.02:
            return run(scenario, times, **how)
        raise FlatError("the disk lies nearly flat", 0.05)

    monkeypatch.setattr(comparisons, "run", flat)
    found = comparisons.compare_motions(Scene(dropped), 0.1)
    assert found.agrees
    assert found.detail == (
        "over 0.01 s; over 0.1 s: the disk lies nearly flat at t = 0.05 s, where a run fails; "
        "give an earlier end"
    )
    # The in-house disk does not.
    assert comparisons.compare_motions(Scene(), 0.1).difference == inf


def test_states_without_a_solution_on_either_side_are_not_counted() -> None:
    found = accelerations(20, friction=SmoothCoulomb(coefficient=1e3, load="contact"))
    assert 0 < not_none(found.counted) < 20
    assert f"at {found.counted} of 20 random states" in found.detail
    assert accelerations(0).agrees is False


VALUES = np.array([1.0 + 2.0j, 1.0 - 2.0j, -3.0])


@pytest.mark.parametrize("found", [VALUES[:2], np.append(VALUES, -5.0), nan * VALUES])
def test_eigenvalues_that_one_side_lacks_are_no_agreement(
    found: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert distance(VALUES[::-1], VALUES) == 0.0
    assert distance(found, VALUES) == distance(found[:0], VALUES[:0]) == inf
    monkeypatch.setattr(mbs_models, "eigenvalues", lambda _: found)
    assert comparisons.compare_eigenvalues(Scene(), MOTIONS[0]).difference == inf


def test_eigenvalues_that_coincide_are_compared_by_the_polynomial_whose_roots_they_are() -> None:
    spread = 1e-3 * np.exp(2j * np.pi * np.arange(3) / 3.0)
    coinciding = np.array([0.0j, 0.0, 0.0, -3.0])
    assert distance(np.append(spread, -3.0), coinciding) == pytest.approx(1e-9, rel=1e-6)
    assert distance(np.append(spread + 1e-5, -3.0), coinciding) == pytest.approx(3e-5, rel=1e-3)
    slow = np.array([0.01j, -0.01j])
    assert distance(np.array([0.02j, -0.02j]), slow) == pytest.approx(3e-4)
    centred = Scenario(disk=CENTRED_DISK, constraints=("contact", "no-slip-along"))
    assert comparisons.compare_eigenvalues(Scene(centred, "floating"), MOTIONS[0]).agrees


def test_a_motion_that_neither_side_can_linearise_is_not_compared() -> None:
    held: ConstraintSet = ("contact", "fixed-cog", "no-slip-across", "held-tilt-rate")
    start = Start(beta=1.2, gamma=0.3)
    scene = Scene(Scenario(constraints=held, start=start), "euler-tree")
    found = comparisons.compare_eigenvalues(scene, MOTIONS[0])
    assert found.agrees is None
    assert found.detail.startswith("neither side has any: singular index-1 system")


def test_eigenvalues_are_not_compared_on_a_contact_too_stiff_for_the_digits_of_heights() -> None:
    found = [
        comparisons.compare_eigenvalues(
            Scene(Scenario(contact=PenaltyContact(stiffness=each)), "floating"), MOTIONS[0]
        )
        for each in (2e11, 1e12)
    ]
    assert [each.agrees for each in found] == [True, None]
    assert found[1].detail.startswith("stiffness 1e+12 N/m turns the last digit of a height into")


# --- The study ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rows() -> Rows:
    """Rows of the study, with a difference that a measurement of two states has found."""
    found = list(compare_scene(Scene(Scenario(), "floating"), states=2, end=0.01))
    compared = [
        {"case": label, "kind": kind, **each._asdict(), "formulation": formulation}
        for label, (kind, scenario) in crosscheck.cases().items()
        for formulation in mbs_models.formulations(scenario)
        for each in found
        if kind != crosscheck.SETS or "motion" not in each.quantity
        if crosscheck.is_defined(each.quantity, scenario)
    ]
    table = pd.DataFrame(compared)
    table = table.assign(counted=table["kind"].map(crosscheck.STATES), lasting=comparisons.END)
    turned = pd.DataFrame({"turned": [1.0, 1.0 + 1e-8], "jellett": [0.0, 1e-10]})
    return {"crosscheck": table, "tippe-top": turned}


def test_study_compares_every_model_load_formulation_and_set(rows: Rows) -> None:
    content = crosscheck.present(rows)
    assert not failing(content.checks)
    assert content.numbers["scenes"] == 25
    cases = content.tables["scenes"]["case"]
    assert {" + ".join(each) for each in POSSIBLE_SETS} < set(cases)
    assert content.numbers["answer"] == "yes"
    wrong = planted(rows["crosscheck"], 0, "difference", 1e-4)
    assert crosscheck.present({**rows, "crosscheck": wrong}).numbers["answer"] == "no"


def test_jelletts_constant_is_kept_by_sliding_friction_and_lost_to_pivoting() -> None:
    pivoting = Dissipation(pivoting=1e-4)
    for scenario, is_kept in (
        (crosscheck.SPUN, True),
        (replace(crosscheck.SPUN, dissipation=pivoting), False),
    ):
        motion = analysis.simulate_to_rest(scenario, 0.05, tolerance=1e-6)
        constant = crosscheck.jellett(motion)
        assert constant.shape == motion.times.shape
        moved = np.max(np.abs(constant / constant[0] - 1.0))
        assert bool(moved < 1e-9) == is_kept
        assert motion.energy_taken("sliding")[-1] > 0.0


FIRST = "crosscheck: accelerations, the paper's models"
MOTION = f"crosscheck: {comparisons.MOTION}, the paper's models"

test_one_difference_that_is_too_large_or_none_and_a_missing_one_fail = faults(
    crosscheck.present,
    [
        ("tippe-top", 1, "turned", "tippe top: turned over", 1.0 + 2e-7, nan, None),
        ("tippe-top", 1, "jellett", "tippe top: Jellett's constant", 2e-9, nan),
        ("crosscheck", 0, "difference", FIRST, 1e-4, nan, None),
        ("crosscheck", -1, "difference", "other bodies", 1e-4, nan, None),
        ("crosscheck", 0, "", f"{FIRST}, scenes", GONE),
        ("crosscheck", 0, "counted", f"{FIRST}, states with a solution", 249),
        ("crosscheck", comparisons.MOTION, "lasting", f"{MOTION}, least time in s", 0.1),
    ],
)
