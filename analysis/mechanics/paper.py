"""The paper's equations of motion as they are printed, to be compared with the general ones.

Nothing is simulated with them. In the co-rotating coordinates, Eqs. (15)-(32),

M(z) z'' - h(z, z') = f + w_N lambda_N + W_T lambda_T with z = (x, y, z, alpha, beta, gamma),

with the constraints (66), (83), (84), (87), (88) on position and velocity level.

Notation as in the paper; s and c in front of a letter are its sine and cosine.
"""

from collections.abc import Sequence
from math import cos, sin

import numpy as np

from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.constraint_set import MULTIPLIERS, ConstraintSet, multiplier_names
from analysis.data.scenario import Scenario

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
    """Generalised gravitational force f, Eq. (30), shape (6,), on a level table."""
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


def _rows(constraints: ConstraintSet) -> list[int]:
    """Numbers of the rows of a set, in the order of `MULTIPLIERS`."""
    return [MULTIPLIERS.index(name) for name in multiplier_names(constraints)]
