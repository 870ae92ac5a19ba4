"""Hard cases: which there are, what they are called, and that whatever is wrong fails a check."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analysis
import mbs_models
from analysis import MODELS, POSSIBLE_SETS, STEEL_DISK, Scenario, Start, Trajectory
from analysis.motion.endings import CONTACT_WOULD_PULL
from tests.faults import Rows, faults
from tests.helpers import failing, not_none
from validation import study as studying
from validation.comparison.references import Reference, reference
from validation.comparison.ways import StepLimit, Way
from validation.studies.robustness import conservation, outcomes, penalty, section, steps
from validation.studies.robustness.outcomes import CASES, CHOSEN, DOUBT, ways
from validation.studies.robustness.problems import TOLERANCE, Problem, problems

TREE = Way("engine", "contact-tree", "RK67")
DOP853 = Way("in-house", "index-1", "DOP853")

EASY = Problem(scenario=Scenario(), end=0.1, samples=11)
FAST = replace(EASY, scenario=Scenario(start=Start(spin=300.0)))
INVERTED = replace(EASY, end=1.0, samples=2, stop_when=("inverted",))


@cache
def known(problem: Problem) -> Reference:
    return reference(problem.scenario, problem.times, stop_when=problem.stop_when)


def test_grid_covers_all_formulations_and_integrators_of_each_model_and_all_sets() -> None:
    every = problems()
    grid = [(each.scenario.constraints, way) for each in every.values() for way in ways(each)]
    tried = {(constraints, way.name) for constraints, way in grid}
    assert tried >= {
        (constraints, f"{formulation}, {integrator}")
        for constraints in MODELS.values()
        for scenario in [Scenario(constraints=constraints)]
        for formulation in mbs_models.formulations(scenario)
        for integrator in mbs_models.integrators(mbs_models.Scene(scenario, formulation))
    }
    sides = {(constraints, way.source) for constraints, way in grid}
    assert sides == {(each, side) for each in POSSIBLE_SETS for side in ("engine", "in-house")}
    sampled, axes = (
        {name.rpartition(": ")[0] for name in names} for names in (CASES.sample, every)
    )
    assert sampled == axes


@pytest.mark.parametrize("label", ["0.001", "10"])
def test_a_disk_of_another_size_turns_as_the_original_does_in_its_time(label: str) -> None:
    problem = problems()[f"radius of the disk in m: {label}, Model 1"]
    scale = float(label) / STEEL_DISK.radius
    times, scenario = problem.times, problem.scenario
    found = analysis.simulate(scenario, times, tolerance=1e-8)
    original = analysis.simulate(Scenario(), times / np.sqrt(scale), tolerance=1e-8)
    np.testing.assert_allclose(found.coordinates[:, 3:], original.coordinates[:, 3:], atol=1e-6)


# --- What they are called -----------------------------------------------------------------------


def judge(problem: Problem, run: Trajectory, truth: Any = None, **told: Any) -> studying.Row:
    """What becomes of a run that promises something and gives this result."""
    found = outcomes.classified(
        problem, replace(run, error_estimate=1e-9), truth or known(problem)
    )
    return explained({"reason": "", **found, **told})


def explained(found: studying.Row) -> studying.Row:
    return found | {"broken": outcomes.is_broken(found), "cause": outcomes.cause(found)}


@pytest.mark.parametrize("way", [TREE, DOP853, Way("engine")], ids=lambda way: way.name)
def test_right_results_and_right_endings_are_called_so(way: Way) -> None:
    for problem, verdict in (
        (EASY, "accurate"),
        (FAST, "ends: contact would pull"),
        (INVERTED, "ends: condition met"),
    ):
        found = explained(outcomes.outcome(problem, way, known(problem)))
        assert (found["verdict"], found["broken"], found["cause"]) == (verdict, False, "")
        assert found["error"] < TOLERANCE


def moved(run: Trajectory, angle: float = 1e-4, column: int = 5) -> Trajectory:
    return replace(run, coordinates=run.coordinates + angle * np.eye(6)[column])


def faster(run: Trajectory) -> Trajectory:
    return replace(run, rates=run.rates + 0.1 * np.eye(6)[4])


def otherwise(run: Trajectory) -> Trajectory:
    return replace(run, ending=replace(not_none(run.ending), reason=CONTACT_WOULD_PULL))


@pytest.mark.parametrize(
    ("problem", "spoil", "wrong"),
    [
        (EASY, moved, "error"),
        (INVERTED, otherwise, "error"),
        (EASY, partial(moved, angle=5e-7, column=2), "drift"),
        (EASY, faster, "energy"),
    ],
)
def test_whatever_is_wrong_is_inaccurate_and_wrong_angles_or_endings_break_a_promise(
    problem: Problem, spoil: Callable[[Trajectory], Trajectory], wrong: str
) -> None:
    right, breaks = known(problem).first, wrong == "error"
    found = judge(problem, spoil(right))
    for name in ("error", "drift", "energy"):
        assert (found[name] > outcomes.SLACK * TOLERANCE) == (name == wrong)
    cause = "wrong angles or ending" if breaks else "angles accurate, energy or constraint not"
    assert (found["verdict"], found["broken"], found["cause"]) == ("inaccurate", breaks, cause)
    assert not judge(problem, spoil(right), estimate=None)["broken"]
    assert not judge(problem, right)["broken"]
    assert judge(problem, right, repeatable=False)["broken"]


def test_accurate_needs_a_reference_known_to_a_tenth_of_the_tolerance() -> None:
    first, second = known(EASY).first, known(EASY).second
    for doubt, error, verdict in (
        (0.9 * DOUBT * TOLERANCE, 0.0, "accurate"),
        (1.1 * DOUBT * TOLERANCE, 0.0, "reference in doubt"),
        (1e-4, 1e-3, "inaccurate"),
    ):
        truth = Reference(first=first, second=moved(first, doubt))
        assert judge(EASY, moved(second, error), truth)["verdict"] == verdict
    found = judge(EASY, first, ArithmeticError("too stiff"))
    assert (found["verdict"], found["broken"]) == ("reference in doubt", False)
    # One in which the contact pulls silently is not, either.
    pulling = analysis.simulate(FAST.scenario, FAST.times, allow_pulling=True, tolerance=1e-8)
    both = Reference(first=pulling, second=pulling)
    assert judge(FAST, pulling, both)["verdict"] == "inaccurate"


@pytest.mark.parametrize(
    ("taken", "error", "verdict", "why"),
    [
        (0, ValueError("explicit integrator"), "crashed", "crashed"),
        (1, mbs_models.EngineError("singular system matrix"), "diverged", "singular"),
        (100_000, ValueError("on the way"), "not finished in the limit", "too many steps"),
    ],
)
def test_failed_refused_and_unfinished_runs_are_told_apart(
    taken: int, error: Exception, verdict: str, why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: Any, progress: StepLimit, **_options: Any) -> Trajectory:
        for _step in range(taken):
            progress(0.0, 1.0)
        raise error

    monkeypatch.setattr(mbs_models, "simulate", fails)
    found = explained(outcomes.outcome(EASY, TREE, known(EASY)))
    assert (found["verdict"], found["broken"]) == (verdict, verdict == "crashed")
    assert why in found["cause"]
    assert str(error) in found["reason"] or "50000 steps taken" in found["reason"]


@pytest.mark.parametrize(
    ("planted", "column", "told"),
    [
        ("coordinates", 2, {"position": 1e-3, "energy": 1e-3 / STEEL_DISK.radius}),
        ("rates", 0, {"momentum": 1e-3 / (STEEL_DISK.radius * 40.0)}),
    ],
)
def test_what_a_long_run_does_not_keep_is_told_in_parts_of_weight_and_speed(
    planted: str, column: int, told: dict[str, float]
) -> None:
    def spoilt(scenario: Scenario, times: np.ndarray, **_: Any) -> Trajectory:
        run = analysis.simulate(scenario, times, local_tolerance=1e-9)
        # A millimetre, or one per second, in the second half.
        values = getattr(run, planted).copy()
        values[times > 1.0, column] += 1e-3
        return replace(run, **{planted: values})

    way: Any = SimpleNamespace(source="in-house", run=spoilt)
    free = conservation.FREE[DOP853.name]
    (found,) = conservation.measure(free._replace(way=way))
    assert {name: found[name] for name in told} == pytest.approx(told, rel=1e-3)


# --- Whatever is wrong fails a check ------------------------------------------------------------


@pytest.fixture(scope="module")
def rows() -> Rows:
    """The stored tables, and others in which all holds."""
    kept = dict.fromkeys(conservation.COLUMNS, 0.0)
    right = {
        conservation.STUDY.name: [{**kept, "case": case} for case in conservation.STUDY.cases()],
        penalty.STUDY.name: [
            {"case": name, "stiffness": stiffness, "load": load, "estimate": 1e-3 / stiffness}
            | dict.fromkeys(("angles", "normal_force"), 1.0 / stiffness)
            for name, (stiffness, load) in penalty.STUDY.cases().items()
        ],
        steps.STUDY.name: [
            {"case": name, "quantity": quantity, "value": value, "integrator": each}
            | {"below": True, "above": False}
            for name, (quantity, value) in steps.STUDY.cases().items()
            for each in steps.EXPLICIT
        ],
    }
    stored = {study.name: studying.load(study) for study in (CASES, CHOSEN)}
    return stored | {name: pd.DataFrame(told) for name, told in right.items()}


def test_stored_cases_hold_and_are_told_with_their_numbers(rows: Rows) -> None:
    content = section.present(rows)
    assert not failing(content.checks)
    numbers, tables = content.numbers, content.tables
    assert numbers["answer"] == "yes"
    shown = tables["outcomes"].set_index("what is extreme")
    assert shown.to_numpy().sum() == numbers["total"] == len(rows["robustness"])
    assert not shown["crashed"].any()
    assert tables["causes"]["cases"].sum() == numbers["without"]


test_what_is_wrong_in_a_table_fails = faults(
    section.present,
    [
        ("robustness", 0, "error", ("promise broken", "against their numbers"), 1e-3),
        ("robustness-chosen", 0, "energy", "against their numbers", inf),
        ("robustness-chosen", 0, "way", "missing or too many", "another"),
        ("robustness-chosen", 0, "verdict", "without an accurate result", "diverged"),
        ("robustness-steps", 0, "below", "the predicted limit", False),
        ("robustness-steps", 0, "above", "the predicted limit", True),
        ("robustness-conservation", 0, "position", "position", 1e-3),
        ("robustness-conservation", 0, "energy", "energy", nan),
        ("robustness-conservation", 2, "growth", "growth", 2.0),
        ("robustness-conservation", 14, "spin", "spin", 1e-3),
        ("robustness-penalty", 0, "angles", "order less one", 1.0),
        ("robustness-penalty", 0, "estimate", "error of integration", 1.0),
    ],
)
