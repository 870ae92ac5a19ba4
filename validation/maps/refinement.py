"""Cases of a grid that are worth running: coarsely everywhere, finely where outcomes change."""

from collections.abc import Callable, Iterable, Mapping
from itertools import product

Classes = Mapping[int, str]
"""Class of the outcome by the number of a case on a grid of two axes, the last one fastest."""

Run = Callable[[Iterable[int]], Classes]
"""Runs some cases; returns the classes of all that have been run so far."""

_PER_CELL = 5
"""Cases for each cell of a row or column that is halved, as in the maps of the report."""


def refine(shape: tuple[int, int], levels: int, run: Run) -> Classes:
    """Run a coarse grid, and halve its cells as long as a cell holds outcomes of two classes.

    What lies between the points of the coarse grid and touches no cell with two classes, such as
    an island smaller than a cell, is not found.

    Parameters
    ----------
    shape : tuple of 2 int
        Of the finest grid: cells * 2**levels + 1 along each axis.
    levels : int
        How often cells are halved.
    run : callable
        See `Run`.

    Returns
    -------
    mapping
        Classes of all cases that have been run.

    Raises
    ------
    ValueError
        If the shape does not fit the levels.
    """
    step = 2**levels
    if levels < 0 or any((size - 1) % step or size <= step for size in shape):
        raise ValueError(
            f"shape must be cells * 2**{levels} + 1 along each axis, got {shape[0]} by {shape[1]}"
        )
    rows, columns = (range(0, size, step) for size in shape)
    classes = run([row * shape[1] + column for row in rows for column in columns])
    while step > 1:
        # A boundary may leave a halved cell through a side that looked uniform.
        while missing := _missing(classes, shape, step):
            classes = run(missing)
        step //= 2
    return classes


def expected_cases(cells: int, levels: int) -> int:
    """About as many cases as a map of usual boundaries runs, of which each level halves the cells.

    A boundary passes some cells of each row and column, so that their number doubles with a level.
    """
    finest = cells << levels
    return min((finest + 1) ** 2, (cells + 1) ** 2 + _PER_CELL * 2 * (finest - cells))


def _missing(classes: Classes, shape: tuple[int, int], step: int) -> list[int]:
    """Cases to run in cells of this size that hold more than one class."""
    wanted: set[int] = set()
    corners = (range(0, size - 1, step) for size in shape)
    for row, column in product(*corners):
        points = [
            (row + down) * shape[1] + column + right
            for down, right in product((0, step // 2, step), repeat=2)
        ]
        if len({classes[point] for point in points if point in classes}) > 1:
            wanted.update(point for point in points if point not in classes)
    return sorted(wanted)
