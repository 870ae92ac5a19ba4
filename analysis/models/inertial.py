"""The equations of motion in the inertial coordinates, Appendix A, and the way between the two.

M(q) q'' - h(q, q') = f + w_N lambda_N + W_T lambda_T with q = (x, y, z, alpha, beta, gamma),
where x, y, z is the position of the geometric centre G in the inertial frame.

Notation as in the paper; s and c in front of a letter are its sine and cosine.
"""

from math import cos, sin

import numpy as np

from analysis.data.checks import Array
from analysis.data.disk import Disk
from analysis.data.table import Table
from analysis.models import equations
from analysis.models.equations import Vector, normal_direction


def mass_matrix(disk: Disk, q: Vector) -> Array:
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


def gyroscopic_forces(disk: Disk, q: Vector, u: Vector) -> Array:
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


def gravity_forces(disk: Disk, table: Table, q: Vector) -> Array:
    """Generalised gravitational force, Eq. (142), shape (6,); on a leaning table, too."""
    force = equations.gravity_forces(disk, table, (0.0, 0.0, *q[2:]))
    force[:2] = disk.mass * np.array(table.vector[:2])
    return force


def tangential_directions(disk: Disk, q: Vector) -> Array:
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


__all__ = [
    "gravity_forces",
    "gyroscopic_forces",
    "mass_matrix",
    "normal_direction",
    "rate_matrix",
    "tangential_directions",
]
