"""Whatever is wrong with any study fails the report: in its table, on the spot, or not there."""

from math import inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

from validation import report
from validation import study as kit
from validation.study import Found, Row, Study

STORED = {
    study.name: study
    for name in (*report.DISK, *report.METHOD)
    for study in report.find(name).STUDIES
    if study.is_stored
}

studies = pytest.mark.parametrize("study", STORED.values(), ids=list(STORED))


def fresh(study: Study, stored: pd.DataFrame) -> Found:
    """The sample of a study as if it came out as it is stored."""
    found: Found = {}
    for task in study.tasks(whole=False):
        rows = stored[stored["case"] == task.label].to_dict("records")
        found[task.key] = [{name: _missing(value) for name, value in row.items()} for row in rows]
    return found


def _missing(value: Any) -> Any:
    return None if isinstance(value, float) and np.isnan(value) else value


def failing(study: Study, found: Found, stored: pd.DataFrame) -> list[str]:
    """Names of the checks that fail."""
    return [check.name for check in kit.confirm(study, found, stored) if not check.holds]


def first(study: Study, found: Found) -> tuple[tuple[str, str], list[Row], Row]:
    """A sampled case of a study, its rows, and the one with most numbers that did not fail."""
    every = [
        (key, rows, row)
        for key, rows in found.items()
        if isinstance(rows, list)
        for row in rows
        if not row.get("failure")
    ]
    return max(every, key=lambda each: len(_numbers(study, each[2])))


def _numbers(study: Study, row: Row) -> list[str]:
    """Columns of which a row has a number that may be off; without these, what must be equal."""
    known = {name: limit for name, limit in study.confirm.items() if row.get(name) is not None}
    return [name for name, limit in known.items() if limit is not None] or list(known)


@studies
def test_what_comes_out_as_it_is_stored_is_confirmed(study: Study) -> None:
    stored = kit.load(study)
    assert set(study.sample) <= set(stored["case"]) <= set(study.cases())
    assert study.confirm
    assert failing(study, fresh(study, stored), stored) == []


@studies
@pytest.mark.parametrize("planted", [nan, inf, -inf, "far"])
def test_a_wrong_number_on_the_spot_or_in_the_table_fails(study: Study, planted: Any) -> None:
    stored = kit.load(study)
    key, rows, row = first(study, fresh(study, stored))
    assert _numbers(study, row)
    for name in _numbers(study, row):
        value = row[name]
        wrong: Any = planted
        if study.confirm[name] is None:
            wrong = "another"
        elif planted == "far":
            wrong = np.add(value, 10.0 * (1.0 + np.abs(value))).tolist()
        elif isinstance(value, list):
            wrong = np.full(np.shape(value), planted).tolist()
        changed = {**row, name: wrong}
        others = [each if each is not row else changed for each in rows]
        assert failing(study, {**fresh(study, stored), key: others}, stored), name
        table = stored.copy()
        table[name] = table[name].astype(object)
        table.at[rows_like(table, study, key[1], row), name] = wrong
        assert failing(study, fresh(study, stored), table), name


def rows_like(table: pd.DataFrame, study: Study, label: str, row: Row) -> Any:
    """Index of a row in a table."""
    same = table["case"] == label
    for name in study.keys:
        same &= table[name] == row[name]
    return table.index[same][0]


@studies
def test_a_crash_an_empty_measurement_and_a_missing_row_fail(study: Study) -> None:
    stored = kit.load(study)
    found = fresh(study, stored)
    key, rows, row = first(study, found)
    assert failing(study, {**found, key: RuntimeError("it crashed")}, stored)
    assert failing(study, {**found, key: []}, stored)
    assert failing(study, {name: rows for name, rows in found.items() if name != key}, stored)
    if len(rows) > 1:
        assert failing(study, {**found, key: [each for each in rows if each is not row]}, stored)
    gone = stored.drop(index=rows_like(stored, study, key[1], row))
    assert failing(study, found, gone)
