"""The study of the inversion: what it shows of its runs, and what fails it."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analysis import Trajectory
from analysis.problem.choices import SOURCES
from tests.calls import ROOT
from tests.faults import Rows, faults
from tests.helpers import failing, planted
from tests.stated import chapter
from validation.studies import inversion
from validation.study import rows_of

NAME = inversion.STUDY.name


@pytest.fixture
def rows(inversions: pd.DataFrame) -> Rows:
    return {NAME: inversions}


def both(table: pd.DataFrame) -> list[Trajectory]:
    """Runs of Model 1, first the engine's."""
    runs = inversion.motions(table)
    return [runs["Model 1", source] for source in SOURCES]


def test_numbers_are_those_of_the_runs_and_all_checks_hold(rows: Rows) -> None:
    content = inversion.present(rows)
    stated = chapter((ROOT / "README.md").read_text("utf-8"), "What it shows")
    *first, last = content.numbers["times"].split(", ")
    assert f"upside down: after {', '.join(first)} and {last} s." in " ".join(stated.split())
    assert content.numbers["answer"] == "yes"
    assert content.checks
    assert not failing(content.checks)
    assert all(draw().axes for draw in content.figures.values())


@pytest.mark.parametrize(
    ("name", "column", "change", "told"),
    [
        ("coordinates", 5, 1e-6, inversion.ANGLES),
        ("rates", 3, 1e-3, "spin apart in rad/s"),
        ("multipliers", 0, 1e-3, "normal force apart in N"),
    ],
)
def test_a_run_that_departs_is_told(
    inversions: pd.DataFrame, name: str, column: int, change: float, told: str
) -> None:
    one, other = both(inversions)
    moved = getattr(one, name).copy()
    moved[:, column] += change
    apart = inversion.agreement(replace(one, **{name: moved}), other)
    assert apart[told] == pytest.approx(change, rel=1e-2)
    assert change > inversion.LIMITS[told]


def test_a_run_that_is_not_inverted_is_as_far_off_as_nothing_else(
    inversions: pd.DataFrame,
) -> None:
    one, other = both(inversions)
    low = one.coordinates * [1, 1, 1, 1, 1, 0]
    apart = inversion.agreement(replace(one, coordinates=low), other)
    assert np.isnan(apart["inversions apart in s"])
    # The engine's last run.
    turned = planted(inversions, 8, "coordinates", lambda x: [[*row[:5], -1.5] for row in x])
    assert inversion.present({NAME: turned}).numbers["answer"] == "partly"


test_a_difference_or_an_estimate_beyond_its_limit_fails = faults(
    inversion.present,
    [(NAME, 8, name, name, 1.1 * limit) for name, limit in inversion.LIMITS.items()],
)


def test_a_case_is_run_by_both_sides() -> None:
    scenario, _ = inversion.cases()["Model 1"]
    rows = pd.DataFrame(rows_of(inversion.measure, (scenario, 0.1))).assign(case="Model 1")
    one, other = both(rows)
    assert 0.0 < np.max(np.abs(one.coordinates - other.coordinates)) < 2 * inversion.TOLERANCE
