"""The paper's friction law, Eq. (3), as force functions for engine items.

Each law is written once and can be handed to the engine in two ways: as a Python function on
plain floats, or recorded into a symbolic expression that the engine evaluates by itself. The
Python functions are the default, since they are measured to be as fast or faster (the symbolic
form evaluates a shared subexpression once for every use).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.advancedUtilities import CreateSymbolicUserFunction

from mbs_models.scene import Scene

Limit = Callable[[Any], float]
"""From the engine's system to the largest friction force: coefficient times load."""

Force = Callable[..., list[Any]]
"""A user function of an engine item."""


@dataclass(frozen=True, slots=True)
class Functions:
    """Elementary functions, on floats or on symbols."""

    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    sqrt: Callable[[Any], Any]
    absolute: Callable[[Any], Any]
    where_positive: Callable[[Any, float], Any]
    """The second argument where the first is positive, and zero elsewhere."""


def _where_positive_float(switch: float, value: float) -> float:
    return value if switch > 0.0 else 0.0


def _where_positive_symbol(switch: Any, value: float) -> Any:
    return value * exu.symbolic.max(0.0 * switch, exu.symbolic.sign(switch))


ON_FLOATS = Functions(math.sin, math.cos, math.sqrt, abs, _where_positive_float)
ON_SYMBOLS = Functions(
    exu.symbolic.sin,
    exu.symbolic.cos,
    exu.symbolic.sqrt,
    exu.symbolic.abs,
    _where_positive_symbol,
)

UPWARD = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Rotation matrix of a frame whose x axis points up."""


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
        # The multiplier of the present Newton iterate: the converged step has no lag. A contact
        # that pulls rubs with no load.
        return coefficient * max(0.0, float(system.GetObjectOutput(contact[0], force)[2]))

    return from_contact


def contact_tree_force(scene: Scene, limit: Limit, functions: Functions) -> Force:
    """Generalised friction force on the joints (alpha, x_C, y_C, beta, gamma) of a contact tree.

    The contact point moves with the joints before gamma, so the slip velocity is the velocity of
    that point plus the rim speed r gamma'.
    """
    r, smoothing = scene.disk.radius, scene.friction.smoothing
    sqrt = functions.sqrt

    def force(system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[Any]:
        x, y, spin = q[1], q[2], u[0]
        slip_x = u[1] - y * spin + r * u[4]
        slip_y = u[2] + x * spin
        factor = -limit(system) / (sqrt(slip_x * slip_x + slip_y * slip_y) + smoothing)
        fx, fy = factor * slip_x, factor * slip_y
        return [x * fy - y * fx, fx, fy, 0.0 * fx, r * fx]

    return force


def euler_tree_force(scene: Scene, limit: Limit, functions: Functions) -> Force:
    """Generalised friction force on the joints (alpha, x, y, z, beta, gamma) of an Euler tree."""
    r, smoothing = scene.disk.radius, scene.friction.smoothing
    sin, cos, sqrt, absolute = functions.sin, functions.cos, functions.sqrt, functions.absolute

    def sliding(system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[Any]:
        x, arm, lift = q[1], r * cos(q[4]) - q[2], r * sin(q[4])
        slip_x = u[1] + arm * u[0] + r * u[5]
        slip_y = u[2] + x * u[0] + lift * u[4]
        factor = -limit(system) / (sqrt(slip_x * slip_x + slip_y * slip_y) + smoothing)
        fx, fy = factor * slip_x, factor * slip_y
        return [arm * fx + x * fy, fx, fy, 0.0 * fx, lift * fy, r * fx]

    def lateral(system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[Any]:
        x, lift = q[1], r * sin(q[4])
        slip_y = u[2] + x * u[0] + lift * u[4]
        fy = -limit(system) * slip_y / (absolute(slip_y) + smoothing)
        return [x * fy, 0.0 * fy, fy, 0.0 * fy, lift * fy, 0.0 * fy]

    return sliding if scene.level <= 2 else lateral


def connector_force(scene: Scene, limit: Limit, functions: Functions) -> Force:
    """Force and torque of a connector between the table and the disk's centre.

    The table's marker is turned so that its x axis points up (`UPWARD`). The disk's attitude then
    comes as Tait-Bryan angles whose first turns the disk's axis about the vertical and whose
    second is its elevation; they are regular unless the disk lies flat. The connector wants the
    force on the table.
    """
    r, smoothing, rolls = scene.disk.radius, scene.friction.smoothing, scene.level >= 3
    sin, cos, sqrt = functions.sin, functions.cos, functions.sqrt

    def force(
        system: Any,
        _t: Any,
        _item: Any,
        _displacement: Any,
        rotation: Any,
        velocity: Any,
        angular: Any,
        _stiffness: Any,
        _damping: Any,
        _frame_0: Any,
        _frame_1: Any,
        _offset: Any,
    ) -> list[Any]:
        n1, n2 = -sin(rotation[0]), cos(rotation[0])
        rise = r * sin(rotation[1])
        c0, c1, c2 = -r * cos(rotation[1]), rise * n1, rise * n2
        slip_1 = velocity[1] + angular[2] * c0 - angular[0] * c2
        slip_2 = velocity[2] + angular[0] * c1 - angular[1] * c0
        if rolls:
            lateral = slip_1 * n1 + slip_2 * n2
            slip_1, slip_2 = lateral * n1, lateral * n2
        factor = limit(system) / (sqrt(slip_1 * slip_1 + slip_2 * slip_2) + smoothing)
        f1, f2 = factor * slip_1, factor * slip_2
        return [0.0 * f1, f1, f2, c1 * f2 - c2 * f1, -c0 * f2, c0 * f1]

    return force


def symbolic_connector(system: Any, force: Force) -> Any:
    """Record a connector's force function into a symbolic user function."""
    return CreateSymbolicUserFunction(
        system,
        force,
        "springForceTorqueUserFunction",
        itemTypeName="ObjectConnectorRigidBodySpringDamper",
    )


def symbolic_tree(system: Any, force: Force, size: int) -> tuple[Any, Any]:
    """Record a tree's force function; returns it with the symbols, which must stay alive.

    The engine's own recorder cannot size the vectors of this item, so they are given here.
    """
    symbols = exu.symbolic
    arguments = [
        system,
        symbols.Real("t", 0.0),
        symbols.Real("item", 0.0),
        symbols.Vector("q", [0.0] * size),
        symbols.Vector("u", [0.0] * size),
    ]
    recorded = {
        "functionName": "friction",
        "argList": arguments,
        "argTypeList": ["MainSystem", "Real", "Index", "StdVector", "StdVector"],
        "returnValue": symbols.Vector(force(*arguments)),
        "returnType": "StdVector",
    }
    function = symbols.UserFunction()
    function.SetUserFunctionFromDict(
        system, recorded, "forceUserFunction", None, "ObjectKinematicTree"
    )
    return function, recorded
