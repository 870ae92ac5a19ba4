"""The disk as a free rigid body with joints: `floating` and `floating-lie`."""

from functools import cached_property
from math import atan2, cos, hypot, pi, sin
from typing import Any, ClassVar

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.lieGroupBasics import CompositionRuleForRotationVectors
from exudyn.rigidBodyUtilities import RigidBodyInertia, RotationMatrixZ

from analysis.motion import frames
from analysis.problem.bodies import Sphere
from analysis.problem.checks import Array
from analysis.problem.contact import CAUSES
from analysis.problem.scenario import Scenario
from mbs_models.friction import UPWARD, Force, connector_force
from mbs_models.loads import loads_of
from mbs_models.model import Floats, Formulation, Model

_OUTPUT = exu.OutputVariableType


class Floating(Model):
    """A free rigid body with Euler parameters, held by joints or on a penalty contact.

    Attributes
    ----------
    loads : Loads or None
        What acts on the disk at its centre on a penalty contact.
    """

    name: ClassVar[Formulation] = "floating"
    # The square of the norm of the Euler parameters is one.
    own_equations: ClassVar[tuple[float, ...]] = (1.0,)

    _outputs = (
        _OUTPUT.Position,
        _OUTPUT.RotationMatrix,
        _OUTPUT.Velocity,
        _OUTPUT.AngularVelocity,
    )
    _law = staticmethod(connector_force)
    _node_type: Any = exu.NodeType.RotationEulerParameters

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:
        if scenario.contact is None and not (
            scenario.disk.is_round_disk or isinstance(scenario.disk, Sphere)
        ):
            return "holds round disks and spheres alone on the ideal contact"
        if "held-tilt-rate" in scenario.constraints:
            return "has no coordinate beta whose rate a joint could hold"
        return ""

    def _build(self) -> None:
        self.loads = None if self.scenario.contact is None else loads_of(self.scenario)
        start, disk = self.start, self.scenario.disk
        coordinates, rates = np.array([start.coordinates]), np.array([start.rates])
        position, rotation = frames.poses(coordinates)
        velocity, angular = frames.twists(coordinates, rates)
        self._body = self.system.CreateRigidBody(
            inertia=RigidBodyInertia(
                mass=disk.mass,
                inertiaTensor=disk.tensor,
                com=[disk.eccentricity, 0.0, 0.0],
            ),
            nodeType=self._node_type,
            referencePosition=position[0],
            referenceRotationMatrix=rotation[0],
            initialVelocity=velocity[0],
            initialAngularVelocity=angular[0],
            gravity=list(self.scenario.table.vector),
        )
        self._node = self.system.GetObject(self._body)["nodeNumber"]
        # The engine adds these four at once.
        self.reasons |= {
            ("node", int(self._node)): "position and rotation of the disk",
            ("object", int(self._body)): "the disk",
            ("marker", 0): "what the weight acts on",
            ("load", 0): "the weight",
        }
        self._table = self._add_table()
        self._centre = self._disk_marker(0.0, "the disk's centre")
        self._add_forces()
        if self.loads is None:
            self._hold(self._table)

    def _close_contact(self, table: int, origin: int) -> None:
        if not isinstance(self.scenario.disk, Sphere):
            super()._close_contact(table, origin)
            return
        above = self._add(
            items.MarkerBodyRigid(
                bodyNumber=table, localPosition=[0.0, 0.0, self.scenario.disk.radius]
            ),
            "the plane in which the middle of a sphere moves",
        )
        joint = self._add(
            items.ObjectJointGeneric(
                markerNumbers=[above, self._centre], constrainedAxes=[0, 0, 1, 0, 0, 0]
            ),
            "contact with the table",
        )
        self._joints["contact"] = joint, [2]

    def _disk_marker(self, offset: float, why: str) -> int:
        return self._add(
            items.MarkerBodyRigid(bodyNumber=self._body, localPosition=[offset, 0.0, 0.0]), why
        )

    def act(self, force: Force, name: str) -> None:
        # Friction alone asks for angles that are regular unless the disk lies flat.
        rotation = UPWARD if self.loads is None else np.eye(3)
        side = self._add(
            items.MarkerBodyRigid(
                bodyNumber=self._table,
                localHT=exu.HT(rotation=rotation, translation=[0.0] * 3),
            ),
            f"the table's side of {name}",
        )
        self._add(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=[side, self._centre],
                useIntrinsicFormulation=False,
                springForceTorqueUserFunction=force,
            ),
            f"{name} by a user function",
        )

    def _contact_force(self) -> Force:
        # The load on the table is minus that on the disk.
        loads, node, attitude = self.loads, self._node, _OUTPUT.RotationMatrix
        assert loads is not None

        def force(
            system: Any, _t: Any, _item: Any, displacement: Any, _rotation: Any,
            velocity: Any, angular: Any, *_unused: Any,
        ) -> list[float]:  # fmt: skip
            # The connector's own angles are singular somewhere; the rotation matrix is not.
            matrix = tuple(system.GetNodeOutput(node, attitude).tolist())
            load = loads.at(float(displacement[2]), matrix, tuple(velocity), tuple(angular))
            return [-value for value in (*load.force, *load.torque)]

        return force

    def _turning(self, coordinate: str) -> tuple[int, int]:
        """Add a carrier that turns at the prescribed spin and takes the disk's axis along."""
        assert coordinate == "alpha"
        start = self.start
        node = self._add(
            items.Node1D(
                referenceCoordinates=[0.0],
                initialCoordinates=[start.coordinates[3]],
                initialVelocities=[start.rates[3]],
            ),
            "the spin angle, which a free body's coordinates do not hold",
        )
        carrier = self._add(
            # Its motion is prescribed, so that its inertia matters to nothing.
            items.ObjectRotationalMass1D(nodeNumber=node, inertia=self.scenario.disk.inertia_z),
            "carrier that turns at the constant spin",
        )
        # The joint wants its y axis along e_x of the R-frame, across the disk's axis.
        across = self._add(
            items.MarkerBodyRigid(
                bodyNumber=carrier,
                localHT=exu.HT(rotation=RotationMatrixZ(-pi / 2), translation=[0.0] * 3),
            ),
            "the carrier's side of its joint",
        )
        self._add(
            items.ObjectJointGeneric(
                markerNumbers=[across, self._centre], constrainedAxes=[0, 0, 0, 1, 0, 0]
            ),
            "takes the disk's axis along with the carrier",
        )
        return node, 0

    @cached_property
    def origin(self) -> Array:
        """What the engine's coordinates are measured from, shape (n,)."""
        data = self.system.systemData
        return np.array(data.GetODE2Coordinates(exu.ConfigurationType.Reference))

    def encode(self, coordinates: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        place, velocity, parameters, local = _free_motion(coordinates, rates)
        turning = quaternion_rates(parameters, local)
        return self._with_carrier([*place, *parameters], [*velocity, *turning], coordinates, rates)

    def _with_carrier(
        self, position: list[float], velocity: list[float], coordinates: Floats, rates: Floats
    ) -> tuple[list[float], list[float]]:
        """The same as measured from the reference pose, and with the carrier if there is one."""
        if "constant-spin" in self.scenario.constraints and self.scenario.contact is None:
            position.append(coordinates[3])
            velocity.append(rates[3])
        return (np.array(position) - self.origin).tolist(), velocity

    def decode(self, records: Array) -> tuple[Array, Array]:
        position, velocity, angular = records[:, :3], records[:, 12:15], records[:, 15:18]
        rotation = records[:, 3:12].reshape(-1, 3, 3)
        return frames.from_poses(position, rotation, velocity, angular)

    def decode_accelerations(
        self, second_derivatives: Array, coordinates: Floats, rates: Floats
    ) -> Array:
        angular = self._angular_acceleration(second_derivatives)
        given = (coordinates, rates, second_derivatives[:3], angular)
        rows = [np.array([each]) for each in given]
        return frames.accelerations_from_inertial(*rows)[0]  # type: ignore[no-any-return]

    def _angular_acceleration(self, second_derivatives: Array) -> Array:
        self.system.systemData.SetODE2Coordinates_tt(second_derivatives.tolist())
        angular = self.system.GetNodeOutput(self._node, _OUTPUT.AngularAcceleration)
        result: Array = np.array(angular, dtype=float)
        return result


class FloatingLie(Floating):
    """The same with a rotation vector, which the engine integrates on the Lie group."""

    name = "floating-lie"
    own_equations = ()
    # A symmetric integrator is none on the Lie group, and has odd powers there, too.
    exponents = (2, 3, 4, 5)

    _node_type = exu.NodeType.RotationRotationVector

    def encode(self, coordinates: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        place, velocity, parameters, local = _free_motion(coordinates, rates)
        position = [*place, *self.rotation_vector(parameters)]
        return self._with_carrier(position, [*velocity, *local], coordinates, rates)

    @staticmethod
    def rotation_vector(parameters: Floats) -> list[float]:
        """The shorter one of the two that belong to Euler parameters, three floats."""
        scalar, *vector = parameters if parameters[0] >= 0.0 else [-each for each in parameters]
        length = hypot(*vector)
        stretch = 2.0 * atan2(length, scalar) / length if length else 2.0
        return [stretch * each for each in vector]

    def moved(self, position: Array, velocity: Array, time: float) -> Array:
        # On the Lie group the velocities are local angular velocities, not rates of coordinates.
        found, origin = super().moved(position, velocity, time), self.origin[3:6]
        turned = CompositionRuleForRotationVectors(origin + position[3:6], time * velocity[3:6])
        found[3:6] = turned - origin
        return found

    def _angular_acceleration(self, second_derivatives: Array) -> Array:
        # The engine offers no such output for this node; its coordinates are the local components.
        rotation = self.record()[3:12].reshape(3, 3)
        angular: Array = rotation @ second_derivatives[3:6]
        return angular


class FloatingWithLosses(FloatingLie):
    """A free disk on a penalty contact, and what each of `CAUSES` has taken from it in J.

    The energies are variables of order 1 with the powers as their rates: they go through the same
    stages of the integrator as the motion.
    """

    def _build(self) -> None:
        super()._build()
        zeros = [0.0] * len(CAUSES)
        self._energies = self._add(
            items.NodeGenericODE1(
                referenceCoordinates=zeros,
                initialCoordinates=zeros,
                numberOfODE1Coordinates=len(CAUSES),
            ),
            "energy taken by each cause",
        )
        self._add(
            items.ObjectGenericODE1(
                nodeNumbers=[self._energies], rhsUserFunction=lambda *_unused: self.powers()
            ),
            "power of each cause, by a user function",
        )

    def powers(self) -> list[float]:
        """What each cause takes in W in the engine's current state, six floats."""

        def output(variable: Any) -> Any:
            return tuple(self.system.GetNodeOutput(self._node, variable).tolist())

        (_, _, height), matrix, v, w = map(output, self._outputs)
        assert self.loads is not None
        return self.loads.at(height, matrix, v, w).taken

    def _readings(self) -> list[tuple[int, Any]]:
        return [*super()._readings(), (self._energies, _OUTPUT.Coordinates)]


def quaternion_rates(quaternion: Floats, angular: Floats) -> list[float]:
    """Rates of a quaternion, four floats, from the angular velocity in axes of the body."""
    (s, x, y, z), (p, q, r) = quaternion, angular
    return [
        -0.5 * (x * p + y * q + z * r),
        0.5 * (s * p + y * r - z * q),
        0.5 * (s * q + z * p - x * r),
        0.5 * (s * r + x * q - y * p),
    ]


def _free_motion(coordinates: Floats, rates: Floats) -> tuple[list[float], ...]:
    """Position and velocity of G, Euler parameters, and angular velocity in the body's axes."""
    x, y, z, alpha, beta, gamma = coordinates
    xd, yd, zd, ad, bd, gd = rates
    sa, ca, sb, cb, sg, cg = sin(alpha), cos(alpha), sin(beta), cos(beta), sin(gamma), cos(gamma)
    vx, vy = xd - ad * y, yd + ad * x
    sh, ch = sin(0.5 * beta), cos(0.5 * beta)
    total, apart = 0.5 * (alpha + gamma), 0.5 * (alpha - gamma)
    return (
        [ca * x - sa * y, sa * x + ca * y, z],
        [ca * vx - sa * vy, sa * vx + ca * vy, zd],
        [
            ch * cos(total),
            sh * cos(apart),
            sh * sin(apart),
            ch * sin(total),
        ],
        [ad * sb * sg + bd * cg, ad * sb * cg - bd * sg, ad * cb + gd],
    )
