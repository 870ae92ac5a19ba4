"""Hopf points of the full system over spin and friction gradient, as roots of a smooth system.

A Hopf point has an eigenvalue i omega: A(Omega, delta) - i omega I is singular, where A is the
state matrix without the drift pair and delta = mu / epsilon. Bordered by a column b and a row c,
it stays regular, and the last entry g of the solution of

    [A - i omega I   b] [v]   [0]
    [c               0] [g] = [1]

is zero exactly at Hopf points: two real equations for three unknowns, a curve. Derivatives of g
are exact: dg = -w dA v with w the solution of the transposed system. Notation as in W. Govaerts,
"Numerical Methods for Bifurcations of Dynamical Equilibria", SIAM (2000).
"""

import numpy as np

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.chart import gradient_matrices
from analysis.stability.continuation import Curve
from analysis.stability.linearisation import ComplexArray, spin_scale


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
