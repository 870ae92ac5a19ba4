"""Cases of a grid that are worth running: coarsely everywhere, finely where outcomes change."""

from collections.abc import Callable, Iterable, Sequence
from itertools import product
from typing import Any

Cell = dict[str, Any]
"""With its `number` on a grid of two axes, the last one fastest, and its `outcome`."""

Run = Callable[[Iterable[int]], list[Cell]]
"""Runs some cases; returns the cells of all that have been run so far."""

_PER_CELL = 5
"""Cases for each cell of a row or column that is halved, as in the maps of the report."""


def refine(shape: Sequence[int], levels: int, run: Run) -> list[Cell]:
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
        See `Run`.

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
