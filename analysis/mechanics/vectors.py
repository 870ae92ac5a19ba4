"""Vectors of three numbers of any kind."""

from collections.abc import Sequence
from typing import Any

from analysis.data.checks import Array

Vector = tuple[Any, Any, Any]

Numbers = Sequence[Any] | Array
"""Some numbers of any kind, one after the other."""

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
