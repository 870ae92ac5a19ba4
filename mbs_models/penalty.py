"""Penalty contact of the thin disk and friction on it, in the coordinates of an Euler tree.

The normal force lifts the disk's lowest point; friction acts there along the table. For free
bodies see `mbs_models.loads`.
"""

from math import cos, hypot, sin
from typing import Any

from analysis.data.contact import PenaltyContact
from analysis.data.scenario import Scenario
from mbs_models.friction import Force, per_speed


def euler_tree_contact(scenario: Scenario, contact: PenaltyContact) -> Force:
    """Generalised contact force on the joints (alpha, x, y, z, beta, gamma) of an Euler tree."""
    r, factor_at = scenario.disk.radius, per_speed(scenario.friction)
    stiffness, damping = contact.stiffness, contact.damping
    by_weight, weight = scenario.friction.load == "weight", scenario.weight
    rough, always = scenario.rubs, contact.bilateral

    def force(_system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[float]:
        side, lift = r * cos(q[4]), r * sin(q[4])
        height = q[3] - lift
        normal = -stiffness * height - damping * (u[3] - side * u[4])
        if not always:
            normal = max(0.0, normal) if height < 0.0 else 0.0
        if not rough:
            return [0.0, 0.0, 0.0, normal, -side * normal, 0.0]
        x, arm = q[1], side - q[2]
        slip_x = u[1] + arm * u[0] + r * u[5]
        slip_y = u[2] + x * u[0] + lift * u[4]
        # A contact that pulls is no load; the weight is one wherever there is contact at all.
        load = max(0.0, normal)
        if by_weight and (always or normal > 0.0):
            load = weight
        factor = -load * factor_at(hypot(slip_x, slip_y))
        fx, fy = factor * slip_x, factor * slip_y
        return [arm * fx + x * fy, fx, fy, normal, lift * fy - side * normal, r * fx]

    return force
