"""The work-precision study: errors, references, measuring, what is kept and what is said."""

import argparse
import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analysis
from analysis import Trajectory
from mbs_models import Integrator
from validation.commands import work_precision as commands_work_precision
from validation.report import Job
from validation.work_precision import study
from validation.work_precision.lesson import paragraphs
from validation.work_precision.methods import EngineMethod, InHouseMethod, label, methods
from validation.work_precision.problems import (
    PROBLEMS,
    TIMES,
    Agreement,
    Errors,
    agreement,
    compare,
    reference,
)
from validation.work_precision.runs import Run, fastest, front, observed_order
from validation.work_precision.section import make_section
from validation.work_precision.tables import all_runs, failures, ways
from validation.work_precision.tables import options as option_table

RK44 = EngineMethod(formulation="contact-tree", integrator=Integrator(name="RK44"))


def made_run(seconds: float, error: float, **changes: Any) -> Run:
    values = dict.fromkeys((field.name for field in dataclasses.fields(Errors)), 0.0)
    run = Run(
        problem="model-1",
        formulation="contact-tree",
        scheme="RK44",
        setting=seconds,
        fixed_step=True,
        seconds=seconds,
        median_seconds=seconds,
        setup_seconds=0.0,
        repeats=1,
        errors=Errors(**(values | {"error": error})),
    )
    return dataclasses.replace(run, **changes)


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
    assert errors.error == pytest.approx(1e-4 / truth.disk.radius)
    turned = compare(moved(truth, 3, 1e-3), truth)
    assert turned.beta == turned.gamma == 0.0 < turned.cog


def test_runs_at_other_times_cannot_be_compared() -> None:
    other = analysis.simulate(1, [0.0, 1.0])
    with pytest.raises(ValueError, match="times must be the same"):
        compare(other, reference("model-1"))


@pytest.mark.parametrize("name", ["model-3", "undamped"])
def test_references_of_different_methods_agree_two_digits_beyond_the_finest_goal(
    name: Any,
) -> None:
    found = agreement(name)
    assert found.others
    assert found.floor <= 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", PROBLEMS)
def test_all_references_agree_two_digits_beyond_the_finest_goal(name: Any) -> None:
    assert agreement(name).floor <= 1e-9


@pytest.mark.parametrize("form", ["index-1", "reduced"])
def test_timed_in_house_runs_are_those_of_the_library(form: Any) -> None:
    problem = PROBLEMS["model-4"]
    method = InHouseMethod(form=form, scheme="DOP853")
    run = method.trajectory(problem, method.run(problem, 1e-6))
    same = analysis.simulate(4, TIMES, form=form, method="DOP853", local_tolerance=1e-6)
    np.testing.assert_array_equal(run.coordinates, same.coordinates)
    np.testing.assert_array_equal(run.multipliers, same.multipliers)


def test_ladder_is_measured_from_coarse_to_fine_with_times_work_and_errors() -> None:
    runs = study.measure("undamped", RK44, True)
    plain = [run for run in runs if not run.extrapolated]
    assert [run.setting for run in plain] == RK44.ladder(True)
    assert all(run.seconds > 0.0 and run.repeats == study.QUICK.repeats for run in plain)
    assert all(run.seconds <= run.median_seconds for run in plain)
    assert plain[1].counts["right_hand_sides"] == 2 * plain[0].counts["right_hand_sides"]
    order = observed_order(plain, 1e-10)
    assert order == pytest.approx(4.0, abs=0.4)


def test_extrapolated_run_counts_the_work_of_all_its_rungs() -> None:
    runs = study.measure("undamped", RK44, True)
    plain = [run for run in runs if not run.extrapolated]
    joined = [run for run in runs if run.extrapolated]
    assert joined[-1].counts["steps"] == sum(run.counts["steps"] for run in plain)
    assert joined[-1].seconds == pytest.approx(sum(run.seconds for run in plain))
    assert joined[-1].error < 0.1 * plain[-1].error


def test_failed_rung_is_a_gap_with_its_reason() -> None:
    method = EngineMethod(
        formulation="euler-tree", integrator=Integrator(name="TrapezoidalIndex2")
    )
    short = dataclasses.replace(study.QUICK, repeats=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "QUICK", short)
        patch.setattr(EngineMethod, "ladder", lambda *_: [0.02, 0.01])
        runs = study.measure("stiff", method, True)
    assert runs[0].errors is None
    assert "Newton's iteration did not converge" in runs[0].failure
    table = failures(runs)
    assert table.rows[0][2] == len([run for run in runs if run.failure])
    assert all_runs(runs).rows[0][-1] == runs[0].failure


def test_every_method_of_a_problem_has_its_own_label_and_only_what_it_can_take() -> None:
    for problem in PROBLEMS.values():
        for quick in (True, False):
            labels = [label(method) for method in methods(problem, quick)]
            assert len(labels) == len(set(labels))
            free = problem.level == 1 and problem.friction.load == "weight"
            assert any("contact-tree" in text for text in labels) is free
            assert any("reduced" in text for text in labels) is (problem.level == 4)


def test_full_study_holds_every_integrator_and_option_of_the_engine() -> None:
    labels = " | ".join(label(method) for method in methods(PROBLEMS["model-1"], False))
    for part in (
        "contact-tree, RK44",
        "contact-tree, RK67",
        "contact-tree, DOPRI5",
        "contact-tree, trapezoidal",
        "floating, generalized-α 1",
        "floating, generalized-α 0.9",
        "floating-lie, generalized-α 0.6",
        "full Newton",
        "Newton to 1e-08",
        "symbolic friction",
        "index-1, BDF",
    ):
        assert part in labels


