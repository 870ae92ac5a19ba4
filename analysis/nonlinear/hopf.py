"""Type of the Hopf bifurcation of inverted spinning.

The critical pair does not slip: its eigenvector v of A(Omega_crit) solves the system without
friction, too (Eq. (129) has friction as a common factor, Eq. (130) has none). Slip is therefore
of third order in the amplitude, and the force law enters the normal form by its gradient alone.
Its kink in the second derivative, which leaves no classical Lyapunov coefficient to be computed
for it, comes in two orders later, and the coefficient of a smooth law of the same gradient holds.

Since the flow is odd about inverted spinning, its quadratic terms vanish. Notation as in
Y. A. Kuznetsov, "Elements of Applied Bifurcation Theory": A q = i omega q, A^T p = -i omega p,
<p, q> = 1, l_1 = Re <p, C(q, q, conj q)> / (2 omega).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from analysis.mechanics import reduced
from analysis.mechanics.dual import Dual, dual, of_slope
from analysis.mechanics.paper import critical_speed, reduced_matrices
from analysis.nonlinear import flow
from analysis.nonlinear.motions import PeriodicMotion
from analysis.problem.checks import Array
from analysis.problem.scenario import Scenario
from analysis.stability.linearisation import ComplexArray, eigenvectors

HopfKind = Literal["supercritical", "subcritical", "degenerate"]

_NOTHING = 1e-10
"""Part of the frequency below which a Lyapunov coefficient is none."""

_SMALL = 1.05
"""Largest amplitude in rad of the cycles from which the growth is fitted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HopfType:
    """Normal form of the Hopf bifurcation.

    Parameters
    ----------
    spin, frequency : float
        Of the Hopf point in rad/s.
    lyapunov : float
        First Lyapunov coefficient l_1 with a critical eigenvector scaled to 1 rad in gamma.
    real_part_slope : float
        Derivative of the real part of the critical pair by the spin, without unit.
    slip : float
        Slip of the critical eigenvector over that of one part of it, 0 but for rounding.
    """

    spin: float
    frequency: float
    lyapunov: float
    real_part_slope: float
    slip: float

    @property
    def curvature(self) -> float:
        """Limit of (spin - Hopf spin) / amplitude² for small cycles, in rad/s for each rad²."""
        return -self.frequency * self.lyapunov / 4.0 / self.real_part_slope

    @property
    def kind(self) -> HopfKind:
        """Supercritical if the cycles are born stable."""
        if abs(self.lyapunov) < _NOTHING * self.frequency:
            return "degenerate"
        return "supercritical" if self.lyapunov < 0.0 else "subcritical"


def hopf_type(scenario: Scenario) -> HopfType:
    """First Lyapunov coefficient of the reduced system at its critical speed.

    Raises
    ------
    ValueError
        If the scenario is not of Model 4 with friction that knows the weight, and an
        eccentricity.
    """
    flow.require_cycles(scenario)
    hopf = critical_speed(scenario)
    less, A, more = reduced_matrices(scenario, hopf.spin + np.array((-1.0, 0.0, 1.0)))
    left, right = eigenvectors(A, 1j * hopf.frequency)
    q = right / right[1]
    p = left / np.conj(np.vdot(left, q))
    C = _third_derivative(scenario, hopf.spin, (q, q, q.conj()))
    # At first order a deviation changes cos(gamma) and the rate of beta alone.
    slip = reduced.lateral_slip(scenario.disk, hopf.spin, (1.0, 0.0, 1.0, -q[1]), q[2])
    return HopfType(
        spin=hopf.spin,
        frequency=hopf.frequency,
        lyapunov=float(np.vdot(p, C).real / (2.0 * hopf.frequency)),
        # The matrix is a quadratic in the spin: the difference is exact.
        real_part_slope=float(np.vdot(p, (more - less) / 2.0 @ q).real),
        slip=float(abs(slip / (scenario.disk.eccentricity * hopf.spin * q[1]))),
    )


def _third_derivative(
    scenario: Scenario, spin: float, directions: Sequence[ComplexArray]
) -> ComplexArray:
    """Third derivative of the flow along three directions, shape (3,).

    With friction in proportion to slip, the flow is analytic; see the top of the file.
    """
    # A dual number in the first direction of one in the second of one in the third: zero, with
    # a change by one of them at each level.
    x: list[Any] = [0.0, 0.0, 0.0]
    for direction in directions:
        x = [Dual(value, change) for value, change in zip(x, direction.tolist(), strict=True)]
    linear = of_slope(scenario.friction.gradient)
    rates: Any = reduced.solver(scenario, spin, lambda _: linear, about_inverted=True)(*x)
    for _ in directions:
        rates = [dual(rate).change for rate in rates]
    return np.array(rates, dtype=complex)


class Growth(NamedTuple):
    """Spin over amplitude near the Hopf point, fitted to cycles.

    Parameters
    ----------
    curvature, curvature_error : float
        Of the term amplitude² in rad/s for each rad², and its standard error.
    exponent, exponent_error : float
        Power of the amplitude with which the spin leaves its critical value, and its standard
        error, with no form assumed but a correction in amplitude².
    """

    curvature: float
    curvature_error: float
    exponent: float
    exponent_error: float


def fitted_growth(cycles: Sequence[PeriodicMotion], critical: float) -> Growth | None:
    """Fit how the spin of small cycles leaves the critical speed.

    Parameters
    ----------
    cycles : sequence of PeriodicMotion
        Symmetric ones.
    critical : float
        Spin of the Hopf point in rad/s.

    Returns
    -------
    Growth or None
        None if there are less than 5 small cycles, or their spins lie on both sides of it.
    """
    small = [(each.value, each.spin - critical) for each in cycles if each.value < _SMALL]
    if len(small) < 5 or len({np.sign(off) for _, off in small}) > 1:
        return None
    a, away = np.transpose(small)
    # Each cycle is known to the same part of its amplitude squared.
    terms = np.stack((a**0, a**2, a**3, a**4), axis=1)
    logs = np.stack((np.log(a), a**0, a**2, a**4), axis=1)
    return Growth(*_least_squares(terms, away / a**2), *_least_squares(logs, np.log(np.abs(away))))


def _least_squares(matrix: Array, values: Array) -> tuple[float, float]:
    """First coefficient and its standard error."""
    inverse = np.linalg.pinv(matrix)
    rest, freedom = values - matrix @ (inverse @ values), np.subtract(*matrix.shape)
    error = np.linalg.norm(rest) / np.sqrt(freedom) * np.linalg.norm(inverse[0])
    return float(inverse[0] @ values), float(error)
