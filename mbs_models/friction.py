"""The paper's friction law, Eq. (3), as force functions for engine items.

The engine calls these functions some ten thousand times a simulated second, so they work on
plain floats.
"""

from collections.abc import Callable
from math import cos, hypot, sin
from typing import Any

import exudyn as exu

from mbs_models.scene import Scene

Limit = Callable[[Any], float]
"""From the engine's system to the largest friction force: coefficient times load."""


def friction_limit(scene: Scene, contact: list[int]) -> Limit:
    """Largest friction force in N, constant or from the contact joint's multiplier.

    Parameters
    ----------
    scene : Scene
    contact : list of int
        Holds the object number of the contact joint once that is built; read at run time.
    """
    coefficient = scene.friction.coefficient
    if scene.friction.load == "weight":
        limit = coefficient * scene.disk.weight
        return lambda _system: limit
    force = exu.OutputVariableType.ForceLocal

    def from_contact(system: Any) -> float:
        # The multiplier of the present Newton iterate: the converged step has no lag.
        return float(coefficient * system.GetObjectOutput(contact[0], force)[2])

    return from_contact


def contact_tree_force(scene: Scene, limit: Limit) -> Callable[..., list[float]]:
    """Generalised friction force on the joints (alpha, x_C, y_C, beta, gamma) of a contact tree.

    The contact point has no velocity relative to the joints before gamma other than their own,
    so the slip velocity is that of the contact point plus the rim speed r gamma'.
    """
    r, smoothing = scene.disk.radius, scene.friction.smoothing

    def force(system: Any, _t: float, _item: int, q: Any, u: Any) -> list[float]:
        x, y = q[1], q[2]
        spin = u[0]
        slip_x = u[1] - y * spin + r * u[4]
        slip_y = u[2] + x * spin
        factor = -limit(system) / (hypot(slip_x, slip_y) + smoothing)
        fx, fy = factor * slip_x, factor * slip_y
        return [x * fy - y * fx, fx, fy, 0.0, r * fx]

    return force


def euler_tree_force(scene: Scene, limit: Limit) -> Callable[..., list[float]]:
    """Generalised friction force on the joints (alpha, x, y, z, beta, gamma) of an Euler tree."""
    r, smoothing = scene.disk.radius, scene.friction.smoothing

    def sliding(system: Any, _t: float, _item: int, q: Any, u: Any) -> list[float]:
        sb, arm, x = sin(q[4]), r * cos(q[4]) - q[2], q[1]
        slip_x = u[1] + arm * u[0] + r * u[5]
        slip_y = u[2] + x * u[0] + r * sb * u[4]
        factor = -limit(system) / (hypot(slip_x, slip_y) + smoothing)
        fx, fy = factor * slip_x, factor * slip_y
        return [arm * fx + x * fy, fx, fy, 0.0, r * sb * fy, r * fx]

    def lateral(system: Any, _t: float, _item: int, q: Any, u: Any) -> list[float]:
        sb, x = sin(q[4]), q[1]
        slip_y = u[2] + x * u[0] + r * sb * u[4]
        fy = -limit(system) * slip_y / (abs(slip_y) + smoothing)
        return [x * fy, 0.0, fy, 0.0, r * sb * fy, 0.0]

    return sliding if scene.level <= 2 else lateral


def connector_force(scene: Scene, limit: Limit) -> Callable[..., list[float]]:
    """Force and torque of a connector between the table and the disk's centre.

    The table's marker is turned so that its x axis points up (`UPWARD`). The disk's attitude then
    comes as Tait-Bryan angles whose first turns the disk's axis about the vertical and whose
    second is its elevation; they are regular unless the disk lies flat. The connector wants the
    force on the table.
    """
    r, smoothing = scene.disk.radius, scene.friction.smoothing
    rolls = scene.level >= 3

    def force(
        system: Any,
        _t: float,
        _item: int,
        _displacement: Any,
        rotation: Any,
        velocity: Any,
        angular: Any,
        *_unused: Any,
    ) -> list[float]:
        turn, elevation = rotation[0], rotation[1]
        n1, n2 = -sin(turn), cos(turn)
        rise = r * sin(elevation)
        c0, c1, c2 = -r * cos(elevation), rise * n1, rise * n2
        slip_1 = velocity[1] + angular[2] * c0 - angular[0] * c2
        slip_2 = velocity[2] + angular[0] * c1 - angular[1] * c0
        if rolls:
            lateral = slip_1 * n1 + slip_2 * n2
            slip_1, slip_2 = lateral * n1, lateral * n2
        factor = limit(system) / (hypot(slip_1, slip_2) + smoothing)
        f1, f2 = factor * slip_1, factor * slip_2
        return [0.0, f1, f2, c1 * f2 - c2 * f1, -c0 * f2, c0 * f1]

    return force


UPWARD = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
"""Rotation matrix of a frame whose x axis points up."""
