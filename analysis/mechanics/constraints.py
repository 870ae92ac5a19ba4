"""The constraints: directions in which they hold the disk, and how far a state is off them.

A constraint holds a velocity, which is linear in the velocity of the centre of gravity S and the
angular velocity. Its direction is that linear form; its multiplier acts along it, so that it is a
force in N, or a moment in N m for a rate of an angle, Eqs. (31), (84), (87) and (88).
"""

from typing import Any, NamedTuple

import numpy as np

from analysis.mechanics.attitude import EulerAngles, Frame, state_of
from analysis.mechanics.linear_algebra import NONE, Vector, cross, dot
from analysis.problem.constraints import DEMANDS, PRESCRIBED, ConstraintSet, multiplier_names
from analysis.problem.elementary import Numbers, cos, sin
from analysis.problem.scenario import Scenario
from analysis.problem.start import State

DEPENDENT = 1e-12
"""Part of what a constraint holds below which the others leave nothing of it."""

AXES: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Direction(NamedTuple):
    """A linear form of the velocity of S in axes of the frame and of the turning in the body's.

    What a constraint holds is the form over a scale: the form of the spin stays finite where the
    disk is nearly flat, and the spin does not.
    """

    linear: Vector
    turning: Vector
    scale: Any = 1.0

    def along(self, velocity: Vector, angular: Vector) -> Any:
        """The form of these velocities."""
        return dot(self.linear, velocity) + dot(self.turning, angular)


SLIPS: ConstraintSet = ("no-slip-along", "no-slip-across")
"""Constraints without which the disk slips along and across its edge."""


def at_point(point: Vector, frame: Frame) -> list[Direction]:
    """Directions in which a point of the body, seen from S, moves along the axes of the frame."""
    return [Direction(along, cross(point, axis)) for along, axis in zip(AXES, frame, strict=True)]


def contact_directions(body: Any, frame: Frame) -> list[Direction]:
    """Directions in which the lowest point moves along the axes of the frame R.

    The e_x of the frame lies in the round disk, so that its point, seen from S, is
    -r e_z x e_x - e x with axes of the body; the cross products with the axes of the frame are
    these.
    """
    if not body.is_round_disk:
        x, y, z = body.lowest_point(frame.up)
        return at_point((x - body.eccentricity, y, z), frame)
    r, e, (x, y, _) = body.radius, body.eccentricity, frame.ahead
    lever = r, 0.0, 0.0
    return [
        Direction(axis, (-(r * c * x), e * c - r * c * y, along - e * b))
        for axis, along, (_, b, c) in zip(AXES, lever, frame, strict=True)
    ]


def directions(constraints: ConstraintSet, disk: Any, angles: Numbers) -> list[Direction]:
    """Directions of the constraints of a set, in the order of their multipliers.

    Parameters
    ----------
    constraints : tuple of str
    disk : Disk
        Or what has its numbers, of any kind.
    angles : sequence of 3 numbers
        Euler angles in rad.
    """
    (_, beta, gamma), frame = angles, EulerAngles.frame(angles)
    ahead, across, up = contact_directions(disk, frame)
    every = {
        "normal_force": up,
        "cog_force_x": Direction(AXES[0], NONE),
        "cog_force_y": Direction(AXES[1], NONE),
        "tangential_force": ahead,
        "lateral_force": across,
        # Along it, the angular velocity is the rate of alpha times the scale.
        "spin_torque": Direction(NONE, (sin(gamma), cos(gamma), 0.0), sin(beta)),
        "tilt_torque": Direction(NONE, frame.ahead),
    }
    return [every[name] for name in multiplier_names(constraints)]


def position_residuals(constraints: ConstraintSet, disk: Any, state: Numbers) -> list[Any]:
    """Position-level residuals of Eqs. (66) and (83) in m, 1 or 3, from a state of `state_of`."""
    position, angles = state[:3], state[3:6]
    frame = EulerAngles.frame(angles)
    height = position[2] - disk.eccentricity * frame.up[0]
    if disk.is_round_disk:
        height += disk.radius * frame.across[2]
    else:
        height += dot(disk.lowest_point(frame.up), frame.up)
    return [height, *position[:2]] if "fixed-cog" in constraints else [height]


def velocity_residuals(constraints: ConstraintSet, disk: Any, state: Numbers) -> list[Any]:
    """Velocity-level residuals in m/s and held rates in rad/s, from a state of `state_of`.

    Those of `position_residuals` are their rates, seen from the turning frame.
    """
    moving = EulerAngles.moving(state)
    x, y, _ = moving.position
    turning = {"cog_force_x": moving.spin * y, "cog_force_y": -moving.spin * x}
    every = directions(constraints, disk, moving.attitude)
    return [
        each.along(moving.velocity, moving.angular) / each.scale + turning.get(name, 0.0)
        for name, each in zip(multiplier_names(constraints), every, strict=True)
    ]


def check_admissible(scenario: Scenario, state: State, tolerance: float = 1e-9) -> None:
    """Raise if `state` breaks a constraint of the scenario, or makes them depend on each other.

    A rate that is held is that of the state itself, so no state can break it.

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
        Naming the first broken constraint, its level and by how much it is broken; or where they
        are dependent.
    """
    held, disk = scenario.constraints, scenario.disk
    moving = state_of(disk, state.coordinates, state.rates)
    names, spin = multiplier_names(held), abs(state.rates[3])
    levels = (
        ("position", "m", position_residuals, tolerance),
        ("velocity", "m/s", velocity_residuals, tolerance * max(1.0, spin)),
    )
    for kind, unit, residuals, allowed in levels:
        for name, residual in zip(names, residuals(held, disk, moving), strict=False):
            if abs(residual) > allowed and name not in PRESCRIBED:
                raise ValueError(
                    f"start breaks '{DEMANDS[name]}' of {scenario.name} on {kind} level "
                    f"by {residual:.3e} {unit}, allowed is {allowed:.1e}"
                )
    rows = [
        (*each.linear, *(part / disk.radius for part in each.turning))
        for each in directions(held, disk, state.coordinates[3:])
    ]
    sizes = np.linalg.norm(rows, axis=1, keepdims=True)
    if np.min(np.linalg.svd(rows / sizes, compute_uv=False)) < DEPENDENT:
        beta, gamma = state.coordinates[4:]
        raise ValueError(
            f"start must be one where the constraints of {scenario.name} do not depend on each "
            f"other, as they do at beta = {beta:g} and gamma = {gamma:g} rad"
        )
