"""What the work-precision study says: stored studies, tables, lesson, report, docs."""

import dataclasses
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from mbs_models import Integrator
from tests.helpers import not_none
from validation.kit.figures import Picture
from validation.kit.provenance import Provenance
from validation.studies.work_precision import confirm, figures, measure, results, section, tables
from validation.studies.work_precision.lesson import paragraphs, repeatability
from validation.studies.work_precision.methods import EngineMethod
from validation.studies.work_precision.prices import Price
from validation.studies.work_precision.problems import PROBLEMS, Agreement
from validation.studies.work_precision.runs import Curve, Run
from validation.studies.work_precision.section import make_section
from validation.studies.work_precision.stored import Study, gathered, shipped

RESULTS = Path(__file__).parents[3] / "docs" / "results.md"


@cache
def measured() -> Curve:
    """A curve with a step, extrapolated and to tolerances."""
    method = EngineMethod(formulation="contact-tree", integrator=Integrator(name="RK44"))
    return measure.measure("model-1", method, True)


def with_runs(formulation: str, changes: dict[str, Any]) -> Curve:
    """The measured curve under another formulation's name, its runs changed."""
    runs = [
        dataclasses.replace(run, formulation=formulation, **changes) for run in measured().runs
    ]
    return dataclasses.replace(measured(), formulation=formulation, runs=tuple(runs))


def failed() -> Curve:
    run = Run(
        problem="model-3",
        formulation="floating",
        scheme="trapezoidal",
        kind="step",
        setting=0.02,
        failure="stopped",
    )
    return Curve(
        problem="model-3", formulation="floating", scheme="trapezoidal", runs=(run,), end="failure"
    )


def made_study(*curves: Curve, quick: bool = False) -> Study:
    return Study(
        provenance=Provenance(
            machine="a machine",
            packages={"exudyn": "1.13.6"},
            date="2026-01-31",
            commit="abc1234567",
        ),
        quick=quick,
        curves=curves or (measured(), failed()),
        agreements={name: Agreement(problem=name, others={"x": 1e-13}) for name in PROBLEMS},
        prices=(
            Price(
                what="full for modified Newton",
                problem="model-1",
                formulation="floating",
                ratios=(2.0, 2.1, 2.2),
                work=0.5,
                error=1.0,
            ),
        ),
    )


def test_run_on_the_spot_confirms_equal_work_and_error_whatever_its_time() -> None:
    slower = [dataclasses.replace(run, rounds=(3.0 * run.seconds,)) for run in measured().runs]
    here = made_study(dataclasses.replace(measured(), runs=tuple(slower)), quick=True)
    text = confirm.sentence(here, made_study())
    assert text.startswith("Confirmed on the spot: yes.")
    assert "take 3 times the processor time" in text


def test_rounds_of_a_curve_are_joined_into_least_times_and_their_scatter() -> None:
    slower = dataclasses.replace(
        measured(),
        runs=tuple(
            dataclasses.replace(run, rounds=(1.5 * run.seconds,)) for run in measured().runs
        ),
    )
    study = gathered(
        [slower, failed(), measured().times, failed().times],
        provenance=made_study().provenance,
        quick=False,
    )
    joined, gap = study.curves
    assert [run.seconds for run in joined.runs] == [run.seconds for run in measured().runs]
    assert [run.scatter for run in joined.runs] == pytest.approx([1.5] * len(joined.runs))
    assert gap == failed()
    assert "differ 1.50 times in the median" in repeatability(study)
    assert not repeatability(made_study())


def test_rounds_that_differ_in_more_than_time_are_refused() -> None:
    first, *others = measured().runs
    runs = (dataclasses.replace(first, counts={"right_hand_sides": 1}), *others)
    with pytest.raises(ValueError, match="rounds differ"):
        measured().joined(dataclasses.replace(measured(), runs=runs).times)


@pytest.mark.parametrize("what", ["error", "work", "failure"])
def test_run_on_the_spot_that_differs_is_counted(what: str) -> None:
    first, *others = measured().runs
    changes: dict[str, dict[str, Any]] = {
        "error": {"errors": dataclasses.replace(not_none(first.errors), error=1.1 * first.error)},
        "work": {"counts": {"right_hand_sides": round(1.1 * first.work)}},
        "failure": {"errors": None, "failure": "stopped"},
    }
    runs = (dataclasses.replace(first, **changes[what]), *others)
    here = made_study(dataclasses.replace(measured(), runs=runs), quick=True)
    text = confirm.sentence(here, made_study())
    assert text.startswith("Confirmed on the spot: partly.")
    assert f"Of {1 + len(others)} runs of the quick selection, {len(others)} take" in text


def test_errors_below_what_the_references_tell_count_as_the_same() -> None:
    first, *others = measured().runs
    tiny = [dataclasses.replace(not_none(first.errors), error=error) for error in (1e-13, 5e-13)]
    here, there = (
        made_study(
            dataclasses.replace(
                measured(), runs=(dataclasses.replace(first, errors=errors), *others)
            )
        )
        for errors in tiny
    )
    assert confirm.sentence(here, there).startswith("Confirmed on the spot: yes.")


def test_tables_say_what_the_runs_say() -> None:
    study = made_study(
        measured(), with_runs("index-1", {"scheme": "DOP853", "kind": "local tolerance"})
    )
    rows = tables.ways(study).rows
    best = min(
        (run for run in measured().runs if run.error <= 1e-3 and run.kind != "tolerance"),
        key=lambda run: run.seconds,
    )
    assert rows[0][:4] == ["Model 1", "1e-3", best.method, best.work]
    assert str(rows[0][5]).startswith("index-1, DOP853")
    assert rows[2][2] != "not reached"
    assert rows[3][2] == "not in this selection"
    assert len(tables.all_runs(study).rows) == 2 * len(measured().runs)


