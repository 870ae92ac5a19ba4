"""Panels of maps: grids of two axes, of which those cells have been run where outcomes change."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import NearestNDInterpolator

from analysis.data.checks import Array
from analysis.data.files import AnyArray
from validation.maps.problems import Problem, judged
from validation.maps.refinement import Cell, refine
from validation.sweeps.pools import Pool
from validation.sweeps.runner import run_cases
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """A panel of a map that has been run.

    Parameters
    ----------
    sweep : Sweep
        Over the finest grid.
    cells : DataFrame
        Columns as in `cell`, one row for each cell that was run.
    problem : Problem, optional
        That it is one of; without it, it is that of any sweep.
    """

    sweep: Sweep
    cells: pd.DataFrame
    problem: Problem | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the finest grid: vertical, horizontal axis."""
        return self.sweep.design.shape

    @property
    def values(self) -> tuple[Array, Array]:
        """Values along the vertical and the horizontal axis."""
        up, right = (
            np.array([axis.at(index) for index in range(axis.size or 0)], dtype=float)
            for axis in self.sweep.design.axes
        )
        return up, right

    @property
    def outcomes(self) -> AnyArray:
        """Outcome of every cell of the finest grid: that of the nearest one that was run."""
        codes, names = pd.factorize(self.cells["outcome"])
        nearest = NearestNDInterpolator(self.places(self.cells), codes)
        found: AnyArray = np.asarray(names, dtype=object)[
            nearest(*np.indices(self.shape)).astype(int)
        ]
        return found

    @property
    def seen(self) -> pd.DataFrame:
        """Cells that the other side was to run as well."""
        return self.cells[self.cells["seen"]]

    @property
    def shares(self) -> str:
        """Parts of the finest grid by outcome, in words."""
        parts = pd.Series(self.outcomes.ravel()).value_counts(normalize=True)
        return ", ".join(f"{name} {100.0 * part:.0f} %" for name, part in parts.items())

    def places(self, cells: pd.DataFrame) -> AnyArray:
        """Row and column of some cells on the finest grid, shape (n, 2)."""
        return np.column_stack(np.divmod(cells["number"].to_numpy(int), self.shape[1]))


def cell(sweep: Sweep, row: Mapping[str, Any], *, to_rest: bool) -> Cell:
    """What a map takes from the row of a case.

    Returns
    -------
    dict
        `number` and `outcome`; `time` of the inversion in s, where it lasts; whether the other
        side was to run it (`seen`), found the same inversion or face (`alike`), and how far off
        (`difference` in rad); `seconds` of processor time.
    """
    outcome = judged(sweep.scenario, row, to_rest=to_rest)
    if to_rest:
        alike = (row.get("face_end") or 0.0) * (row.get("other_face_end") or 0.0) > 0.0
    else:
        alike = row.get("inversion") == row.get("other_inversion")
    seen = row.get("other_inversion") is not None
    return {
        "number": row["number"],
        "outcome": outcome,
        "time": row["inverted_at"] if outcome == "inverted" else None,
        "seen": seen,
        "alike": seen and alike,
        "difference": row.get("difference"),
        "seconds": row["seconds"],
    }


def run_panel(
    problem: Problem, sweep: Sweep, path: Path, pool: Pool, *, levels: int, **how: Any
) -> Panel:
    """Run a panel, or what its store does not hold of it.

    Parameters
    ----------
    problem : Problem
    sweep : Sweep
        One of `panels`.
    path : Path
        Of the store.
    pool : Pool
    levels : int
        How often cells are halved.
    **how
        As in `run_cases`.
    """
    with Store(path, sweep) as store:

        def run(numbers: Iterable[int]) -> list[Cell]:
            run_cases(sweep, store, pool, numbers=numbers, **how)
            return [cell(sweep, row, to_rest=problem.to_rest) for row in store.rows()]

        cells = refine(sweep.design.shape, levels, run)
    return Panel(problem=problem, sweep=sweep, cells=pd.DataFrame(cells))
