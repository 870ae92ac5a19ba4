"""The work-precision study: errors, references, ladders, prices, what is kept and what is said."""

import argparse
import dataclasses
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import Scenario, Start, Trajectory
from mbs_models import Integrator, Scene
from validation.commands import studies
from validation.kit.report import Job, Section
from validation.kit.tables import Table
from validation.studies.work_precision import measure, section
from validation.studies.work_precision.jobs import jobs
from validation.studies.work_precision.measure import ladder_end
from validation.studies.work_precision.methods import EngineMethod, InHouseMethod, label, methods
from validation.studies.work_precision.problems import (
    PROBLEMS,
    TIMES,
    Errors,
    agreement,
    compare,
    reference,
)
from validation.studies.work_precision.runs import (
    Curve,
    Run,
    fastest,
    front,
    observed_order,
    shortfall,
)

RK44 = EngineMethod(formulation="contact-tree", integrator=Integrator(name="RK44"))
TRAPEZOIDAL = EngineMethod(
    formulation="euler-tree", integrator=Integrator(name="TrapezoidalIndex2")
)


def made_run(seconds: float, error: float, **changes: Any) -> Run:
    values = dict.fromkeys((field.name for field in dataclasses.fields(Errors)), 0.0)
    run = Run(
        problem="model-1",
        formulation="contact-tree",
        scheme="RK44",
        kind="step",
        setting=seconds,
        rounds=(seconds,),
        repeats=1,
        counts={"steps": 100, "right_hand_sides": 400},
        errors=Errors(**(values | {"error": error})),
    )
    return dataclasses.replace(run, **changes)


def made_curve(*runs: Run, end: Any = "goal") -> Curve:
    first = runs[0]
    return Curve(
        problem=first.problem,
        formulation=first.formulation,
        scheme=first.scheme,
        runs=runs,
        end=end,
    )


def of_kind(curve: Curve, kind: str) -> list[Run]:
    return [run for run in curve.runs if run.kind == kind]


def moved(run: Trajectory, column: int, by: float) -> Trajectory:
    coordinates = run.coordinates.copy()
    coordinates[:, column] += by
    return dataclasses.replace(run, coordinates=coordinates)


def test_run_has_no_error_against_itself() -> None:
    errors = compare(reference("model-2"), reference("model-2"))
    assert errors.error == errors.end == errors.energy == errors.normal_force == 0.0
    assert errors.position_drift < 1e-12


@pytest.mark.parametrize(("column", "name"), [(4, "beta"), (5, "gamma")])
def test_angle_error_is_the_angle_and_knows_no_whole_turns(column: int, name: str) -> None:
    truth = reference("model-1")
    assert getattr(compare(moved(truth, column, 1e-3), truth), name) == pytest.approx(1e-3)
    assert getattr(compare(moved(truth, column, 6 * np.pi), truth), name) < 1e-12


def test_position_error_is_that_of_the_centre_of_gravity_in_the_inertial_frame() -> None:
    truth = reference("model-1")
    errors = compare(moved(truth, 0, 1e-4), truth)
    assert errors.cog == pytest.approx(1e-4)
    assert errors.error == pytest.approx(1e-4 / truth.scenario.disk.radius)
    turned = compare(moved(truth, 3, 1e-3), truth)
    assert turned.beta == turned.gamma == 0.0 < turned.cog


def test_runs_at_other_times_cannot_be_compared() -> None:
    other = analysis.simulate(Scenario(), [0.0, 1.0])
    with pytest.raises(ValueError, match="times must be the same"):
        compare(other, reference("model-1"))


@pytest.mark.parametrize("name", [pytest.param("model-3", marks=pytest.mark.slow), "undamped"])
def test_references_of_different_methods_agree_two_digits_beyond_the_finest_goal(
    name: Any,
) -> None:
    found = agreement(name)
    assert found.others
    assert found.floor <= 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in PROBLEMS if name != "stiff"])
def test_contact_of_no_problem_would_have_to_pull(name: Any) -> None:
    often = np.linspace(0.0, TIMES[-1], 4001)
    run = analysis.simulate(PROBLEMS[name].scenario, often, local_tolerance=1e-6)
    assert run.ending is None
    assert run.normal_force.min() > 0.0


def test_reference_of_a_motion_whose_contact_pulls_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pulling = dataclasses.replace(PROBLEMS["fast"], scenario=Scenario(start=Start(spin=200.0)))
    monkeypatch.setitem(PROBLEMS, "fast", pulling)
    with pytest.raises(ArithmeticError, match="problem 'fast': contact would pull at"):
        reference.__wrapped__("fast")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["model-2", "contact-load", "fast"])
def test_other_references_agree_two_digits_beyond_the_finest_goal(name: Any) -> None:
    assert agreement(name).floor <= 1e-9


