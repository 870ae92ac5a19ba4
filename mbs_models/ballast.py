"""Parts that a scene does not need, to be added for the sake of measuring what they cost.

Each function takes a model that is built and has not run, adds its part and assembles anew. None
of them changes the motion.
"""

from collections.abc import Callable
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items

from mbs_models.friction import UPWARD, connector_force, contact_tree_force, euler_tree_force
from mbs_models.model import Model

Ballast = Callable[[Model], None]


def idle_friction(model: Model) -> None:
    """Friction of coefficient zero, as a connector or in the tree's user function."""
    scenario, system = model.scenario, model.system

    def nothing(_system: Any) -> float:
        return 0.0

    if not model.has_euler_angles:
        table, body = _object_of(model, "Ground"), _object_of(model, "RigidBody")
        upward = system.AddMarker(
            items.MarkerBodyRigid(
                bodyNumber=table, localHT=exu.HT(rotation=UPWARD, translation=[0.0] * 3)
            )
        )
        centre = system.AddMarker(items.MarkerBodyRigid(bodyNumber=body))
        system.AddObject(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=[upward, centre],
                useIntrinsicFormulation=False,
                springForceTorqueUserFunction=connector_force(scenario, nothing),
            )
        )
    else:
        law = contact_tree_force if model.closes_contact else euler_tree_force
        system.SetObjectParameter(
            _object_of(model, "KinematicTree"),
            "forceUserFunction",
            law(scenario, nothing),
        )
    system.Assemble()


def sensor_per_quantity(model: Model) -> None:
    """Five sensors, stored at every sample: coordinates, rates, accelerations, state and force."""
    system = model.system
    data = system.systemData
    for read in (
        data.GetODE2Coordinates,
        data.GetODE2Coordinates_t,
        data.GetODE2Coordinates_tt,
        model.record,
        data.GetAECoordinates,
    ):
        system.AddSensor(
            items.SensorUserFunction(
                sensorNumbers=[],
                factors=[],
                storeInternal=True,
                writeToFile=False,
                sensorUserFunction=lambda *_unused, read=read: read(),
            )
        )
    system.Assemble()


def ten_markers(model: Model) -> None:
    """Ten markers that nothing refers to."""
    table = model.system.AddObject(items.ObjectGround())
    for _ in range(10):
        model.system.AddMarker(items.MarkerBodyRigid(bodyNumber=table))
    model.system.Assemble()


def second_body(model: Model) -> None:
    """A free rotating mass, unconnected: two more states to integrate."""
    node = model.system.AddNode(items.Node1D(referenceCoordinates=[0.0]))
    model.system.AddObject(items.ObjectRotationalMass1D(nodeNumber=node, inertia=1.0))
    model.system.Assemble()


def six_axes(model: Model) -> None:
    """The centre of gravity held by a joint with six axes instead of one with three.

    The spherical joint is switched off and a generic one does its work.
    """
    system = model.system
    old = _object_of(model, "JointSpherical")
    markers = system.GetObject(old)["markerNumbers"]
    system.SetObjectParameter(old, "activeConnector", False)
    system.AddObject(
        items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 0])
    )
    system.Assemble()


BALLAST: dict[str, Ballast] = {
    "friction of coefficient zero": idle_friction,
    "a sensor per quantity": sensor_per_quantity,
    "ten unused markers": ten_markers,
    "an unconnected body": second_body,
}
"""Parts by name; all but a force law on a scene that has one of its own fit any scene."""


def _object_of(model: Model, kind: str) -> int:
    system = model.system
    for number in range(system.systemData.NumberOfObjects()):
        if system.GetObject(number)["objectType"] == kind:
            return number
    raise LookupError(f"no object of type {kind!r} in formulation {model.name!r}")
