"""The study of the way to rest: its numbers, and that what is wrong in it fails."""

from collections.abc import Callable
from math import nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.problem.choices import SOURCES
from tests.helpers import failing, planted
from validation import study as studying
from validation.studies.rest import closed_forms, creep, runs, section, starts
from validation.study import Row


@pytest.fixture(scope="module")
def fresh() -> pd.DataFrame:
    """In place of the runs made for each report, rows of stored ones."""
    known = studying.load(runs.STUDY).set_index("case").to_dict("index")
    rows = [
        {**known[runs.ENGINE[each]], "case": runs.INHOUSE[each]}
        for each in (runs.SHOWN, runs.VISCOUS)
    ]
    ideal = {name: known[runs.INHOUSE[runs.SLIDING]][name] for name in runs.PHASES[:2]}
    return pd.DataFrame([*rows, {**ideal, "case": runs.IDEAL, "end": 19.5}])


def judged(part: Any, table: pd.DataFrame, fresh: pd.DataFrame) -> set[str]:
    """Names of the checks that fail with a table of a part."""
    if part is not runs:
        return failing(part.present(table).checks)
    every = pd.concat([table, fresh]).set_index("case")
    return failing(section.checks(every.to_dict("index")))


def wrong(table: pd.DataFrame, case: str, column: str, change: Callable[[Any], Any]) -> Any:
    """The table with a value of a case replaced."""
    return planted(table, table.index[table["case"] == case][0], column, change)


CASES = {runs: runs.ENGINE[runs.SHOWN], creep: "ε = 0.3 m/s", starts: "random, seed 3"}
"""In which a value is replaced."""


@pytest.mark.parametrize(
    ("part", "column", "change", "check"),
    [
        (runs, "tilt", lambda x: [*x[:700], x[700] + 2e-3, *x[701:]], "tilt in rad"),
        (runs, "flat", lambda _: nan, "phases in s"),
        (runs, "taken_by_sliding", lambda taken: 1.1 * taken, "energy taken"),
        (runs, "face", lambda _: "second", "face apart"),
        (runs, "rise", lambda _: 1e-6, "rise of the energy"),
        (runs, "force", lambda _: -1.0, "contact pulls"),
        (runs, "unexplained", lambda _: 1e-3, "unexplained part"),
        (creep, "error", lambda _: 0.01, "deviation from the law"),
        (creep, "part", lambda _: 0.9, "parts of the rate"),
        (starts, "force", lambda _: -1.0, "contact pulls"),
    ],
)
def test_what_departs_in_a_stored_table_fails_its_check(
    part: Any, column: str, change: Callable[[Any], Any], check: str, fresh: pd.DataFrame
) -> None:
    right, case = studying.load(part.STUDY), CASES[part]
    assert not judged(part, right, fresh)
    found = judged(part, wrong(right, case, column, change), fresh)
    assert any(check in name and (case in name or part is not runs) for name in found)


def test_a_variant_that_shifts_a_phase_or_loses_its_proportion_fails(fresh: pd.DataFrame) -> None:
    table = wrong(studying.load(runs.STUDY), "stiffness doubled", "rest", lambda time: time + 0.1)
    table = wrong(table, "spin 1e-06 rad/s faster", "tilt", lambda x: [each + 1e-3 for each in x])
    assert judged(runs, table, fresh) == {
        f"rest, stiffness doubled: phases in s apart from {runs.INHOUSE[runs.SHOWN]}",
        "rest, spin: effect out of proportion",
    }


def test_a_phase_that_one_side_passes_without_fails_but_not_one_behind_its_end() -> None:
    whole: Row = dict.fromkeys(runs.PHASES, 1.0) | {"end": 5.0}
    assert section.shift(whole, whole | {"rest": 1.5}) == pytest.approx(0.5)
    assert section.shift(whole, whole | {"rest": None}) == np.inf
    assert section.shift(whole | {"rest": None}, whole) == np.inf
    assert section.shift(whole | {"rest": 4.0}, whole | {"rest": nan, "end": 3.0}) == 0.0
    nothing: Row = dict.fromkeys(runs.PHASES) | {"end": 5.0}
    assert section.shift(nothing, nothing) == np.inf


def test_the_creeps_law_and_its_deviation_are_found() -> None:
    times = np.arange(1.25, 60.0, creep.MEAN_TIME)
    tilts = (10.0 + 0.02 * times) ** -0.5
    tilts[times >= creep.TIMES[1]] *= 1.01
    assert creep.fit(times, tilts) == pytest.approx((0.02, 0.01), rel=1e-6)


def test_a_side_that_misses_a_closed_form_fails() -> None:
    cases = closed_forms.cases().items()
    right = pd.DataFrame(
        {"case": name, "quantity": quantity, "exact": exact, "source": source, "value": exact}
        for name, case in cases
        if isinstance(case, tuple)
        for quantity, exact in case.exact.items()
        for source in SOURCES
    )
    assert not failing(closed_forms.present(right).checks)
    for place, value in ((0, nan), (0, 1.1 * right.at[0, "value"]), (right.index[-1], 1.0)):
        table = planted(right, place, "value", value)
        assert len(failing(closed_forms.present(table).checks)) == 2
