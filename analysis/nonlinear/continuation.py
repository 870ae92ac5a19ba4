"""Continuation by pseudo-arclength: along the tangent of a curve, through folds of every unknown.

Periodic motions, whose unknowns are functions, are followed in `families`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from analysis.problem.checks import Array

_SEARCH_STEP, WIDEST = 0.02, 0.5
"""Steps and range to both sides of a search for a root, in parts of its centre."""

_NEWTON = 8
"""Iterations at most to a point of a curve."""

_CONVERGED, _FURTHEST = 1e-8, 1.0
"""Last step of Newton's method, whose error is about its square; and one that leads elsewhere."""

_GROWTH = 1.5
_SMALLEST = 1e-6
"""Step at which a curve counts as lost."""

_MOST = 2000
"""Points of a curve one way, at most."""

_STRAIGHT = 0.99
"""Cosine of the angle between neighbouring tangents of a curve, at least."""


def nearest_root(function: Callable[[float], float], centre: float) -> float | None:
    """Root of a function next to a centre to 1e-11, or None.

    None is found if the function does not change its sign within half the centre to both sides.
    """
    middle = function(centre)
    for count in range(1, round(WIDEST / _SEARCH_STEP) + 1):
        for way in (-_SEARCH_STEP, _SEARCH_STEP):
            outer, inner = (centre * (1.0 + way * each) for each in (count, count - 1))
            if function(outer) * middle <= 0.0:
                return float(brentq(function, inner, outer, xtol=1e-11, rtol=1e-14))
    return None


class Curve(NamedTuple):
    """A curve of solutions of equations, of one more unknown than the rank of these.

    Parameters
    ----------
    equations : callable
        From a point, shape (n,), to residuals, shape (m,), and their Jacobian, shape (m, n).
    interval : tuple of 2 floats
        Lowest and highest value of the last unknown, at which the curve is left.
    step : float
        Longest one.
    where : callable
        What to say of the last good point where the curve is lost.
    ends_before : callable
        Whether the curve ends before a point.
    """

    equations: Callable[[Array], tuple[Array, Array]]
    interval: tuple[float, float]
    step: float
    where: Callable[[Array], str] = str
    ends_before: Callable[[Array], bool] = lambda _: False

    def through(self, start: Array) -> list[Array]:
        """Points of the curve both ways from one of them: first that on which the last one falls.

        Raises
        ------
        ArithmeticError
            If no further point is found, however short the step, or too many are.
        """
        tangent = np.linalg.svd(self.equations(start)[1])[2][-1]
        tangent = np.copysign(1.0, tangent[-1]) * tangent
        before, after = (self._way(start, way * tangent) for way in (-1.0, 1.0))
        return [*reversed(before), start, *after]

    def _way(self, point: Array, tangent: Array) -> list[Array]:
        """Points beyond one."""
        step, made = self.step, list[Array]()
        while step > _SMALLEST:
            ahead = point + step * tangent
            guess, row, end = ahead, tangent, float(np.clip(ahead[-1], *self.interval))
            if end != ahead[-1]:
                fraction = (end - point[-1]) / (ahead - point)[-1]
                guess, row = point + fraction * (ahead - point), np.eye(point.size)[-1]
            found = self._corrected(guess, row)
            if found is None or not _is_near(*found, ahead, tangent, step):
                step /= 2.0
                continue
            if self.ends_before(found[0]):
                return made
            if len(made) == _MOST:
                why = f"has more than {_MOST} points one way, and goes on"
                raise ArithmeticError(f"the curve {why} {self.where(point)}")
            made.append(found[0])
            if end != ahead[-1]:
                return made
            point, tangent = found[0], np.copysign(1.0, found[1] @ tangent) * found[1]
            step = min(_GROWTH * step, self.step)
        raise ArithmeticError(f"the curve fails, however short the step, {self.where(point)}")

    def _corrected(self, guess: Array, row: Array) -> tuple[Array, Array] | None:
        """Point of the curve in the plane through a guess with this normal, and its unit tangent.

        That is to either side; None if Newton's method does not converge.
        """
        point = guess
        for _ in range(_NEWTON):
            residual, jacobian = self.equations(point)
            right = -np.append(residual, row @ (point - guess))
            step = np.linalg.lstsq(np.vstack((jacobian, row)), right, rcond=None)[0]
            point = point + step
            size = np.max(np.abs(step))
            if not size < _FURTHEST:
                return None
            if size < _CONVERGED:
                return point, np.linalg.svd(jacobian)[2][-1]
        return None


def _is_near(point: Array, direction: Array, ahead: Array, tangent: Array, step: float) -> bool:
    """Whether a point lies near where it was looked for, the curve in the same direction."""
    off = float(np.linalg.norm(point - ahead))
    return off < step and abs(float(direction @ tangent)) > _STRAIGHT
