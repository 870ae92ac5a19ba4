"""The study of the inversion: what it shows of its runs, and what fails it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.problem.choices import SOURCES
from tests.calls import ROOT
from tests.helpers import failing, planted
from tests.stated import chapter
from validation.studies import inversion
from validation.study import Content, rows_of


def shown(table: pd.DataFrame) -> Content:
    return inversion.present({inversion.STUDY.name: table})


def test_numbers_are_those_of_the_runs_and_all_checks_hold(inversions: pd.DataFrame) -> None:
    content = shown(inversions)
    stated = chapter((ROOT / "README.md").read_text("utf-8"), "What it shows")
    *first, last = content.numbers["times"].split(", ")
    assert f"upside down: after {', '.join(first)} and {last} s." in " ".join(stated.split())
    assert content.numbers["answer"] == "yes"
    assert content.checks
    assert not failing(content.checks)


@pytest.mark.parametrize(
    ("name", "change", "check"),
    [
        ("error_estimate", lambda _: 1e-3, "engine's error estimate in rad"),
        ("coordinates", lambda x: [[*row[:5], row[5] + 1e-6] for row in x], "β and γ apart"),
        ("coordinates", lambda x: [[*row[:5], -1.5] for row in x], "inversions apart"),
        ("rates", lambda x: [[*row[:3], row[3] + 1e-3, *row[4:]] for row in x], "spin apart"),
        ("multipliers", lambda x: [[row[0] + 1e-3, *row[1:]] for row in x], "normal force apart"),
    ],
)  # fmt: skip
def test_a_run_that_departs_or_promises_too_little_fails(
    inversions: pd.DataFrame, name: str, change: Callable[[Any], Any], check: str
) -> None:
    last = inversions.index[inversions["source"] == "engine"][-1]
    content = shown(planted(inversions, last, name, change))
    assert any(check in each for each in failing(content.checks))
    turned = check != "inversions apart"
    assert content.numbers["answer"] == ("yes" if turned else "partly")


def test_a_case_is_run_by_both_sides() -> None:
    scenario, _ = inversion.cases()["Model 1"]
    runs = inversion.motions(
        pd.DataFrame(rows_of(inversion.measure, (scenario, 0.1))).assign(case="Model 1")
    )
    one, other = (runs["Model 1", source].coordinates for source in SOURCES)
    assert 0.0 < np.max(np.abs(one - other)) < 2 * inversion.TOLERANCE
