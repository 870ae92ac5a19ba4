"""Elementary functions of numbers of several kinds, so that equations are written once.

Floats, complex numbers, arrays and, with the extra `fast`, the symbols that are compiled: what a
formula is given decides which library works it out. Floats take a tenth of a microsecond more
than with `math`.

`Members` are the numbers of the members of an ensemble, in place of one number. What is written
for one (a range, a start that follows from constraints, a choice between two formulas) holds for
all members at once where these go the same way. Where they do not, they are told apart, and each
group goes its own.
"""

import cmath
import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

T = TypeVar("T")

Numbers = Sequence[Any] | npt.NDArray[np.float64]
"""Some numbers of any kind, one after the other."""

Rows = npt.NDArray[np.intp]
"""Numbers of members."""


class DividedError(Exception):
    """Members do not all go the same way.

    Attributes
    ----------
    mask : ndarray of bool, shape (n,)
        Those that go the one of two ways.
    """

    def __init__(self, mask: npt.NDArray[np.bool_]) -> None:
        super().__init__("members do not all go the same way")
        self.mask = mask


class Members(np.ndarray[Any, np.dtype[Any]]):
    """One number for each member, shape (n,), n > 0; calculates as arrays do.

    As a condition it is true or false if it is for all members, and raises `DividedError`
    otherwise. There is no way to a single float, so that no function takes one for all.
    """

    def __bool__(self) -> bool:
        truth = np.asarray(self) != 0
        if truth.any() and not truth.all():
            raise DividedError(truth)
        return bool(truth.all())

    def __float__(self) -> float:
        raise TypeError("one number is wanted, and there is one for each member")

    def __format__(self, spec: str) -> str:
        return format(np.asarray(self)[0].item(), spec)


_LIBRARIES: dict[type, Any] = {
    complex: cmath,
    np.complex128: cmath,
    np.ndarray: np,
    Members: np,
}


def register(kind: type, library: Any) -> None:
    """Let numbers of this kind be worked out by a library that has these functions.

    Parameters
    ----------
    kind : type
    library : module
    """
    _LIBRARIES[kind] = library


def _elementary(name: str) -> Callable[[T], T]:
    """Function that the library of its argument has by this name."""
    of_float = getattr(math, name)

    def function(x: Any, /) -> Any:
        """As in `math`, of any number."""
        return of_float(x) if type(x) is float else getattr(_library(x), name)(x)

    return function


sin = _elementary("sin")
cos = _elementary("cos")
exp = _elementary("exp")
log = _elementary("log")
sqrt = _elementary("sqrt")
tanh = _elementary("tanh")
asinh = _elementary("asinh")


_PLAIN = float, int


def _of_two(name: str) -> Callable[[T, T], T]:
    """The same of two arguments."""

    def function(x: Any, y: Any, /) -> Any:
        """As in `math`, of any numbers."""
        return getattr(_library(y) if type(x) in _PLAIN else _library(x), name)(x, y)

    return function


hypot = _of_two("hypot")
atan2 = _of_two("atan2")

NAMES = ("sin", "cos", "exp", "log", "sqrt", "tanh", "asinh", "hypot", "atan2")
"""Of all of these, as in `math`."""


def _library(x: Any) -> Any:
    return _LIBRARIES.get(type(x), math)
