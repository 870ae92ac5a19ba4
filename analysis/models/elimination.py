"""Linear systems of symbols, solved once and for all."""

from collections.abc import Callable, Sequence
from typing import Any


def is_float_zero(entry: Any) -> bool:
    """Whether an entry is no symbol, but the number zero."""
    return isinstance(entry, float) and entry == 0.0


def solve(
    matrix: Sequence[Sequence[Any]],
    right: Sequence[Sequence[Any]],
    pivots: Sequence[tuple[int, int]],
    is_zero: Callable[[Any], bool] = is_float_zero,
) -> list[list[Any]]:
    """Solution of a linear system by elimination in a given order of pivots.

    Parameters
    ----------
    matrix : n rows of n symbols or floats
    right : n rows of k symbols or floats
    pivots : sequence of n pairs of ints
        Row and column of each pivot, none of which may vanish.
    is_zero : callable
        Whether an entry is zero whatever the symbols are; nothing is done with those.

    Returns
    -------
    k columns of n symbols or floats
    """
    table = [[*entries, *sides] for entries, sides in zip(matrix, right, strict=True)]
    size, width = len(table), len(table[0])
    columns = [column for _, column in pivots] + list(range(size, width))
    for done, (row, column) in enumerate(pivots, start=1):
        for other, _ in pivots[done:]:
            if is_zero(table[other][column]):
                continue
            part = table[other][column] / table[row][column]
            for each in columns[done:]:
                if not is_zero(table[row][each]):
                    table[other][each] = table[other][each] - part * table[row][each]
    solution = [[0.0] * size for _ in range(size, width)]
    for done, (row, column) in reversed(list(enumerate(pivots, start=1))):
        for each, found in enumerate(solution):
            value = table[row][size + each]
            for _, later in pivots[done:]:
                if not is_zero(table[row][later]) and not is_zero(found[later]):
                    value = value - table[row][later] * found[later]
            found[column] = value / table[row][column]
    return solution
