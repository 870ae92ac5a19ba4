"""Panels of maps: grids of two axes, of which those cells are run that are worth it.

That is coarsely everywhere, and finely where outcomes change.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import griddata

from analysis import Scenario
from analysis.motion.files import AnyArray
from analysis.motion.outcomes import DONE
from analysis.problem.body import Body
from analysis.problem.checks import Array
from validation.sweeps.case import WITNESS_FAILED
from validation.sweeps.pools import Pool
from validation.sweeps.results import Results
from validation.sweeps.runner import run_cases
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep

Cell = dict[str, Any]
"""With its `number` on a grid of two axes, the last one fastest, and its `outcome`."""


_PER_CELL = 5
"""Cases for each cell of a row or column that is halved, as in the maps of the report."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """A panel of a map that has been run.

    Parameters
    ----------
    sweep : Sweep
        Over the finest grid.
    cells : DataFrame
        Columns as in `cell`, one row for each cell that was run.
    failures : mapping
        Numbers of cases that failed and may not do so again; see `Store.failures`.
    """

    sweep: Sweep
    cells: pd.DataFrame
    failures: Mapping[str, int] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the finest grid: vertical, horizontal axis."""
        return self.sweep.design.shape

    @property
    def values(self) -> tuple[Array, Array]:
        """Values along the vertical and the horizontal axis."""
        up, right = (np.array(axis.grid, dtype=float) for axis in self.sweep.design.axes)
        return up, right

    @property
    def outcomes(self) -> AnyArray:
        """Outcome of every cell of the finest grid: that of the nearest one that was run."""
        codes, names = pd.factorize(self.cells["outcome"])
        nearest = self.spread(self.cells, codes, "nearest")
        return np.asarray(names, dtype=object)[nearest.astype(int)]

    @property
    def seen(self) -> pd.DataFrame:
        """Cells that the other side was to run as well."""
        return self.cells[self.cells["seen"]]

    @property
    def summary(self) -> dict[str, Any]:
        """What became of the disk, with parts of the area, and what the other side says."""
        outcomes = self.outcomes
        parts = {name: mean_over_area(outcomes == name) for name in np.unique(outcomes)}
        told = sorted(parts.items(), key=itemgetter(1), reverse=True)
        apart = [self.seen["difference"].astype(float).agg(each) for each in ("median", "max")]
        median, largest = (None if np.isnan(each) else float(each) for each in apart)
        return {
            "model": self.sweep.scenario.name,
            "runs": len(self.cells),
            "in place of": self.sweep.design.size,
            "outcomes": ", ".join(f"{name} {100 * part:.0f} %" for name, part in told),
            "seen by the other side": len(self.seen),
            "of them alike": int(self.seen["alike"].sum()),
            "median difference in rad": median,
            "largest difference in rad": largest,
        }

    def spread(self, cells: pd.DataFrame, values: Any, method: str) -> Array:
        """Values of some cells over the finest grid, as `scipy.interpolate.griddata` calls it."""
        return griddata(self.places(cells), values, tuple(np.indices(self.shape)), method)

    def places(self, cells: pd.DataFrame) -> AnyArray:
        """Row and column of some cells on the finest grid, shape (n, 2)."""
        return np.column_stack(np.divmod(cells["number"].to_numpy(int), self.shape[1]))


def mean_over_area(values: AnyArray) -> float:
    """Mean of values on a grid, shape (m, n), of which those on an edge stand for half a cell."""
    weights = [np.ones(size) for size in values.shape]
    for along in weights:
        along[[0, -1]] = 1.0 if along.size == 1 else 0.5
    return float(np.average(values, weights=np.outer(*weights)))


def cell(sweep: Sweep, row: Mapping[str, Any], *, by_face: bool) -> Cell:
    """What a map takes from the row of a case.

    Returns
    -------
    dict
        `number` and `outcome`; `time` of the inversion in s, where it lasts; whether the other
        side was to run it (`seen`), found the same outcome or face (`alike`), and how far off
        (`difference` in rad); `seconds` of processor time.
    """
    scenario = sweep.scenario
    if by_face and row["status"] == DONE:
        scenario = sweep.scenario_of(row["number"])
    outcome = became(scenario, row, by_face=by_face)
    if by_face:
        alike = (row.get("face_end") or 0.0) * (row.get("other_face_end") or 0.0) > 0.0
    else:
        other = {name: row.get(f"other_{name}") for name in ("inversion", "ending")}
        alike = outcome == became(scenario, {"status": DONE, **other}, by_face=False)
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


