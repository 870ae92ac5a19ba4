"""The equations of motion in the co-rotating coordinates, Eqs. (15)-(32).

M(z) z'' - h(z, z') = f + w_N lambda_N + W_T lambda_T with z = (x, y, z, alpha, beta, gamma).

Notation as in the paper; s and c in front of a letter are its sine and cosine.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.disk import Disk
from analysis.data.elementary import cos, sin
from analysis.data.table import Table

Vector = Sequence[float] | Array


def mass_matrix(disk: Disk, z: Vector) -> Array:
    """Mass matrix, Eqs. (16)-(22), shape (6, 6).

    Parameters
    ----------
    disk : Disk
    z : array_like, shape (6,)
        Co-rotating coordinates in m and rad.
    """
    return np.array(mass_rows(disk, z))


def mass_rows(disk: Disk, z: Vector) -> tuple[tuple[Any, ...], ...]:
    """The rows of `mass_matrix`, of numbers of any kind."""
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
    return (
        (m, 0.0, 0.0, m14, 0.0, m16),
        (0.0, m, 0.0, m24, m25, m26),
        (0.0, 0.0, m, 0.0, m35, m36),
        (m14, m24, 0.0, m44, m45, m46),
        (0.0, m25, m35, m45, m55, 0.0),
        (m16, m26, m36, m46, 0.0, C),
    )


def gyroscopic_forces(disk: Disk, z: Vector, u: Vector) -> Array:
    """Gyroscopic vector h, Eqs. (23)-(30), shape (6,).

    Parameters
    ----------
    disk : Disk
    z, u : array_like, shape (6,)
        Co-rotating coordinates and their rates.
    """
    return np.array(gyroscopic_rows(disk, z, u))


def gyroscopic_rows(disk: Disk, z: Vector, u: Vector) -> tuple[Any, ...]:
    """The rows of `gyroscopic_forces`, of numbers of any kind."""
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
    return h1, h2, h3, h4, h5, h6


def gravity_forces(disk: Disk, table: Table, z: Vector) -> Array:
    """Generalised gravitational force f, Eq. (30), shape (6,); on a leaning table, too.

    Parameters
    ----------
    disk : Disk
    table : Table
    z : array_like, shape (6,)
        Co-rotating coordinates.
    """
    return np.array(gravity_rows(disk, table, z))


def gravity_rows(disk: Disk, table: Table, z: Vector) -> tuple[Any, ...]:
    """The rows of `gravity_forces`, of numbers of any kind."""
    x, y, _, alpha, beta, gamma = z
    m, e = disk.mass, disk.eccentricity
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    weight = m * table.pressing
    f5, f6 = -weight * e * cb * sg, -weight * e * sb * cg
    if table.is_horizontal:
        return 0.0, 0.0, -weight, 0.0, f5, f6
    # Gravity along the table in axes of the R-frame; it acts at S = (x + e cg, y + e cb sg).
    gx, gy, _ = table.vector
    sa, ca = sin(alpha), cos(alpha)
    fx, fy = m * (ca * gx + sa * gy), m * (ca * gy - sa * gx)
    f4 = (x + e * cg) * fy - (y + e * cb * sg) * fx
    f5 -= e * sb * sg * fy
    f6 += e * (cb * cg * fy - sg * fx)
    return fx, fy, -weight, f4, f5, f6


def normal_direction(disk: Disk, z: Vector) -> Array:
    """Generalised direction w_N of the normal contact force, Eq. (31), shape (6,)."""
    return np.array((0.0, 0.0, 1.0, 0.0, -disk.radius * cos(z[4]), 0.0))


def tangential_directions(disk: Disk, z: Vector) -> Array:
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
