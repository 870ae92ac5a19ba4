"""Dual numbers: values that carry their derivative in one direction, exact to rounding."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from analysis.problem import elementary
from analysis.problem.checks import Array
from analysis.problem.elementary import asinh, atan2, cos, exp, hypot, log, sin, sqrt, tanh
from analysis.problem.friction import LAWS, SPEEDS, FrictionLaw, asked
from analysis.problem.names import ArgumentError


class Dual:
    """A number and its derivative in a direction, both of any kind; calculates as floats do.

    Parameters
    ----------
    value, change : number
        The change may have more than one entry where the value has one: an array of changes is
        one for each of several directions.
    """

    __slots__ = ("change", "value")
    # Arrays leave an operation with one to it.
    __array_ufunc__ = None

    def __init__(self, value: Any, change: Any) -> None:
        self.value, self.change = value, change

    def __neg__(self) -> "Dual":
        return Dual(-self.value, -self.change)

    def __add__(self, other: Any) -> "Dual":
        other = dual(other)
        return Dual(self.value + other.value, self.change + other.change)

    __radd__ = __add__

    def __sub__(self, other: Any) -> "Dual":
        other = dual(other)
        return Dual(self.value - other.value, self.change - other.change)

    def __rsub__(self, other: Any) -> "Dual":
        return dual(other) - self

    def __mul__(self, other: Any) -> "Dual":
        other = dual(other)
        change = self.value * other.change + other.value * self.change
        return Dual(self.value * other.value, change)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Dual":
        other = dual(other)
        quotient = self.value / other.value
        return Dual(quotient, (self.change - quotient * other.change) / other.value)

    def __rtruediv__(self, other: Any) -> "Dual":
        return dual(other) / self

    def __abs__(self) -> "Dual":
        # Its derivative at zero, where there is none, is taken to be zero.
        return Dual(abs(self.value), np.sign(self.value) * self.change)

    def __lt__(self, other: Any) -> Any:
        return self.value < value_of(other)

    def __gt__(self, other: Any) -> Any:
        return self.value > value_of(other)

    def __le__(self, other: Any) -> Any:
        return self.value <= value_of(other)

    def __ge__(self, other: Any) -> Any:
        return self.value >= value_of(other)

    def __pow__(self, exponent: Any) -> Any:
        if isinstance(exponent, Dual):
            return exp(exponent * log(self))
        slope = exponent * self.value ** (exponent - 1)
        return Dual(self.value**exponent, slope * self.change)

    def __rpow__(self, base: float) -> "Dual":
        power = base**self.value
        slope = log(base) * power if base else 0.0
        return Dual(power, slope * self.change)


def dual(number: Any) -> Dual:
    """The number itself, or a constant."""
    return number if isinstance(number, Dual) else Dual(number, 0.0)


def value_of(number: Any) -> Any:
    """The value of a dual number, or the number itself."""
    return number.value if isinstance(number, Dual) else number


def rate(
    function: Callable[[Sequence[Any]], Iterable[Any]], place: Iterable[Any], change: Iterable[Any]
) -> list[Any]:
    """Derivative of a function of several numbers along a change of them.

    Parameters
    ----------
    function : callable
        From a sequence of n numbers of any kind to some numbers.
    place, change : n numbers
        Neither of them dual: derivatives of derivatives are not told apart.
    """
    moving = [Dual(value, each) for value, each in zip(place, change, strict=True)]
    return [dual(result).change for result in function(moving)]


def derivatives(
    function: Callable[[Sequence[Any]], Iterable[Any]], place: Sequence[float] | Array
) -> Array:
    """Jacobian of a function of several numbers, shape (k, n), at a place, shape (n,)."""
    changes = rate(function, np.asarray(place).tolist(), np.eye(len(place)))
    return np.array([np.broadcast_to(each, len(place)) for each in changes])


def _sqrt(x: Dual) -> Dual:
    """Its derivative at zero, where there is none, is taken to be zero."""
    root = sqrt(x.value)
    is_zero = isinstance(root, float) and root == 0.0
    return Dual(root, x.change / (math.inf if is_zero else 2.0 * root))


def _hypot(x: Any, y: Any) -> Dual:
    """Its derivative at the origin, where there is none, is taken to be zero."""
    x, y = dual(x), dual(y)
    size = hypot(x.value, y.value)
    return Dual(size, (x.value * x.change + y.value * y.change) / (size + (size == 0.0)))


def _atan2(y: Any, x: Any) -> Dual:
    """Its derivative at the origin, where there is none, is taken to be zero."""
    y, x = dual(y), dual(x)
    size = hypot(x.value, y.value)
    size = size + (size == 0.0)
    turn = (x.value / size) * y.change - (y.value / size) * x.change
    return Dual(atan2(y.value, x.value), turn / size)


def _lifted(function: Callable[[Any], Any], slope: Callable[[Any], Any]) -> Callable[[Dual], Dual]:
    """A function of dual numbers from that of their values and its derivative."""
    return lambda x: Dual(function(x.value), slope(x.value) * x.change)


elementary.register(
    Dual,
    SimpleNamespace(
        sin=_lifted(sin, cos),
        cos=_lifted(cos, lambda x: -sin(x)),
        sqrt=_sqrt,
        exp=_lifted(exp, exp),
        tanh=_lifted(tanh, lambda x: 1.0 - tanh(x) * tanh(x)),
        log=_lifted(log, lambda x: 1.0 / x),
        asinh=_lifted(asinh, lambda x: 1.0 / hypot(1.0, x)),
        hypot=_hypot,
        atan2=_atan2,
    ),
)


_NO_SLIP = 1e-12
"""Slip over the finest speed of a law, in an array at least."""

Functions = Mapping[str, Callable[..., Any]]
"""Functions of one kind of numbers by their names in recorded code; see `Recorder.code`."""


_OF_FLOATS: Functions = {name: getattr(math, name) for name in elementary.NAMES}


def per_speed_and_slope(law: FrictionLaw, speed: Any) -> tuple[Any, Any]:
    """`per_speed` of a law, in s/m, and its derivative by the speed in s²/m².

    The derivative is exact where the law takes dual numbers. One that is written for floats alone
    has it from differences of sixth order, good to some 1e-10 of the gradient over `finest_speed`
    where the law is smooth. At no slip, where it counts for nothing, it is that to the right.

    Parameters
    ----------
    law : FrictionLaw
        One that is isotropic and in proportion to the load.
    speed : float or ndarray
        Slip speed in m/s, not negative.
    """
    if isinstance(speed, np.ndarray):
        # Where there is none, 0 / 0 would be no force.
        speed = np.maximum(speed, _NO_SLIP * law.finest_speed)
    # One that fails at floats, too, is told by those.
    with suppress(Exception):
        moving: Any = Dual(speed, 1.0)
        found = law.per_speed(moving)
        # NumPy makes arrays that hold dual numbers.
        if not isinstance(found, np.ndarray):
            return value_of(found), dual(found).change
    if isinstance(speed, np.ndarray):
        return np.vectorize(partial(per_speed_and_slope, law), otypes=[float, float])(speed)
    step = 1e-3 * max(law.finest_speed, speed)
    nodes, weights = range(-3, 4), (-1 / 60, 3 / 20, -3 / 4, 0.0, 3 / 4, -3 / 20, 1 / 60)
    if speed < 3.0 * step:
        nodes, weights = range(7), (-49 / 20, 6.0, -15 / 2, 20 / 3, -15 / 4, 6 / 5, -1 / 6)
    ask = asked(law, "per_speed")
    near = [ask(speed + node * step) for node in nodes]
    return ask(speed), float(np.dot(weights, near)) / step


def of_floats(law: FrictionLaw) -> Functions:
    """Functions of floats for a body that a friction law acts on."""
    return {**_OF_FLOATS, "speed": math.hypot, "per_speed": asked(law, "per_speed")}


def of_duals(law: FrictionLaw) -> Functions:
    """Functions of arrays and dual numbers; at no slip, whose size has no slope, friction has one.

    Raises
    ------
    ArgumentError
        If the force of a law does not take dual numbers.
    """
    if not law.is_simple:
        # It may say something else at other speeds.
        slips, load = (Dual(each, 1.0) for each in (law.finest_speed, *SPEEDS)), Dual(1.0, 0.0)
        try:
            _ = [float(value_of(each)) for slip in slips for each in law.force(slip, slip, load)]
        except TypeError as error:
            fault = "must do with arithmetic and the functions of analysis.problem.elementary here"
            subject = f"friction law {LAWS.name_of(type(law))!r}"
            raise ArgumentError("law", f"{fault}: {error}", subject) from error

    def per_speed(speed: Any) -> Any:
        value, slope = per_speed_and_slope(law, value_of(speed))
        return Dual(value, slope * speed.change) if isinstance(speed, Dual) else value

    def speed(along: Any, across: Any) -> Any:
        # One that is held is the float 0.0, and the other one's size takes less time.
        return abs(across) if isinstance(along, float) and along == 0.0 else hypot(along, across)

    return {"speed": speed, "per_speed": per_speed}


def of_slope(gradient: Any) -> Functions:
    """Functions of dual numbers under friction of this force for each unit of slip and load.

    That is any law at no slip.
    """
    return {"speed": lambda *_: 0.0, "per_speed": lambda _: gradient}