@pytest.mark.parametrize(
    ("name", "form", "within"),
    # Where slip reverses in one direction, the library ends a step that SciPy's goes across.
    [("model-2", "index-1", 0.0), ("model-4", "index-1", 1e-7), ("model-4", "reduced", 1e-7)],
)
def test_timed_in_house_runs_are_those_of_the_library(name: Any, form: Any, within: float) -> None:
    problem = PROBLEMS[name]
    method = InHouseMethod(form=form, scheme="DOP853")
    run = method.trajectory(problem, method.run(problem, 1e-6))
    same = analysis.simulate(
        problem.scenario, TIMES, form=form, method="DOP853", local_tolerance=1e-6
    )
    np.testing.assert_allclose(run.coordinates, same.coordinates, rtol=0.0, atol=within)
    if not within:
        np.testing.assert_array_equal(run.multipliers, same.multipliers)


def test_ladder_is_measured_from_coarse_to_fine_with_times_work_and_errors() -> None:
    curve = measure.measure("model-1", RK44, True)
    plain = of_kind(curve, "step")
    assert [run.setting for run in plain] == RK44.ladder(PROBLEMS["model-1"])[: len(plain)]
    assert all(run.repeats == measure.QUICK.repeats for run in plain)
    assert all(run.seconds > 0.0 for run in plain)
    assert plain[1].work == 2 * plain[0].work == 800
    assert plain[-1].error <= measure.QUICK.goal < plain[-2].error
    assert curve.end == "goal"
    assert observed_order(plain, 1e-10).value == pytest.approx(4.0, abs=0.2)


def test_extrapolated_run_counts_the_work_of_all_its_rungs() -> None:
    curve = measure.measure("model-1", RK44, True)
    plain, joined = of_kind(curve, "step"), of_kind(curve, "extrapolated")
    assert joined[-1].counts["steps"] == sum(run.counts["steps"] for run in plain)
    assert joined[-1].seconds == pytest.approx(sum(run.seconds for run in plain), rel=1e-3)
    assert joined[-1].error < 0.1 * plain[-1].error


def test_run_to_a_tolerance_is_that_of_the_library_and_keeps_its_promise() -> None:
    asked = of_kind(measure.measure("model-1", RK44, True), "tolerance")
    assert [run.setting for run in asked] == [1e-3, 1e-6]
    assert all(run.error <= run.setting for run in asked)
    same = mbs_models.simulate(
        Scene(PROBLEMS["model-1"].scenario, "contact-tree"),
        TIMES,
        tolerance=1e-6,
        integrator="RK44",
    )
    assert asked[1].work == same.counts["right_hand_sides"]
    assert asked[1].error == pytest.approx(compare(same, reference("model-1")).error, rel=1e-3)


@pytest.mark.slow
def test_what_is_run_does_not_depend_on_the_time_it_takes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    swift = measure.measure("model-1", RK44, True)
    run = EngineMethod.run

    def slow(method: EngineMethod, problem: Any, setting: float) -> Any:
        return dataclasses.replace(run(method, problem, setting), seconds=1e3)

    monkeypatch.setattr(EngineMethod, "run", slow)
    late = measure.measure("model-1", RK44, True)
    assert [(run.kind, run.setting, run.error, run.work, run.repeats) for run in late.runs] == [
        (run.kind, run.setting, run.error, run.work, run.repeats) for run in swift.runs
    ]


def test_failed_rung_is_a_gap_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(EngineMethod, "ladder", lambda *_: [0.02, 0.01])
    curve = measure.measure("stiff", TRAPEZOIDAL, True)
    first = curve.runs[0]
    assert first.errors is None
    assert first.error == inf
    assert "Newton's iteration did not converge" in first.failure


@pytest.mark.parametrize(
    ("errors", "end"),
    [
        ([1e-2, 1e-5], None),
        ([1e-2, 1e-5, 1e-9], "goal"),
        ([inf, inf, 1e-2], None),
        ([1e-2, 1e-4, 1e-7, 0.9e-7, 0.8e-7], "rounding"),
        ([1e-2, 1e-4, 1e-7, 0.9e-7, 0.4e-7], None),
        ([0.5, 0.3, 0.4, 0.6], None),
        ([1e-2, 1e-5, inf, inf], "failure"),
        ([1e-2, 1e-5, inf], None),
        ([1.0, inf, inf, inf], None),
    ],
)
def test_ladder_ends_at_the_goal_at_rounding_or_where_it_fails(
    errors: list[float], end: Any
) -> None:
    assert ladder_end(errors, 1e-9, fixed_step=True) == end


def test_tolerances_that_change_nothing_yet_do_not_end_a_ladder() -> None:
    assert ladder_end([4e-6, 4e-6, 4e-6], 1e-9, fixed_step=False) is None


@pytest.mark.slow
def test_stiff_contact_tree_is_as_exact_as_steps_below_its_stability_limit_make_it() -> None:
    method = EngineMethod(formulation="contact-tree", integrator=Integrator(name="RK67"))
    curve = measure.measure("stiff", method, True)
    errors = {run.counts["steps"]: run.error for run in of_kind(curve, "step")}
    assert errors[3200] > 1e-2
    assert errors[12800] < 1e-9


