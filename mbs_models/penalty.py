"""Penalty contact and friction on it, as force functions for engine items.

The normal force lifts the disk's lowest point; friction acts there along the table. As in
`mbs_models.friction`, each law serves on floats and on symbols.
"""

from collections.abc import Callable
from typing import Any

from mbs_models.contact import PenaltyContact
from mbs_models.friction import Force, Functions
from mbs_models.scene import Scene

Normal = Callable[[Any, Any], Any]


def _normal_force(contact: PenaltyContact, functions: Functions) -> Normal:
    """From height of the lowest point and its rate to the normal force."""
    stiffness, damping, absolute = contact.stiffness, contact.damping, functions.absolute

    def normal(height: Any, rate: Any) -> Any:
        force = -stiffness * height - damping * rate
        return 0.5 * (force + absolute(force))

    return normal


def _friction_factor(scene: Scene, functions: Functions) -> Normal:
    """From normal force and squared slip speed to friction force per slip speed, positive.

    With the load "weight" the full weight presses wherever there is contact at all.
    """
    coefficient, smoothing = scene.friction.coefficient, scene.friction.smoothing
    limit, by_weight = coefficient * scene.disk.weight, scene.friction.load == "weight"
    sqrt, where_positive = functions.sqrt, functions.where_positive

    def factor(normal: Any, squared_slip: Any) -> Any:
        load = where_positive(normal, limit) if by_weight else coefficient * normal
        return load / (sqrt(squared_slip) + smoothing)

    return factor


def euler_tree_contact(scene: Scene, contact: PenaltyContact, functions: Functions) -> Force:
    """Generalised contact force on the joints (alpha, x, y, z, beta, gamma) of an Euler tree."""
    r, sin, cos = scene.disk.radius, functions.sin, functions.cos
    rough = scene.friction.coefficient > 0.0
    normal_force = _normal_force(contact, functions)
    friction_factor = _friction_factor(scene, functions)

    def force(_system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[Any]:
        side, lift = r * cos(q[4]), r * sin(q[4])
        normal = normal_force(q[3] - lift, u[3] - side * u[4])
        if not rough:
            return [0.0 * normal, 0.0 * normal, 0.0 * normal, normal, -side * normal, 0.0 * normal]
        x, arm = q[1], side - q[2]
        slip_x = u[1] + arm * u[0] + r * u[5]
        slip_y = u[2] + x * u[0] + lift * u[4]
        factor = friction_factor(normal, slip_x * slip_x + slip_y * slip_y)
        fx, fy = -factor * slip_x, -factor * slip_y
        return [arm * fx + x * fy, fx, fy, normal, lift * fy - side * normal, r * fx]

    return force


def connector_contact(scene: Scene, contact: PenaltyContact, functions: Functions) -> Force:
    """Force and torque of a connector between the table and the disk's centre.

    See `mbs_models.friction.connector_force` for its frames.
    """
    r, sin, cos = scene.disk.radius, functions.sin, functions.cos
    rough = scene.friction.coefficient > 0.0
    normal_force = _normal_force(contact, functions)
    friction_factor = _friction_factor(scene, functions)

    def force(
        _system: Any,
        _t: Any,
        _item: Any,
        displacement: Any,
        rotation: Any,
        velocity: Any,
        angular: Any,
        _stiffness: Any,
        _damping: Any,
        _frame_0: Any,
        _frame_1: Any,
        _offset: Any,
    ) -> list[Any]:
        rise = r * sin(rotation[1])
        c0 = -r * cos(rotation[1])
        c1, c2 = -rise * sin(rotation[0]), rise * cos(rotation[0])
        normal = normal_force(
            displacement[0] + c0, velocity[0] + angular[1] * c2 - angular[2] * c1
        )
        if not rough:
            return [-normal, 0.0 * normal, 0.0 * normal, 0.0 * normal, -c2 * normal, c1 * normal]
        slip_1 = velocity[1] + angular[2] * c0 - angular[0] * c2
        slip_2 = velocity[2] + angular[0] * c1 - angular[1] * c0
        factor = friction_factor(normal, slip_1 * slip_1 + slip_2 * slip_2)
        f1, f2 = factor * slip_1, factor * slip_2
        return [-normal, f1, f2, c1 * f2 - c2 * f1, -c2 * normal - c0 * f2, c0 * f1 + c1 * normal]

    return force
