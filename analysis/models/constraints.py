"""The constraints of Table 2 on position, velocity and acceleration level.

Rows are in the order of `analysis.MULTIPLIERS`: contact g_N, horizontally fixed centre of
gravity g_S (two rows), no tangential slip gamma_x, constant spinning speed gamma_alpha. The slip
constraint is nonholonomic, and the last one is used on velocity level, so neither has a
position-level row.
"""

from math import cos, sin

import numpy as np

from analysis.data.checks import Array
from analysis.data.disk import Disk
from analysis.data.state import Level, State, multiplier_names
from analysis.models.equations import Vector

LABELS = {
    "normal_force": "contact g_N = z - r sin(beta) = 0",
    "cog_force_x": "fixed centre of gravity g_Sx = x + e cos(gamma) = 0",
    "cog_force_y": "fixed centre of gravity g_Sy = y + e cos(beta) sin(gamma) = 0",
    "tangential_force": "no tangential slip gamma_x = 0",
    "spin_torque": "constant spin gamma_alpha = 0",
}
"""What each constraint demands, by the name of its multiplier."""


def positions(level: Level, disk: Disk, z: Vector) -> Array:
    """Position-level residuals of Eqs. (66) and (83) in m, shape (1,) or (3,)."""
    r, e = disk.radius, disk.eccentricity
    x, y, height, _, beta, gamma = z
    rows = (
        height - r * sin(beta),
        x + e * cos(gamma),
        y + e * cos(beta) * sin(gamma),
    )
    return np.array(rows[: min(len(multiplier_names(level)), 3)])


def directions(level: Level, disk: Disk, z: Vector) -> Array:
    """Matrix W^T of Eqs. (31), (84), (87) and (88), shape (n, 6).

    Velocity-level residuals are W^T u, less the prescribed spin in the last row of Model 4.
    """
    r, e = disk.radius, disk.eccentricity
    y, beta, gamma = z[1], z[4], z[5]
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    rows = (
        (0.0, 0.0, 1.0, 0.0, -r * cb, 0.0),
        (1.0, 0.0, 0.0, 0.0, 0.0, -e * sg),
        (0.0, 1.0, 0.0, 0.0, -e * sb * sg, e * cb * cg),
        (1.0, 0.0, 0.0, r * cb - y, 0.0, r),
        (0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
    )
    return np.array(rows[: len(multiplier_names(level))])


def acceleration_terms(level: Level, disk: Disk, z: Vector, u: Vector) -> Array:
    """Terms chi = (d/dt W^T) u of the acceleration-level constraints, Eq. (59), shape (n,)."""
    r, e = disk.radius, disk.eccentricity
    beta, gamma = z[4], z[5]
    _, yd, _, ad, bd, gd = u
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    rows = (
        r * sb * bd * bd,
        -e * cg * gd * gd,
        -e * (cb * sg * (bd * bd + gd * gd) + 2 * sb * cg * bd * gd),
        -(r * sb * bd + yd) * ad,
        0.0,
    )
    return np.array(rows[: len(multiplier_names(level))])


def check_admissible(level: Level, disk: Disk, state: State, tolerance: float = 1e-9) -> None:
    """Raise if `state` breaks a constraint of Model `level`.

    The constant spin of Model 4 is that of the state itself, so no state can break it.

    Parameters
    ----------
    level : {1, 2, 3, 4}
    disk : Disk
    state : State
    tolerance : float
        Largest residual let through, in m on position level; on velocity level in m/s for a spin
        of up to 1 rad/s, growing with it.

    Raises
    ------
    ValueError
        Naming the first broken constraint, its level and by how much it is broken.
    """
    names = multiplier_names(level)
    velocities = directions(level, disk, state.coordinates) @ np.array(state.rates)
    checks = (
        ("position", "m", positions(level, disk, state.coordinates), tolerance),
        ("velocity", "m/s", velocities[:4], tolerance * max(1.0, abs(state.rates[3]))),
    )
    for kind, unit, residuals, allowed in checks:
        for name, residual in zip(names, residuals, strict=False):
            if abs(residual) > allowed:
                raise ValueError(
                    f"start breaks '{LABELS[name]}' of Model {level} on {kind} level "
                    f"by {residual:.3e} {unit}, allowed is {allowed:.1e}"
                )