def test_stored_runs_are_not_measured_again(tmp_path: Path) -> None:
    conditions = {"quick": True, "code": "1"}
    first = study.stored_measure(tmp_path, conditions, "undamped", RK44)
    again = study.stored_measure(tmp_path, conditions, "undamped", RK44)
    assert again == first
    changed = study.stored_measure(tmp_path, conditions | {"code": "2"}, "undamped", RK44)
    assert [run.seconds for run in changed] != [run.seconds for run in first]


def test_damaged_store_is_named_and_not_taken_for_a_result(tmp_path: Path) -> None:
    conditions = {"quick": True}
    study.stored_measure(tmp_path, conditions, "undamped", RK44)
    (path,) = tmp_path.iterdir()
    path.write_text(path.read_text()[:-20])
    with pytest.raises(ValueError, match=r"is not readable: .*--fresh"):
        study.stored_measure(tmp_path, conditions, "undamped", RK44)


def test_failed_runs_survive_the_store() -> None:
    run = Run(
        problem="fast",
        formulation="floating",
        scheme="trapezoidal",
        setting=0.02,
        fixed_step=True,
        failure="stopped",
    )
    assert Run.from_dict(json.loads(json.dumps(run.to_dict()))).failure == "stopped"


def test_jobs_cover_all_problems_under_keys_of_their_own() -> None:
    found = study.jobs(True)
    assert all(isinstance(job, Job) and job.key[0] == "work-precision" for job in found)
    assert len({job.key for job in found}) == len(found)
    assert {job.key[1] for job in found} == {"agreement", *PROBLEMS}


def test_fastest_way_is_the_quickest_run_that_is_good_enough() -> None:
    runs = [made_run(3.0, 1e-7), made_run(1.0, 1e-2), made_run(2.0, 1e-4)]
    assert fastest(runs, 1e-3) is runs[2]
    assert fastest(runs, 1e-9) is None


def test_front_leaves_out_what_is_slower_and_worse() -> None:
    runs = [made_run(1.0, 1e-2), made_run(2.0, 3e-2), made_run(3.0, 1e-4), made_run(0.5, 5.0)]
    runs.insert(1, made_run(float("nan"), 0.0, errors=None, failure="stopped"))
    assert [run.seconds for run in front(runs)] == [1.0, 3.0]


def test_observed_order_is_found_between_the_useless_and_the_unmeasurable() -> None:
    runs = [made_run(0.5**k, 2.0 * 0.5 ** (3 * k), scheme="RK") for k in range(12)]
    assert observed_order(runs, 1e-7) == pytest.approx(3.0)
    assert observed_order(runs[:1], 1e-7) is None
    assert observed_order([made_run(1.0, 1.0), made_run(0.5, 0.5)], 1e-7) is None


def test_tables_say_what_the_runs_say() -> None:
    runs = [
        made_run(0.002, 1e-4),
        made_run(0.004, 1e-7, extrapolated=True),
        made_run(0.006, 1e-4, setting=0.002, variant="full Newton"),
        made_run(0.02, 1e-5, formulation="index-1", scheme="DOP853"),
    ]
    rows = ways(runs).rows
    assert list(rows[0][1:5]) == [1e-3, "contact-tree, RK44", 0.002, 2.0]
    assert rows[1][2] == "contact-tree, RK44, extrapolated"
    assert rows[2][2] == "not reached"
    assert rows[0][5] == "index-1, DOP853"
    assert option_table(runs).rows[0][1:] == [1, pytest.approx(3.0), 1.0]
    assert len(all_runs(runs).rows) == 4


def test_lesson_says_nothing_without_runs() -> None:
    assert paragraphs([]) == []


def test_lesson_compares_topology_with_constraints_from_the_runs() -> None:
    runs = [made_run(0.002, 1e-4), made_run(0.05, 1e-4, formulation="euler-tree")]
    text = " ".join(paragraphs(runs))
    assert "takes 25 times as long" in text


def test_section_draws_and_tells_what_was_run() -> None:
    runs = [*study.measure("undamped", RK44, True), made_run(0.002, 1e-4)]
    agreements = {name: Agreement(problem=name, others={"x": 1e-12}) for name in PROBLEMS}
    section = make_section(runs, agreements, quick=True)
    assert [picture.name for picture in section.pictures] == [
        "work-precision",
        "work-precision-orders",
    ]
    assert all(picture.png.startswith(b"\x89PNG") for picture in section.pictures)
    assert "quick selection" in section.paragraphs[0]


def test_command_prints_the_tables_and_the_page(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def main(folder: Path, *, quick: bool, fresh: bool) -> tuple[Path, list[Any]]:
        assert (quick, fresh) == (True, False)
        return folder / "report.html", [ways([made_run(0.002, 1e-4)])]

    monkeypatch.setattr(study, "main", main)
    options = argparse.Namespace(out=str(tmp_path), quick=True, fresh=False)
    assert commands_work_precision.work_precision(options) == 0
    printed = capsys.readouterr().out
    assert "Fastest way" in printed
    assert printed.rstrip().endswith(f"Open {tmp_path / 'report.html'}")


@pytest.mark.slow
def test_quick_study_writes_its_page_and_resumes(tmp_path: Path) -> None:
    page, tables = study.main(tmp_path, quick=True)
    assert page.exists()
    assert (tmp_path / "work-precision-all-runs.csv").exists()
    again, same = study.main(tmp_path, quick=True)
    assert again == page
    assert same[0].rows == tables[0].rows
