"""The paper's linear systems and closed forms as they are printed, with the numbers of equations.

The full system, Eqs. (48)-(55), is M z'' + (D + G) z' + (K + N) z = 0 with z = (x, y, beta - pi/2,
gamma -+ pi/2): horizontal position of the geometric centre G in the co-rotating frame and
deviations of the angles. The reduced system, Eqs. (111), (112), has the states (beta - pi/2,
gamma -+ pi/2, beta'); p(lambda) = (a - lambda)(lambda² + b lambda + c) is its characteristic
polynomial, and B_bar = B - m e².

Turning the body frame by pi about its z axis swaps inverted and noninverted spinning and the sign
of the eccentricity and changes nothing else, so noninverted spinning has the same equations with
-e. Any constraints are linearised, without these matrices, in `linearisation`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np
import numpy.typing as npt

from analysis.problem.body import Body
from analysis.problem.checks import Array, choice
from analysis.problem.scenario import Scenario, require_plain
from analysis.problem.start import MOTIONS, Motion
from analysis.stability.linearisation import ComplexArray, require_spinning, spin_array


def signed_eccentricity(disk: Body, motion: Motion) -> float:
    """Height of S above G in m: +e for inverted, -e for noninverted spinning.

    Raises
    ------
    ValueError
        If the motion is unknown.
    """
    choice("motion", motion, MOTIONS)
    return disk.eccentricity if motion == "inverted" else -disk.eccentricity


# --- The full system ----------------------------------------------------------------------------


def printed_matrices(numbers: Mapping[str, float], D: float | None = None) -> dict[str, Array]:
    """Matrices of Eqs. (48)-(54) by the paper's names, shape (4, 4) each, of `paper_numbers`.

    With the signs of Eq. (48), friction enters as + d D_C and + d Omega B_C with the force d =
    mu m g / epsilon: the paper prints (53) and (54) with a minus, which would feed energy in. The
    powers of Omega are left out: D + G = d D_C + Omega G_h and K + N = Omega² K_h + K_f + d Omega
    B_C. M is Eq. (49), G_h (50), K_h (51), K_f (52), D_C (53) and B_C (54); D abbreviates A - B -
    C, unless another number is given.
    """
    m, r, e, A, B, C, mg = numbers.values()
    me, D = m * e, A - B - C if D is None else D
    printed = {
        "M": ((m, 0, 0, -me), (0, m, -me, 0), (0, -me, B, 0), (-me, 0, 0, C)),
        "G_h": (
            (0, -2 * m, 2 * me, 0),
            (2 * m, 0, 0, -2 * me),
            (-2 * me, 0, 0, -D),
            (0, 2 * me, D, 0),
        ),
        "K_h": ((-m, 0, 0, me), (0, -m, me, 0), (0, me, A - C, 0), (me, 0, 0, A - B)),
        "K_f": ((0, 0, 0, 0), (0, 0, 0, 0), (0, 0, -mg * (e + r), 0), (0, 0, 0, -mg * e)),
        "D_C": ((1, 0, 0, r), (0, 1, r, 0), (0, r, r * r, 0), (r, 0, 0, r * r)),
        "B_C": ((0, -1, -r, 0), (1, 0, 0, 0), (r, 0, 0, 0), (0, -r, -r * r, 0)),
    }
    return {name: np.array(rows, dtype=float) for name, rows in printed.items()}


def paper_numbers(scenario: Scenario, motion: Motion = "inverted") -> dict[str, float]:
    """Numbers of `printed_matrices` by the paper's names."""
    disk = scenario.disk
    return {
        "m": disk.mass,
        "r": disk.radius,
        "e": signed_eccentricity(disk, motion),
        "A": disk.inertia_x,
        "B": disk.inertia_y,
        "C": disk.inertia_z,
        "mg": scenario.weight,
    }


def first_order(printed: Mapping[str, Array], spins: Array, d: npt.ArrayLike) -> Array:
    """Eq. (55): state matrices in (z, z'), shape (n, 8, 8), with a friction force d in N s/m.

    That is one for all spins, or one for each.
    """
    M, G_h, K_h, K_f, D_C, B_C = printed.values()
    Omega, d = spins[:, None, None], np.reshape(d, (-1, 1, 1))
    result = np.zeros((spins.size, 8, 8))
    result[:, :4, 4:] = np.eye(4)
    result[:, 4:, :4] = -np.linalg.solve(M, Omega**2 * K_h + K_f + d * Omega * B_C)
    result[:, 4:, 4:] = -np.linalg.solve(M, d * D_C + Omega * G_h)
    return result


