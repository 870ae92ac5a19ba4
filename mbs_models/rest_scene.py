"""The disk on a compliant table in the engine, in every attitude: the scene `rest`."""

from dataclasses import dataclass, field
from math import hypot, sqrt
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia

from analysis import frames
from analysis.checks import Array
from analysis.disk import GRAVITY, STEEL_DISK, Disk
from analysis.dissipation import CAUSES, Dissipation, RimContact
from analysis.friction import SmoothCoulomb
from analysis.state import State, consistent_start
from mbs_models.rest_loads import Loads

_OUTPUT = exu.OutputVariableType

STAGE_WEIGHTS = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
"""Weights of the stages of the classical Runge-Kutta method of order 4."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RestScene:
    """A scene for the way to rest.

    Parameters
    ----------
    disk : Disk
    friction : SmoothCoulomb
        On the actual contact force.
    contact : RimContact
    dissipation : Dissipation
        What is off in it is left out of the scene.
    start : State, optional
        By default Table 3; lowered until the contact carries the weight.

    Raises
    ------
    ValueError
        If the spheroid is thicker than the disk is wide, or friction takes the weight as load.
    """

    disk: Disk = STEEL_DISK
    friction: SmoothCoulomb = field(default_factory=lambda: SmoothCoulomb(load="contact"))
    contact: RimContact = field(default_factory=RimContact)
    dissipation: Dissipation = field(default_factory=Dissipation)
    start: State = None  # type: ignore[assignment]  # filled in below

    def __post_init__(self) -> None:
        self.contact.check(self.disk)
        if self.friction.load != "contact":
            raise ValueError(
                f"friction must take the load 'contact' on the way to rest, "
                f"got {self.friction.load!r}"
            )
        if self.start is None:
            object.__setattr__(self, "start", consistent_start(1, self.disk))

    def largest_step(self, leaning: float = 1.0) -> float:
        """Step in s above which explicit Runge-Kutta runs of order 4 are predicted to diverge.

        Parameters
        ----------
        leaning : float
            Sine of the smallest inclination, 0 flat. The lower the disk leans, the more a rolling
            resistance on the fast contour brakes its turning.
        """
        disk, contact, loss = self.disk, self.contact, self.dissipation
        inertia = min(disk.inertia_about_cog[:2])
        # The contact point of a disk leaning low carries the least mass.
        mobility = 1.0 / disk.mass + (disk.radius + disk.eccentricity) ** 2 / inertia
        frequency = sqrt(contact.stiffness * mobility)
        slope = loss.rolling_viscous + loss.rolling_dry / loss.rolling_smoothing
        reach = disk.radius**2 / hypot(disk.radius * leaning, contact.half_thickness)
        decay = max(contact.damping * mobility, slope * disk.weight * reach**2 / inertia)
        # Stability limits of the method along the imaginary and the negative real axis.
        return min(2.8 / frequency, 2.7 / decay) if decay else 2.8 / frequency


class RestModel:
    """The scene built in the engine, from a free rigid body on the Lie group.

    Attributes
    ----------
    system : exudyn.MainSystem
        Assembled, with the start of the scene as its initial state.
    loads : Loads
        What acts on the disk at its centre.
    taken : list of 6 floats
        Energy in J taken so far by each of `CAUSES`.
    step : float
        Step in s of the present run.
    calls : int
        Evaluations of the loads since `calls` was last set to zero.
    """

    def __init__(self, scene: RestScene) -> None:
        self.scene = scene
        self.loads = Loads(scene.disk, scene.friction, scene.contact, scene.dissipation)
        self.taken = [0.0] * len(CAUSES)
        self.step, self.calls = 0.0, 0
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        self._build()
        self.system.Assemble()

    def _build(self) -> None:
        start, disk = self.scene.start, self.scene.disk
        coordinates, rates = np.array([start.coordinates]), np.array([start.rates])
        position, rotation = frames.poses(coordinates)
        velocity, angular = frames.twists(coordinates, rates)
        sunk = disk.weight / self.scene.contact.stiffness
        position[0, 2] = self.loads.height(float(rotation[0, 2, 2])) - sunk
        body = self.system.CreateRigidBody(
            inertia=RigidBodyInertia(
                mass=disk.mass,
                inertiaTensor=np.diag((disk.inertia_x, disk.inertia_y, disk.inertia_z)),
                com=[disk.eccentricity, 0.0, 0.0],
            ),
            nodeType=exu.NodeType.RotationRotationVector,
            referencePosition=position[0],
            referenceRotationMatrix=rotation[0],
            initialVelocity=velocity[0],
            initialAngularVelocity=angular[0],
            gravity=[0.0, 0.0, -GRAVITY],
        )
        self.node = self.system.GetObject(body)["nodeNumber"]
        ground = self.system.AddObject(items.ObjectGround())
        markers = [
            self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=number))
            for number in (ground, body)
        ]
        self.system.AddObject(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=markers,
                useIntrinsicFormulation=False,
                springForceTorqueUserFunction=self._connector(),
            )
        )

    def _connector(self) -> Any:
        """User function with the load on the table, which is minus that on the disk."""
        loads, node, attitude = self.loads, self.node, _OUTPUT.RotationMatrix

        def force(
            system: Any, _t: Any, _item: Any, displacement: Any, _rotation: Any,
            velocity: Any, angular: Any, *_unused: Any,
        ) -> list[float]:  # fmt: skip
            # The connector's own angles are singular somewhere; the rotation matrix is not.
            matrix = system.GetNodeOutput(node, attitude).tolist()
            load = loads.at(
                float(displacement[2]),
                (matrix[2], matrix[5], matrix[8]),
                tuple(velocity),
                tuple(angular),
            )
            self.count_work(load.taken)
            return [-value for value in (*load.force, *load.torque)]

        return force

    def count_work(self, powers: list[float]) -> None:
        """Add the work of one stage of a step of the classical Runge-Kutta method.

        The engine evaluates the loads once a stage; `run` checks that. An engine variable of
        order 1 would see the powers of the stage before.
        """
        part = self.step * STAGE_WEIGHTS[self.calls % len(STAGE_WEIGHTS)]
        self.calls += 1
        for cause, power in enumerate(powers):
            if power:
                self.taken[cause] += part * power

    def record(self) -> Array:
        """Position of G, rotation, velocity, angular velocity and energy taken, shape (24,)."""
        outputs = (
            _OUTPUT.Position,
            _OUTPUT.RotationMatrix,
            _OUTPUT.Velocity,
            _OUTPUT.AngularVelocity,
        )
        parts = [self.system.GetNodeOutput(self.node, output) for output in outputs]
        return np.concatenate((*parts, self.taken))
