"""Hard cases: which there are, what they are called, and that whatever is wrong fails a check."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analysis
import mbs_models
from analysis import LOADS, MODELS, POSSIBLE_SETS, Scenario, Start, Trajectory
from analysis.data.endings import CONTACT_WOULD_PULL
from tests.helpers import failing, mostly_slow, not_none
from validation import study as kit
from validation.kit.references import Reference, reference
from validation.kit.ways import StepLimit, Way
from validation.page.content import Rows
from validation.studies.robustness import outcomes, penalty, steps
from validation.studies.robustness import section as robustness
from validation.studies.robustness.checks import NEAR, checks
from validation.studies.robustness.conservation import CONSERVATION, DRIFTING, FREE
from validation.studies.robustness.conservation import measure as long_run
from validation.studies.robustness.outcomes import CASES, CHOSEN, DOUBT, cases, cause, ways
from validation.studies.robustness.problems import TOLERANCE, Problem

TREE = Way("engine", "contact-tree", "RK67")
EULER = Way("engine", "euler-tree", "TrapezoidalIndex2")
DOP853 = Way("in-house", "index-1", "DOP853")
CHOSEN_WAY = Way("engine")

EASY = Problem(axis="none", label="", scenario=Scenario(), end=0.1, samples=11)
FAST = replace(EASY, scenario=Scenario(start=Start(spin=300.0)))
INVERTED = replace(EASY, end=1.0, samples=2, stop_when=("inverted",))


@cache
def known(problem: Problem) -> Reference:
    return reference(problem.scenario, problem.times, stop_when=problem.stop_when)


# --- Which there are ----------------------------------------------------------------------------


def test_grid_covers_all_formulations_and_integrators_of_each_model_and_all_sets() -> None:
    grid = [
        (problem.scenario.constraints, way)
        for problem in cases().values()
        for way in ways(problem)
    ]
    tried = {(constraints, way.name) for constraints, way in grid}
    for constraints in MODELS.values():
        for formulation in mbs_models.formulations(Scenario(constraints=constraints)):
            for integrator in mbs_models.integrators(formulation):
                assert (constraints, f"{formulation}, {integrator}") in tried
    sides = {(constraints, way.source) for constraints, way in grid}
    assert sides == {(each, side) for each in POSSIBLE_SETS for side in ("engine", "in-house")}
    sample = [cases()[name] for name in CASES.sample]
    assert {each.axis for each in sample} == {each.axis for each in cases().values()}


def test_what_the_library_is_left_to_choose_for_is_what_named_ways_do_not_finish() -> None:
    stored = kit.load(CASES)
    late = stored["cause"].str.contains("too many steps|does not converge")
    assert set(CHOSEN.cases()) == set(stored[late]["case"])
    assert {way for each in CHOSEN.cases().values() for way in ways(each)} == {CHOSEN_WAY}


# --- What they are called -----------------------------------------------------------------------


def judge(problem: Problem, run: Trajectory, truth: Any = None, **told: Any) -> kit.Row:
    """What becomes of a run that promises something and gives this result."""
    found = outcomes.judged(problem, replace(run, error_estimate=1e-9), truth or known(problem))
    found |= told
    return found | {"broken": outcomes.is_broken(found), "cause": cause(found)}


@pytest.mark.parametrize("way", [TREE, EULER, DOP853, CHOSEN_WAY], ids=lambda way: way.name)
def test_right_results_and_right_endings_are_called_so(way: Way) -> None:
    for problem, verdict in (
        (EASY, "accurate"),
        (FAST, "ends: contact would pull"),
        (INVERTED, "ends: condition met"),
    ):
        found = outcomes.outcome(problem, way, known(problem))
        assert (found["verdict"], found["broken"], found["cause"]) == (verdict, False, "")
        assert max(found["error"], found["ending_error"] or 0.0) < TOLERANCE


def moved(run: Trajectory, angle: float, column: int = 5) -> Trajectory:
    shift = angle * (np.arange(6) == column)
    return replace(run, coordinates=run.coordinates + shift)


def faster(run: Trajectory) -> Trajectory:
    return replace(run, rates=run.rates + 0.1 * (np.arange(6) == 4))


def later(run: Trajectory, seconds: float) -> Trajectory:
    """A run that ends later in the same state, as a condition makes it."""
    ending = not_none(run.ending)
    times = np.append(run.times[:-1], run.times[-1] + seconds)
    return replace(run, times=times, ending=replace(ending, time=ending.time + seconds))


def otherwise(run: Trajectory) -> Trajectory:
    return replace(run, ending=replace(not_none(run.ending), reason=CONTACT_WOULD_PULL))


@pytest.mark.parametrize(
    ("problem", "spoil"),
    [
        (EASY, partial(moved, angle=1e-4)),
        (INVERTED, partial(later, seconds=5e-6)),
        (INVERTED, otherwise),
    ],
    ids=["angles", "late", "reason"],
)
def test_wrong_angles_or_endings_break_the_promise_of_runs_that_make_one(
    problem: Problem, spoil: Callable[[Trajectory], Trajectory]
) -> None:
    right = known(problem).first
    assert not judge(problem, right)["broken"]
    wrong = judge(problem, spoil(right))
    assert (wrong["verdict"], wrong["broken"]) == ("inaccurate", True)
    assert wrong["cause"] == "wrong angles or ending"
    assert not judge(problem, spoil(right), estimate=None)["broken"]
    assert judge(problem, right, repeatable=False)["broken"]
    assert judge(problem, right, error=nan)["broken"]
    assert judge(problem, right, ending_error=inf)["broken"]


@pytest.mark.parametrize(
    ("wrong", "right", "spoil"),
    [("drift", "energy", partial(moved, angle=5e-7, column=2)), ("energy", "drift", faster)],
)
def test_drift_and_energy_count_as_well_as_the_angles(wrong: str, right: str, spoil: Any) -> None:
    found = judge(EASY, spoil(known(EASY).first))
    assert (found["verdict"], found["broken"]) == ("inaccurate", False)
    assert found[wrong] > outcomes.SLACK * TOLERANCE > found[right]
    assert found["cause"] == "angles accurate, energy or constraint not"


def test_run_in_which_the_contact_pulls_silently_is_not_accurate() -> None:
    run = analysis.simulate(FAST.scenario, FAST.times, allow_pulling=True, tolerance=1e-8)
    assert judge(FAST, run, Reference(first=run, second=run))["verdict"] == "inaccurate"


@pytest.mark.parametrize(
    ("doubt", "error", "verdict"),
    [
        (0.9 * DOUBT * TOLERANCE, 0.0, "accurate"),
        (1.1 * DOUBT * TOLERANCE, 0.0, "reference in doubt"),
        (1e-4, 1e-3, "inaccurate"),
    ],
)
def test_accurate_needs_a_reference_known_to_a_tenth_of_the_tolerance(
    doubt: float, error: float, verdict: str
) -> None:
    first = known(EASY).first
    truth = Reference(first=first, second=moved(first, doubt))
    assert judge(EASY, moved(known(EASY).second, error), truth)["verdict"] == verdict


def test_result_without_a_reference_is_not_called_accurate() -> None:
    run = known(EASY).first
    found = judge(EASY, run, ArithmeticError("too stiff"))
    assert (found["verdict"], found["broken"]) == ("reference in doubt", False)
    assert "too stiff" in found["reason"]
    assert judge(EASY, run, ValueError("cannot start"))["verdict"] == "inaccurate"


@pytest.mark.parametrize(
    ("taken", "error", "verdict", "why"),
    [
        (0, ValueError("explicit integrator"), "refused", "explicit integrator"),
        (1, ValueError("beta must lie in (0, pi)"), "crashed", "crashed"),
        (1, mbs_models.EngineError("Newton's iteration did not converge"), "diverged", "Newton"),
        (1, mbs_models.EngineError("singular: each newton of normal force"), "diverged", "load:"),
        (100_000, ValueError("on the way"), "not finished in the limit", "too many steps"),
    ],
)
def test_failed_refused_crashed_and_unfinished_runs_are_told_apart(
    taken: int, error: Exception, verdict: str, why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: Any, progress: StepLimit, **_options: Any) -> Trajectory:
        for _step in range(taken):
            progress(0.0, 1.0)
        raise error

    monkeypatch.setattr(mbs_models, "simulate", fails)
    found = outcomes.outcome(EASY, EULER, known(EASY))
    assert (found["verdict"], found["broken"]) == (verdict, verdict == "crashed")
    assert why in found["cause"]
    assert str(error) in found["reason"] or "50000 steps taken" in found["reason"]


def test_problem_of_which_the_process_ends_has_a_row_for_each_way() -> None:
    late = outcomes.failed(EASY, "not finished within 1 s")
    ended = outcomes.failed(EASY, "the interpreter ended with -11")
    for rows, verdict in ((late, "time limit"), (ended, "crashed")):
        assert [row["way"] for row in rows] == [way.name for way in ways(EASY)]
        told = {(row["verdict"], row["broken"]) for row in rows}
        assert told == {(verdict, verdict == "crashed")}


# --- Beside the cases ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "place", mostly_slow((("smoothing", 1e-8), ("stiffness", 1e7)), [("smoothing", 1e-8)])
)
def test_largest_stable_step_is_the_predicted_one(place: steps.Place) -> None:
    for row in steps.measure(place):
        assert row["step"] == pytest.approx(row["predicted"], rel=NEAR)


def test_long_runs_drift_where_and_only_where_constraints_are_differentiated() -> None:
    first, *_, last = (long_run(each)[0] for each in list(DRIFTING.values())[::6])
    assert first["growth"] > 1.5
    assert first["position"] > 1e-9
    assert last["position"] < 1e-15
    (free,) = long_run(FREE["contact-tree, RK67"])
    assert max(free[name] for name in ("energy", "momentum", "spin")) < 1e-9


@pytest.mark.parametrize("load", LOADS)
def test_penalty_contact_tends_to_the_ideal_one_with_its_stiffness(load: Any) -> None:
    (soft,), (stiff,) = (penalty.measure((each, load)) for each in (1e5, 1e6))
    assert stiff["estimate"] < 0.01 * stiff["angles"]
    for name in ("angles", "normal_force"):
        assert soft[name] / stiff[name] == pytest.approx(10.0, rel=0.1)


# --- Whatever is wrong fails a check ------------------------------------------------------------


def made(study: kit.Study, rows: Callable[[Any], list[kit.Row]]) -> pd.DataFrame:
    """A table of a study from made-up rows of its cases."""
    told = study.cases().items()
    return kit.frame({**row, "case": name} for name, case in told for row in rows(case))


def limits(place: steps.Place) -> list[kit.Row]:
    axis, value = place
    predicted = None if value == 1.0 else 1e-3
    row = {"over": axis, "value": value, "step": 1e-3, "predicted": predicted}
    return [row | {"integrator": each} for each in steps.EXPLICIT]


def ideal(case: Any) -> list[kit.Row]:
    error = 1.0 / case[0]
    same = {"angles": error, "normal_force": error, "estimate": 1e-3 * error}
    return [{"stiffness": case[0], "load": case[1], **same}]


@pytest.fixture
def rows() -> dict[str, pd.DataFrame]:
    """The stored cases, and tables in which all holds."""
    kept = {**dict.fromkeys(CONSERVATION.columns, 0.0), "allowed": 1e-6}
    return {
        **{study.name: kit.load(study) for study in (CASES, CHOSEN)},
        steps.STEPS.name: made(steps.STEPS, limits),
        CONSERVATION.name: made(CONSERVATION, lambda _: [kept]),
        penalty.PENALTY.name: made(penalty.PENALTY, ideal),
    }


def test_stored_cases_hold_and_are_told_with_their_numbers(rows: Rows) -> None:
    content = robustness.present(rows)
    assert all(check.holds for check in content.checks)
    (verdict,) = content.verdicts
    assert (verdict.answer, verdict.good) == ("yes", True)
    numbers = content.numbers
    assert sum(numbers["counts"].values()) == numbers["total"] == len(rows["robustness"])
    assert numbers["without"] == sum(numbers["causes"][each] for each in numbers["causes"] if each)


@pytest.mark.parametrize(
    ("study", "column", "value", "check"),
    [
        ("robustness", "error", 1e-3, "promise broken"),
        ("robustness-chosen", "energy", inf, "against their numbers"),
        ("robustness-chosen", "way", "another", "missing or too many"),
        ("robustness-steps", "step", 2e-3, "stable over predicted"),
        ("robustness-steps", "predicted", nan, "places without"),
        ("robustness-conservation", "position", 1e-3, "position"),
        ("robustness-conservation", "energy", nan, "energy"),
        ("robustness-penalty", "angles", 1.0, "order less one"),
        ("robustness-penalty", "estimate", 1.0, "error of integration"),
    ],
)
def test_what_is_wrong_in_a_table_fails(
    study: str, column: str, value: Any, check: str, rows: dict[str, pd.DataFrame]
) -> None:
    # At the first place of the steps, the spinning itself is unstable.
    rows[study].loc[2 if study == "robustness-steps" else 0, column] = value
    assert [name for name in failing(checks(rows)) if check in name]


def test_too_many_cases_left_and_growing_drift_fail(
    rows: dict[str, pd.DataFrame],
) -> None:
    rows["robustness-conservation"]["growth"] = 2.0
    rows["robustness-chosen"].loc[:3, "verdict"] = "diverged"
    for check, number in (("growth", 3), ("accurate result", 1)):
        assert sum(name.endswith(check) for name in failing(checks(rows))) == number
