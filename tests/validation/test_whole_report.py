"""The whole report: every check holds, every page can be read to its end, every fault is found."""

import re
from html import unescape
from math import nan
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image

from tests.calls import ROOT, python
from tests.stated import missing, values
from validation import report
from validation import study as studying
from validation.measurement.kept import measured
from validation.parser.kinds import DISK, METHOD
from validation.study import Rows

WORDS = {"report.html": 6000, "method.html": 4000}
TABLES = {"report.html": 30, "method.html": 20}

pytestmark = pytest.mark.whole


CALL = ("-m", "validation", "report", "--text", "results.md")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the whole report, all checks of which hold."""
    found = tmp_path_factory.mktemp("whole")
    assert "All checks hold" in python(*CALL, folder=found).stdout
    return found / "report"


@pytest.mark.parametrize("page", WORDS)
def test_a_page_is_short_enough_to_be_read_to_its_end(page: str, folder: Path) -> None:
    text = (folder / page).read_text("utf-8")
    body = text.partition('<h2 id="stored">')[0].partition('<h2 id="files">')[0]
    assert body.count("<table>") <= TABLES[page]
    body = re.sub(r"<(style|script|table|svg|nav)\b.*?</\1>", " ", body, flags=re.DOTALL)
    words = re.findall(r"\w[\w'’.,-]*", unescape(re.sub(r"<[^>]*>", " ", body)))
    assert len(words) <= WORDS[page]


def test_every_figure_is_drawn_and_on_a_page(folder: Path) -> None:
    pages = "".join((folder / page).read_text("utf-8") for page in WORDS)
    pictures = sorted(folder.glob("*.png"))
    assert len(pictures) > 15
    for path in pictures:
        assert path.with_suffix(".svg").stat().st_size > 1000, path.name
        assert f'<figure id="{path.stem}"' in pages
        with Image.open(path) as picture:
            assert np.ptp(np.asarray(picture.convert("L"))) > 128, f"{path.name} is blank"


def test_all_results_state_what_the_report_has_found(folder: Path) -> None:
    fresh = (folder.parent / "results.md").read_text("utf-8").split("\n## ")
    stated = (ROOT / "docs" / "results.md").read_text("utf-8").split("\n## ")
    assert [part.partition("\n")[0] for part in stated] == [p.partition("\n")[0] for p in fresh]
    for said, found in zip(stated, fresh, strict=True):
        if said.startswith("Lean scenes"):
            # Its numbers are run times, which are measured anew.
            continue
        # What rounding leaves differs from machine to machine.
        lost = missing(said, values(found))
        heads = [re.findall(r"^\|.*(?=\n\| ?[:-])", part, re.MULTILINE) for part in (said, found)]
        assert heads[0] == heads[1]
        assert len(lost) <= 0.02 * len(values(said)), (said.partition("\n")[0], lost)


def test_a_second_call_takes_what_the_first_has_left(folder: Path) -> None:
    before = (folder / "checks.csv").read_bytes()
    assert "measure" not in python(*CALL, folder=folder.parent).stderr
    assert (folder / "checks.csv").read_bytes() == before


@pytest.mark.parametrize("name", [*DISK, *METHOD])
def test_whatever_is_no_number_in_what_is_measured_whole_fails(name: str, folder: Path) -> None:
    module = report.find(name)
    whole = [study for study in module.STUDIES if not study.is_stored]
    rows = {study.name: studying.load(study) for study in module.STUDIES if study.is_stored}
    for study in whole:
        rows[study.name] = studying.whole_table(study, measured(study.tasks(whole=True), folder))
    assert all(check.holds for check in module.present(rows).checks)
    for study in whole:
        table = rows[study.name].copy()
        for column in list(table.select_dtypes("number")) or list(table):
            if column not in ("case", "number"):
                table[column] = nan
        assert fails(module, {**rows, study.name: table}), study.name
        assert fails(module, {**rows, study.name: table.iloc[:0]}), study.name


def fails(module: ModuleType, rows: Rows) -> bool:
    """Whether a section from these rows has a check that fails, or cannot be made."""
    try:
        content = module.present(rows)
        for draw in (*content.figures.values(), *content.animations.values()):
            draw()
    except Exception:  # noqa: BLE001 # the report takes that for a check that fails
        return True
    return not all(check.holds for check in content.checks)
