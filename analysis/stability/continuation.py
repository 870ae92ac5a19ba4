"""Continuation: what is found for one value of a parameter leads to what there is for the next.

Natural: the parameter is given, and where a step is too long it is halved. By pseudo-arclength:
the step goes along the tangent of a curve, through folds of every parameter. Both say why they
end.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import Array
from analysis.data.watch import Progress

_HALVINGS = 5
"""How often a step in the parameter that fails is halved before the family ends there."""

_NEWTON = 8
"""Iterations at most to a point of a curve, and half as many for steps to grow."""

_CONVERGED, _FURTHEST = 1e-8, 1.0
"""Last step of Newton's method, whose error is about its square; and one that leads elsewhere."""

_GROWTH = 1.5
_SMALLEST = 1e-5
"""Step over the first one below which a curve counts as lost."""

_STRAIGHT = 0.99
"""Cosine of the angle between neighbouring tangents of a curve, at least."""


class Solution(Protocol):
    """What is followed in a parameter."""

    @property
    def value(self) -> float:
        """Of the parameter."""

    @property
    def spin(self) -> float:
        """In rad/s."""


S = TypeVar("S", bound=Solution)
K = TypeVar("K")

Solve = Callable[[Any, S], S]
"""From a value and a solution near it to the solution there; `ArithmeticError` if it fails."""


def reach(solve: Solve[S], start: S, value: float, halvings: int = _HALVINGS) -> S:
    """Solution at a value, on the way over others if it is too far from `start`.

    Raises
    ------
    ArithmeticError
        That of the first solution for which halving does not help.
    """
    try:
        return solve(value, start)
    except ArithmeticError:
        if not halvings:
            raise
    between = reach(solve, start, (start.value + value) / 2.0, halvings - 1)
    return reach(solve, between, value, halvings - 1)


def followed(
    solve: Solve[S], start: S, values: Iterable[Any], halvings: int = _HALVINGS
) -> Iterator[S]:
    """Solutions at values of the parameter, each reached from the one before.

    Without halvings the values may be anything, such as scenarios.

    Raises
    ------
    ArithmeticError
        If one is not found; the message names the last good one.
    """
    last = start
    for value in values:
        try:
            found = reach(solve, last, value, halvings)
        except ArithmeticError as error:
            raise type(error)(
                f"{error}; the last good one has {last.value:.9g} rad at a spin of "
                f"{last.spin:.9g} rad/s"
            ) from error
        yield found
        last = found


def gathered(
    *ways: Iterable[S], progress: Progress | None, wanted: int
) -> tuple[tuple[S, ...], str | None]:
    """All solutions, one way after the other, and why one of them ends, if it is too early.

    After each of them `progress` is called with how many there are and how many are wanted.
    """
    found: list[S] = []
    reason = None
    for way in ways:
        try:
            for each in way:
                found.append(each)
                if progress is not None:
                    progress(float(len(found)), float(wanted))
        except ArithmeticError as error:
            reason = str(error)
    return tuple(found), reason


def nearest_change(
    function: Callable[[float], float], centre: float, part: float, widest: float
) -> tuple[float, float] | None:
    """Interval next to a centre in which a function changes sign, if there is one.

    Parameters
    ----------
    function : callable
    centre : float
    part, widest : float
        Steps and range to both sides, in parts of the centre.
    """
    middle = function(centre)
    for count in range(1, round(widest / part) + 1):
        for way in (-part, part):
            outer, inner = (centre * (1.0 + way * each) for each in (count, count - 1))
            if function(outer) * middle <= 0.0:
                return min(inner, outer), max(inner, outer)
    return None


def sign_changes(
    solve: Solve[S], solutions: Iterable[S], tests: Mapping[K, Callable[[S], float]]
) -> Iterator[tuple[K, S]]:
    """Solutions between neighbouring ones at which a test is zero, with its name.

    Raises
    ------
    ArithmeticError
        If an iteration between two of them fails.
    """
    for first, last in pairwise(solutions):
        for name, test in tests.items():
            if test(first) * test(last) < 0.0:
                yield name, _zero(solve, first, last, test)


