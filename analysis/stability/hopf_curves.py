"""Hopf curves of the full system over spin and friction gradient, and the corners where they meet.

Pseudo-arclength continuation in spin, logarithm of the friction gradient and frequency: it follows
a curve through folds and ends where the curve does.

At a Hopf point the two eigenvalues nearest to +-i omega have the sum 0 and the product omega².
Both are smooth functions of the parameters, also where the pair becomes a double zero: two
equations for three unknowns, a curve. Their derivatives follow from those of the eigenvalues,
w dA v with the left and right eigenvectors w and v.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import log
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import Array, choice, positive
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.stability.chart import with_gradient
from analysis.stability.continuation import Bound, Curve
from analysis.stability.critical import critical_speeds, spin_interval
from analysis.stability.linearisation import ComplexArray, falling, require_spinning, spin_scale
from analysis.stability.printed import full_matrices

_SEEDS = 9
"""Lines of constant gradient, equally spaced in its logarithm, on which curves are looked for."""

_LEAST_FREQUENCY = 1e-3
"""Frequency in rad/s at which a curve counts as having met a double zero eigenvalue."""

_SAME = 0.02
"""Distance from a chord of a curve, without units, within which a point lies on it."""


Kind = Literal["double hopf", "zero hopf", "double zero"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HopfCurve:
    """A curve of Hopf points of the full system.

    Parameters
    ----------
    motion : {"inverted", "noninverted"}
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s along the curve.
    gradients : ndarray, shape (n,)
        Friction gradients mu / epsilon in s/m.
    frequencies : ndarray, shape (n,)
        Imaginary part of the crossing pair in rad/s.
    ends : tuple of 2 of {"spin", "gradient", "double zero"}
        Why the curve ends: at a bound of the spin or of the gradient, or because the frequency
        falls to zero where a static curve meets it (a Bogdanov-Takens point).
    """

    motion: Motion
    spins: Array
    gradients: Array
    frequencies: Array
    ends: tuple[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """A point at which two stability boundaries of the full system meet.

    Parameters
    ----------
    kind : {"double hopf", "zero hopf", "double zero"}
        Two Hopf curves cross; a Hopf curve crosses the static curve; a Hopf curve starts there.
    spin : float
        Spinning speed in rad/s.
    gradient : float
        Friction gradient mu / epsilon in s/m.
    frequencies : tuple of float
        Imaginary parts of the critical pairs in rad/s.
    """

    kind: Kind
    spin: float
    gradient: float
    frequencies: tuple[float, ...]


class HopfPoints:
    """What is zero at Hopf points, of x = (Omega / s, ln delta, omega / s) with s² = g / r."""

    def __init__(self, scenario: Scenario, motion: Motion, bounds: Iterable[Bound] = ()) -> None:
        self.scenario, self.motion = scenario, motion
        self.scale = spin_scale(scenario)
        self.curve = Curve(self.residual, "the Hopf curve", self._where, bounds, _longest_step)

    def _where(self, x: Array) -> str:
        return f"at spin {x[0] * self.scale:g} rad/s, gradient {np.exp(x[1]):g} s/m"

    def matrices(self, x: Array) -> tuple[Array, Array, Array]:
        """State matrix A / s, its derivatives by Omega / s and by ln delta.

        A is a quadratic in Omega and linear in delta, so these differences are exact.
        """
        spin, gradient = x[0] * self.scale, float(np.exp(x[1]))
        spins = np.array((spin - 1.0, spin, spin + 1.0))
        less, A, more = full_matrices(self.scenario, spins, self.motion, gradient=gradient)
        double = full_matrices(self.scenario, spin, self.motion, gradient=2 * gradient)[0]
        return A / self.scale, (more - less) / 2.0, (double - A) / self.scale

    def residual(self, x: Array) -> tuple[Array, Array]:
        """Sum of the pair and its product less omega², shape (2,), and Jacobian, (2, 3)."""
        A, *slopes = self.matrices(x)
        values, v = np.linalg.eig(A)
        pair = np.argsort(np.abs(values**2 + x[2] ** 2))[:2]
        w, values = np.linalg.inv(v)[pair], values[pair]
        changes = np.array([np.sum(w * (slope @ v[:, pair]).T, axis=1) for slope in slopes])
        sums, products = changes.sum(axis=1).real, (changes @ values[::-1]).real
        residual = np.array((values.sum().real, values.prod().real - x[2] ** 2))
        return residual, np.array(((*sums, 0.0), (*products, -2.0 * x[2])))

    def others(self, x: Array) -> ComplexArray:
        """Eigenvalues in 1/s by falling real part without the pair."""
        values = np.linalg.eigvals(self.matrices(x)[0]).astype(complex)
        order = np.argsort(np.abs(values**2 + x[2] ** 2))
        return falling(self.scale * values[order[2:]])


def hopf_curves(
    scenario: Scenario,
    motion: Motion = "inverted",
    *,
    spins: tuple[float, float] = (0.0, 100.0),
    gradients: tuple[float, float] = (0.1, 1000.0),
) -> tuple[HopfCurve, ...]:
    """Trace the Hopf curves of the full system inside a rectangle.

    Curves start at the Hopf points found on 9 lines of constant gradient, so a closed curve
    between two of those lines would be missed.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table; its friction is not looked at.
    motion : {"inverted", "noninverted"}
    spins : tuple of 2 floats
        Lowest, not negative, and highest spin in rad/s.
    gradients : tuple of 2 floats
        Lowest, positive, and highest friction gradient mu / epsilon in s/m.

    Returns
    -------
    tuple of HopfCurve
        Each from its end with the lower gradient to the other; empty if there is none.

    Raises
    ------
    ValueError
        If a range is empty or out of bounds, the motion is unknown or the scenario another one.
    ArithmeticError
        If the continuation comes to a halt inside the rectangle.
    """
    require_spinning(scenario, "the full system", 1)
    choice("motion", motion, MOTIONS)
    system, scale = (
        HopfPoints(scenario, motion, _bounds(scenario, spins, gradients)),
        spin_scale(scenario),
    )
    curves: list[tuple[Array, tuple[str, str]]] = []
    for gradient in np.geomspace(*gradients, _SEEDS + 2)[1:-1].tolist():
        found = critical_speeds(with_gradient(scenario, gradient), spins, "full", motion)
        for each in found.hopf:
            seed = np.array((each.spin / scale, log(gradient), each.frequency / scale))
            if not any(_passes(points, seed) for points, _ in curves):
                curves.append(_trace(system, seed))
    curves.sort(key=lambda curve: float(curve[0][:, 2].max()))
    return tuple(
        HopfCurve(
            motion=motion,
            spins=points[:, 0] * scale,
            gradients=np.exp(points[:, 1]),
            frequencies=points[:, 2] * scale,
            ends=ends,
        )
        for points, ends in curves
    )


def _bounds(
    scenario: Scenario, spins: tuple[float, float], gradients: tuple[float, float]
) -> list[Bound]:
    """Where curves of (Omega / s, ln delta, omega / s) end."""
    low, high = spin_interval(spins, "spins")
    least, most = (positive("gradients", end) for end in gradients)
    if not least < most:
        raise ValueError(f"gradients must have lowest < highest, got {least:g} to {most:g}")
    scale = spin_scale(scenario)
    return [
        Bound("double zero", 2, _LEAST_FREQUENCY / scale, upper=False),
        Bound("spin", 0, low / scale, upper=False),
        Bound("spin", 0, high / scale, upper=True),
        Bound("gradient", 1, log(least), upper=False),
        Bound("gradient", 1, log(most), upper=True),
    ]


def _longest_step(point: Array) -> float:
    return 0.1 + 0.02 * float(np.linalg.norm(point))


def _passes(points: Array, seed: Array) -> bool:
    """Whether a curve goes through a point, told from its chords."""
    starts, chords = points[:-1], np.diff(points, axis=0)
    part = np.sum((seed - starts) * chords, axis=1) / np.sum(chords**2, axis=1)
    nearest = starts + np.clip(part, 0.0, 1.0)[:, None] * chords
    return bool(np.min(np.linalg.norm(nearest - seed, axis=1)) < _SAME)


def _trace(system: HopfPoints, seed: Array) -> tuple[Array, tuple[str, str]]:
    """Points of the curve through a Hopf point, lower gradient first, and the kinds of ends."""
    found = system.curve.correct(seed, np.eye(3)[2])
    if found is None:
        raise ArithmeticError(f"no Hopf point near spin {seed[0] * system.scale:g} rad/s")
    points, (one, other) = system.curve.through(found[0], axis=1)
    ends = str(one), str(other)
    if points[0][1] > points[-1][1]:
        return np.array(points[::-1]), ends[::-1]
    return np.array(points), ends


def corners(scenario: Scenario, curves: Iterable[HopfCurve]) -> tuple[Corner, ...]:
    """Where Hopf curves of one scenario meet each other or the static curve, by gradient.

    Parameters
    ----------
    scenario : Scenario
        That of the curves.
    curves : iterable of HopfCurve

    Raises
    ------
    ArithmeticError
        If a meeting point cannot be refined.
    """
    found = [each for curve in curves for each in _along(scenario, curve)]
    return tuple(sorted(found, key=lambda corner: corner.gradient))


def _along(scenario: Scenario, curve: HopfCurve) -> Iterator[Corner]:
    """Corners of a curve; of two curves that cross, those of the lower frequency."""
    for end, spin, gradient in zip(
        curve.ends, curve.spins[[0, -1]].tolist(), curve.gradients[[0, -1]].tolist(), strict=True
    ):
        if end == "double zero":
            yield Corner(kind="double zero", spin=spin, gradient=gradient, frequencies=(0.0,))
    scale = spin_scale(scenario)
    points = np.column_stack(
        (curve.spins / scale, np.log(curve.gradients), curve.frequencies / scale)
    )
    system = HopfPoints(scenario, curve.motion)
    unstable = [int(np.sum(system.others(point).real > 0.0)) for point in points]
    for index in np.flatnonzero(np.diff(unstable)).tolist():
        # The last one that is unstable on either side is the one that crosses.
        place = max(unstable[index : index + 2]) - 1
        point = _meeting(system, points[index], points[index + 1], place)
        frequency = abs(float(system.others(point)[place].imag))
        spin, own = (point[[0, 2]] * scale).tolist()
        gradient = float(np.exp(point[1]))
        if frequency == 0.0:
            yield Corner(kind="zero hopf", spin=spin, gradient=gradient, frequencies=(own,))
        elif frequency > own:
            yield Corner(
                kind="double hopf", spin=spin, gradient=gradient, frequencies=(own, frequency)
            )


def _meeting(system: HopfPoints, low: Array, high: Array, place: int) -> Array:
    """Point between two neighbouring ones of a curve at which a real part is zero."""

    def between(part: float) -> Array:
        found = system.curve.correct(low + part * (high - low), high - low)
        if found is None:
            raise ArithmeticError(
                f"no meeting of two boundaries near {system.scale * low[0]:g} rad/s"
            )
        return found[0]

    part = brentq(
        lambda part: float(system.others(between(part))[place].real), 0.0, 1.0, xtol=1e-14
    )
    return between(float(part))