def full_matrices(
    scenario: Scenario,
    spins: npt.ArrayLike,
    motion: Motion = "inverted",
    *,
    gradient: npt.ArrayLike | None = None,
) -> Array:
    """State matrices of the full system, Eqs. (48)-(55), without the drift.

    In the R-frame, which turns with the disk, a place fixed on the table circles with -Omega. That
    gives Eq. (55) the pair of eigenvalues +-i Omega exactly, whatever the friction. In the states
    (beta, gamma, inertial velocity of G along e_x^R and e_y^R, rates of beta and gamma) the place
    does not occur.

    Load "weight" and load "contact" have the same linearisation, because the contact force is m g
    up to second order, Eq. (40).

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}
    gradient : float or array_like, shape (n,), optional
        Friction gradient mu / epsilon in s/m, or one for each spin, in place of that of the
        scenario's law.

    Returns
    -------
    ndarray, shape (n, 6, 6)

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown or the scenario another one.
    """
    require_spinning(scenario, "the full system", 1)
    spins = spin_array(spins)
    d = scenario.weight * np.array(scenario.friction.gradient if gradient is None else gradient)
    matrices = first_order(printed_matrices(paper_numbers(scenario, motion)), spins, d)
    change = np.zeros((spins.size, 8, 8))
    change[:, 4, 1], change[:, 5, 0] = -spins, spins
    turned = (np.eye(8) + change) @ matrices @ (np.eye(8) - change)
    return np.ascontiguousarray(turned[:, 2:, 2:])


