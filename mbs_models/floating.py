"""The disk as a free rigid body with joints: `floating` and `floating-lie`."""

from collections.abc import Sequence
from functools import cached_property, partial
from math import atan2, cos, hypot, pi, sin
from typing import Any, ClassVar

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia, RotationMatrixZ

from analysis.motion import frames
from analysis.problem.bodies import Sphere
from analysis.problem.checks import Array
from analysis.problem.choices import EngineFormulation
from analysis.problem.constraints import prescribed
from analysis.problem.scenario import Scenario
from mbs_models.friction import free_slip_force
from mbs_models.joints import CENTRE
from mbs_models.model import Floats, Force, Load, Model, Reading

_OUTPUT = exu.OutputVariableType

_POSE = (_OUTPUT.Position, _OUTPUT.RotationMatrix, _OUTPUT.Velocity, _OUTPUT.AngularVelocity)

UPWARD = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""Rotation matrix of a frame whose x axis points up."""


class Floating(Model):
    """A free rigid body with Euler parameters, held by joints or on a penalty contact."""

    name: ClassVar[EngineFormulation] = "floating"
    has_norm = True

    _node_type: Any = exu.NodeType.RotationEulerParameters

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:
        if scenario.contact is None and not (
            scenario.disk.is_round_disk or isinstance(scenario.disk, Sphere)
        ):
            return "holds round disks and spheres alone on the ideal contact"
        for rate in prescribed(scenario.constraints).values():
            if rate != "alpha":
                return f"has no coordinate {rate} whose rate a joint could hold"
        return ""

    def _build(self) -> None:
        start, disk = self.start, self.scenario.disk
        coordinates, rates = np.array([start.coordinates]), np.array([start.rates])
        position, rotation = frames.poses(coordinates)
        velocity, angular = frames.twists(coordinates, rates)
        inertia = RigidBodyInertia(mass=disk.mass, com=[disk.eccentricity, 0.0, 0.0])
        # Given at once, the tensor of a lamina is warned of on the console, by a rounding.
        inertia.inertiaTensor = disk.tensor
        self._body = self.system.CreateRigidBody(
            inertia=inertia,
            nodeType=self._node_type,
            referencePosition=position[0],
            referenceRotationMatrix=rotation[0],
            initialVelocity=velocity[0],
            initialAngularVelocity=angular[0],
            gravity=list(self.scenario.table.vector),
        )
        self._node = self.system.GetObject(self._body)["nodeNumber"]
        # The engine adds these four at once.
        self.assembly.reasons |= {
            ("node", int(self._node)): "position and rotation of the disk",
            ("object", int(self._body)): "the disk",
            ("marker", 0): "what the weight acts on",
            ("load", 0): "the weight",
        }
        self._markers: dict[float, int] = {}
        self._add_forces()
        if self.scenario.contact is None:
            # The middle of a sphere stays at its height.
            level = partial(self.joints.hold, "z", self._node, 2, "contact with the table")
            self.joints.add(self._disk_marker, self._turning, level)

    def _disk_marker(self, offset: float, why: str) -> int:
        # What acts on the centre and what holds it share a marker.
        if offset not in self._markers:
            marker = items.MarkerBodyRigid(bodyNumber=self._body, localPosition=[offset, 0.0, 0.0])
            self._markers[offset] = self.assembly.add(marker, why)
        return self._markers[offset]

    def act(self, force: Force, name: str) -> None:
        # Friction alone asks for angles that are regular unless the disk lies flat.
        rotation = UPWARD if self.scenario.contact is None else np.eye(3)
        side = self.assembly.add(
            items.MarkerBodyRigid(
                bodyNumber=self.assembly.table,
                localHT=exu.HT(rotation=rotation, translation=[0.0] * 3),
            ),
            f"the table's side of {name}",
        )
        self.assembly.add(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=[side, self._disk_marker(*CENTRE)],
                useIntrinsicFormulation=False,
                springForceTorqueUserFunction=force,
            ),
            f"{name} by a user function",
        )

    def friction(self, load: Load) -> Force:
        """Force and torque of a connector between the table and the middle of a disk or a sphere.

        The table's marker is turned so that its x axis points up (`UPWARD`). The disk's attitude
        then comes as Tait-Bryan angles whose first turns the disk's axis about the vertical and
        whose second is its elevation; they are regular unless the disk lies flat. Below a sphere's
        middle, all level directions are alike. The connector wants the force on the table.
        """
        r, friction = self.scenario.disk.radius, free_slip_force(self.scenario, self.slip_part)
        is_sphere = isinstance(self.scenario.disk, Sphere)

        def force(
            _system: Any, _t: Any, _item: Any, _displacement: Any, rotation: Any,
            velocity: Any, angular: Any, *_unused: Any,
        ) -> list[float]:  # fmt: skip
            n1, n2 = -sin(rotation[0]), cos(rotation[0])
            elevation = 0.0 if is_sphere else rotation[1]
            rise = r * sin(elevation)
            c0, c1, c2 = -r * cos(elevation), rise * n1, rise * n2
            slip_1 = velocity[1] + angular[2] * c0 - angular[0] * c2
            slip_2 = velocity[2] + angular[0] * c1 - angular[1] * c0
            # The normal's level direction (n1, n2) points against e_y.
            fx, fy = friction(slip_2 * n1 - slip_1 * n2, -slip_1 * n1 - slip_2 * n2, load())
            f1, f2 = fx * n2 + fy * n1, fy * n2 - fx * n1
            return [0.0, f1, f2, c1 * f2 - c2 * f1, -c0 * f2, c0 * f1]

        return force

    def _contact_force(self) -> Force:
        # The load on the table is minus that on the disk.
        loads, node, attitude = self.loads, self._node, _OUTPUT.RotationMatrix

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
        node = self.assembly.add(
            items.Node1D(
                referenceCoordinates=[0.0],
                initialCoordinates=[start.coordinates[3]],
                initialVelocities=[start.rates[3]],
            ),
            "the spin angle, which a free body's coordinates do not hold",
        )
        carrier = self.assembly.add(
            # Its motion is prescribed, so that its inertia matters to nothing.
            items.ObjectRotationalMass1D(nodeNumber=node, inertia=self.scenario.disk.inertia_z),
            "carrier that turns at the constant spin",
        )
        # The joint wants its y axis along e_x of the R-frame, across the disk's axis.
        across = self.assembly.add(
            items.MarkerBodyRigid(
                bodyNumber=carrier,
                localHT=exu.HT(rotation=RotationMatrixZ(-pi / 2), translation=[0.0] * 3),
            ),
            "the carrier's side of its joint",
        )
        self.assembly.add(
            items.ObjectJointGeneric(
                markerNumbers=[across, self._disk_marker(*CENTRE)],
                constrainedAxes=[0, 0, 0, 1, 0, 0],
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
        x, y, z, alpha, beta, gamma = coordinates
        xd, yd, zd, ad, bd, gd = rates
        sa, ca, sb, cb, sg, cg = _sines_and_cosines(alpha, beta, gamma)
        vx, vy = xd - ad * y, yd + ad * x
        sh, ch = sin(0.5 * beta), cos(0.5 * beta)
        total, apart = 0.5 * (alpha + gamma), 0.5 * (alpha - gamma)
        attitude, turning = self._rotation(
            [ch * cos(total), sh * cos(apart), sh * sin(apart), ch * sin(total)],
            [ad * sb * sg + bd * cg, ad * sb * cg - bd * sg, ad * cb + gd],
        )
        position = [ca * x - sa * y, sa * x + ca * y, z, *attitude]
        velocity = [ca * vx - sa * vy, sa * vx + ca * vy, zd, *turning]
        if "constant-spin" in self.scenario.constraints:
            # The carrier's.
            position.append(alpha)
            velocity.append(ad)
        return (np.array(position) - self.origin).tolist(), velocity

    def _rotation(self, parameters: Floats, local: Floats) -> tuple[Floats, Floats]:
        """The engine's coordinates of a rotation, and their rates, from angular velocity."""
        return parameters, quaternion_rates(parameters, local)

    def pose_readings(self) -> list[Reading]:
        """Position, rotation matrix row by row, velocity and angular velocity."""
        return [partial(self.system.GetNodeOutput, self._node, each) for each in _POSE]

    def decode(self, records: Array) -> tuple[Array, Array]:
        position, velocity, angular = records[:, :3], records[:, 12:15], records[:, 15:18]
        rotation = records[:, 3:12].reshape(-1, 3, 3)
        return frames.from_poses(position, rotation, velocity, angular)

    def decode_accelerations(
        self, second_derivatives: Array, coordinates: Floats, rates: Floats
    ) -> Floats:
        x, y, _, alpha, beta, gamma = coordinates
        xd, yd, _, ad, bd, gd = rates
        sa, ca, sb, cb, sg, cg = _sines_and_cosines(alpha, beta, gamma)
        ax, ay, zdd, *turning = second_derivatives.tolist()
        wx, wy, wz = self._angular_acceleration(turning)
        # Both frames turn: the components in them change by that, too.
        bdd = cg * wx - sg * wy - ad * gd * sb
        add = (sg * wx + cg * wy + bd * gd - ad * bd * cb) / sb
        gdd = wz - add * cb + ad * bd * sb
        xdd = ca * ax + sa * ay + 2.0 * ad * yd + add * y + ad * ad * x
        ydd = ca * ay - sa * ax - 2.0 * ad * xd - add * x + ad * ad * y
        return xdd, ydd, zdd, add, bdd, gdd

    def _angular_acceleration(self, turning: Floats) -> Sequence[float]:
        """Components in axes of the body, from second derivatives of what tells the rotation."""
        position = self.system.systemData.GetODE2Coordinates()
        # Two sets of parameters, apart in sign, tell a rotation.
        s, x, y, z = (position[3:7] + self.origin[3:7]).tolist()
        sdd, xdd, ydd, zdd, *_unused = turning
        return (
            2.0 * (s * xdd - x * sdd - y * zdd + z * ydd),
            2.0 * (s * ydd - y * sdd - z * xdd + x * zdd),
            2.0 * (s * zdd - z * sdd - x * ydd + y * xdd),
        )


