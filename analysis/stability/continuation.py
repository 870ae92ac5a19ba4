"""Continuation by pseudo-arclength: along the tangent of a curve, through folds of every unknown.

Periodic motions, whose unknowns are functions, are followed in `analysis.nonlinear.families`.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import Array

_NEWTON = 8
"""Iterations at most to a point of a curve, and half as many for steps to grow."""

_CONVERGED, _FURTHEST = 1e-8, 1.0
"""Last step of Newton's method, whose error is about its square; and one that leads elsewhere."""

_GROWTH = 1.5
_SMALLEST = 1e-6
"""Step at which a curve counts as lost."""

_MOST = 2000
"""Points of a curve one way, at most."""

_STRAIGHT = 0.99
"""Cosine of the angle between neighbouring tangents of a curve, at least."""


def nearest_root(
    function: Callable[[float], float],
    centre: float,
    *,
    part: float,
    widest: float,
    accuracy: float,
) -> float | None:
    """Root of a function next to a centre; None if it does not change its sign in the range.

    Parameters
    ----------
    function : callable
    centre : float
    part, widest : float
        Steps and range to both sides, in parts of the centre.
    accuracy : float
    """
    middle = function(centre)
    for count in range(1, round(widest / part) + 1):
        for way in (-part, part):
            outer, inner = (centre * (1.0 + way * each) for each in (count, count - 1))
            if function(outer) * middle <= 0.0:
                return float(brentq(function, inner, outer, xtol=accuracy, rtol=1e-14))
    return None


class Bound(NamedTuple):
    """Where a curve is left: a coordinate below or beyond a value."""

    name: str
    axis: int
    value: float
    upper: bool

    def is_crossed(self, point: Array) -> bool:
        """Whether a point lies beyond it."""
        beyond = float(point[self.axis]) - self.value
        return beyond > 0.0 if self.upper else beyond < 0.0


class Curve:
    """A curve of solutions of equations, of one more unknown than the rank of these.

    Parameters
    ----------
    equations : callable
        From a point, shape (n,), to residuals, shape (m,), and their Jacobian, shape (m, n).
    name : str
    where : callable
        What to say of the last good point where the curve is lost.
    bounds : iterable of Bound
        Where the curve is left.
    longest : callable
        Longest step from a point.
    """

    def __init__(
        self,
        equations: Callable[[Array], tuple[Array, Array]],
        name: str,
        where: Callable[[Array], str],
        bounds: Iterable[Bound] = (),
        longest: Callable[[Array], float] = lambda _: 1.0,
    ) -> None:
        self._equations, self._name, self._where = equations, name, where
        self._bounds, self._longest = tuple(bounds), longest

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

    def through(
        self,
        start: Array,
        axis: int,
        is_over: Callable[[Array], bool] = lambda _: False,
    ) -> tuple[list[Array], list[str | None]]:
        """Points of the curve both ways from one of them, and the names of the bounds at its ends.

        Parameters
        ----------
        start : ndarray, shape (n,)
            A point of the curve.
        axis : int
            A coordinate that falls from it on the first of the ways, and rises on the other.
        is_over : callable
            Whether the curve ends before a point, without a bound.

        Raises
        ------
        ArithmeticError
            If no further point is found, however short the step, or too many are.
        """
        tangent = np.linalg.svd(self._equations(start)[1])[2][-1]
        tangent = np.copysign(1.0, tangent[axis]) * tangent
        (before, first), (after, last) = (
            self._way(start, way * tangent, is_over) for way in (-1.0, 1.0)
        )
        return [*reversed(before), start, *after], [first, last]

    def _way(
        self, point: Array, tangent: Array, is_over: Callable[[Array], bool]
    ) -> tuple[list[Array], str | None]:
        """Points beyond one, and the bound that the last one lies on."""
        step, made = self._longest(point), list[Array]()
        while step > _SMALLEST:
            guess, row = point + step * tangent, tangent
            bound = next((each for each in self._bounds if each.is_crossed(guess)), None)
            if bound is not None:
                part = (bound.value - point[bound.axis]) / (guess - point)[bound.axis]
                guess, row = point + part * (guess - point), np.eye(point.size)[bound.axis]
            found = self.correct(guess, row)
            if found is None or not self._is_near(point + step * tangent, step, tangent, found):
                step /= 2.0
                continue
            if is_over(found[0]):
                return made, None
            if len(made) == _MOST:
                raise self._lost(f"has more than {_MOST} points one way, and goes on", point)
            made.append(found[0])
            if bound is not None:
                return made, bound.name
            point, tangent = found[0], np.copysign(1.0, found[1] @ tangent) * found[1]
            if found[2] <= _NEWTON // 2:
                step = min(_GROWTH * step, self._longest(point))
        raise self._lost("fails, however short the step,", point)

    def _lost(self, why: str, last: Array) -> ArithmeticError:
        return ArithmeticError(f"{self._name} {why} {self._where(last)}")

    @staticmethod
    def _is_near(
        guess: Array, step: float, tangent: Array, found: tuple[Array, Array, int]
    ) -> bool:
        """Whether a point lies near where it was looked for, the curve in the same direction."""
        off = float(np.linalg.norm(found[0] - guess))
        return off < step and abs(float(found[1] @ tangent)) > _STRAIGHT
