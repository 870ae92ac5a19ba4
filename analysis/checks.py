"""Validators that return the clean value or raise a one-line `ValueError`."""

from collections.abc import Iterable
from math import isfinite
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
T = TypeVar("T")


class ToleranceError(ArithmeticError):
    """A requested accuracy could not be met."""


class TimeLimitError(ArithmeticError):
    """A run met its time limit before it had a result to return."""


def number(name: str, value: Any) -> float:
    """Return `value` as a finite float.

    Raises
    ------
    ValueError
        If it is not a number, or not finite.
    """
    try:
        result = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a finite number, got {value!r}") from None
    if not isfinite(result):
        raise ValueError(f"{name} must be a finite number, got {result}")
    return result


def positive(name: str, value: Any) -> float:
    """Return `value` as a float above zero; `ValueError` otherwise."""
    result = number(name, value)
    if result <= 0.0:
        raise ValueError(f"{name} must be positive, got {result:g}")
    return result


def not_negative(name: str, value: Any) -> float:
    """Return `value` as a float not below zero; `ValueError` otherwise."""
    result = number(name, value)
    if result < 0.0:
        raise ValueError(f"{name} must not be negative, got {result:g}")
    return result


def choice(name: str, value: T, allowed: Iterable[T]) -> T:
    """Return `value` if it is one of `allowed`; `ValueError` listing them otherwise."""
    options = list(allowed)
    if value not in options:
        listed = ", ".join(str(option) for option in options)
        raise ValueError(f"{name} must be one of {listed}, got {value!r}")
    return value


def increasing_times(times: npt.ArrayLike) -> Array:
    """Return `times` as a float array, shape (n,), n >= 2, strictly increasing and finite.

    Raises
    ------
    ValueError
        If it is not one-dimensional, too short, not finite or not increasing.
    """
    try:
        result = np.array(times, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"times must be numbers, got {times!r}") from None
    if result.ndim != 1 or result.size < 2:
        raise ValueError(
            f"times must be one-dimensional with at least 2 entries, got shape {result.shape}"
        )
    if not np.all(np.isfinite(result)):
        raise ValueError("times must be finite")
    steps = np.diff(result)
    if np.any(steps <= 0.0):
        worst = int(np.argmax(steps <= 0.0))
        raise ValueError(
            f"times must increase strictly, got {result[worst]:g} before {result[worst + 1]:g}"
        )
    return result
