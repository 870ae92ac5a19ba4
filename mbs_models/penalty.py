"""Penalty contact of the thin disk and friction on it, in the coordinates of an Euler tree.

The normal force lifts the disk's lowest point; friction acts there along the table. As in
`mbs_models.friction`, each law serves on floats and on symbols. For free bodies see
`mbs_models.loads`.
"""

from collections.abc import Callable
from typing import Any

from analysis.contact import PenaltyContact
from mbs_models.friction import Force, Functions
from mbs_models.scene import Scene

Normal = Callable[[Any, Any], Any]


def _normal_force(contact: PenaltyContact, functions: Functions) -> Normal:
    """From height of the lowest point and its rate to the normal force."""
    stiffness, damping, absolute = contact.stiffness, contact.damping, functions.absolute
    where_positive = functions.where_positive

    def bilateral(height: Any, rate: Any) -> Any:
        return -stiffness * height - damping * rate

    def unilateral(height: Any, rate: Any) -> Any:
        force = bilateral(height, rate)
        return where_positive(-height, 0.5) * (force + absolute(force))

    return bilateral if contact.bilateral else unilateral


def _friction_factor(scene: Scene, contact: PenaltyContact, functions: Functions) -> Normal:
    """From normal force and squared slip speed to friction force per slip speed, positive.

    With the load "weight" the full weight presses wherever there is contact at all. A contact
    that pulls rubs with no load of its own.
    """
    coefficient, smoothing = scene.friction.coefficient, scene.friction.smoothing
    limit, by_weight = coefficient * scene.disk.weight, scene.friction.load == "weight"
    sqrt, absolute, where_positive = functions.sqrt, functions.absolute, functions.where_positive
    always = contact.bilateral

    def factor(normal: Any, squared_slip: Any) -> Any:
        if by_weight:
            load = limit if always else where_positive(normal, limit)
        else:
            load = coefficient * 0.5 * (normal + absolute(normal))
        return load / (sqrt(squared_slip) + smoothing)

    return factor


def euler_tree_contact(scene: Scene, contact: PenaltyContact, functions: Functions) -> Force:
    """Generalised contact force on the joints (alpha, x, y, z, beta, gamma) of an Euler tree."""
    r, sin, cos = scene.disk.radius, functions.sin, functions.cos
    rough = scene.friction.coefficient > 0.0
    normal_force = _normal_force(contact, functions)
    friction_factor = _friction_factor(scene, contact, functions)

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
