"""Whether a disk that rolls without slip inverts (Sect. 4.3)."""

from dataclasses import replace
from math import inf
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analysis import ConstraintSet, Scenario, SmoothCoulomb, Start
from analysis.data.checks import Array
from analysis.data.trajectory import SOURCES
from validation.run import run
from validation.studies.claims.grades import Judged, within
from validation.study import Check, Row, Study, at_most, equal

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


class Case(NamedTuple):
    """Friction coefficient, infinite for no slip, and spin at the start in rad/s."""

    coefficient: float
    spin: float


def cases() -> dict[str, Case]:
    """More and more friction at the paper's spin, and no slip at all at each spin."""
    slipping = {f"μ = {each:g}": Case(each, Start().spin) for each in COEFFICIENTS}
    return slipping | {f"no slip, {spin:g} rad/s": Case(inf, spin) for spin in SPINS}


def measure(case: Case) -> list[Row]:
    """How high the centre of gravity gets on either side, from Table 3's position."""
    scenario, rolls = Scenario(start=Start(spin=case.spin)), case.coefficient == inf
    held: Any = {"constraints": ROLLING}
    if not rolls:
        held = {"friction": SmoothCoulomb(coefficient=case.coefficient)}
    scenario = replace(scenario, **held)
    accuracy: dict[str, Any] = {"tolerance": ENGINE_TOLERANCE} if rolls else {"step": ENGINE_STEP}
    method = "DOP853" if rolls else "LSODA"
    runs = (
        run(scenario, TIMES, formulation="euler-tree", **accuracy),
        run(scenario, TIMES, source="in-house", method=method, local_tolerance=1e-8),
    )
    return [
        {
            "source": source,
            "spin": case.spin,
            "gradient": None if rolls else scenario.friction.gradient,
            "highest": float(np.max(found.cog_direction)),
            "longest_up": longest_up(found.cog_direction),
            "outcome": found.inversion.outcome,
        }
        for source, found in zip(SOURCES, runs, strict=True)
    ]


def longest_up(direction: Array) -> float:
    """Longest time in s for which the centre of gravity stays above the geometric centre."""
    change = np.diff(np.concatenate(([0], direction > 0.0, [0])).astype(int))
    begins, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    return float(np.max(ends - begins, initial=0) * (TIMES[1] - TIMES[0]))


PURE_ROLLING = Study(
    name="pure-rolling",
    cases=cases,
    measure=measure,
    keys=("source",),
)


def judge(table: pd.DataFrame) -> Judged:
    """Section 4.3: pure rolling does not lead to the inversion."""
    rolled = table[table["gradient"].isna()]
    stays = (rolled["outcome"] == "not inverted").groupby(rolled["spin"]).all()
    return within(len(SPINS) - int(stays.sum()), 0, len(SPINS) - 1) | {
        "highest": rolled.groupby("spin")["highest"].max().tolist(),
        "longest": rolled["longest_up"].max(),
    }


def both_sides(table: pd.DataFrame) -> pd.DataFrame:
    """A row for each case with the highest place and the outcome on either side."""
    shown = table.pivot(index="case", columns="source", values=["highest", "outcome"])
    shown.columns = [" ".join(each) for each in shown.columns]
    return shown.reindex(list(cases())).reset_index()


def checks(table: pd.DataFrame) -> list[Check]:
    """Whether both sides find the same."""
    shown = both_sides(table)
    apart = (shown["highest engine"] - shown["highest in-house"]).astype(float).abs()
    same = shown["outcome engine"] == shown["outcome in-house"]
    return [
        at_most("pure rolling: highest places", float(apart.max(skipna=False)), APART),
        equal("pure rolling: cases with the same outcome", int(same.sum()), len(cases())),
    ]
