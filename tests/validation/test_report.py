"""Pages from studies: what they show, what fails them, and what a second call takes over."""

import re
from pathlib import Path

import pandas as pd
import pytest

from tests.helpers import failing
from tests.toy_study import STUDY
from validation import report
from validation import study as kit

PAGES = (("report.html", "Toys", ("tests.toy_section",)),)


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the table of the toy study."""
    folder = tmp_path_factory.mktemp("results")
    report.measure(STUDY, folder, results=folder, workers=0)
    return folder


def test_a_report_shows_text_tables_figures_and_verdicts_and_holds(
    results: Path, tmp_path: Path
) -> None:
    made = report.make(tmp_path, results=results, pages=PAGES, workers=0)
    assert made.holds
    assert {"toy: one: rows", "toy: largest"} < {check.name for check in made.checks}
    page = made.page.read_text()
    assert "<em>Toy</em>: the largest is 4," in page
    for shown in ("Of <em>two</em> numbers.", "It grows.", "paper: Fig. 1", "M0,0 L9,9"):
        assert shown in page
    assert "10 of 40 rows, with the largest: number" in page
    assert len(pd.read_csv(tmp_path / "toy-section-long.csv")) == 40
    assert (tmp_path / "toy-section-curve.svg").is_file()
    text = report.as_text(made)
    assert "| power | value |\n| --- | --- |\n| 1 | 1 |\n" in text
    assert "*Figure in the report: A sketch.* A line." in text
    assert '<a href="toy-section-powers.csv">' in page
    assert not re.search("[<\ue000]", text)
    assert "\ue000" not in page
    assert pd.read_csv(tmp_path / "checks.csv")["holds"].all()


def test_a_second_call_measures_and_draws_nothing(
    results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # In processes of their own, as usual.
    first = report.make(tmp_path, results=results, pages=PAGES)

    def none(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(kit, "_run", lambda tasks, *_: iter(()) if not tasks else none())
    assert (
        report.make(tmp_path, results=results, pages=PAGES, workers=0).sections == first.sections
    )


def test_files_of_an_earlier_report_go_and_foreign_ones_stay(
    results: Path, tmp_path: Path
) -> None:
    (tmp_path / "mine.csv").write_text("1\n")
    (tmp_path / "old.csv").write_text("1\n")
    (tmp_path / ".contents").write_text("old.csv\n")
    report.make(tmp_path, results=results, pages=PAGES, workers=0)
    assert (tmp_path / "mine.csv").is_file()
    assert not (tmp_path / "old.csv").is_file()


def test_two_reports_do_not_work_in_one_folder(results: Path, tmp_path: Path) -> None:
    with report.locked(tmp_path), pytest.raises(OSError, match="another process works in it"):
        report.make(tmp_path, results=results, pages=PAGES, workers=0)


def test_a_report_fails_without_a_table_or_with_nothing_measured_on_the_spot(
    tmp_path: Path,
) -> None:
    made = report.make(tmp_path / "report", results=tmp_path, pages=PAGES, workers=0)
    assert failing(made.checks) == {"toy: table", "toy-section: section"}
    assert not report.verdict([kit.at_most("a", 0.0, 1.0, "stored")])
    assert not report.verdict([])
