"""Checks of arguments: validators, and data types that their declarations check."""

import os
import re
from abc import ABCMeta
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cache
from inspect import Signature, signature
from math import inf, isfinite, isnan
from numbers import Integral, Real
from operator import ge, gt, lt
from sys import float_info
from typing import Any, ClassVar, TypeVar, cast

import numpy as np
import numpy.typing as npt

from analysis.problem.elementary import Members
from analysis.problem.names import ArgumentError, check_names, nearest
from analysis.problem.quantities import FASTEST_TURN, LARGEST_VALUE, QUANTITIES, Quantity, short

Array = npt.NDArray[np.float64]
T = TypeVar("T")


class ToleranceError(ArithmeticError):
    """A requested accuracy could not be met."""


class TimeLimitError(ArithmeticError):
    """A run met its time limit before it had a result to return."""


def optional(check: Callable[..., T], name: str, value: Any, *allowed: Any) -> T | None:
    """Return None for None, and else what another check makes of `value`."""
    return None if value is None else check(name, value, *allowed)


_NO_NUMBERS = bool, np.timedelta64
"""Subclasses of numbers that are none: truth values and durations."""


def number(name: str, value: Any) -> float:
    """Return `value` as a finite float; numbers of `Members`, one for each, as they are.

    Raises
    ------
    ValueError
        If it is not a real number (text is none), or not finite.
    """
    # To ask an abstract class takes longer than all the rest.
    if type(value) is float and isfinite(value):
        return value
    result = value
    if not isinstance(value, Members):
        if not isinstance(value, Real) or isinstance(value, _NO_NUMBERS):
            fault = f"must be a finite number, got {value!r}{_in_numbers(value)}"
            raise ArgumentError(name, fault)
        try:
            result = float(value)
        except OverflowError:
            raise ArgumentError(name, "must be a finite number, got one too large") from None
    if not np.isfinite(result):
        raise ArgumentError(name, f"must be a finite number, got {result:g}")
    return cast("float", result)


def _in_numbers(value: Any) -> str:
    """How to write an angle that is given as text."""
    angle = re.fullmatch(r"\s*([-+.\d]+)\s*(deg|°)\s*", value) if isinstance(value, str) else None
    return f"; write np.radians({angle[1]})" if angle else ""


def within(
    name: str,
    value: Any,
    least: float = -inf,
    most: float = inf,
    *,
    is_above: bool = False,
    is_below: bool = False,
    why: str = "",
) -> float:
    """Return `value` as a float in a range, an end of which may itself be left out.

    Parameters
    ----------
    name : str
    value
    least, most : float
    is_above, is_below : bool
        Whether `least` and `most` themselves are left out.
    why : str
        Why an open interval is wanted.

    Raises
    ------
    ValueError
        If it is no number, or lies elsewhere.
    """
    result = number(name, value)
    if is_above and least == 0.0 < result < float_info.min:
        # The reciprocal of one that is smaller may be infinite.
        raise ArgumentError(name, f"must be at least {float_info.min:.3g}, got {result:.3g}")
    if (least < result or (least == result and not is_above)) and (
        result < most or (result == most and not is_below)
    ):
        return result
    low, high = short(float(least)), short(float(most))
    wanted = f"lie from {low} to {'less than ' if is_below else ''}{high}"
    if is_above and is_below:
        wanted = f"lie in the open interval ({low}, {high}), {why}"
    elif least == 0.0 and result <= 0.0:
        wanted = "be positive" if is_above else "not be negative"
    elif is_below and result >= most and least in (0.0, -inf):
        wanted = f"be less than {high}"
    elif is_above:
        wanted = f"be above {low} and at most {high}"
    raise ArgumentError(name, f"must {wanted}, got {result:g}")


def positive(name: str, value: Any) -> float:
    """Return `value` as a float above zero; `ValueError` otherwise."""
    return within(name, value, 0.0, is_above=True)


def turn_rate(name: str, value: Any, *, is_above: bool = False) -> float:
    """Return a rate of turning in rad/s as a float, up to `FASTEST_TURN` either way.

    Parameters
    ----------
    name : str
    value
    is_above : bool
        Whether only positive ones are allowed.

    Raises
    ------
    ValueError
        If it is no number, or lies elsewhere.
    """
    return within(name, value, 0.0 if is_above else -FASTEST_TURN, FASTEST_TURN, is_above=is_above)


def not_negative(name: str, value: Any) -> float:
    """Return `value` as a float not below zero; `ValueError` otherwise."""
    return within(name, value, 0.0)


def local_tolerance(name: str, value: Any, least: float) -> float:
    """Return the error of a step, from `least` to less than 1; `ValueError` otherwise."""
    return within(name, positive(name, value), least, 1.0, is_below=True)


