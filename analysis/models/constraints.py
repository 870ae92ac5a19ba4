"""The constraints of Table 2, and no lateral slip, on position, velocity and acceleration level.

Rows are in the order of `analysis.MULTIPLIERS`: contact g_N, horizontally fixed centre of
gravity g_S (two rows), no tangential slip gamma_x, no lateral slip gamma_y, constant spinning
speed gamma_alpha. The slip constraints are nonholonomic, and the last one is used on velocity
level, so none of them has a position-level row.
"""

from functools import cache
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.constraint_set import (
    MULTIPLIERS,
    PRESCRIBED,
    ConstraintSet,
    multiplier_names,
)
from analysis.data.disk import Disk
from analysis.data.elementary import cos, sin
from analysis.data.scenario import Scenario
from analysis.data.state import State
from analysis.models.equations import Vector

LABELS = {
    "normal_force": "contact g_N = z - r sin(beta) = 0",
    "cog_force_x": "fixed centre of gravity g_Sx = x + e cos(gamma) = 0",
    "cog_force_y": "fixed centre of gravity g_Sy = y + e cos(beta) sin(gamma) = 0",
    "tangential_force": "no tangential slip gamma_x = 0",
    "lateral_force": "no lateral slip gamma_y = 0",
    "spin_torque": "constant spin gamma_alpha = 0",
}
"""What each constraint demands, by the name of its multiplier."""


_POSITIONAL = 3
"""Number of rows that have a position level, the first ones of `MULTIPLIERS`."""


@cache
def rows(constraints: ConstraintSet) -> list[int]:
    """Numbers of the rows of a set, among those of all constraints."""
    return [MULTIPLIERS.index(name) for name in multiplier_names(constraints)]


def positions(constraints: ConstraintSet, disk: Disk, z: Vector) -> Array:
    """Position-level residuals of Eqs. (66) and (83) in m, shape (1,) or (3,)."""
    return np.array(position_rows(constraints, disk, z))


def position_rows(constraints: ConstraintSet, disk: Disk, z: Vector) -> list[float]:
    """The rows of `positions`, of numbers of any kind."""
    r, e = disk.radius, disk.eccentricity
    x, y, height, _, beta, gamma = z
    every = (
        height - r * sin(beta),
        x + e * cos(gamma),
        y + e * cos(beta) * sin(gamma),
    )
    return [every[row] for row in rows(constraints) if row < _POSITIONAL]


def directions(constraints: ConstraintSet, disk: Disk, z: Vector) -> Array:
    """Matrix W^T of Eqs. (31), (84), (87) and (88), shape (n, 6).

    Velocity-level residuals are W^T u, less the prescribed spin in the row of a constant spin.
    """
    return np.array(direction_rows(constraints, disk, z))


def direction_rows(constraints: ConstraintSet, disk: Disk, z: Vector) -> list[tuple[float, ...]]:
    """The rows of `directions`, of numbers of any kind."""
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
    return [every[row] for row in rows(constraints)]


def acceleration_terms(constraints: ConstraintSet, disk: Disk, z: Vector, u: Vector) -> Array:
    """Terms chi = (d/dt W^T) u of the acceleration-level constraints, Eq. (59), shape (n,)."""
    return np.array(acceleration_rows(constraints, disk, z, u))


def acceleration_rows(constraints: ConstraintSet, disk: Disk, z: Vector, u: Vector) -> list[Any]:
    """The rows of `acceleration_terms`, of numbers of any kind."""
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
    return [every[row] for row in rows(constraints)]


def check_admissible(scenario: Scenario, state: State, tolerance: float = 1e-9) -> None:
    """Raise if `state` breaks a constraint of the scenario.

    A constant spin is that of the state itself, so no state can break it.

    Parameters
    ----------
    scenario : Scenario
    state : State
    tolerance : float
        Largest residual let through, in m on position level; on velocity level in m/s for a spin
        of up to 1 rad/s, growing with it.

    Raises
    ------
    ValueError
        Naming the first broken constraint, its level and by how much it is broken.
    """
    constraints, disk = scenario.constraints, scenario.disk
    names = multiplier_names(constraints)
    velocities = [
        sum(part * rate for part, rate in zip(row, state.rates, strict=True))
        for row in direction_rows(constraints, disk, state.coordinates)
    ]
    checks = (
        ("position", "m", position_rows(constraints, disk, state.coordinates), tolerance),
        ("velocity", "m/s", velocities, tolerance * max(1.0, abs(state.rates[3]))),
    )
    for kind, unit, residuals, allowed in checks:
        for name, residual in zip(names, residuals, strict=False):
            if abs(residual) > allowed and name not in PRESCRIBED:
                raise ValueError(
                    f"start breaks '{LABELS[name]}' of {scenario.name} on {kind} level "
                    f"by {residual:.3e} {unit}, allowed is {allowed:.1e}"
                )
