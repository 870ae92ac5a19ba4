"""Continuation by pseudo-arclength: along the tangent of a curve, through folds of every unknown.

Periodic motions, whose unknowns are functions, are followed in `analysis.nonlinear.following`.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from analysis.problem.checks import Array

_SEARCH_STEP, WIDEST = 0.02, 0.5
"""Steps and range to both sides of a search for a root, in parts of its centre."""

_NEWTON = 8
"""Iterations at most to a point of a curve."""

_CONVERGED, _FURTHEST = 1e-8, 1.0
"""Last step of Newton's method, whose error is about its square; and one that leads elsewhere. As
near to a bound, in parts of a step, a curve is there."""

_DIFFERENCE = 1e-6
"""Of unknowns, by which equations are differentiated; it steers Newton's method alone."""

_GROWTH = 1.5
_SMALLEST = 1e-6
"""Step at which a curve counts as lost."""

_MOST = 2000
"""Points of a curve one way, at most."""

_NO_LOOP = 10
"""Points beyond its start within which no curve closes: neighbours turn by less than a tenth."""

_STRAIGHT = 0.99
"""Cosine of the angle between neighbouring tangents of a curve, at least."""


def roots_around(function: Callable[[float], float], centre: float) -> Iterator[float]:
    """Where a function changes its sign, to 1e-11, the nearest place to a centre first.

    It is looked at in steps, within half the centre to both sides.
    """
    seen = dict.fromkeys((-_SEARCH_STEP, _SEARCH_STEP), function(centre))
    for count in range(1, round(WIDEST / _SEARCH_STEP) + 1):
        for way, before in seen.items():
            inner, outer = (centre * (1.0 + way * each) for each in (count - 1, count))
            seen[way] = function(outer)
            if seen[way] * before <= 0.0:
                yield float(brentq(function, inner, outer, xtol=1e-11, rtol=1e-14))


class Curve(NamedTuple):
    """A curve of solutions of equations, of one more unknown than the rank of these.

    Parameters
    ----------
    equations : callable
        From points, shape (k, n), to their residuals, shape (k, m), without units as the points.
    bounds : tuple of 2 ndarrays, shape (n,)
        Lowest and highest value of each unknown, at which the curve is left.
    step : float
        Longest one.
    where : callable
        What to say of the last good point where the curve is lost.
    ends_before : callable
        Whether the curve ends before a point.
    """

    equations: Callable[[Array], Array]
    bounds: tuple[Array, Array]
    step: float
    where: Callable[[Array], str] = str
    ends_before: Callable[[Array], bool] = lambda _: False

    def through(self, start: Array) -> list[Array]:
        """Points of the curve both ways from one of them: first that on which the last one falls.

        A curve that is closed begins and ends there.

        Raises
        ------
        ArithmeticError
            If no further point is found, however short the step, or too many are.
        """
        tangent = np.linalg.svd(self._linearised(start)[1])[2][-1]
        tangent = np.copysign(1.0, tangent[-1]) * tangent
        before = self._way(start, -tangent)
        is_closed = bool(before) and before[-1] is start
        return [*reversed(before), start, *([] if is_closed else self._way(start, tangent))]

    def _way(self, start: Array, tangent: Array) -> list[Array]:
        """Points beyond one, which is the last of them if the curve is closed."""
        point, step, made = start, self.step, list[Array]()
        while step > _SMALLEST:
            ahead = point + step * tangent
            guess, row, ends = ahead, tangent, np.clip(ahead, *self.bounds)
            beyond = np.flatnonzero(ahead != ends)
            if beyond.size:
                # The bound that is met first.
                fractions = (ends - point)[beyond] / (ahead - point)[beyond]
                if np.min(fractions) < _CONVERGED:
                    return made
                guess = point + np.min(fractions) * (ahead - point)
                row = np.eye(point.size)[beyond[np.argmin(fractions)]]
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
            if beyond.size:
                return made
            point, tangent = found[0], np.copysign(1.0, found[1] @ tangent) * found[1]
            if len(made) > _NO_LOOP and self._meets(start, point, tangent):
                return [*made, start]
            step = min(_GROWTH * step, self.step)
        raise ArithmeticError(f"the curve fails, however short the step, {self.where(point)}")

    def _meets(self, start: Array, point: Array, tangent: Array) -> bool:
        """Whether the curve comes to its start within a step beyond a point."""
        way = float((start - point) @ tangent)
        if way < 0.0 or np.linalg.norm(start - point) > self.step:
            return False
        # Where it has folded, it may also pass close by.
        found = self._corrected(point + way * tangent, tangent)
        return found is not None and float(np.max(np.abs(found[0] - start))) < _SMALLEST

    def _linearised(self, point: Array) -> tuple[Array, Array]:
        """Residuals at a point, shape (m,), and their Jacobian, shape (m, n)."""
        steps = _DIFFERENCE * np.eye(point.size)
        found = self.equations(np.vstack((point, point + steps, point - steps)))
        ahead, behind = np.split(found[1:], 2)
        return found[0], (ahead - behind).T / (2.0 * _DIFFERENCE)

    def _corrected(self, guess: Array, row: Array) -> tuple[Array, Array] | None:
        """Point of the curve in the plane through a guess with this normal, and its unit tangent.

        That is to either side; None if Newton's method does not converge.
        """
        point = guess
        for _ in range(_NEWTON):
            residual, jacobian = self._linearised(point)
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
