"""Hopf curves of the full system over spin and friction gradient, traced as curves.

Pseudo-arclength continuation in spin, logarithm of the friction gradient and frequency: it follows
a curve through folds and ends where the curve does.

A Hopf point has an eigenvalue i omega: A(Omega, delta) - i omega I is singular, where A is the
state matrix without the drift pair and delta = mu / epsilon. Bordered by a column b and a row c,
it stays regular, and the last entry g of the solution of

    [A - i omega I   b] [v]   [0]
    [c               0] [g] = [1]

is zero exactly at Hopf points: two real equations for three unknowns, a curve. Derivatives of g
are exact: dg = -w dA v with w the solution of the transposed system. Notation as in W. Govaerts,
"Numerical Methods for Bifurcations of Dynamical Equilibria", SIAM (2000).
"""

from dataclasses import dataclass
from math import log

import numpy as np

from analysis.data.checks import Array, choice, number, positive
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.stability.chart import with_gradient
from analysis.stability.continuation import Bound, Curve
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import ComplexArray, require_spinning, spin_scale
from analysis.stability.printed import full_matrices

_SEEDS = 9
"""Lines of constant gradient, equally spaced in its logarithm, on which curves are looked for."""

_FIRST_STEP, _LARGEST_STEP = 0.02, 0.1
_LEAST_FREQUENCY = 1e-3
"""Frequency in rad/s at which a curve counts as having met a double zero eigenvalue."""

_SAME = 0.02
"""Distance from a chord of a curve, without units, within which a point lies on it."""


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


class ExtendedSystem:
    """The extended system g = 0 in the unknowns (Omega / s, ln delta, omega / s), s² = g / r."""

    def __init__(self, scenario: Scenario, motion: Motion, start: Array) -> None:
        self.scenario, self.motion = scenario, motion
        self.scale = spin_scale(scenario)
        self.row: Array = np.zeros(6)
        self.column: Array = np.zeros(6)
        self.curve = Curve(self.residual)
        self.renew(start)

    def matrices(self, x: Array) -> tuple[Array, Array, Array]:
        """A, its derivative by Omega / s and by ln delta.

        A is a quadratic in Omega and linear in delta, so these differences are exact.
        """
        spin, gradient = x[0] * self.scale, float(np.exp(x[1]))
        spins = np.array((spin - 1.0, spin, spin + 1.0))
        less, A, more = full_matrices(self.scenario, spins, self.motion, gradient=gradient)
        double = full_matrices(self.scenario, spin, self.motion, gradient=2 * gradient)[0]
        return A, (more - less) / 2 * self.scale, double - A

    def renew(self, x: Array) -> None:
        """Take the singular vectors at `x`, turned to be as real as can be, as borders.

        With real borders g is conjugate where omega changes its sign.
        """
        A = self.matrices(x)[0] - 1j * x[2] * self.scale * np.eye(6)
        left, size, right = np.linalg.svd(A)
        self.column = _most_real(left[:, -1]) * size[0]
        self.row = _most_real(right[-1])

    def residual(self, x: Array) -> tuple[Array, Array]:
        """Real part of g and imaginary part over omega, shape (2,), and Jacobian, (2, 3).

        The imaginary part is odd in omega; divided by omega it stays regular at a double zero.
        """
        A, by_spin, by_gradient = self.matrices(x)
        bordered: ComplexArray = np.zeros((7, 7), dtype=complex)
        bordered[:6, :6] = A - 1j * x[2] * self.scale * np.eye(6)
        bordered[:6, 6], bordered[6, :6] = self.column, self.row
        unit = np.eye(7)[6]
        v = np.linalg.solve(bordered, unit)
        w = np.linalg.solve(bordered.T, unit)[:6]
        g, v = v[6], v[:6]
        slopes = np.array((-w @ by_spin @ v, -w @ by_gradient @ v, 1j * self.scale * (w @ v)))
        jacobian = np.array((slopes.real, slopes.imag / x[2]))
        jacobian[1, 2] -= g.imag / x[2] ** 2
        return np.array((g.real, g.imag / x[2])), jacobian


def _most_real(vector: ComplexArray) -> Array:
    """Real part of a complex vector turned by the phase that makes it largest, of length 1."""
    turned: Array = (vector * np.exp(-0.5j * np.angle(np.sum(vector**2)))).real
    return turned / np.linalg.norm(turned)


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
    bounds, scale = _bounds(scenario, spins, gradients), spin_scale(scenario)
    curves: list[tuple[Array, tuple[str, str]]] = []
    for gradient in np.geomspace(*gradients, _SEEDS + 2)[1:-1].tolist():
        found = critical_speeds(with_gradient(scenario, gradient), spins, "full", motion)
        for each in found.hopf:
            seed = np.array((each.spin / scale, log(gradient), each.frequency / scale))
            if not any(_passes(points, seed) for points, _ in curves):
                curves.append(_trace(ExtendedSystem(scenario, motion, seed), seed, bounds))
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
    low, high = (number("spins", end) for end in spins)
    least, most = (positive("gradients", end) for end in gradients)
    if not 0.0 <= low < high:
        raise ValueError(f"spins must have 0 <= lowest < highest, got {low:g} to {high:g}")
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


def _passes(points: Array, seed: Array) -> bool:
    """Whether a curve goes through a point, told from its chords."""
    starts, chords = points[:-1], np.diff(points, axis=0)
    part = np.sum((seed - starts) * chords, axis=1) / np.sum(chords**2, axis=1)
    nearest = starts + np.clip(part, 0.0, 1.0)[:, None] * chords
    return bool(np.min(np.linalg.norm(nearest - seed, axis=1)) < _SAME)


def _trace(
    system: ExtendedSystem, seed: Array, bounds: list[Bound]
) -> tuple[Array, tuple[str, str]]:
    """Points of the curve through a Hopf point, lower gradient first, and the kinds of ends."""
    found = system.curve.correct(seed, np.eye(3)[2])
    if found is None:
        raise ArithmeticError(f"no Hopf point near spin {seed[0] * system.scale:g} rad/s")
    start = found[0]
    system.renew(start)
    along = np.cross(*system.residual(start)[1])
    halves = [_half(system, start, way * along, bounds) for way in (-1.0, 1.0)]
    if halves[0][0][-1][1] > halves[1][0][-1][1]:
        halves.reverse()
    (one, one_end), (other, other_end) = halves
    return np.array([*one[::-1], start, *other]), (one_end, other_end)


def _half(
    system: ExtendedSystem, start: Array, along: Array, bounds: list[Bound]
) -> tuple[list[Array], str]:
    """Points beyond a start to one end of the curve, and the kind of the end."""
    points: list[Array] = []
    system.renew(start)
    try:
        for point, end in system.curve.points(
            start,
            along,
            step=_FIRST_STEP,
            largest=lambda point: _LARGEST_STEP * (1.0 + 0.2 * float(np.linalg.norm(point))),
            bounds=bounds,
        ):
            points.append(point)
            if end is not None:
                return points, end
            system.renew(point)
    except ArithmeticError as error:
        last = points[-1] if points else start
        raise ArithmeticError(
            f"the Hopf curve {error} at spin {last[0] * system.scale:g} rad/s, "
            f"gradient {np.exp(last[1]):g} s/m after {len(points) + 1} points"
        ) from error
    raise AssertionError("a curve ends at a bound")
