"""Following periodic motions in a parameter that tells them apart, such as their amplitude."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeVar

from scipy.optimize import brentq

from analysis.data.checks import Array
from analysis.nonlinear.collocation import NoCycleError

M = TypeVar("M")


def reach(
    solve: Callable[[float, Any], M], begin: float, value: float, start: Any, halvings: int
) -> M:
    """Motion at a value of the parameter, on the way over others if it is too far from `start`.

    Parameters
    ----------
    solve : callable
        From a value and a motion to begin with to the motion at that value.
    begin, value : float
        Value of `start`, and the one wanted.
    start
        What `solve` begins with.
    halvings : int
        How often the way may be halved.

    Raises
    ------
    NoCycleError
        That of the first motion for which halving does not help.
    """
    try:
        return solve(value, start)
    except NoCycleError:
        if not halvings:
            raise
    middle = (begin + value) / 2.0
    between = reach(solve, begin, middle, start, halvings - 1)
    return reach(solve, middle, value, between, halvings - 1)


def followed(
    solve: Callable[[float, Any], M],
    values: Array,
    start: M,
    value_of: Callable[[M], float],
    halvings: int,
) -> Iterator[M]:
    """Motions at values of the parameter, each reached from the one before.

    Parameters
    ----------
    solve, start, halvings
        As in `reach`.
    values : ndarray, shape (n,)
        In rad.
    value_of : callable
        Value of a motion.

    Raises
    ------
    NoCycleError
        If one is not found; the message names the last good one.
    """
    last: Any = start
    for value in values.tolist():
        try:
            last = reach(solve, value_of(last), value, last, halvings)
        except NoCycleError as error:
            raise NoCycleError(
                f"{error}; the last good one has {value_of(last):.9g} rad at a spin of "
                f"{last.spin:.9g} rad/s"
            ) from error
        yield last


def locate(find: Callable[[float], M], test: Callable[[M], float], ends: Mapping[float, M]) -> M:
    """Motion between two others at which a test is zero.

    Parameters
    ----------
    find : callable
        From a value of the parameter to the motion there.
    test : callable
        Of opposite sign at the two.
    ends : mapping
        The two by their values.
    """
    found = dict(ends)

    def at(value: float) -> float:
        if value not in found:
            found[value] = find(value)
        return test(found[value])

    brentq(at, *ends, xtol=1e-9)
    return min(found.values(), key=lambda motion: abs(test(motion)))
