"""Linear systems of symbols, solved once and for all."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

Symbols = Any
"""An array of symbols and floats (dtype object)."""


def solve(
    matrix: Symbols,
    right: Symbols,
    pivots: Sequence[tuple[int, int]],
    is_zero: Callable[[Any], bool],
) -> Symbols:
    """Solution of a linear system by elimination in a given order of pivots.

    Parameters
    ----------
    matrix : ndarray of objects, shape (n, n)
    right : ndarray of objects, shape (n, k)
    pivots : sequence of n pairs of ints
        Row and column of each pivot, none of which may vanish.
    is_zero : callable
        Whether an entry is zero whatever the symbols are; nothing is done with those.

    Returns
    -------
    ndarray of objects, shape (n, k)
    """
    table = np.concatenate((matrix, right), axis=1).tolist()
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
    solution = np.zeros((size, width - size), dtype=object)
    for done, (row, column) in reversed(list(enumerate(pivots, start=1))):
        for each in range(width - size):
            value = table[row][size + each]
            for _, later in pivots[done:]:
                if not is_zero(table[row][later]) and not is_zero(solution[later, each]):
                    value = value - table[row][later] * solution[later, each]
            solution[column, each] = value / table[row][column]
    return solution
