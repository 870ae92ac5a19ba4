"""Whether a disk that rolls without slip inverts (Sect. 4.3)."""

from itertools import groupby
from typing import Any

import numpy as np
import pandas as pd

from analysis import ConstraintSet, Scenario, SmoothCoulomb, Start
from analysis.problem.checks import Array
from analysis.problem.choices import SOURCES
from validation.run import run
from validation.study import Check, Row, Study, at_most, equal, within

SPINS = (20.0, 30.0, 40.0, 60.0, 80.0, 100.0)
"""Spins at the start in rad/s, of which the third is the paper's."""

COEFFICIENTS = (3.0, 30.0, 300.0)
"""Friction coefficients with the paper's smoothing, on the way to the limit of no slip."""

ROLLING: ConstraintSet = ("contact", "no-slip-along", "no-slip-across")

ENGINE_STEP, ENGINE_TOLERANCE = 2e-3, 1e-3
"""Step in s of the engine's runs with slip, and tolerance in rad of those without."""

APART = 1e-3
"""By which the highest places of the centre of gravity may differ between both sides."""

TIMES = np.linspace(0.0, 5.0, 1001)
"""Times of all runs in s."""

HIGHEST, OUTCOME, LONGEST = (
    [f"{name}, {source}" for source in SOURCES] for name in ("highest", "outcome", "longest up")
)
"""Columns: of the largest height, of what became of the disk, and of the longest time in s for
which the centre of gravity stays above the geometric centre."""


def cases() -> dict[str, Scenario]:
    """More and more friction at the paper's spin, and no slip at all at each spin."""
    slipping = {
        f"μ = {each:g}": Scenario(friction=SmoothCoulomb(coefficient=each))
        for each in COEFFICIENTS
    }
    return slipping | {
        f"no slip, {spin:g} rad/s": Scenario(constraints=ROLLING, start=Start(spin=spin))
        for spin in SPINS
    }


def measure(scenario: Scenario) -> list[Row]:
    """How high the centre of gravity gets on either side, from Table 3's position."""
    rolls = scenario.constraints == ROLLING
    accuracy: dict[str, Any] = {"tolerance": ENGINE_TOLERANCE} if rolls else {"step": ENGINE_STEP}
    method = "DOP853" if rolls else "LSODA"
    runs = (
        run(scenario, TIMES, formulation="euler-tree", **accuracy),
        run(scenario, TIMES, source="in-house", method=method, local_tolerance=1e-8),
    )
    row: Row = {"rolls": rolls}
    for found, highest, outcome, longest in zip(runs, HIGHEST, OUTCOME, LONGEST, strict=True):
        row |= {highest: np.max(found.cog_direction), outcome: found.inversion.outcome}
        row[longest] = longest_up(found.cog_direction)
    return [row]


def longest_up(direction: Array) -> float:
    """Longest time in s for which the centre of gravity stays above the geometric centre."""
    up = [len(list(run)) for is_up, run in groupby(direction > 0.0) if is_up]
    return float(max(up, default=0) * TIMES[1])


PURE_ROLLING = Study(name="pure-rolling", cases=cases, measure=measure)


def judge(table: pd.DataFrame) -> Row:
    """Section 4.3: pure rolling does not lead to the inversion."""
    rolled = table[table["rolls"]]
    stays = (rolled[OUTCOME] == "not inverted").all(axis=1).sum()
    return within(len(SPINS) - stays, 0, len(SPINS) - 1) | {
        "highest": rolled[HIGHEST].max(axis=1),
        "longest": rolled[LONGEST].max(axis=None),
    }


def checks(table: pd.DataFrame) -> list[Check]:
    """Whether both sides find the same."""
    apart = (table[HIGHEST[0]] - table[HIGHEST[1]]).abs().max(skipna=False)
    same = int((table[OUTCOME[0]] == table[OUTCOME[1]]).sum())
    return [
        at_most("pure rolling: highest places", float(apart), APART),
        equal("pure rolling: cases with the same outcome", same, len(cases())),
    ]
