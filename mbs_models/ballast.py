"""Parts that a scene does not need, to be added for the sake of measuring what they cost.

Each function takes a model that is built and has not run, adds its part and assembles anew. None
of them changes the motion.
"""

from collections.abc import Callable

import exudyn.itemInterface as items

from mbs_models.model import Model

Ballast = Callable[[Model], None]


def idle_friction(model: Model) -> None:
    """Friction of coefficient zero, as a connector or in the tree's user function."""
    model.act(model.friction(lambda: 0.0), "friction of coefficient zero")
    model.system.Assemble()


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
    data = system.systemData
    old = next(
        number
        for number in range(data.NumberOfObjects())
        if system.GetObject(number)["objectType"] == "JointSpherical"
    )
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
