"""The study of the inversion: what it shows of its runs, and what fails it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import simulate
from analysis.data.trajectory import SOURCES
from tests.helpers import failing, planted
from validation.page.content import Content
from validation.studies import inversion
from validation.study import frame, plain


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """Rows of in-house runs, which take the engine's place as well."""
    rows = []
    for case, (level, load, end) in inversion.cases().items():
        times = np.linspace(0.0, end, round(end / inversion.SPACING) + 1)
        run = simulate(inversion.scenario_of(level, load), times, local_tolerance=1e-6)
        told = {"case": case, "level": level, "load": load, "formulation": "index-1"}
        names = ("times", "coordinates", "rates", "multipliers")
        curves = {name: getattr(run, name) for name in names}
        rows += [told | curves | {"source": s, "error_estimate": 1e-8} for s in SOURCES]
    return frame(plain(rows))


def shown(table: pd.DataFrame) -> Content:
    return inversion.present({inversion.STUDY.name: table})


def test_numbers_are_those_of_the_runs_and_all_checks_hold(table: pd.DataFrame) -> None:
    content = shown(table)
    assert content.numbers["times"] == "0.49, 0.58, 0.77, 0.76"
    assert content.numbers["short"] == pytest.approx(0.28, abs=5e-3)
    assert content.numbers["change"] == pytest.approx(2.4e-2, abs=5e-4)
    assert content.verdicts[0].answer == "yes"
    assert content.checks
    assert not failing(content.checks)


def changed(table: pd.DataFrame, name: str, change: Callable[[Any], Any]) -> Content:
    """What is shown with a value of the last run of the engine replaced."""
    return shown(planted(table, table.index[table["source"] == "engine"][-1], name, change))


@pytest.mark.parametrize(
    ("name", "change", "check"),
    [
        ("error_estimate", lambda _: 1e-3, "engine's error estimate in rad"),
        ("coordinates", lambda x: [[*row[:5], row[5] + 1e-6] for row in x], "β and γ apart"),
        ("rates", lambda x: [[*row[:3], row[3] + 1e-3, *row[4:]] for row in x], "spin apart"),
        ("multipliers", lambda x: [[row[0] + 1e-3, *row[1:]] for row in x], "normal force apart"),
    ],
)  # fmt: skip
def test_a_run_that_departs_or_promises_too_little_fails(
    table: pd.DataFrame, name: str, change: Callable[[Any], Any], check: str
) -> None:
    assert any(check in each for each in failing(changed(table, name, change).checks))


def test_a_disk_that_does_not_turn_over_fails_and_is_said_so(table: pd.DataFrame) -> None:
    low = changed(table, "coordinates", lambda x: [[*row[:5], -1.5] for row in x])
    assert low.verdicts[0].answer == "partly"
    assert any("inversions apart" in each for each in failing(low.checks))


def test_a_case_is_run_by_both_sides() -> None:
    rows = plain(inversion.measure((1, "weight", 0.1)))
    assert [row["source"] for row in rows] == list(SOURCES)
    runs = inversion.motions(frame(rows).assign(case="Model 1"))
    one, other = (runs["Model 1", source].coordinates for source in SOURCES)
    assert 0.0 < np.max(np.abs(one - other)) < 2 * inversion.TOLERANCE