def test_formulation_table_tells_apart_why_there_is_no_time() -> None:
    coarse = with_runs("euler-tree", {})
    coarse = dataclasses.replace(coarse, runs=coarse.runs[:2], end="rounding")
    rows = tables.formulation_ways(made_study(measured(), coarse)).rows
    assert str(rows[1][2]).startswith("RK44")
    assert str(rows[1][3]).startswith("not reached, best")
    assert rows[1][4] == "not in this selection"
    model_3 = tables.formulation_ways(made_study()).rows[-6:]
    assert all(row[2] in {None, "not in this selection"} for row in model_3)


def test_every_way_lists_each_kind_of_run_with_its_work() -> None:
    rows = tables.every_way(made_study(measured())).rows
    assert [row[3] for row in rows] == ["step", "extrapolated", "tolerance"]
    plain = [run for run in measured().runs if run.kind == "step"]
    assert rows[0][4] == min(run.work for run in plain if run.error <= 1e-3)
    assert rows[2][4] == next(
        run.work for run in measured().runs if run.kind == "tolerance" and run.setting == 1e-3
    )
    assert rows[0][8] is None


def test_tolerance_table_counts_refusals_and_margins() -> None:
    row = tables.tolerances(made_study(measured())).rows[0]
    assert row[:3] == ["contact-tree, RK44", 2, 0]
    assert 0.0 < float(str(row[3])) < 1.0
    assert float(str(row[6])) >= 1.0


def test_tolerance_table_tells_the_promised_angles_from_the_position() -> None:
    astray = [
        dataclasses.replace(run, errors=dataclasses.replace(run.errors, error=1.0))
        for run in measured().runs
        if run.kind == "tolerance" and run.errors is not None
    ]
    plain = [run for run in measured().runs if run.kind != "tolerance"]
    curve = dataclasses.replace(measured(), runs=(*plain, *astray))
    row = tables.tolerances(made_study(curve)).rows[0]
    assert row[1:3] == [2, 0]
    assert float(str(row[3])) < 1.0
    assert row[5] == 2


def test_price_within_scatter_is_called_so() -> None:
    study = made_study()
    noise = dataclasses.replace(study.prices[0], ratios=(0.9, 1.1, 1.2))
    rows = tables.price_table([*study.prices, noise]).rows
    assert [row[5] for row in rows] == ["more", "within scatter"]


def test_lesson_says_nothing_without_runs() -> None:
    empty = dataclasses.replace(made_study(), curves=(), prices=())
    assert paragraphs(empty) == []


def test_lesson_compares_topology_with_constraints_from_the_runs() -> None:
    slow = with_runs("euler-tree", {"scheme": "trapezoidal"})
    slow = dataclasses.replace(
        slow,
        runs=tuple(dataclasses.replace(run, rounds=(25.0 * run.seconds,)) for run in slow.runs),
    )
    text = " ".join(paragraphs(made_study(measured(), slow)))
    assert "takes 25 times as long to the same error" in text


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures take seconds, and do not matter to most tests."""
    picture = Picture(name="x", title="x", caption="", png=b"", svg="")
    for name in ("fronts", "orders"):
        monkeypatch.setattr(figures, name, lambda *_: picture)


@pytest.mark.usefixtures("undrawn")
def test_quick_study_draws_no_lesson_and_says_what_it_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(section, "shipped", lambda: None)
    made = make_section(made_study(quick=True))
    assert "from which no lesson is drawn" in made.paragraphs[1]
    assert len(made.paragraphs) == 3


@pytest.mark.usefixtures("undrawn")
def test_quick_study_shows_the_shipped_one_and_confirms_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    full = made_study()
    monkeypatch.setattr(section, "shipped", lambda: full)
    made = make_section(made_study(measured(), quick=True))
    assert "a machine" in made.paragraphs[1]
    assert "contact tree: RK44; floating, Euler parameters: trapezoidal." in made.paragraphs[2]
    assert made.paragraphs[3].startswith("Confirmed on the spot: yes.")
    assert "work-precision-confirmed" in {table.name for table in made.tables}
    assert "Prices, each the median" in " ".join(made.paragraphs)
    assert len(made.tables[-1].rows) == len(full.runs)


@pytest.mark.usefixtures("undrawn")
def test_full_study_on_the_spot_speaks_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(section, "shipped", lambda: made_study(measured()))
    made = make_section(made_study())
    assert "Measured on the spot" in made.paragraphs[1]
    assert "work-precision-confirmed" not in {table.name for table in made.tables}


@pytest.mark.slow
def test_figures_lay_the_runs_on_the_spot_over_the_full_curves() -> None:
    full = made_study()
    pictures = [
        figures.fronts(full),
        figures.fronts(full, made_study(measured(), quick=True)),
        figures.orders(full),
    ]
    assert all(picture.png.startswith(b"\x89PNG") for picture in pictures)
    assert ["on the spot" in picture.caption for picture in pictures] == [False, True, False]


def test_results_show_the_fastest_ways_of_the_shipped_study() -> None:
    full = shipped()
    if full is None:
        pytest.skip("no full study is shipped yet")
    text = RESULTS.read_text(encoding="utf-8")
    block = text[text.index(results.BEGIN) : text.index(results.END) + len(results.END)]
    assert block == results.results_block(full)
