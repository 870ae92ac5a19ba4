"""The disk as a free rigid body with joints: `floating` and `floating-lie`."""

from math import pi
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.lieGroupBasics import TExpSO3Inv
from exudyn.rigidBodyUtilities import RigidBodyInertia, RotationMatrixZ

from analysis import frames
from analysis.checks import Array
from mbs_models.friction import UPWARD, connector_force, friction_limit, symbolic_connector
from mbs_models.model import GRAVITY_VECTOR, Model

_OUTPUT = exu.OutputVariableType


class Floating(Model):
    """A free rigid body with Euler parameters, held by joints."""

    _node_type: Any = exu.NodeType.RotationEulerParameters

    def _build(self) -> None:
        start, disk = self.scene.start, self.scene.disk
        coordinates, rates = np.array([start.coordinates]), np.array([start.rates])
        position, rotation = frames.poses(coordinates)
        velocity, angular = frames.twists(coordinates, rates)
        self._body = self.system.CreateRigidBody(
            inertia=RigidBodyInertia(
                mass=disk.mass,
                inertiaTensor=np.diag((disk.inertia_x, disk.inertia_y, disk.inertia_z)),
                com=[disk.eccentricity, 0.0, 0.0],
            ),
            nodeType=self._node_type,
            referencePosition=position[0],
            referenceRotationMatrix=rotation[0],
            initialVelocity=velocity[0],
            initialAngularVelocity=angular[0],
            gravity=GRAVITY_VECTOR,
        )
        self._node = self.system.GetObject(self._body)["nodeNumber"]
        table, origin = self._add_table()
        centre = self._disk_marker(0.0)
        self._add_contact(origin, centre)
        if self.scene.friction.coefficient:
            self._add_friction(table, centre)
        if self.scene.level >= 2:
            self._add_fixed_cog(origin, self._disk_marker(disk.eccentricity))
        if self.scene.level >= 4:
            self._add_carrier(centre)

    def _disk_marker(self, offset: float) -> int:
        return int(
            self.system.AddMarker(
                items.MarkerBodyRigid(bodyNumber=self._body, localPosition=[offset, 0.0, 0.0])
            )
        )

    def _add_friction(self, table: int, centre: int) -> None:
        upward = self.system.AddMarker(
            items.MarkerBodyRigid(
                bodyNumber=table, localHT=exu.HT(rotation=np.array(UPWARD), translation=[0.0] * 3)
            )
        )
        limit = friction_limit(self.scene, self._contact)
        force = connector_force(self.scene, limit, self._functions())
        if self._symbolic:
            force = symbolic_connector(self.system, force)
            self._kept.append(force)
        self.system.AddObject(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=[upward, centre],
                useIntrinsicFormulation=False,
                springForceTorqueUserFunction=force,
            )
        )

    def _add_carrier(self, centre: int) -> None:
        """Add a carrier that turns at the prescribed spin and takes the disk's axis along."""
        start = self.scene.start
        node = self.system.AddNode(
            items.Node1D(
                referenceCoordinates=[0.0],
                initialCoordinates=[start.coordinates[3]],
                initialVelocities=[start.rates[3]],
            )
        )
        carrier = self.system.AddObject(
            # Its motion is prescribed, so that its inertia matters to nothing.
            items.ObjectRotationalMass1D(nodeNumber=node, inertia=self.scene.disk.inertia_z)
        )
        # The joint wants its y axis along e_x of the R-frame, across the disk's axis.
        across = self.system.AddMarker(
            items.MarkerBodyRigid(
                bodyNumber=carrier,
                localHT=exu.HT(rotation=RotationMatrixZ(-pi / 2), translation=[0.0] * 3),
            )
        )
        self._add_constant_spin(node)
        self.system.AddObject(
            items.ObjectJointGeneric(
                markerNumbers=[across, centre], constrainedAxes=[0, 0, 0, 1, 0, 0]
            )
        )

    def record(self) -> Array:
        return np.concatenate(
            [
                self.system.GetNodeOutput(self._node, output)
                for output in (
                    _OUTPUT.Position,
                    _OUTPUT.RotationMatrix,
                    _OUTPUT.Velocity,
                    _OUTPUT.AngularVelocity,
                )
            ]
        )

    def decode(self, records: Array) -> tuple[Array, Array]:
        position, velocity, angular = records[:, :3], records[:, 12:15], records[:, 15:]
        rotation = records[:, 3:12].reshape(-1, 3, 3)
        return frames.from_poses(position, rotation, velocity, angular)

    def decode_accelerations(self, second_derivatives: Array) -> Array:
        coordinates, rates = self.decode(self.record()[None])
        angular = self._angular_acceleration(second_derivatives)
        result: Array = frames.accelerations_from_inertial(
            coordinates, rates, second_derivatives[None, :3], angular[None]
        )[0]
        return result

    def _angular_acceleration(self, second_derivatives: Array) -> Array:
        self.system.systemData.SetODE2Coordinates_tt(second_derivatives.tolist())
        angular = self.system.GetNodeOutput(self._node, _OUTPUT.AngularAcceleration)
        result: Array = np.array(angular, dtype=float)
        return result


class FloatingLie(Floating):
    """The same with a rotation vector, which the engine integrates on the Lie group."""

    _node_type = exu.NodeType.RotationRotationVector

    def coordinate_rates(self) -> Array:
        # On the Lie group the velocities are local angular velocities, not rates of coordinates.
        rates = super().coordinate_rates()
        vector = np.array(self.system.systemData.GetODE2CoordinatesTotal())[3:6]
        rates[3:6] = TExpSO3Inv(vector) @ rates[3:6]
        return rates

    def _angular_acceleration(self, second_derivatives: Array) -> Array:
        # The engine offers no such output for this node; its coordinates are the local components.
        rotation = self.record()[3:12].reshape(3, 3)
        angular: Array = rotation @ second_derivatives[3:6]
        return angular