class FloatingLie(Floating):
    """The same with a rotation vector, which the engine integrates on the Lie group."""

    name = "floating-lie"
    has_norm = False
    # A symmetric integrator is none on the Lie group, and has odd powers there, too.
    exponents = (2, 3, 4, 5)

    _node_type = exu.NodeType.RotationRotationVector

    def _rotation(self, parameters: Floats, local: Floats) -> tuple[Floats, Floats]:
        return self.rotation_vector(parameters), local

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
        x, y, z = (origin + position[3:6]).tolist()
        half = 0.5 * hypot(x, y, z)
        part = 0.5 * sin(half) / half if half else 0.5
        parameters = np.array((cos(half), part * x, part * y, part * z))
        turning = np.array(quaternion_rates(parameters.tolist(), velocity[3:6].tolist()))
        found[3:6] = self.rotation_vector((parameters + time * turning).tolist()) - origin
        return found

    def _angular_acceleration(self, turning: Floats) -> Sequence[float]:
        return turning[:3]


def quaternion_rates(quaternion: Floats, angular: Floats) -> list[float]:
    """Rates of a quaternion, four floats, from the angular velocity in axes of the body."""
    (s, x, y, z), (p, q, r) = quaternion, angular
    return [
        -0.5 * (x * p + y * q + z * r),
        0.5 * (s * p + y * r - z * q),
        0.5 * (s * q + z * p - x * r),
        0.5 * (s * r + x * q - y * p),
    ]


def rotation_rows(quaternion: Floats) -> list[list[float]]:
    """Rows of the rotation matrix of a quaternion of any length."""
    s, x, y, z = quaternion
    double = 2.0 / (s * s + x * x + y * y + z * z)
    return [
        [1.0 - double * (y * y + z * z), double * (x * y - s * z), double * (x * z + s * y)],
        [double * (x * y + s * z), 1.0 - double * (x * x + z * z), double * (y * z - s * x)],
        [double * (x * z - s * y), double * (y * z + s * x), 1.0 - double * (x * x + y * y)],
    ]


def _sines_and_cosines(a: float, b: float, c: float) -> tuple[float, ...]:
    return sin(a), cos(a), sin(b), cos(b), sin(c), cos(c)
