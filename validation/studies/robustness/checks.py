"""What has to hold of the hard cases and of what is measured beside them."""

from collections.abc import Iterator
from itertools import pairwise
from math import log10, nan

import pandas as pd

from analysis import LOADS
from validation.kit.limits import largest
from validation.page.content import Rows
from validation.studies.robustness.conservation import DRIFTING, FREE
from validation.studies.robustness.outcomes import (
    CASES,
    CHOSEN,
    GOOD,
    is_broken,
    is_right,
    ways,
)
from validation.studies.robustness.penalty import STIFFNESSES
from validation.studies.robustness.steps import EXPLICIT, STEPS
from validation.study import Check, Row, Study, at_most

NEAR = 0.03
"""Largest relative difference of a stable step from the predicted one."""

ENERGY = 1e-4
"""Largest residual of the energy balance over weight times radius."""

GROWTH = 1.5
"""Largest drift in the second half of the time over that in the first that does not grow."""

LEFT = 3
"""Most of the cases as chosen that may be left without an accurate result."""

ORDER = 0.1
"""Largest deviation from one of the order in which the penalty contact tends to the ideal one."""

INTEGRATED = 0.01
"""Largest error of its integration over its difference from the ideal contact."""


def checks(rows: Rows) -> Iterator[Check]:
    """All of them."""
    for study in (CASES, CHOSEN):
        yield from _cases(study, rows[study.name])
    left = int((~rows[CHOSEN.name]["verdict"].isin(GOOD)).sum())
    yield at_most("cases as chosen: without an accurate result", left, LEFT, "stored")
    yield from _steps(rows["robustness-steps"])
    yield from _conservation(rows["robustness-conservation"])
    yield from _penalty(rows["robustness-penalty"])


def broken(table: pd.DataFrame) -> int:
    """Number of cases that crashed or broke their promise, as noted or by their numbers."""
    return sum(row["broken"] or is_broken(row) for row in _rows(table))


def _rows(table: pd.DataFrame) -> list[Row]:
    """Rows with None for what is missing."""
    return [
        {name: None if value != value else value for name, value in row.items()}  # noqa: PLR0124
        for row in table.to_dict("records")
    ]


def _cases(study: Study, table: pd.DataFrame) -> Iterator[Check]:
    name = "cases" if study is CASES else "cases as chosen"
    wanted = {(label, way.name) for label, each in study.cases().items() for way in ways(each)}
    other = wanted ^ set(zip(table["case"], table["way"], strict=True))
    yield at_most(f"{name}: missing or too many", len(other), 0, "stored")
    yield at_most(f"{name}: crashed or promise broken", broken(table), 0, "stored")
    wrong = sum(row["verdict"] in GOOD and not is_right(row) for row in _rows(table))
    yield at_most(f"{name}: called right against their numbers", wrong, 0, "stored")


def _steps(limits: pd.DataFrame) -> Iterator[Check]:
    stable = limits.set_index(["case", "integrator"])
    for integrator in EXPLICIT:
        found = stable.reindex([(name, integrator) for name in STEPS.cases()])
        hidden = found["predicted"].isna()
        # The widest smoothing: there the spinning itself is unstable about as fast.
        yield at_most(f"steps: {integrator}, places without a stable step", int(hidden.sum()), 1)
        apart = (found["step"] / found["predicted"] - 1.0)[~hidden].abs()
        yield at_most(f"steps: {integrator}, stable over predicted", largest(apart), NEAR)


def _conservation(table: pd.DataFrame) -> Iterator[Check]:
    rows = table.set_index("case")
    for name, run in DRIFTING.items():
        row = rows.loc[name]
        yield at_most(f"drift: {name}, position in m", row["position"], row["allowed"])
        yield at_most(f"drift: {name}, energy", row["energy"], ENERGY)
        if run.held:
            yield at_most(f"drift: {name}, growth", row["growth"], GROWTH)
    for name in FREE:
        changed = largest(rows.loc[name, ["energy", "momentum", "spin"]])
        yield at_most(f"conserved: {name}", changed, rows.loc[name, "allowed"])


def _penalty(table: pd.DataFrame) -> Iterator[Check]:
    found = table.set_index(["load", "stiffness"])
    for load in LOADS:
        rows = found.reindex([(load, each) for each in STIFFNESSES])
        for column in ("angles", "normal_force"):
            values = rows[column].tolist()
            orders = [_order(*each) for each in pairwise(values)]
            worst = largest(abs(each - 1.0) for each in orders)
            yield at_most(f"penalty: load {load}, {column}, order less one", worst, ORDER)
        integrated = largest(rows["estimate"] / rows["angles"])
        yield at_most(f"penalty: load {load}, error of integration", integrated, INTEGRATED)


def _order(soft: float, stiff: float) -> float:
    """Order over a decade of stiffness."""
    return log10(soft / stiff) if soft > 0.0 and stiff > 0.0 else nan
