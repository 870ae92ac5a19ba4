"""What a scene consists of in the engine, and why."""

from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np

from mbs_models.model import KINDS, Kind, Model
from mbs_models.scene import Scene, build


@dataclass(frozen=True, slots=True, kw_only=True)
class Item:
    """One item of the engine.

    Parameters
    ----------
    kind : {"node", "object", "marker", "load", "sensor"}
    number : int
        Its number among the items of its kind.
    type : str
        The engine's name of its type.
    coordinates : int
        Unknowns of motion that a node brings; each has a differential equation of second order.
    equations : int
        Algebraic equations that it brings.
    idle : int
        How many of those only say that an unused constraint force is zero; all others constrain
        the motion.
    user_functions : tuple of str
        User functions that the engine calls, by the engine's names.
    why : str
        What it is there for; recorded where it is added.
    """

    kind: Kind
    number: int
    type: str
    coordinates: int
    equations: int
    idle: int
    user_functions: tuple[str, ...]
    why: str


def inventory(scene: Scene) -> list[Item]:
    """List what is in a scene as it runs, with its sensors, read back from the engine.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    LookupError
        If an item has no recorded reason to be there.
    """
    model = build(scene)
    data = model.system.systemData
    return [
        _item(model, kind, number)
        for kind in KINDS
        for number in range(getattr(data, f"NumberOf{kind.capitalize()}s")())
    ]


def _item(model: Model, kind: Kind, number: int) -> Item:
    stored: dict[str, Any] = getattr(model.system, f"Get{kind.capitalize()}")(number)
    if (kind, number) not in model.reasons:
        raise LookupError(f"{kind} {number} has no recorded reason to be in the scene")
    equations = coordinates = idle = 0
    if kind == "object":
        equations = len(model.system.systemData.GetObjectLTGAE(number))
        idle = list(stored.get("constrainedAxes", [])).count(0)
    elif kind == "node":
        output = exu.OutputVariableType.Coordinates_t
        ground = stored["nodeType"] == "PointGround"
        coordinates = 0 if ground else np.size(model.system.GetNodeOutput(number, output))
    return Item(
        kind=kind,
        number=number,
        type=stored[f"{kind}Type"],
        coordinates=coordinates,
        equations=equations,
        idle=idle,
        user_functions=tuple(
            name for name, value in stored.items() if name.endswith("UserFunction") and value
        ),
        why=model.reasons[kind, number],
    )