_BREAKS = {"be at least": lt, "be less than": ge, "not exceed": gt}


def bound(
    name: str, value: float, relation: str, limit: float, what: str, *, why: str = ""
) -> None:
    """Check a number against one that follows from others.

    Parameters
    ----------
    name : str
    value : float
    relation : {"be at least", "be less than", "not exceed"}
    limit : float
    what : str
        What the limit is.
    why : str
        Its unit, and why there is one.

    Raises
    ------
    ValueError
        If it is not so.
    """
    if _BREAKS[relation](value, limit):
        raise ArgumentError(name, f"must {relation} {what} = {limit:g}{why}, got {value:g}")


def whole(name: str, value: Any, least: int = 1, most: float = inf) -> int:
    """Return `value` as an int from `least` to `most`; `ValueError` otherwise."""
    if not isinstance(value, Integral) or isinstance(value, _NO_NUMBERS):
        raise ArgumentError(name, f"must be a whole number, got {value!r}")
    if value < least:
        raise ArgumentError(name, f"must be at least {least}, got {value}")
    if int(value) > most:
        raise ArgumentError(name, f"must be at most {most}, got {value}")
    return int(value)


def switch(name: str, value: Any) -> bool:
    """Return `value` if it is True or False; `ValueError` otherwise."""
    if not isinstance(value, bool | np.bool_):
        raise ArgumentError(name, f"must be True or False, got {value!r}")
    return bool(value)


def instance(name: str, value: T, kind: type) -> T:
    """Return `value` if it is of this class; `ValueError` otherwise."""
    if isinstance(value, kind):
        return value
    got = f"the class: write {kind.__name__}()" if value is kind else repr(value)
    raise ArgumentError(name, f"must be {one(kind)}, got {got}")


def one(kind: type) -> str:
    """Name of a class with its article."""
    return f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}"


def function(name: str, value: T) -> T:
    """Return `value` if it can be called; `ValueError` otherwise."""
    if not callable(value):
        raise ArgumentError(name, f"must be a function, got {value!r}")
    return value


def path_like(name: str, value: Any) -> str | os.PathLike[str]:
    """Return `value` if it can name a file; `ValueError` otherwise."""
    if not isinstance(value, str | os.PathLike) or "\0" in os.fspath(value):
        raise ArgumentError(name, f"must be the path of a file, got {value!r}")
    return value


def several(name: str, values: Any, of: str) -> list[Any]:
    """Return what an iterable holds; `ValueError` for what is none, or is text or a mapping."""
    is_one = isinstance(values, str | bytes | Mapping | type) or getattr(values, "ndim", 1) == 0
    if is_one or not isinstance(values, Iterable):
        raise ArgumentError(name, f"must be a list of {of}, got {values!r}")
    return list(values)


def numbers(name: str, values: Any, of: Sequence[str]) -> tuple[float, ...]:
    """Return finite numbers, one for each of these names; `ValueError` otherwise."""
    given = several(name, values, wanted := ", ".join(of))
    if len(given) != len(of):
        raise ArgumentError(name, f"must hold {wanted}, got {values!r}")
    return tuple(number(f"{name}[{key}]", each) for key, each in zip(of, given, strict=True))


def choice(name: str, value: T, allowed: Iterable[T]) -> T:
    """Return `value` if it is one of `allowed`; `ValueError` listing them otherwise."""
    options = list(allowed)
    # An array answers with one for each of its entries.
    if isinstance(value, np.ndarray) or value not in options:
        listed = ", ".join(str(option) for option in options)
        raise ArgumentError(
            name, f"must be one of {listed}, got {value!r}{nearest(value, options)}"
        )
    return value


def float_array(name: str, values: npt.ArrayLike) -> Array:
    """Return a new array of floats from real numbers, which may be infinite or no numbers.

    Raises
    ------
    ValueError
        If they are complex, text, truth values or objects, if rows differ in length, or if one is
        masked.
    """
    if np.ma.is_masked(values):
        raise ArgumentError(name, f"must hold no masked values, got {values!r}")
    try:
        given = np.asarray(values)
    except (TypeError, ValueError):
        raise ArgumentError(name, f"must be an array of real numbers, got {values!r}") from None
    if given.dtype.kind not in "fiu":
        raise ArgumentError(name, f"must be an array of real numbers, got {given.dtype} values")
    return np.array(given, dtype=float)


def real_array(name: str, values: npt.ArrayLike) -> Array:
    """Return a new array of floats from real numbers.

    Raises
    ------
    ValueError
        As in `float_array`, or if a number is not finite or larger than `LARGEST_VALUE`.
    """
    result = float_array(name, values)
    # Its size is not finite if one of its numbers is not: one pass, for the shortest runs.
    largest = np.abs(result).max(initial=0.0)
    if not isfinite(largest):
        worst = result[~np.isfinite(result)][0]
        raise ArgumentError(name, f"must be finite, got {worst}")
    if largest > LARGEST_VALUE:
        raise ArgumentError(name, f"must not exceed {LARGEST_VALUE:g} in size")
    return result


