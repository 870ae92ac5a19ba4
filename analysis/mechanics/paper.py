"""The paper's equations of motion as they are printed, to be compared with the general ones.

Nothing is simulated with them. In the co-rotating coordinates, Eqs. (15)-(32),

M(z) z'' - h(z, z') = f + w_N lambda_N + W_T lambda_T with z = (x, y, z, alpha, beta, gamma),

with the constraints (66), (83), (84), (87), (88) on position, velocity and acceleration level,
which together are the systems of index 1, (79), (80), (92). Appendix A has the same in inertial
coordinates q = (x, y, z, alpha, beta, gamma), the position of G in the inertial frame.

Notation as in the paper; s and c in front of a letter are its sine and cosine.
"""

from collections.abc import Sequence
from math import cos, sin

import numpy as np

from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.constraints import MULTIPLIERS, ConstraintSet, multiplier_names
from analysis.problem.scenario import Scenario

Vector = Sequence[float] | Array


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
    """Gyroscopic vector h, Eqs. (23)-(30), shape (6,).

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
    """Generalised gravitational force f, Eqs. (30) and (142), shape (6,), on a level table.

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
    """Generalised direction w_N of the normal contact force, Eq. (31), shape (6,)."""
    return np.array((0.0, 0.0, 1.0, 0.0, -disk.radius * cos(z[4]), 0.0))


def tangential_directions(disk: Body, z: Vector) -> Array:
    """Generalised directions W_T = [w_x, w_y] of the friction force, Eq. (32), shape (6, 2).

    The slip velocity of the contact point in the R-frame is W_T^T u.
    """
    r, x, y, beta = disk.radius, z[0], z[1], z[4]
    return np.array(
        (
            (1.0, 0.0),
            (0.0, 1.0),
            (0.0, 0.0),
            (r * cos(beta) - y, x),
            (0.0, r * sin(beta)),
            (r, 0.0),
        )
    )


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
    r, e = disk.radius, disk.eccentricity
    x, y, beta, gamma = z[0], z[1], z[4], z[5]
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    every = (
        (0.0, 0.0, 1.0, 0.0, -r * cb, 0.0),
        (1.0, 0.0, 0.0, 0.0, 0.0, -e * sg),
        (0.0, 1.0, 0.0, 0.0, -e * sb * sg, e * cb * cg),
        (1.0, 0.0, 0.0, r * cb - y, 0.0, r),
        (0.0, 1.0, 0.0, x, r * sb, 0.0),
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
    """Generalised directions W_T of the friction force, Eq. (143), shape (6, 2)."""
    r, alpha, beta = disk.radius, q[3], q[4]
    sa, ca, sb, cb = sin(alpha), cos(alpha), sin(beta), cos(beta)
    return np.array(
        (
            (1.0, 0.0),
            (0.0, 1.0),
            (0.0, 0.0),
            (r * ca * cb, r * sa * cb),
            (-r * sa * sb, r * ca * sb),
            (r * ca, r * sa),
        )
    )


def rate_matrix(z: Vector) -> Array:
    """Matrix B(z) of Eq. (12), shape (6, 6): inertial rates are B(z) times co-rotating rates."""
    x, y, alpha = z[0], z[1], z[3]
    sa, ca = sin(alpha), cos(alpha)
    B = np.eye(6)
    B[:2, :2] = ((ca, -sa), (sa, ca))
    B[:2, 3] = (-sa * x - ca * y, ca * x - sa * y)
    return B
