"""What a scene consists of in the engine, and why; and ballast, to measure what more would cost.

Ballast is a function that takes a model which is built and has not run, and adds a part that this
does not need; its system is to be assembled anew then. None of them changes the motion.
"""

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from mbs_models.assembly import KINDS, Kind
from mbs_models.model import Model
from mbs_models.scene import Scene, build

Ballast = Callable[[Model], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Item:
    """One item of the engine.

    Parameters
    ----------
    kind : {"node", "object", "marker", "load"}
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
    """List what is in a scene as it runs, read back from the engine.

    On the way to rest a node and an object come to it, which add up the energy that is taken.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    LookupError
        If an item has no recorded reason to be there.
    """
    with closing(build(scene)) as model:
        data = model.system.systemData
        return [
            _item(model, kind, number)
            for kind in KINDS
            for number in range(getattr(data, f"NumberOf{kind.capitalize()}s")())
        ]


def _item(model: Model, kind: Kind, number: int) -> Item:
    stored: dict[str, Any] = getattr(model.system, f"Get{kind.capitalize()}")(number)
    if (kind, number) not in model.assembly.reasons:
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
        why=model.assembly.reasons[kind, number],
    )


def idle_friction(model: Model) -> None:
    """Friction of coefficient zero, as a connector or in the tree's user function."""
    model.act(model.friction(lambda: 0.0), "friction of coefficient zero")


def sensor_per_quantity(model: Model) -> None:
    """Five sensors, stored at every sample: coordinates, rates, accelerations, state and force."""
    data = model.system.systemData
    for read in (
        data.GetODE2Coordinates,
        data.GetODE2Coordinates_t,
        data.GetODE2Coordinates_tt,
        model.record,
        data.GetAECoordinates,
    ):
        sensor = items.SensorUserFunction(
            sensorNumbers=[],
            factors=[],
            sensorUserFunction=lambda *_unused, read=read: read(),
            storeInternal=True,
            writeToFile=False,
        )
        model.system.AddSensor(sensor)


def ten_markers(model: Model) -> None:
    """Ten markers that nothing refers to."""
    for _ in range(10):
        model.system.AddMarker(items.MarkerBodyRigid(bodyNumber=model.assembly.table))


def second_body(model: Model) -> None:
    """A free rotating mass, unconnected: two more states to integrate."""
    node = model.system.AddNode(items.Node1D(referenceCoordinates=[0.0]))
    model.system.AddObject(items.ObjectRotationalMass1D(nodeNumber=node, inertia=1.0))


BALLAST: dict[str, Ballast] = {
    "friction of coefficient zero": idle_friction,
    "a sensor per quantity": sensor_per_quantity,
    "ten unused markers": ten_markers,
    "an unconnected body": second_body,
}
"""Parts by name; all but a force law on a scene that has one of its own fit any scene."""
