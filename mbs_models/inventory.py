"""What a scene consists of in the engine, and why."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np

from mbs_models.building import Kind
from mbs_models.model import Model
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
    scene : Scene
    items : tuple of Item
    """

    scene: Scene
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
    return Inventory(scene=scene, items=tuple(_items(model)))


def unused_markers(scene: Scene) -> tuple[int, ...]:
    """Numbers of the markers that no object and no load refers to."""
    model = build(scene)
    system, data = model.system, model.system.systemData
    used: set[int] = set()
    for number in range(data.NumberOfObjects()):
        used.update(int(marker) for marker in system.GetObject(number).get("markerNumbers", ()))
    for number in range(data.NumberOfLoads()):
        used.add(int(system.GetLoad(number)["markerNumber"]))
    return tuple(sorted(set(range(data.NumberOfMarkers())) - used))


def _items(model: Model) -> Iterator[Item]:
    system = model.system
    data = system.systemData
    kinds: tuple[tuple[Kind, int, Any], ...] = (
        ("node", data.NumberOfNodes(), system.GetNode),
        ("object", data.NumberOfObjects(), system.GetObject),
        ("marker", data.NumberOfMarkers(), system.GetMarker),
        ("load", data.NumberOfLoads(), system.GetLoad),
        ("sensor", data.NumberOfSensors(), system.GetSensor),
    )
    for kind, count, read in kinds:
        for number in range(count):
            yield _item(model, kind, number, read(number))


def _item(model: Model, kind: Kind, number: int, stored: dict[str, Any]) -> Item:
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
        user_functions=tuple(_user_functions(stored)),
        why=model.reasons[kind, number],
    )


def _user_functions(stored: dict[str, Any]) -> Iterator[str]:
    for name, value in stored.items():
        if name.endswith("UserFunction") and value:
            yield name
