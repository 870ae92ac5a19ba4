"""The reduced system linearised about spinning, Eqs. (111), (112), and its closed forms.

Noninverted spinning has the same equations with -e for e, as in `analysis.stability.linear_full`.

Notation as in the paper: A_31, A_32, A_33 are the entries of the state matrix, p(lambda) =
(a - lambda)(lambda² + b lambda + c) its characteristic polynomial, B_bar = B - m e².
"""

from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.linear_full import signed_eccentricity
from analysis.stability.linearisation import ComplexArray, require_spinning, spin_array


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
    A_31, A_32, A_33 = _entries(scenario, Omega, motion)
    result = np.zeros((Omega.size, 3, 3))
    result[:, 0, 2] = 1.0
    result[:, 1, 0] = Omega
    result[:, 2, 0], result[:, 2, 1], result[:, 2, 2] = A_31, A_32, A_33
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
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s.
    a : float
        Limit of the real eigenvalue lambda_3 in 1/s, Eqs. (119), (122); the same at all spins.
    b : ndarray, shape (n,)
        Coefficient b in 1/s, Eq. (121).
    c : ndarray, shape (n,)
        Coefficient c in 1/s², Eq. (120).
    """

    spins: Array
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
    scenario.require_plain("the closed form")
    if not scenario.friction.is_on:
        raise ValueError("friction must have a positive gradient for the closed form, got 0")
    Omega = spin_array(spins)
    r, e = scenario.disk.radius, signed_eccentricity(scenario.disk, motion)
    A_31, _, A_33 = _entries(scenario, Omega, motion)
    a = A_33
    c = e / (r + e) * Omega**2
    return ClosedForm(spins=Omega, a=a, b=(A_31 + c) / a, c=c)


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
    scenario.require_plain("the closed form")
    disk = scenario.disk
    r, e = disk.radius, signed_eccentricity(disk, motion)
    B_bar = disk.inertia_about_cog[1]
    Omega_crit = sqrt((r + e) ** 2 / r * scenario.weight / B_bar)
    if e > 0.0:
        return CriticalSpeed(
            spin=Omega_crit, frequency=sqrt(e / (r + e)) * Omega_crit, kind="hopf"
        )
    return CriticalSpeed(spin=Omega_crit, frequency=0.0, kind="static" if e == 0.0 else "saddle")
