"""The paper's equations as they are printed, with their numbers, and its closed forms.

Nothing is simulated with them; the general equations are compared with them, and the misprints
come from there. In the co-rotating coordinates, Eqs. (15)-(32),

M(z) z'' - h(z, z') = f + w_N lambda_N + W_T lambda_T with z = (x, y, z, alpha, beta, gamma),

with the constraints (66), (83), (85), (87), (89), (90) on position, velocity and acceleration
level, which together are the systems of index 1, (79), (80), (92). Appendix A has the same in
inertial coordinates q = (x, y, z, alpha, beta, gamma), the position of G in the inertial frame.

The linear full system, Eqs. (48)-(55), is M z'' + (D + G) z' + (K + N) z = 0 with z = (x, y,
beta - pi/2, gamma -+ pi/2). The linear reduced system, Eqs. (111), (112), has the states (beta -
pi/2, gamma -+ pi/2, beta'); p(lambda) = (a - lambda)(lambda² + b lambda + c) is its characteristic
polynomial, and B_bar = B - m e². Turning the body frame by pi about its z axis swaps inverted and
noninverted spinning and the sign of the eccentricity and changes nothing else, so noninverted
spinning has the same equations with -e. The reduced system itself, Eqs. (93)-(110), is that of
`reduced`.

Notation as in the paper; s and c in front of a letter are its sine and cosine.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, sin, sqrt
from typing import Literal

import numpy as np
import numpy.typing as npt

from analysis.problem.body import Body
from analysis.problem.checks import Array, choice, spin_array
from analysis.problem.constraints import MULTIPLIERS, ConstraintSet, multiplier_names
from analysis.problem.scenario import Scenario, require_plain
from analysis.problem.start import MOTIONS, Motion

Vector = Sequence[float] | Array

# --- Equations of motion in co-rotating coordinates ---------------------------------------------


def mass_matrix(disk: Body, z: Vector) -> Array:
    """Mass matrix, Eqs. (16)-(22), shape (6, 6).

    Parameters
    ----------
    disk : Body
    z : array_like, shape (6,)
        Co-rotating coordinates in m and rad.
    """
    m, me = disk.mass, disk.mass * disk.eccentricity
    A, B, C = disk.inertia_x, disk.inertia_y, disk.inertia_z
    x, y, _, _, beta, gamma = z
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    m14, m24 = -m * y - me * cb * sg, m * x + me * cg
    m16, m25, m26 = -me * sg, -me * sb * sg, me * cb * cg
    m35, m36 = me * cb * sg, me * sb * cg
    m44 = (
        m * (x * x + y * y)
        + 2 * me * (x * cg + y * cb * sg)
        + (A * sg * sg + B * cg * cg) * sb * sb
        + C * cb * cb
    )
    m45 = (A - B) * sb * sg * cg - me * x * sb * sg
    m46 = me * x * cb * cg + me * y * sg + C * cb
    m55 = A * cg * cg + B * sg * sg
    return np.array(
        (
            (m, 0.0, 0.0, m14, 0.0, m16),
            (0.0, m, 0.0, m24, m25, m26),
            (0.0, 0.0, m, 0.0, m35, m36),
            (m14, m24, 0.0, m44, m45, m46),
            (0.0, m25, m35, m45, m55, 0.0),
            (m16, m26, m36, m46, 0.0, C),
        )
    )


def gyroscopic_forces(disk: Body, z: Vector, u: Vector) -> Array:
    """Gyroscopic vector h, Eqs. (23)-(29), shape (6,).

    Parameters
    ----------
    disk : Body
    z, u : array_like, shape (6,)
        Co-rotating coordinates and their rates.
    """
    m, me = disk.mass, disk.mass * disk.eccentricity
    A, B, C = disk.inertia_x, disk.inertia_y, disk.inertia_z
    x, y, _, _, beta, gamma = z
    xd, yd, _, ad, bd, gd = u
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    aa, bb, gg, c2g = ad * ad, bd * bd, gd * gd, cg * cg - sg * sg
    AB, across = A - B, A * sg * sg + B * cg * cg
    coriolis_x, coriolis_y = 2 * xd * ad - y * aa, 2 * yd * ad + x * aa
    h1 = m * coriolis_y + me * ((aa + gg) * cg - 2 * ad * bd * sb * sg + 2 * ad * gd * cb * cg)
    h2 = -m * coriolis_x + me * (
        (aa + bb + gg) * cb * sg + 2 * ad * gd * sg + 2 * bd * gd * sb * cg
    )
    h3 = me * ((bb + gg) * sb * sg - 2 * bd * gd * cb * cg)
    h4 = (
        -2 * m * (x * xd + y * yd) * ad
        - me * (2 * xd * ad * cg + (2 * yd * ad - x * bb - x * gg) * cb * sg)
        + me * (2 * x * ad * gd * sg + 2 * x * bd * gd * sb * cg - y * gg * cg)
        + 2 * me * y * ad * (bd * sb * sg - gd * cb * cg)
        - AB * (bb * cb * sg * cg + 2 * ad * gd * sb * sb * sg * cg + bd * gd * sb * c2g)
        - 2 * (across - C) * ad * bd * sb * cb
        + C * bd * gd * sb
    )
    h5 = (
        me * coriolis_x * sb * sg
        + AB * (2 * bd * gd * sg * cg - ad * gd * sb * c2g)
        + (across - C) * aa * sb * cb
        - C * ad * gd * sb
    )
    h6 = (
        -me * coriolis_y * sg
        - me * coriolis_x * cb * cg
        + AB * ((aa * sb * sb - bb) * sg * cg + ad * bd * c2g * sb)
        + C * ad * bd * sb
    )
    return np.array((h1, h2, h3, h4, h5, h6))


def gravity_forces(scenario: Scenario, z: Vector) -> Array:
    """Generalised gravitational force f, Eq. (30), shape (6,), on a level table.

    Parameters
    ----------
    scenario : Scenario
    z : array_like, shape (6,)
        Co-rotating or inertial coordinates.
    """
    weight, e, beta, gamma = scenario.weight, scenario.disk.eccentricity, z[4], z[5]
    f5, f6 = -weight * e * cos(beta) * sin(gamma), -weight * e * sin(beta) * cos(gamma)
    return np.array((0.0, 0.0, -weight, 0.0, f5, f6))


def normal_direction(disk: Body, z: Vector) -> Array:
    """Generalised direction w_N of the normal contact force, Eqs. (31) and (142), shape (6,)."""
    return np.array((0.0, 0.0, 1.0, 0.0, -disk.radius * cos(z[4]), 0.0))


def tangential_directions(disk: Body, z: Vector) -> Array:
    """Generalised directions W_T = [w_x, w_y] of the friction force, Eq. (32), shape (6, 2).

    The slip velocity of the contact point in the R-frame is W_T^T u.
    """
    r, x, y, beta = disk.radius, z[0], z[1], z[4]
    w_x = (1.0, 0.0, 0.0, r * cos(beta) - y, 0.0, r)
    w_y = (0.0, 1.0, 0.0, x, r * sin(beta), 0.0)
    return np.column_stack((w_x, w_y))


def constraint_positions(constraints: ConstraintSet, disk: Body, z: Vector) -> Array:
    """Position-level residuals of Eqs. (66) and (83) in m, shape (1,) or (3,)."""
    r, e = disk.radius, disk.eccentricity
    x, y, height, _, beta, gamma = z
    every = (height - r * sin(beta), x + e * cos(gamma), y + e * cos(beta) * sin(gamma))
    return np.array([every[row] for row in _rows(constraints) if row < len(every)])


def constraint_directions(constraints: ConstraintSet, disk: Body, z: Vector) -> Array:
    """Matrix W^T of Eqs. (31), (84), (87) and (88), shape (n, 6).

    Velocity-level residuals are W^T u, less the prescribed spin in the row of a constant spin.
    """
    e, beta, gamma = disk.eccentricity, z[4], z[5]
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    every = (
        normal_direction(disk, z),
        (1.0, 0.0, 0.0, 0.0, 0.0, -e * sg),
        (0.0, 1.0, 0.0, 0.0, -e * sb * sg, e * cb * cg),
        *tangential_directions(disk, z).T,
        (0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
    )
    return np.array([every[row] for row in _rows(constraints)])


def constraint_changes(constraints: ConstraintSet, disk: Body, z: Vector, u: Vector) -> Array:
    """Terms chi = (d/dt W^T) u of the acceleration-level constraints, Eq. (59), shape (n,)."""
    r, e = disk.radius, disk.eccentricity
    beta, gamma = z[4], z[5]
    xd, yd, _, ad, bd, gd = u
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    every = (
        r * sb * bd * bd,
        -e * cg * gd * gd,
        -e * (cb * sg * (bd * bd + gd * gd) + 2 * sb * cg * bd * gd),
        -(r * sb * bd + yd) * ad,
        xd * ad + r * cb * bd * bd,
        0.0,
    )
    return np.array([every[row] for row in _rows(constraints)])


def _rows(constraints: ConstraintSet) -> list[int]:
    """Numbers of the rows of a set, in the order of `MULTIPLIERS`."""
    return [MULTIPLIERS.index(name) for name in multiplier_names(constraints)]


# --- Appendix A: the same in inertial coordinates -----------------------------------------------


def inertial_mass_matrix(disk: Body, q: Vector) -> Array:
    """Mass matrix, Eq. (134), shape (6, 6), from inertial coordinates `q`, shape (6,)."""
    m, me = disk.mass, disk.mass * disk.eccentricity
    A, B, C = disk.inertia_x, disk.inertia_y, disk.inertia_z
    _, _, _, alpha, beta, gamma = q
    sa, ca = sin(alpha), cos(alpha)
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    M12 = me * np.array(
        (
            (-ca * cb * sg - sa * cg, sa * sb * sg, -ca * sg - sa * cb * cg),
            (-sa * cb * sg + ca * cg, -ca * sb * sg, -sa * sg + ca * cb * cg),
            (0.0, cb * sg, sb * cg),
        )
    )
    m45 = (A - B) * sb * sg * cg
    M22 = np.array(
        (
            ((A * sg * sg + B * cg * cg) * sb * sb + C * cb * cb, m45, C * cb),
            (m45, A * cg * cg + B * sg * sg, 0.0),
            (C * cb, 0.0, C),
        )
    )
    return np.block([[m * np.eye(3), M12], [M12.T, M22]])


def inertial_gyroscopic_forces(disk: Body, q: Vector, u: Vector) -> Array:
    """Gyroscopic vector h, Eqs. (135)-(141), shape (6,), from `q` and its rates `u`."""
    me = disk.mass * disk.eccentricity
    A, B, C = disk.inertia_x, disk.inertia_y, disk.inertia_z
    _, _, _, alpha, beta, gamma = q
    _, _, _, ad, bd, gd = u
    sa, ca = sin(alpha), cos(alpha)
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    aa, bb, gg, c2g = ad * ad, bd * bd, gd * gd, cg * cg - sg * sg
    across = A * sg * sg + B * cg * cg
    h1 = me * (
        (aa + gg) * (ca * cg - sa * cb * sg)
        - bb * sa * cb * sg
        - 2 * ad * bd * ca * sb * sg
        - 2 * ad * gd * (sa * sg - ca * cb * cg)
        - 2 * bd * gd * sa * sb * cg
    )
    h2 = me * (
        (aa + gg) * (sa * cg + ca * cb * sg)
        + bb * ca * cb * sg
        - 2 * ad * bd * sa * sb * sg
        + 2 * ad * gd * (ca * sg + sa * cb * cg)
        + 2 * bd * gd * ca * sb * cg
    )
    h3 = me * ((bb + gg) * sb * sg - 2 * bd * gd * cb * cg)
    h4 = (
        -bb * (A - B) * cb * sg * cg
        - 2 * ad * bd * (across - C) * sb * cb
        - 2 * ad * gd * (A - B) * sb * sb * sg * cg
        - bd * gd * sb * ((A - B) * c2g - C)
    )
    h5 = (
        aa * sb * cb * (across - C)
        - ad * gd * sb * ((A - B) * c2g + C)
        + 2 * bd * gd * (A - B) * sg * cg
    )
    h6 = (
        aa * (A - B) * sb * sb * sg * cg
        - bb * sg * cg * (A - B)
        + ad * bd * sb * ((A - B) * c2g + C)
    )
    return np.array((h1, h2, h3, h4, h5, h6))


def inertial_tangential_directions(disk: Body, q: Vector) -> Array:
    """Generalised directions W_T = [w_x, w_y] of the friction force, Eq. (143), shape (6, 2)."""
    r, alpha, beta = disk.radius, q[3], q[4]
    sa, ca, sb, cb = sin(alpha), cos(alpha), sin(beta), cos(beta)
    w_x = (1.0, 0.0, 0.0, r * ca * cb, -r * sa * sb, r * ca)
    w_y = (0.0, 1.0, 0.0, r * sa * cb, r * ca * sb, r * sa)
    return np.column_stack((w_x, w_y))


def rate_matrix(z: Vector) -> Array:
    """Matrix B(z) of Eq. (12), shape (6, 6): inertial rates are B(z) times co-rotating rates."""
    x, y, alpha = z[0], z[1], z[3]
    sa, ca = sin(alpha), cos(alpha)
    B = np.eye(6)
    B[:2, :2] = ((ca, -sa), (sa, ca))
    B[:2, 3] = (-sa * x - ca * y, ca * x - sa * y)
    return B


# --- The linear full system ---------------------------------------------------------------------


def paper_numbers(scenario: Scenario, motion: Motion = "inverted") -> dict[str, float]:
    """Numbers of `printed_matrices` by the paper's names, of a scenario and a motion.

    The eccentricity is the height of S above G: +e for inverted, -e for noninverted spinning.

    Raises
    ------
    ValueError
        If the motion is unknown.
    """
    choice("motion", motion, MOTIONS)
    disk = scenario.disk
    return {
        "m": disk.mass,
        "r": disk.radius,
        "e": disk.eccentricity if motion == "inverted" else -disk.eccentricity,
        "A": disk.inertia_x,
        "B": disk.inertia_y,
        "C": disk.inertia_z,
        "mg": scenario.weight,
    }


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


def first_order(printed: Mapping[str, Array], spins: npt.ArrayLike, d: npt.ArrayLike) -> Array:
    """Eq. (55): state matrices in (z, z'), shape (n, 8, 8), with a friction force d in N s/m.

    That is one for all spins, or one for each.
    """
    M, G_h, K_h, K_f, D_C, B_C = printed.values()
    Omega, d = np.reshape(spins, (-1, 1, 1)), np.reshape(d, (-1, 1, 1))
    result = np.zeros((Omega.size, 8, 8))
    result[:, :4, 4:] = np.eye(4)
    result[:, 4:, :4] = -np.linalg.solve(M, Omega**2 * K_h + K_f + d * Omega * B_C)
    result[:, 4:, 4:] = -np.linalg.solve(M, d * D_C + Omega * G_h)
    return result


# --- The linear reduced system ------------------------------------------------------------------


def reduced_matrices(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> Array:
    """State matrices of the reduced system, Eqs. (111), (112), shape (n, 3, 3).

    Parameters
    ----------
    scenario : Scenario
        Its constraints are not looked at.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}
    """
    m, r, e, _, B, _, mg = paper_numbers(scenario, motion).values()
    Omega, stiffness = np.atleast_1d(spins), mg / (B - m * e**2)
    d = scenario.friction.gradient * stiffness
    A = np.zeros((Omega.size, 3, 3))
    A[:, 0, 2] = 1.0
    A[:, 1, 0] = Omega
    A[:, 2, 0] = stiffness * (r + e) - Omega**2
    A[:, 2, 1] = -d * e * (r + e) * Omega
    A[:, 2, 2] = -d * (r + e) ** 2
    return A


def closed_form(
    scenario: Scenario, spins: npt.ArrayLike, motion: Motion = "inverted"
) -> npt.NDArray[np.complex128]:
    """Eigenvalues in closed form for small smoothing in 1/s, shape (n, 3), Eqs. (113)-(123).

    lambda_1 and lambda_2 are those of Eq. (123), and the real lambda_3 is its limit, Eq. (122),
    the same at all spins.

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
    if not scenario.friction_gradient > 0.0:
        raise ValueError("friction must have a positive gradient for the closed form, got 0")
    Omega = spin_array(spins)
    _, r, e, *_ = paper_numbers(scenario, motion).values()
    A = reduced_matrices(scenario, Omega, motion)
    # Eqs. (119), (120) and (121), of the factors in Eq. (114)
    a, c = A[:, 2, 2], e / (r + e) * Omega**2
    b = (A[:, 2, 0] + c) / a
    root = np.sqrt((b**2 - 4 * c).astype(complex))
    return np.column_stack(((-b + root) / 2, (-b - root) / 2, a))


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
    on the smoothing: Eq. (129) contains them as a common factor, and Eq. (130) not at all.

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