def settings(name: str, values: Any) -> dict[str, str | float | int | None]:
    """Return a mapping from names to text, numbers or None as a dictionary.

    Raises
    ------
    ValueError
        If it is no such mapping, or a number is not one (nan).
    """
    if not isinstance(values, Mapping):
        raise ArgumentError(name, f"must be a mapping, got {type(values).__name__}")
    for key, value in values.items():
        if not isinstance(key, str):
            raise ArgumentError(name, f"must have names as its keys, got {key!r}")
        is_nan = isinstance(value, float) and isnan(value)
        if is_nan or not isinstance(value, str | Real | None):
            fault = f"must be text, a number or None, got {value!r}"
            raise ArgumentError(f"{name}[{key!r}]", fault)
    return dict(values)


def increasing_times(times: npt.ArrayLike) -> Array:
    """Return `times` as a float array, shape (n,), n >= 2, strictly increasing and finite.

    Raises
    ------
    ValueError
        If it is not one-dimensional, too short, not finite or not increasing.
    """
    return increasing("times", finite_row("times", times, 2))


def increasing(name: str, row: Array) -> Array:
    """Return finite numbers, shape (n,), if they increase strictly; `ValueError` otherwise."""
    steps = row[1:] - row[:-1]
    if not (steps > 0.0).all():
        worst = int(np.argmax(steps <= 0.0))
        fault = f"must increase strictly, got {row[worst]:g} before {row[worst + 1]:g}"
        raise ArgumentError(name, fault)
    return row


def spin_array(spins: npt.ArrayLike) -> Array:
    """Return `spins` as a float array, shape (n,), n >= 1; a single number gives n = 1.

    Raises
    ------
    ValueError
        If it holds no real numbers, is empty, has more than one dimension, is not finite or
        exceeds `FASTEST_TURN`.
    """
    result = finite_row("spins", spins)
    turn_rate("spins", float(result[np.argmax(np.abs(result))]))
    return result


def finite_row(name: str, values: npt.ArrayLike, least: int = 1) -> Array:
    """Return real numbers as an array, shape (n,), n >= `least`; `ValueError` otherwise.

    A single number gives n = 1; what else is refused is that of `real_array`.
    """
    result = np.atleast_1d(real_array(name, values))
    if result.ndim != 1 or result.size < least:
        fault = f"must be one-dimensional with {least} or more entries, got shape {result.shape}"
        raise ArgumentError(name, fault)
    return result


def checked(quantity: Quantity, value: Any) -> Any:
    """Return the clean value of a quantity.

    Raises
    ------
    ArgumentError
        If it is of the wrong kind or out of range.
    """
    if quantity.is_switch:
        return switch(quantity.name, value)
    if quantity.choices:
        return choice(quantity.name, value, quantity.choices)
    return within(
        quantity.name,
        value,
        quantity.least,
        quantity.most,
        is_above=quantity.is_above,
        is_below=quantity.is_below,
        why=quantity.why,
    )


class _Checking(ABCMeta):
    """Classes whose keywords are checked before an object is made of them."""

    def __call__(cls, *arguments: Any, **given: Any) -> Any:
        known = _known(cls)
        check_names(cls.__name__, given, known)
        for name, value in given.items():
            quantity, follows = known[name]
            if quantity is not None and not (value is None and follows):
                given[name] = checked(quantity, value)
        return super().__call__(*arguments, **given)

    @property
    def __signature__(cls) -> Signature:
        """That of the dataclass, which `__call__` would hide from help and documentation."""
        made = signature(cls.__init__)  # type: ignore[misc] # it is the class's own
        return made.replace(parameters=list(made.parameters.values())[1:])


@cache
def _known(kind: Any) -> dict[str, tuple[Quantity | None, bool]]:
    """Fields of a class: their quantities, and whether they follow from the rest for None.

    Raises
    ------
    TypeError
        If it is made of others.
    """
    made_of = {*[*signature(kind.__init__).parameters][1:]}
    if made_of != {field.name for field in fields(kind) if field.init}:
        raise TypeError(
            f"{kind.__name__} must be a frozen dataclass, whose fields are its numbers, and have "
            "no __init__ of its own"
        )
    return {
        field.name: (QUANTITIES.get(f"{kind.TABLE}.{field.name}"), field.default is None)
        for field in fields(kind)
    }


class Described(metaclass=_Checking):
    """Base of dataclasses whose fields are quantities of a table of a scenario."""

    __slots__ = ()

    TABLE: ClassVar[str] = ""
    """Name of the table."""
