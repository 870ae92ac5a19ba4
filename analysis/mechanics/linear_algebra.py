"""Vectors of three and linear systems, of numbers of any kind."""

from collections.abc import Sequence
from typing import Any

Vector = tuple[Any, Any, Any]

NONE: Vector = (0.0, 0.0, 0.0)


def add(a: Vector, b: Vector) -> Vector:
    """Sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def scaled(factor: Any, a: Vector) -> Vector:
    """Multiple."""
    return factor * a[0], factor * a[1], factor * a[2]


def dot(a: Vector, b: Vector) -> Any:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def solve(matrix: Sequence[Sequence[Any]], sides: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """Solutions of a symmetric, positive definite system by elimination without roots.

    Rows of the fewest entries go first. Nothing is done with an entry that is the float 0.0: where
    a recorder writes the code, what is never anything else is left out of it.

    Parameters
    ----------
    matrix : n rows of n numbers
    sides : k columns of n numbers

    Returns
    -------
    k columns of n numbers
    """
    rest = [list(row) for row in matrix]
    columns = [list(side) for side in sides]
    left, order = list(range(len(rest))), []
    while left:
        pivot = min(left, key=lambda row: sum(not _is_zero(rest[row][each]) for each in left))
        left.remove(pivot)
        others = [row for row in left if not _is_zero(rest[pivot][row])]
        order.append((pivot, others))
        for place, row in enumerate(others):
            part = rest[pivot][row] / rest[pivot][pivot]
            for other in others[place:]:
                rest[row][other] = rest[other][row] = rest[row][other] - part * rest[pivot][other]
            for column in columns:
                column[row] = column[row] - part * column[pivot]
    for column in columns:
        for pivot, others in reversed(order):
            known = sum((rest[pivot][row] * column[row] for row in others), 0.0)
            column[pivot] = (column[pivot] - known) / rest[pivot][pivot]
    return columns


def _is_zero(entry: Any) -> bool:
    return isinstance(entry, float) and entry == 0.0
