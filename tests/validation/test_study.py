"""The one mechanism of all studies: what it keeps, and that everything wrong fails a check."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from tests.helpers import failing
from tests.toy_study import CASES, STUDY
from validation import study as kit
from validation.kit.provenance import Provenance
from validation.study import Study


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the table of the toy study, measured."""
    folder = tmp_path_factory.mktemp("results")
    found = kit.measured(STUDY.tasks(whole=True), folder / "kept", workers=0)
    kit.write(STUDY, kit.whole_table(STUDY, found), Provenance.here(), folder)
    return folder


def dictionary(cases: dict[str, Any]) -> dict[str, Any]:
    """The same, importable by its name."""
    return cases


def of(case: Any) -> Study:
    """The toy study with another case in place of its first."""
    return replace(STUDY, cases=partial(dictionary, {**CASES, "one": case}))


def fails(study: Study, folder: Path, results: Path) -> set[str]:
    """Names of the checks that fail after measuring its sample."""
    (case,) = (study.cases()[label] for label in study.sample)
    workers = 1 if case == "ends" else 0
    found = kit.measured(study.tasks(whole=False), folder, workers=workers)
    return failing(kit.confirm(study, found, kit.load(STUDY, results)))


def test_a_stored_table_comes_back_as_it_was_written(results: Path) -> None:
    table = kit.load(STUDY, results)
    assert table["value"].tolist() == [1.0, 1.0, 2.0, 4.0]
    assert table["curve"].tolist() == [[1.0, 1], [1.0, 2], [2.0, 1], [2.0, 2]]


@pytest.mark.parametrize(
    ("case", "check"),
    [
        ("raises", "toy: one: runs"),
        ("ends", "toy: one: runs"),
        ("nothing", "toy: one: runs"),
        ("inf", "toy: one: value"),
        ("shorter", "toy: one: rows"),
    ],
)
def test_whatever_goes_wrong_on_the_spot_fails_a_check(
    case: str, check: str, results: Path, tmp_path: Path
) -> None:
    assert check in fails(of(case), tmp_path, results)


def test_a_case_that_hangs_is_ended_and_is_a_result_where_the_study_says_so(
    tmp_path: Path,
) -> None:
    study = replace(of("hangs"), limit=1.0)
    (task,) = study.tasks(whole=False)
    crash = kit.measured([task], tmp_path)[task.key]
    assert "not finished within 1 s" in str(crash)
    study = replace(study, failed=failed)
    (task,) = study.tasks(whole=False)
    assert kit.measured([task], tmp_path)[task.key] == [
        {"power": 1, "failure": "not finished within 1 s"}
    ]


def failed(_: object, reason: str) -> list[kit.Row]:
    """The row of a case that was ended."""
    return [{"power": 1, "failure": reason}]


def test_what_is_kept_is_not_measured_again_until_the_code_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tasks = STUDY.tasks(whole=False)
    first = kit.measured(tasks, tmp_path, workers=0)
    assert kit.measured(tasks, tmp_path, workers=0) == first
    assert kit.measured(tasks, tmp_path, workers=0, fresh=True) != first
    with (tmp_path / "toy.jsonl").open("a") as stream:
        stream.write('["one", 0, [{"val')
    assert kit.measured(tasks, tmp_path, workers=0) != first
    latest = kit.measured(tasks, tmp_path, workers=0)
    monkeypatch.setattr(kit, "behind", lambda _: "other code")
    assert kit.measured(tasks, tmp_path, workers=0) != latest


def test_a_table_is_not_made_of_crashes_of_rows_alike_or_of_what_no_file_can_hold(
    tmp_path: Path,
) -> None:
    found = kit.measured(of("raises").tasks(whole=True), tmp_path, workers=0)
    with pytest.raises(RuntimeError, match="toy: 1 cases crashed"):
        kit.whole_table(STUDY, found)
    found = kit.measured(STUDY.tasks(whole=True), tmp_path, workers=0)
    with pytest.raises(ValueError, match="do not tell rows apart"):
        kit.whole_table(replace(STUDY, keys=()), found)
    with pytest.raises(TypeError, match="rows must hold numbers"):
        kit.rows_of(lambda _: [{"value": 1j}], CASES)
