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

from analysis.data.checks import Array, choice, number, positive, whole
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.stability.chart import gradient_matrices, with_gradient
from analysis.stability.continuation import Bound, Curve
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import ComplexArray, require_spinning, spin_scale

_FIRST_STEP, _LARGEST_STEP = 0.02, 0.1
LEAST_FREQUENCY = 1e-3
"""Frequency in rad/s at which a curve counts as having met a double zero eigenvalue."""


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
        less, A, more = gradient_matrices(self.scenario, spins, gradient, self.motion)
        double = gradient_matrices(self.scenario, spins[1:2], 2 * gradient, self.motion)[0]
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
    seeds: int = 9,
) -> tuple[HopfCurve, ...]:
    """Trace the Hopf curves of the full system inside a rectangle.

    Curves start at the Hopf points found on `seeds` lines of constant gradient, so a closed curve
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
    seeds : int
        Number of lines, equally spaced in the logarithm of the gradient.

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
    seeds = whole("seeds", seeds)
    bounds = _bounds(scenario, spins, gradients)
    curves: list[HopfCurve] = []
    for gradient in np.geomspace(*gradients, seeds + 2)[1:-1].tolist():
        found = critical_speeds(with_gradient(scenario, gradient), spins, "full", motion)
        for point in found.hopf:
            if not any(_passes(curve, point.spin, gradient, point.frequency) for curve in curves):
                seed = np.array((point.spin, log(gradient), point.frequency))
                curves.append(_trace(scenario, motion, seed, bounds))
    return tuple(sorted(curves, key=lambda curve: float(curve.frequencies.max())))


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
        Bound("double zero", 2, LEAST_FREQUENCY / scale, upper=False),
        Bound("spin", 0, low / scale, upper=False),
        Bound("spin", 0, high / scale, upper=True),
        Bound("gradient", 1, log(least), upper=False),
        Bound("gradient", 1, log(most), upper=True),
    ]


def _passes(curve: HopfCurve, spin: float, gradient: float, frequency: float) -> bool:
    """Whether the curve goes through a Hopf point, told from its chords."""
    side = np.log(curve.gradients / gradient)
    for index in np.nonzero(side[:-1] * side[1:] <= 0.0)[0]:
        part = side[index] / (side[index] - side[index + 1])
        chord = slice(index, index + 2)
        for values, value in ((curve.spins, spin), (curve.frequencies, frequency)):
            start, end = values[chord]
            if abs(start + part * (end - start) - value) > 0.02 * value + abs(end - start):
                break
        else:
            return True
    return False


def _trace(scenario: Scenario, motion: Motion, seed: Array, bounds: list[Bound]) -> HopfCurve:
    """Follow a curve from a Hopf point (Omega, ln delta, omega) to both ends."""
    scale = spin_scale(scenario)
    start = seed / np.array((scale, 1.0, scale))
    halves = [_half(ExtendedSystem(scenario, motion, start), start, bounds, w) for w in (-1, 1)]
    if halves[0][0][-1][1] > halves[1][0][-1][1]:
        halves.reverse()
    (one, one_end), (other, other_end) = halves
    points = np.array(one[:0:-1] + other)
    return HopfCurve(
        motion=motion,
        spins=points[:, 0] * scale,
        gradients=np.exp(points[:, 1]),
        frequencies=points[:, 2] * scale,
        ends=(one_end, other_end),
    )


def _half(
    system: ExtendedSystem, start: Array, bounds: list[Bound], way: float
) -> tuple[list[Array], str]:
    """Points from `start` to one end of the curve, and the kind of the end."""
    found = system.curve.correct(start, np.eye(3)[2])
    if found is None:
        raise ArithmeticError(f"no Hopf point near spin {start[0] * system.scale:g} rad/s")
    points = [found[0]]
    try:
        for point, end in system.curve.points(
            points[0],
            way * np.cross(*system.residual(points[0])[1]),
            step=_FIRST_STEP,
            largest=lambda point: _LARGEST_STEP * (1.0 + 0.2 * float(np.linalg.norm(point))),
            bounds=bounds,
        ):
            points.append(point)
            if end is not None:
                return points, end
            system.renew(point)
    except ArithmeticError as error:
        raise ArithmeticError(
            f"the Hopf curve {error} at spin {points[-1][0] * system.scale:g} rad/s, "
            f"gradient {np.exp(points[-1][1]):g} s/m after {len(points)} points"
        ) from error
    raise AssertionError("a curve ends at a bound")
