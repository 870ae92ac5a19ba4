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
        Coordinates of a node, or unknowns of motion that it brings.
    equations : int
        Algebraic equations that it brings.
    idle : int
        How many of those only say that an unused constraint force is zero.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Inventory:
    """All items of a scene as it runs, with its sensors.

    Parameters
    ----------
    items : tuple of Item
    """

    items: tuple[Item, ...]

    @property
    def coordinates(self) -> int:
        """Unknowns of motion; each brings a differential equation of second order."""
        return sum(item.coordinates for item in self.items)

    @property
    def equations(self) -> int:
        """Algebraic equations, the idle ones included."""
        return sum(item.equations for item in self.items)

    @property
    def constraints(self) -> int:
        """Algebraic equations that constrain the motion."""
        return self.equations - sum(item.idle for item in self.items)

    @property
    def user_functions(self) -> int:
        """Number of user functions."""
        return sum(len(item.user_functions) for item in self.items)


def inventory(scene: Scene) -> Inventory:
    """List what is in a scene, read back from the engine.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Inventory

    Raises
    ------
    LookupError
        If an item has no recorded reason to be there.
    """
    model = build(scene)
    counted = {kind: f"NumberOf{kind.capitalize()}s" for kind in KINDS}
    return Inventory(
        items=tuple(
            _item(model, kind, number)
            for kind, count in counted.items()
            for number in range(getattr(model.system.systemData, count)())
        )
    )


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