def test_every_method_of_a_problem_has_its_own_label_and_only_what_it_can_take() -> None:
    for problem in PROBLEMS.values():
        labels = [label(method) for method in methods(problem, False)]
        assert len(labels) == len(set(labels))
        scenario = problem.scenario
        free = scenario.model == 1 and scenario.friction.load == "weight"
        assert any("contact-tree" in text for text in labels) is free
        assert any("reduced" in text for text in labels) is (scenario.model == 4)
        assert {label(method) for method in methods(problem, True)} <= set(labels)


def test_full_study_holds_every_integrator_of_the_engine() -> None:
    labels = " | ".join(label(method) for method in methods(PROBLEMS["model-1"], False))
    for part in (
        "contact-tree, RK44",
        "contact-tree, RK67",
        "contact-tree, DOPRI5",
        "contact-tree, trapezoidal",
        "floating, generalized-α 1",
        "floating, generalized-α 0.9",
        "floating-lie, generalized-α 0.6",
        "index-1, BDF",
    ):
        assert part in labels


@pytest.mark.parametrize("quick", [True, False])
def test_jobs_have_keys_of_their_own(quick: bool) -> None:
    found = jobs(quick=quick)
    assert all(isinstance(job, Job) and job.key[0] == "work-precision" for job in found)
    assert len({job.key for job in found}) == len(found)


def test_full_jobs_cover_all_problems_and_quick_ones_some_of_them() -> None:
    full = {job.key for job in jobs(quick=False)}
    assert {key[1] for key in full} == {"agreement", "price", *PROBLEMS}
    assert {job.key for job in jobs(quick=True)} < full


def test_fastest_way_is_the_quickest_run_that_is_good_enough() -> None:
    runs = [made_run(3.0, 1e-7), made_run(1.0, 1e-2), made_run(2.0, 1e-4)]
    assert fastest(runs, 1e-3) is runs[2]
    assert fastest(runs, 1e-9) is None
    by_itself = made_run(0.1, 1e-7, kind="tolerance", setting=1e-3)
    assert fastest([*runs, by_itself], 1e-3) is runs[2]


def test_front_leaves_out_what_is_slower_and_worse() -> None:
    runs = [made_run(1.0, 1e-2), made_run(2.0, 3e-2), made_run(3.0, 1e-4), made_run(0.5, 5.0)]
    runs.insert(1, made_run(float("nan"), 0.0, errors=None, failure="stopped"))
    assert [run.seconds for run in front(runs)] == [1.0, 3.0]


def test_not_reached_is_said_only_of_ladders_that_went_to_their_end() -> None:
    run = made_run(0.02, 2e-5)
    assert shortfall([]) == "not in this selection"
    assert shortfall([made_curve(run, end="rounding")]) == "not reached, best 2e-05"
    assert shortfall([made_curve(run, end="failure")]) == "not reached, best 2e-05"
    assert shortfall([made_curve(run, end="finest")]) == "not reached, best 2e-05"
    ended_early = [made_curve(run, end="rounding"), made_curve(run, end="work")]
    gap = made_run(0.005, inf, errors=None, failure="stopped")
    assert shortfall([made_curve(gap, end="work")]) == "fails up to 400 steps"
    assert shortfall(ended_early) == "not tried beyond 100 steps, best 2e-05"
    assert shortfall([made_curve(run, end="goal")]) == "not in this selection"


def test_observed_order_is_found_between_the_useless_and_the_unmeasurable() -> None:
    runs = [made_run(0.5**k, 2.0 * 0.5 ** (3 * k)) for k in range(12)]
    assert observed_order(runs, 1e-7).value == pytest.approx(3.0)


def test_observed_order_takes_four_rungs_that_agree() -> None:
    runs = [made_run(0.5**k, 1e-2 * 0.5 ** (3 * k)) for k in range(4)]
    assert observed_order(runs, 1e-12).value == pytest.approx(3.0)
    assert observed_order(runs[:3], 1e-12).reason == "few rungs"
    assert observed_order([*runs[:3], made_run(0.1, 1.0)], 1e-12).reason == "few rungs"
    jump = [*runs[:3], made_run(0.125, 1e-9)]
    assert observed_order(jump, 1e-12).reason == "unsettled, 3.0 to 17.3"


def test_command_prints_the_tables_and_the_page(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    table = Table(name="x", title="Fastest way", columns=("a",), rows=[[1]])
    made = Section(name="x", title="x", paragraphs=[], tables=[table])
    monkeypatch.setattr(studies, "run_kept", lambda *_, **__: {})
    monkeypatch.setattr(section, "section", lambda *_, **__: made)
    options = argparse.Namespace(
        command="work_precision", out=str(tmp_path), quick=True, fresh=False
    )
    assert studies.work_precision(options) == 0
    printed = capsys.readouterr().out
    assert "Fastest way" in printed
    assert printed.rstrip().endswith(f"Open {tmp_path / 'report.html'}")
