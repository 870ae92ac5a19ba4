"""Hard cases: which there are, what they are called, and that whatever is wrong fails a check."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import cos, inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analysis
import mbs_models
from analysis import LEVELS, LOADS, MODELS, POSSIBLE_SETS, STEEL_DISK, Scenario, Start, Trajectory
from analysis.data.endings import CONTACT_WOULD_PULL
from mbs_models import Scene
from tests.helpers import not_none
from validation import study as kit
from validation.kit.references import Reference, reference
from validation.kit.ways import StepLimit, Way
from validation.page.content import Rows
from validation.studies.robustness import ended, outcomes, penalty, random_scenarios, steps
from validation.studies.robustness import section as robustness
from validation.studies.robustness.checks import NEAR, checks
from validation.studies.robustness.conservation import CONSERVATION, DRIFTING, FREE
from validation.studies.robustness.conservation import measure as long_run
from validation.studies.robustness.outcomes import (
    CASES,
    DOUBT,
    cases,
    cause,
    is_broken,
    judged,
    outcome,
    reference_or_error,
    ways,
)
from validation.studies.robustness.problems import TOLERANCE, Problem, body
from validation.studies.robustness.refusals import REFUSALS, REQUESTS
from validation.studies.robustness.refusals import measure as ask

TREE = Way(source="engine", formulation="contact-tree", integrator="RK67")
EULER = Way(source="engine", formulation="euler-tree", integrator="TrapezoidalIndex2")
DOP853 = Way(source="in-house", formulation="index-1", integrator="DOP853")
WAYS = pytest.mark.parametrize("way", [TREE, EULER, DOP853], ids=lambda way: way.name)

EASY = Problem(axis="none", label="", scenario=Scenario(), end=0.1, samples=11)
FAST = replace(EASY, scenario=Scenario(start=Start(spin=300.0)))
INVERTED = replace(EASY, end=1.0, samples=2, stop_when=("inverted",))


@cache
def known(problem: Problem) -> Reference:
    return reference(problem.scenario, problem.times, stop_when=problem.stop_when)


# --- Which there are ----------------------------------------------------------------------------

GRID = [(problem, way) for problem in cases().values() for way in ways(problem)]


def test_grid_covers_all_formulations_and_integrators_of_each_model_and_all_sets() -> None:
    tried = {(problem.scenario.constraints, way.name) for problem, way in GRID}
    for constraints in MODELS.values():
        for formulation in mbs_models.formulations(Scenario(constraints=constraints)):
            for integrator in mbs_models.integrators(formulation):
                assert (constraints, f"{formulation}, {integrator}") in tried
    sides = {(problem.scenario.constraints, way.source) for problem, way in GRID}
    assert sides == {(each, side) for each in POSSIBLE_SETS for side in ("engine", "in-house")}


def test_sample_has_a_case_of_each_axis_without_a_model_of_more_constraints() -> None:
    sample = [cases()[name] for name in CASES.sample]
    assert {each.axis for each in sample} == {each.axis for each in cases().values()}
    assert {each.scenario.model for each in sample} == {1, None}


def test_motions_that_end_cover_models_conditions_accuracies_and_loads_with_few_samples() -> None:
    own = [problem for problem in cases().values() if problem.axis == ended.AXIS]
    few = [problem for problem in own if problem.samples == 2]
    assert len(few) > len(own) / 2
    assert {problem.scenario.model for problem in few} == set(LEVELS)
    conditions = {problem.stop_when for problem in few}
    names = ("inverted", "lost", f"{ended.OWN}passes_sideways", f"{ended.OWN}falls_low")
    assert conditions == {(), *((name,) for name in names)}
    assert {problem.tolerance for problem in few} == {10.0**-n for n in range(3, 9)}
    assert {problem.scenario.friction.load for problem in few} == set(LOADS)


def test_rigid_body_exists_for_every_eccentricity_and_as_flat_as_it_may_be() -> None:
    moments = STEEL_DISK.inertia_about_cog
    for eccentricity in (0.0, 1e-9, 0.99 * STEEL_DISK.radius):
        found = body(moments, eccentricity).inertia_about_cog
        np.testing.assert_allclose(found, moments, rtol=1e-9)
    flat = cases()["inertia about the COG: lamina, COG at 0.9 r, Model 1"].scenario.disk
    a, b, c = flat.inertia_about_cog
    assert a + b == pytest.approx(c, rel=1e-12)


@pytest.mark.parametrize("radius", ["0.001", "10"])
def test_scaled_disk_makes_the_same_motion(radius: str) -> None:
    problem = cases()[f"radius of the disk in m: {radius}, Model 1"]
    run, original = (
        mbs_models.simulate(Scene(each), np.linspace(0.0, end, 51), tolerance=1e-8)
        for each, end in ((problem.scenario, problem.end), (Scenario(), 0.5))
    )
    np.testing.assert_allclose(run.coordinates[:, 3:], original.coordinates[:, 3:], atol=1e-7)


def test_random_draws_are_those_of_their_seed_and_within_their_ranges() -> None:
    drawn = random_scenarios.draws(40, 3)
    assert drawn == random_scenarios.draws(40, 3)
    assert drawn[0] != random_scenarios.draws(1, 4)[0]
    assert {problem.scenario.constraints for problem, _ in drawn} == set(MODELS.values())
    for problem, way in drawn:
        assert way.formulation in mbs_models.formulations(problem.scenario)
        assert 1e-8 <= problem.tolerance <= 1e-3


@pytest.mark.parametrize(("broken", "code"), [(False, 0), (True, 1)])
def test_random_motion_that_breaks_its_promise_fails(
    broken: bool, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = dict.fromkeys(outcomes.COLUMNS) | {"verdict": "accurate", "reason": "", "broken": broken}
    monkeypatch.setattr(random_scenarios, "reference_or_error", lambda _: None)
    monkeypatch.setattr(random_scenarios, "outcome", lambda *_: row)
    assert random_scenarios.main(["--number", "2"]) == code
    assert ("2 BROKEN" in capsys.readouterr().out) is broken


# --- What they are called -----------------------------------------------------------------------


def judge(problem: Problem, run: Trajectory, truth: Any = None, **told: Any) -> kit.Row:
    """Verdict on a run that promises something, with what it breaks."""
    found = judged(problem, replace(run, error_estimate=1e-9), truth or known(problem)) | told
    return found | {"broken": is_broken(problem.tolerance, found)}


@WAYS
def test_easy_case_is_accurate(way: Way) -> None:
    found = outcome(EASY, way, known(EASY))
    assert found["verdict"] == "accurate"
    assert not found["broken"]
    assert found["error"] <= found["estimate"]


@WAYS
def test_right_endings_are_classes_of_their_own(way: Way) -> None:
    for problem, verdict in (
        (FAST, "ends: contact would pull"),
        (INVERTED, "ends: condition met"),
    ):
        found = outcome(problem, way, known(problem))
        assert (found["verdict"], found["broken"], found["cause"]) == (verdict, False, "")
        assert found["ending_error"] < TOLERANCE


def moved(run: Trajectory, angle: float, column: int = 5) -> Trajectory:
    shift = angle * (np.arange(6) == column)
    return replace(run, coordinates=run.coordinates + shift)


def test_wrong_angles_break_the_promise_of_runs_that_make_one() -> None:
    wrong = judge(EASY, moved(known(EASY).first, 1e-4))
    assert (wrong["verdict"], wrong["broken"]) == ("inaccurate", True)
    assert cause(TOLERANCE, wrong) == "wrong angles or ending"
    assert not is_broken(TOLERANCE, wrong | {"estimate": None})
    assert is_broken(TOLERANCE, judge(EASY, known(EASY).first, repeatable=False))


def faster(run: Trajectory) -> Trajectory:
    return replace(run, rates=run.rates + 0.1 * (np.arange(6) == 4))


@pytest.mark.parametrize(
    ("wrong", "right", "spoil"),
    [("drift", "energy", partial(moved, angle=5e-7, column=2)), ("energy", "drift", faster)],
)
def test_drift_and_energy_count_as_well_as_the_angles(wrong: str, right: str, spoil: Any) -> None:
    found = judge(EASY, spoil(known(EASY).first))
    assert (found["verdict"], found["broken"]) == ("inaccurate", False)
    assert found[wrong] > outcomes.SLACK * TOLERANCE > found[right]
    assert cause(TOLERANCE, found) == "angles accurate, energy or constraint not"


def later(run: Trajectory, seconds: float) -> Trajectory:
    """A run that ends later in the same state, as a condition makes it."""
    ending = not_none(run.ending)
    times = np.append(run.times[:-1], run.times[-1] + seconds)
    return replace(run, times=times, ending=replace(ending, time=ending.time + seconds))


def unended(run: Trajectory) -> Trajectory:
    return replace(run, times=np.append(run.times[:-1], INVERTED.end), ending=None)


def otherwise(run: Trajectory) -> Trajectory:
    return replace(run, ending=replace(not_none(run.ending), reason=CONTACT_WOULD_PULL))


@pytest.mark.parametrize(
    "spoil",
    [
        partial(later, seconds=5e-6),
        partial(later, seconds=-5e-7),
        partial(moved, angle=2e-6),
        otherwise,
        unended,
    ],
    ids=["late", "early, at some rad/s", "attitude", "reason", "not at all"],
)
def test_wrong_ending_breaks_the_promise(spoil: Callable[[Trajectory], Trajectory]) -> None:
    right = known(INVERTED).first
    assert not judge(INVERTED, right)["broken"]
    wrong = judge(INVERTED, spoil(right))
    assert (wrong["verdict"], wrong["broken"]) == ("inaccurate", True)
    coarse = judge(replace(INVERTED, tolerance=1e-3), later(right, 1e-5))
    assert coarse["verdict"] == "ends: condition met"


@pytest.mark.parametrize("wrong", [nan, inf, None])
def test_error_that_is_no_number_breaks_a_promise(wrong: Any) -> None:
    found = {"verdict": "accurate", "error": 1e-9, "doubt": 0.0, "estimate": 1e-9}
    assert not is_broken(1e-6, found)
    assert is_broken(1e-6, found | {"ending_error": nan if wrong is None else wrong})
    assert is_broken(1e-6, found | {"error": wrong}) is (wrong is not None)


def test_run_in_which_the_contact_pulls_silently_is_not_accurate() -> None:
    run = analysis.simulate(FAST.scenario, FAST.times, allow_pulling=True, tolerance=1e-8)
    assert judge(FAST, run, Reference(first=run, second=run))["verdict"] == "inaccurate"


@pytest.mark.parametrize(("doubt", "verdict"), [(0.9, "accurate"), (1.1, "reference in doubt")])
def test_accurate_needs_a_reference_known_to_a_tenth_of_the_tolerance(
    doubt: float, verdict: str
) -> None:
    first = known(EASY).first
    truth = Reference(first=first, second=moved(first, doubt * DOUBT * TOLERANCE))
    assert judge(EASY, known(EASY).second, truth)["verdict"] == verdict
    doubtful = Reference(first=first, second=moved(first, 1e-4))
    assert judge(EASY, moved(known(EASY).second, 1e-3), doubtful)["verdict"] == "inaccurate"
    assert judge(EASY, known(EASY).second, doubtful)["verdict"] == "reference in doubt"


def test_result_without_a_reference_is_not_called_accurate() -> None:
    run = known(EASY).first
    found = judge(EASY, run, ArithmeticError("too stiff"))
    assert (found["verdict"], found["broken"]) == ("reference in doubt", False)
    assert "too stiff" in found["reason"]
    assert judge(EASY, run, ValueError("cannot start"))["verdict"] == "inaccurate"


def test_start_that_needs_a_pulling_contact_is_refused_by_run_and_reference() -> None:
    start, rate = EASY.scenario.initial_state, 100.0
    x, y, _, alpha, _, gamma = start.rates
    rising = STEEL_DISK.radius * cos(start.coordinates[4]) * rate
    thrown = replace(start, rates=(x, y, rising, alpha, rate, gamma))
    problem = replace(EASY, scenario=Scenario(start=thrown))
    truth = reference_or_error(problem)
    assert isinstance(truth, ValueError)
    found = outcome(problem, TREE, truth)
    assert found["verdict"] == "refused"
    assert found["cause"] == "starts where the contact would pull"


@pytest.mark.parametrize(
    ("taken", "error", "verdict"),
    [
        (0, ValueError("explicit integrator"), "refused"),
        (1, ValueError("beta must lie in the open interval (0, pi)"), "crashed"),
        (1, mbs_models.EngineError("engine run stopped"), "diverged"),
        (100_000, ValueError("on the way"), "not finished in the limit"),
    ],
)
def test_failed_refused_crashed_and_unfinished_runs_are_told_apart(
    taken: int, error: Exception, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(*_: Any, progress: StepLimit, **_options: Any) -> Trajectory:
        for _step in range(taken):
            progress(0.0, 1.0)
        raise error

    monkeypatch.setattr(mbs_models, "simulate", failing)
    found = outcome(EASY, EULER, known(EASY))
    assert (found["verdict"], found["broken"]) == (verdict, verdict == "crashed")
    assert str(error) in found["reason"] or "50000 steps taken" in found["reason"]


@pytest.mark.parametrize(
    ("reason", "verdict"),
    [("not finished within 1 s", "time limit"), ("the interpreter ended with -11", "crashed")],
)
def test_problem_of_which_the_process_ends_has_a_row_for_each_way(
    reason: str, verdict: str
) -> None:
    rows = outcomes.failed(EASY, reason)
    assert [row["way"] for row in rows] == [way.name for way in ways(EASY)]
    assert {(row["verdict"], row["broken"]) for row in rows} == {(verdict, verdict == "crashed")}


@pytest.mark.parametrize(
    ("reason", "expected"),
    [
        ("Newton's iteration did not converge", "Newton's iteration does not converge"),
        ("singular: each newton of normal force calls for 1.5 N", "contact load: friction calls"),
        ("the disk lies flat, and", "falls flat, where Euler angles end"),
        ("something else", "something else"),
    ],
)
def test_causes_are_told_from_what_runs_say(reason: str, expected: str) -> None:
    assert cause(1e-6, {"verdict": "diverged", "reason": reason}).startswith(expected)


@pytest.mark.parametrize(
    ("model", "formulation", "integrator"),
    [(1, "floating", "GeneralizedAlpha"), (4, "floating-lie", "TrapezoidalIndex2")],
)
def test_newton_is_content_with_rounding_on_a_disk_that_weighs_next_to_nothing(
    model: int, formulation: Any, integrator: Any
) -> None:
    problem = cases()[f"radius of the disk in m: 0.001, Model {model}"]
    way = Way(source="engine", formulation=formulation, integrator=integrator)
    assert outcome(problem, way, known(problem))["verdict"] == "accurate"


# --- Beside the cases ---------------------------------------------------------------------------


@pytest.mark.parametrize("place", [("smoothing", 1e-8), ("stiffness", 1e7)])
def test_largest_stable_step_is_the_predicted_one_and_implicit_ones_are_longer(
    place: steps.Place,
) -> None:
    rows = steps.measure(place)
    stable = [row for row in rows if row["kind"] == "stable"]
    assert len(stable) == 2
    for row in stable:
        assert row["step"] == pytest.approx(row["predicted"], rel=NEAR)
    explicit, *implicit = [row["step"] for row in rows if row["kind"] == "accurate"] or [1.0, 2.0]
    assert all(step > explicit for step in implicit)


def test_steps_at_which_a_run_leaves_all_bounds_are_no_accurate_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(steps, "LADDER", (1e-1, 3e-3))
    problem = cases()["contact stiffness in N/m: 1e6, Model 1"]
    run = analysis.simulate(Scenario(), EASY.times)
    assert steps.largest_accurate(Scene(problem.scenario, "euler-tree"), "RK44", run) is None


def test_acceleration_level_drifts_and_minimal_coordinates_do_not() -> None:
    first, *_, last = (long_run(each)[0] for each in (*list(DRIFTING.values())[::6],))
    assert first["growth"] > 1.5
    assert first["position"] > 1e-9
    assert last["position"] < 1e-15


def test_frictionless_disk_keeps_energy_and_momenta() -> None:
    (found,) = long_run(FREE["contact-tree, RK67"])
    assert max(found[name] for name in ("energy", "momentum", "spin")) < 1e-9


@pytest.mark.parametrize("load", LOADS)
def test_penalty_contact_tends_to_the_ideal_one_with_its_stiffness(load: Any) -> None:
    (soft,), (stiff,) = (penalty.measure((each, load)) for each in (1e5, 1e6))
    assert stiff["estimate"] < 0.01 * stiff["angles"]
    for name in ("angles", "normal_force"):
        assert soft[name] / stiff[name] == pytest.approx(10.0, rel=0.1)


@pytest.mark.parametrize("name", REQUESTS)
def test_what_cannot_work_is_refused_at_once_in_one_line(name: str) -> None:
    (found,) = ask(name)
    assert found["at_once"], found["reason"]


# --- Whatever is wrong fails a check ------------------------------------------------------------


def made(study: kit.Study, rows: Callable[[Any], list[kit.Row]]) -> pd.DataFrame:
    """A table of a study from made-up rows of its cases."""
    told = study.cases().items()
    return kit.frame({"case": name, **row} for name, case in told for row in rows(case))


def limits(place: steps.Place) -> list[kit.Row]:
    axis, value = place
    stable = {"kind": "stable", "step": 1e-3, "predicted": None if value == 1.0 else 1e-3}
    found = [{**stable, "formulation": steps.TREES[axis], "integrator": i} for i in steps.EXPLICIT]
    found += [
        {"kind": "accurate", "step": 1e-3, "formulation": formulation, "integrator": integrator}
        for formulation, integrator in steps.WAYS[axis]
    ]
    return [{"over": axis, "value": value, **row} for row in found]


KEPT = ("position", "at_end", "growth", "velocity", "energy", "momentum", "spin")


def ideal(case: Any) -> list[kit.Row]:
    error = 1.0 / case[0]
    same = {"angles": error, "normal_force": error, "estimate": 1e-3 * error}
    return [{"stiffness": case[0], "load": case[1], **same}]


@pytest.fixture
def rows() -> dict[str, pd.DataFrame]:
    """The stored cases, and tables in which all holds."""
    refused = {"at_once": True, "reason": "", "seconds": 0.0}
    return {
        CASES.name: kit.load(CASES),
        steps.STEPS.name: made(steps.STEPS, limits),
        CONSERVATION.name: made(
            CONSERVATION, lambda _: [{**dict.fromkeys(KEPT, 0.0), "allowed": 1e-6}]
        ),
        penalty.PENALTY.name: made(penalty.PENALTY, ideal),
        REFUSALS.name: made(REFUSALS, lambda _: [refused]),
    }


def failing(rows: Rows) -> list[str]:
    return [check.name for check in checks(rows) if not check.holds]


def test_stored_cases_hold_and_are_told_with_their_numbers(rows: Rows) -> None:
    content = robustness.present(rows)
    assert all(check.holds for check in content.checks)
    (verdict,) = content.verdicts
    assert (verdict.answer, verdict.good) == ("yes", True)
    numbers = content.numbers
    assert sum(numbers["counts"].values()) == numbers["total"] == len(GRID)
    assert numbers["without"] == sum(numbers["causes"][each] for each in numbers["causes"] if each)


@pytest.mark.parametrize(
    ("study", "column", "value", "check"),
    [
        ("robustness", "broken", True, "promise broken"),
        ("robustness", "error", 1e-3, "promise broken"),
        ("robustness", "error", nan, "against their numbers"),
        ("robustness", "energy", inf, "against their numbers"),
        ("robustness", "verdict", "crashed", "promise broken"),
        ("robustness-steps", "step", 2e-3, "stable over predicted"),
        ("robustness-steps", "predicted", nan, "places without"),
        ("robustness-conservation", "position", 1e-3, "position"),
        ("robustness-conservation", "energy", nan, "energy"),
        ("robustness-penalty", "angles", 1.0, "order less one"),
        ("robustness-penalty", "estimate", 1.0, "error of integration"),
        ("robustness-refusals", "at_once", False, "not at once"),
    ],
)
def test_what_is_wrong_in_a_table_fails(
    study: str, column: str, value: Any, check: str, rows: dict[str, pd.DataFrame]
) -> None:
    assert failing(rows) == []
    table = rows[study]
    # At the first place of the steps, the spinning itself is unstable.
    table.loc[6 if study == "robustness-steps" else 0, column] = value
    assert [name for name in failing(rows) if check in name]


@pytest.mark.parametrize(
    ("study", "check"),
    [("robustness", "missing or too many"), ("robustness-steps", "places without")],
)
def test_missing_row_fails(study: str, check: str, rows: dict[str, pd.DataFrame]) -> None:
    rows[study] = rows[study].drop(index=6)
    assert [name for name in failing(rows) if check in name]


def test_drift_that_grows_and_implicit_steps_that_shrink_fail(
    rows: dict[str, pd.DataFrame],
) -> None:
    drift, found = rows["robustness-conservation"], rows["robustness-steps"]
    drift["growth"] = 2.0
    accurate = (found["kind"] == "accurate") & (found["case"] == "stiffness 1e+09 N/m")
    found.loc[accurate, "step"] = 1e-5
    assert sum(name.endswith("growth") for name in failing(rows)) == 3
    assert sum("over all stiffnesses" in name for name in failing(rows)) == 3


def spoiled(column: str, value: Any) -> Callable[[list[kit.Row]], Any]:
    return lambda rows: [rows[0] | {column: value}, *rows[1:]]


@pytest.mark.parametrize(
    "spoil",
    [
        spoiled("verdict", "inaccurate"),
        spoiled("broken", True),
        spoiled("error", nan),
        spoiled("error", 1e-6),
        lambda rows: rows[1:],
        lambda _: RuntimeError("the interpreter ended with code -11"),
        lambda _: [],
    ],
    ids=["verdict", "broken", "nan", "error", "missing", "crash", "nothing"],
)
def test_sample_that_comes_out_otherwise_fails(spoil: Any) -> None:
    stored = kit.load(CASES)
    found: kit.Found = {}
    for name in CASES.sample:
        own = stored[stored["case"] == name].drop(columns="case").to_dict("records")
        found[CASES.name, name] = [
            {key: None if value != value else value for key, value in row.items()}  # noqa: PLR0124
            for row in own
        ]
    assert all(check.holds for check in kit.confirm(CASES, found, stored))
    key = (CASES.name, CASES.sample[0])
    found[key] = spoil(found[key])
    assert not all(check.holds for check in kit.confirm(CASES, found, stored))