def became(scenario: Scenario, row: Mapping[str, Any], *, by_face: bool) -> str:
    """What became of the disk in a case: of its inversion, or which of its faces is up.

    A face is up for good once the disk cannot pass through standing on its rim any more, however
    long it takes to come to rest there.
    """
    if row["status"] != DONE:
        return "refused" if row["status"] == "refused" and not by_face else "failed"
    if by_face:
        barrier = scenario.weight * _least_upright_height(scenario.disk)
        if scenario.contact is not None:
            # It gives way under the weight.
            barrier -= 0.5 * scenario.weight**2 / scenario.penalty_contact.stiffness
        if float(row["energy_end"] or np.inf) >= barrier and row["ending"] != "flat":
            return "not decided"
        return "upper face" if float(row["face_end"] or 0.0) > 0.0 else "lower face"
    if row["inversion"] in ("inverted", "lost", "not decided", WITNESS_FAILED):
        return str(row["inversion"])
    return {"contact would pull": "pulls", "flat": "flat"}.get(str(row["ending"]), "not inverted")


@cache
def _least_upright_height(disk: Body) -> float:
    """Least height in m of the centre of gravity with the axis level: r - e of a round disk."""
    gammas = np.linspace(-np.pi, np.pi, 7201)
    heights = disk.clearance(np.pi / 2, gammas)[0] + disk.eccentricity * np.sin(gammas)
    return float(np.min(heights))


# --- Running ------------------------------------------------------------------------------------


def refine(
    shape: Sequence[int], levels: int, run: Callable[[Iterable[int]], list[Cell]]
) -> list[Cell]:
    """Run a coarse grid, and halve its squares as long as one holds two outcomes.

    What lies between the points of the coarse grid and touches no square with two outcomes, such
    as an island smaller than one, is not found.

    Parameters
    ----------
    shape : sequence of 2 int
        Of the finest grid: cells * 2**levels + 1 along each axis.
    levels : int
        How often squares are halved.
    run : callable
        Runs some cases; returns the cells of all that have been run so far.

    Returns
    -------
    list of dict
        Cells of all cases that have been run.
    """
    step = 2**levels
    rows, columns = (range(0, size, step) for size in shape)
    cells = run([row * shape[1] + column for row in rows for column in columns])
    while step > 1:
        # A boundary may leave a halved square through a side that looked uniform.
        while missing := _missing(cells, shape, step):
            cells = run(missing)
        step //= 2
    return cells


def expected_cases(cells: int, levels: int) -> int:
    """About as many cases as a map of usual boundaries runs, of which each level halves the cells.

    A boundary passes some cells of each row and column, so that their number doubles with a level.
    """
    finest = cells << levels
    return min((finest + 1) ** 2, (cells + 1) ** 2 + _PER_CELL * 2 * (finest - cells))


def _missing(cells: Iterable[Cell], shape: Sequence[int], step: int) -> list[int]:
    """Cases to run in squares of this size that hold more than one outcome."""
    known = {cell["number"]: cell["outcome"] for cell in cells}
    wanted: set[int] = set()
    corners = (range(0, size - 1, step) for size in shape)
    for row, column in product(*corners):
        points = [
            (row + down) * shape[1] + column + right
            for down, right in product((0, step // 2, step), repeat=2)
        ]
        if len({known[point] for point in points if point in known}) > 1:
            wanted.update(point for point in points if point not in known)
    return sorted(wanted)


def run_panel(
    sweep: Sweep, path: Path, pool: Pool, *, by_face: bool, levels: int = 0, retry: bool = False
) -> Panel:
    """Run a panel, or what its store does not hold of it.

    Parameters
    ----------
    sweep : Sweep
        One of `panels`, or of any cases if no cell is to be halved.
    path : Path
        Of the store.
    pool : Pool
    by_face : bool
        See `became`.
    levels : int
        How often cells are halved.
    retry : bool
        Whether cases of the store that failed, on either side, run again.
    """
    with Store(path, sweep) as store:
        if retry:
            run_cases(store, pool, numbers=store.failed(), retry=True)

        def run(numbers: Iterable[int] | None = None) -> list[Cell]:
            run_cases(store, pool, numbers=numbers)
            return [cell(sweep, row, by_face=by_face) for row in Results.load(path).rows()]

        cells = refine(sweep.design.shape, levels, run) if levels else run()
        failures = store.failures()
    failures.pop("refused", None)
    return Panel(sweep=sweep, cells=pd.DataFrame(cells), failures=failures)