def _zero(solve: Solve[S], first: S, last: S, test: Callable[[S], float]) -> S:
    found = {first.value: first, last.value: last}

    def at(value: float) -> float:
        if value not in found:
            found[value] = reach(solve, first, value)
        return test(found[value])

    brentq(at, first.value, last.value, xtol=1e-9)
    return min(found.values(), key=lambda each: abs(test(each)))


class Bound(NamedTuple):
    """Where a curve is left: a coordinate below or beyond a value."""

    name: str
    axis: int
    value: float
    upper: bool


class Curve:
    """A curve of solutions of equations, of one more unknown than the rank of these.

    Parameters
    ----------
    equations : callable
        From a point, shape (n,), to residuals, shape (m,), and their Jacobian, shape (m, n).
    """

    def __init__(self, equations: Callable[[Array], tuple[Array, Array]]) -> None:
        self._equations = equations

    def correct(self, guess: Array, row: Array) -> tuple[Array, Array, int] | None:
        """Point of the curve in the plane through a guess with this normal.

        Also the unit tangent there, to either side, and the iterations; None if Newton's method
        does not converge.
        """
        point = guess
        for iteration in range(1, _NEWTON + 1):
            residual, jacobian = self._equations(point)
            matrix = np.vstack((jacobian, row))
            right = -np.append(residual, row @ (point - guess))
            if len(right) == point.size:
                step = np.linalg.solve(matrix, right)
            else:
                step = np.linalg.lstsq(matrix, right, rcond=None)[0]
            point = point + step
            size = np.max(np.abs(step))
            if not size < _FURTHEST:
                return None
            if size < _CONVERGED:
                return point, np.linalg.svd(jacobian)[2][-1], iteration
        return None

    def points(
        self,
        start: Array,
        along: Array,
        *,
        step: float,
        largest: Callable[[Array], float],
        bounds: Iterable[Bound],
        most: int = 2000,
    ) -> Iterator[tuple[Array, str | None]]:
        """Points from a start on, and with the last one the name of the bound it lies on.

        Parameters
        ----------
        start : ndarray, shape (n,)
            A point of the curve.
        along : ndarray, shape (n,)
            To which side to go.
        step : float
            Length of the first step.
        largest : callable
            That of the longest one at a point.
        bounds : iterable of Bound
            Where the curve is left.
        most : int
            Points to find at most.

        Raises
        ------
        ArithmeticError
            If no further point is found, however short the step, or more than `most` are.
        """
        point, smallest, made = start, step * _SMALLEST, 0
        tangent = np.linalg.svd(self._equations(start)[1])[2][-1]
        tangent = np.copysign(1.0, tangent @ along) * tangent
        while step > smallest:
            guess, row = point + step * tangent, tangent
            bound = _crossed(bounds, guess)
            if bound is not None:
                part = (bound.value - point[bound.axis]) / (guess - point)[bound.axis]
                guess, row = point + part * (guess - point), np.eye(start.size)[bound.axis]
            found = self.correct(guess, row)
            if found is None or not self._is_near(point + step * tangent, step, tangent, found):
                step /= 2.0
                continue
            if made == most:
                raise ArithmeticError(f"has more than {most} points one way, and goes on")
            made += 1
            yield found[0], None if bound is None else bound.name
            if bound is not None:
                return
            point, tangent = found[0], np.copysign(1.0, found[1] @ tangent) * found[1]
            if found[2] <= _NEWTON // 2:
                step = min(_GROWTH * step, largest(point))
        raise ArithmeticError("fails, however short the step,")

    @staticmethod
    def _is_near(
        guess: Array, step: float, tangent: Array, found: tuple[Array, Array, int]
    ) -> bool:
        """Whether a point lies near where it was looked for, the curve in the same direction."""
        off = float(np.linalg.norm(found[0] - guess))
        return off < step and abs(float(found[1] @ tangent)) > _STRAIGHT


def _crossed(bounds: Iterable[Bound], point: Array) -> Bound | None:
    for bound in bounds:
        if (point[bound.axis] > bound.value) if bound.upper else (point[bound.axis] < bound.value):
            return bound
    return None