def static_gradient(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> Array:
    """Friction gradient at which a real eigenvalue is zero, in s/m, shape (n,), in closed form.

    An eigenvalue is zero where det(K + N) = 0 in Eq. (55). The determinant is quadratic in
    d = mu m g / epsilon without a linear term:

        d² ((B - A + m e r) Omega² + m e g) ((C - A + 2 m e r + m r²) Omega² + m g (r + e))
        = (m Omega)² ((A - B_bar) Omega² - m e g) ((C - A - m e²) Omega² + m g (r + e)).

    Below the gradient found, an odd number of eigenvalues is unstable: inverted spinning falls
    over without oscillating. Where there is no such gradient the result is nan; so it is at every
    spin for noninverted spinning of a disk with A >= B_bar, whose right side is positive and
    whose left side is not: it is unstable at every spin and with every friction.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table; its friction is not looked at.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown or the scenario another one.
    """
    require_spinning(scenario, "the full system", 1)
    Omega2 = spin_array(spins) ** 2
    m, r, e, A, B, C, mg = paper_numbers(scenario, motion).values()
    B_bar = scenario.disk.inertia_about_cog[1]
    left = ((B - A + m * e * r) * Omega2 + mg * e) * (
        (C - A + 2 * m * e * r + m * r**2) * Omega2 + mg * (r + e)
    )
    right = ((A - B_bar) * Omega2 - mg * e) * ((C - A - m * e**2) * Omega2 + mg * (r + e))
    exists = left * right > 0.0
    ratio = np.divide(right, left, out=np.full_like(left, np.nan), where=exists)
    result: Array = np.sqrt(Omega2 * ratio) / scenario.table.gravity
    return result


# --- The reduced system -------------------------------------------------------------------------


def reduced_matrices(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> Array:
    """State matrices of the reduced system, Eqs. (111), (112), shape (n, 3, 3).

    Parameters
    ----------
    scenario : Scenario
        Of Model 4, on a horizontal table.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown or the scenario another one.
    """
    require_spinning(scenario, "the reduced system", 4)
    Omega = spin_array(spins)
    result = np.zeros((Omega.size, 3, 3))
    result[:, 0, 2] = 1.0
    result[:, 1, 0] = Omega
    result[:, 2, 0], result[:, 2, 1], result[:, 2, 2] = _entries(scenario, Omega, motion)
    return result


def _entries(scenario: Scenario, Omega: Array, motion: Motion) -> tuple[Array, Array, float]:
    """Entries A_31, A_32 and A_33, Eq. (112)."""
    disk = scenario.disk
    r, e = disk.radius, signed_eccentricity(disk, motion)
    stiffness = scenario.weight / disk.inertia_about_cog[1]
    d = scenario.friction.gradient * stiffness
    return stiffness * (r + e) - Omega**2, -d * e * (r + e) * Omega, -d * (r + e) ** 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClosedForm:
    """Approximate factors of the characteristic polynomial for small smoothing, Eq. (114).

    Parameters
    ----------
    a : float
        Limit of the real eigenvalue lambda_3 in 1/s, Eqs. (119), (122); the same at all spins.
    b, c : ndarray, shape (n,)
        Coefficients b in 1/s, Eq. (121), and c in 1/s², Eq. (120).
    """

    a: float
    b: Array
    c: Array

    @property
    def eigenvalues(self) -> ComplexArray:
        """lambda_1 and lambda_2 from Eq. (123) and lambda_3 from Eq. (122), shape (n, 3), 1/s."""
        root = np.sqrt((self.b**2 - 4 * self.c).astype(complex))
        third = np.full_like(root, self.a)
        return np.column_stack(((-self.b + root) / 2, (-self.b - root) / 2, third))


def closed_form(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> ClosedForm:
    """Eigenvalues in closed form for small smoothing, Eqs. (113)-(123).

    Parameters
    ----------
    scenario : Scenario
        Its constraints are not looked at: the closed form is that of the reduced system. Its
        friction must be on: the expansion is one in the reciprocal friction gradient.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}
        For noninverted spinning c is negative: lambda_1 and lambda_2 are real and of opposite
        sign at every spin but 0, so the motion is unstable.

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown, there is no friction or the
        table leans.
    """
    require_plain(scenario, "the closed form")
    if not scenario.friction.is_on:
        raise ValueError("friction must have a positive gradient for the closed form, got 0")
    Omega = spin_array(spins)
    r, e = scenario.disk.radius, signed_eccentricity(scenario.disk, motion)
    A_31, _, a = _entries(scenario, Omega, motion)
    c = e / (r + e) * Omega**2
    return ClosedForm(a=a, b=(A_31 + c) / a, c=c)


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalSpeed:
    """Spin at which two eigenvalues of the reduced system sum to zero, Eqs. (126), (132).

    Parameters
    ----------
    spin : float
        Critical spinning speed in rad/s (paper: Omega_crit).
    frequency : float
        Imaginary part of the crossing pair in rad/s, Eqs. (127), (131); 0 where none crosses.
    kind : {"hopf", "static", "saddle"}
        "hopf": the pair +-i omega crosses the imaginary axis, stable above the critical speed.
        "static": without eccentricity omega is 0; a real eigenvalue passes zero, beside the
        neutral one of the angle gamma. "saddle": for noninverted spinning omega² is negative;
        the sum of two real eigenvalues of opposite sign passes zero and no stability changes.
    """

    spin: float
    frequency: float
    kind: Literal["hopf", "static", "saddle"]


def critical_speed(scenario: Scenario, motion: Motion = "inverted") -> CriticalSpeed:
    """Critical spinning speed of the reduced system in closed form, Eqs. (126), (127).

    It is exact for every positive friction and depends neither on the friction coefficient nor
    on the smoothing: Eqs. (129), (130) contain them as a common factor only.

    Parameters
    ----------
    scenario : Scenario
        Its disk and gravity alone are looked at: the closed form is that of the reduced system,
        whatever the constraints of the scenario.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If the motion is unknown or the table leans.
    """
    require_plain(scenario, "the closed form")
    m, r, e, _, B, _, mg = paper_numbers(scenario, motion).values()
    Omega_crit = sqrt((r + e) ** 2 / r * mg / (B - m * e**2))
    if e > 0.0:
        frequency = sqrt(e / (r + e)) * Omega_crit
        return CriticalSpeed(spin=Omega_crit, frequency=frequency, kind="hopf")
    return CriticalSpeed(spin=Omega_crit, frequency=0.0, kind="static" if e == 0.0 else "saddle")
