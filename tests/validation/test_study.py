"""The one mechanism of all studies: what it keeps and shows, and that everything wrong fails."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.calls import answer, printed
from tests.helpers import failing
from tests.toy_study import CASES, STUDY
from validation import report
from validation import study as studying
from validation.measurement import kept
from validation.measurement.kept import measured
from validation.page.section import Section
from validation.study import Content, Row, Study

PAGES = (("report.html", "Toys", ("tests.toy_section",)),)

STORED = "What comes with the package"
"""Heading of a page's last part."""

Make = Callable[..., report.Report]


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the table of the toy study."""
    folder = tmp_path_factory.mktemp("results")
    report.measure(STUDY, folder, results=folder, workers=0)
    return folder


@pytest.fixture
def make(results: Path) -> Make:
    """Makes a report on the toy study."""

    def made(**how: Any) -> report.Report:
        how = {"results": results, "workers": 0, "pages": PAGES, **how}
        return report.make(Path(), **how)

    return made


def of(case: Any) -> Study:
    """The toy study with another case in place of its first."""
    return replace(STUDY, cases=lambda: {**CASES, "one": case})


WRONG = {
    "raises": ("runs", "ZeroDivisionError"),
    "ends": ("runs", "the interpreter ended with code 7"),
    "hangs": ("runs", "not finished within 1 s"),
    "nothing": ("runs", "nothing was measured"),
    "inf": ("value", "inf"),
    "shorter": ("rows", "1"),
}


@pytest.mark.parametrize("case", WRONG)
def test_whatever_goes_wrong_on_the_spot_fails_a_check(case: str, results: Path) -> None:
    study = replace(of(case), limit=1.0 if case == "hangs" else STUDY.limit)
    workers = int(case in {"ends", "hangs"})
    found = measured(study.tasks(whole=False), Path(), workers=workers)
    checks = studying.confirm(study, found, studying.load(STUDY, results))
    failed = {each.name: str(each.value) for each in checks if not each.holds}
    check, said = WRONG[case]
    assert said in failed[f"toy: one: {check}"]


@pytest.mark.parametrize("apart", [0.9e-9, 1.1e-9])
@pytest.mark.parametrize("column", ["value", "curve"])
def test_a_number_may_be_off_by_its_limit_and_by_no_more(
    column: str, apart: float, results: Path
) -> None:
    study = replace(STUDY, sample=("two",))
    found: Any = measured(study.tasks(whole=False), Path(), workers=0)
    # The first row alone; one of the columns relative to its size.
    for row, off in zip(found["toy", "two"], (apart, 0.9e-9), strict=True):
        value = row[column]
        row[column] = value * (1.0 + off) if column == "value" else np.add(value, -off)
    failed = failing(studying.confirm(study, found, studying.load(STUDY, results)))
    assert failed == ({f"toy: two: {column}"} if apart > 1e-9 else set())


def test_what_is_kept_is_not_measured_again_until_the_code_changes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tasks = STUDY.tasks(whole=False)
    first = measured(tasks, Path(), workers=0)
    assert measured(tasks, Path(), workers=0) == first
    assert measured(tasks, Path(), workers=0, fresh=True) != first
    latest = measured(tasks, Path(), workers=0, fresh=True)
    assert measured(tasks, Path(), workers=0) == latest
    monkeypatch.setattr(kept, "behind", lambda _: "other code")
    assert measured(tasks, Path(), workers=0) != latest


def test_an_interrupted_call_goes_on_where_it_stopped() -> None:
    called: list[float] = []

    def measure(case: float) -> list[Row]:
        called.append(case)
        if called == [1.0, 2.0]:
            raise KeyboardInterrupt
        return [{"value": case}]

    tasks = replace(STUDY, measure=measure).tasks(whole=True)
    with pytest.raises(KeyboardInterrupt):
        measured(tasks, Path(), workers=0)
    assert len(measured(tasks, Path(), workers=0)) == 2
    assert called == [1.0, 2.0, 2.0]


def test_a_table_is_not_made_of_crashes_or_of_what_no_file_can_hold() -> None:
    found = measured(of("raises").tasks(whole=True), Path(), workers=0)
    with pytest.raises(ArithmeticError, match="toy: 1 of 2 cases crashed: one: "):
        studying.whole_table(STUDY, found)
    with pytest.raises(TypeError, match="rows must hold numbers"):
        studying.rows_of(lambda _: [{"value": 1j}], CASES)


# --- Pages --------------------------------------------------------------------------------------


def test_a_report_shows_text_tables_figures_and_verdicts_and_holds(make: Make) -> None:
    made = make()
    assert made.holds
    assert {"toy: one: rows", "toy: largest"} < {check.name for check in made.checks}
    page, text = made.page.read_text(), report.as_text(made)
    assert "<em>Toy</em>: the largest is 4," in page
    for shown in ("Of <em>two</em> numbers.", "It grows.", "paper: Fig. 1", "M0,0 L9,9"):
        assert shown in page
    assert "10 of 40 rows, with the largest: number" in page
    assert '<td class="good" data-head="holds">yes</td>' in page
    assert len(pd.read_csv("toy-section-long.csv")) == 40
    assert Path("toy-section-curve.svg").is_file()
    assert "| power | value |\n| --- | --- |\n| 1 | 1 |\n" in text
    assert "*Figure in the report: A sketch.* A line." in text
    assert '<a href="toy-section-powers.csv">' in page
    assert '<td data-head="code since">the same</td>' in page
    assert not re.search("[<\ue000]", text)
    assert "\ue000" not in page
    assert pd.read_csv("checks.csv")["holds"].all()


def test_a_verdict_that_lacks_its_criterion_is_refused() -> None:
    text = Path("toy.md")
    text.write_text('{% call verdict("yes") %}It grows.\n\nBy 4.{% endcall %}')
    with pytest.raises(ValueError, match="must have 3 paragraphs, got 2: It grows"):
        Section("toy", Content(), text).filled({})


def test_a_second_call_measures_and_draws_nothing(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    # In processes of their own, as usual.
    first = make(workers=None)

    def none(tasks: Any, *_: object) -> Any:
        assert not tasks
        return iter(())

    monkeypatch.setattr(kept, "_called", none)
    assert make().sections == first.sections


def test_part_of_a_report_has_the_sections_that_are_asked_for(make: Make) -> None:
    others = ("other.html", "Other", ("modelled",))
    made = make(pages=(others, *PAGES), only=("tests.toy_section",))
    assert [section.name for section in made.sections] == ["toy-section"]
    assert made.page == Path("report.html")
    assert not Path("other.html").exists()
    assert STORED in made.page.read_text("utf-8")
    assert STORED not in report.make(Path(), only=("modelled",)).page.read_text("utf-8")
    with pytest.raises(ValueError, match=r"^study must be one of modelled, .* got 'models'$"):
        report.make(Path(), only=("models",))


def test_two_reports_do_not_work_in_one_folder(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept, "_called", lambda *_: make())
    with pytest.raises(OSError, match="another process works in it"):
        make()


@pytest.mark.parametrize(
    "spoil", [Path.mkdir, lambda path: path.write_text("no database" * 99)], ids=["folder", "text"]
)
def test_a_folder_in_which_nothing_can_be_kept_is_refused(
    spoil: Callable[[Path], object], make: Make
) -> None:
    spoil(Path(".kept.db"))
    with pytest.raises(OSError, match="cannot be written to now: "):
        make()


def test_a_report_fails_without_a_table_or_with_nothing_measured_on_the_spot(make: Make) -> None:
    assert failing(make(results=Path()).checks) == {"toy: table", "toy-section: section"}
    made = make()
    (section,) = made.sections
    for checks in ([check for check in made.checks if check.where == "stored"], []):
        assert not made._replace(sections=[section._replace(checks=checks)]).holds


def test_command_prints_what_fails_and_all_checks_if_asked(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    holding, failed = make(), make(results=Path())
    call = "report --out ."
    monkeypatch.setattr(report, "make", lambda *_, **__: holding)
    told = "holds: toy: largest: 4.0, limit 4.0 (stored)"
    assert told in printed(call, "--verbose")
    said = printed(call)
    assert told not in said
    assert "It grows. Yes: 4 [above 1]" in said
    assert "All checks hold" in said
    monkeypatch.setattr(report, "make", lambda *_, **__: failed)
    shown = answer(call)
    assert "FAILS: toy: table" in shown.out
    assert "2 of 2 checks FAIL" in shown.out
    data = answer(call, "--json --csv a.csv --plot a.png")
    assert shown.code == data.code == 1
    names = [each["name"] for each in json.loads(data.out)["checks"]]
    assert names == ["toy: table", "toy-section: section"]
    assert Path("a.csv").read_text() == "section,statement,answer,numbers,criterion,good\n"


def test_command_tells_what_it_has_measured_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(report, "find", lambda _: SimpleNamespace(STUDIES=[STUDY]))
    monkeypatch.setattr(report, "measure", partial(report.measure, workers=0))
    (told,) = json.loads(printed("study claims --out . --json"))
    assert told["cases"] == len(CASES)
    assert len(pd.read_csv(told["file"])) == told["rows"]
