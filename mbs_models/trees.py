"""The disk as a kinematic tree: `euler-tree` and `contact-tree`."""

from functools import partial
from math import cos, sin
from typing import Any, ClassVar

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.problem import elementary
from analysis.problem.checks import Array
from analysis.problem.constraints import MODELS
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES
from mbs_models.friction import free_slip_force
from mbs_models.loads import IMAGINARY, pressing
from mbs_models.model import Floats, Force, Load, Model, Reading


class _Tree(Model):
    """A chain of massless links with the disk at its end; the last joint turns it in its plane."""

    has_euler_angles = True
    quick_from = 3e-12

    _chain: ClassVar[str]
    """Joints, by the engine's names of their types."""

    def _build(self) -> None:
        joints = [getattr(exu.JointType, name) for name in self._chain.split()]
        disk = self.scenario.disk
        n = len(joints)
        position, velocity = self.encode(self.start.coordinates, self.start.rates)
        self._node = self.assembly.add(
            items.NodeGenericODE2(
                numberOfODE2Coordinates=n,
                referenceCoordinates=[0.0] * n,
                initialCoordinates=position,
                initialCoordinates_t=velocity,
            ),
            "the joint coordinates",
        )
        # Above the contact point, if the chain starts there.
        zeros, offset = [[0.0] * 3] * (n - 1), disk.radius if self.closes_contact else 0.0
        inertias = [np.zeros((3, 3))] * (n - 1) + [disk.tensor_about_cog]
        self._tree = self.assembly.add(
            items.ObjectKinematicTree(
                nodeNumber=self._node,
                gravity=list(self.scenario.table.vector),
                jointTypes=joints,
                linkParents=list(range(-1, n - 1)),
                jointTransformations=exu.Matrix3DList([np.eye(3)] * n),
                jointOffsets=exu.Vector3DList([*zeros, [0.0, offset, 0.0]]),
                linkInertiasCOM=exu.Matrix3DList(inertias),
                linkCOMs=exu.Vector3DList([*zeros, [disk.eccentricity, 0.0, 0.0]]),
                linkMasses=[0.0] * (n - 1) + [disk.mass],
            ),
            "the disk at the end of its joints, with its weight",
        )
        self._add_forces()

    def pose_readings(self) -> list[Reading]:
        data = self.system.systemData
        return [data.GetODE2Coordinates, data.GetODE2Coordinates_t]

    def act(self, force: Force, name: str) -> None:
        self.system.SetObjectParameter(self._tree, "forceUserFunction", force)
        self.assembly.reasons["object", self._tree] += f" and {name} by a user function"


class EulerTree(_Tree):
    """Tree in the paper's coordinates: alpha, then x, y, z in the R-frame, then beta, gamma."""

    name = "euler-tree"

    _chain = "RevoluteZ PrismaticX PrismaticY PrismaticZ RevoluteX RevoluteZ"
    _order = (3, 0, 1, 2, 4, 5)
    _back: ClassVar[list[int]] = [1, 2, 3, 0, 4, 5]

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:
        contact = scenario.contact
        if contact is not None and contact.is_rounded:
            return (
                "is singular when the disk lies flat, which a contact with half_thickness = "
                f"{contact.half_thickness:g} lasts until"
            )
        if scenario.dissipation.is_on:
            return "knows no dissipation besides friction and the contact's damping"
        return ""

    def encode(self, coordinates: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        order = self._order
        return [coordinates[place] for place in order], [rates[place] for place in order]

    def _build(self) -> None:
        super()._build()
        if self.scenario.contact is None:
            close = partial(self.joints.touch, self._tree, self._gap)
            self.joints.add(self._disk_marker, self._turning, close)

    def _turning(self, coordinate: str) -> tuple[int, int]:
        return self._node, self._order.index(COORDINATES.index(coordinate))

    def _disk_marker(self, offset: float, why: str) -> int:
        return self.assembly.add(
            items.MarkerKinematicTreeRigid(
                objectNumber=self._tree, linkNumber=5, localPosition=[offset, 0.0, 0.0]
            ),
            why,
        )

    def residual_rate(self, position: Array, velocity: Array) -> Array | None:
        if self.scenario.disk.is_round_disk:
            return None
        _, slopes = self._gap(position + IMAGINARY * 1j * velocity)
        return np.array([np.dot(slopes, velocity).imag / IMAGINARY])

    def _lowest(self, beta: Any, gamma: Any) -> tuple[Any, Any, Any]:
        """Lowest point of the body seen from its centre, in axes of the R-frame."""
        disk = self.scenario.disk
        if disk.is_round_disk:
            return 0.0, -disk.radius * cos(beta), -disk.radius * sin(beta)
        s, c, turn, side = (
            of(x) for x in (beta, gamma) for of in (elementary.sin, elementary.cos)
        )
        x, y, z = disk.lowest_point((s * turn, s * side, c))
        along = turn * x + side * y
        return side * x - turn * y, c * along - s * z, s * along + c * z

    def _gap(self, q: Any) -> tuple[Any, list[Any]]:
        """Height of the lowest point over the table, and its slopes in the joint coordinates."""
        # The point moves over the surface, which is level there.
        x, y, z = self._lowest(q[4], q[5])
        return q[3] + z, [0.0, 0.0, 0.0, 1.0, y, elementary.sin(q[4]) * x]

    def friction(self, load: Load) -> Force:
        """Generalised force on the joints (alpha, x, y, z, beta, gamma)."""
        friction, lowest = free_slip_force(self.scenario, self.slip_part), self._lowest

        def force(_system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[float]:
            px, py, pz = lowest(q[4], q[5])
            s, c = sin(q[4]), cos(q[4])
            x, y, roll = q[1] + px, q[2] + py, s * pz + c * py
            slip_x = u[1] - y * u[0] - roll * u[5]
            slip_y = u[2] + x * u[0] + c * px * u[5] - pz * u[4]
            fx, fy = friction(slip_x, slip_y, load())
            return [x * fy - y * fx, fx, fy, 0.0, -pz * fy, c * px * fy - roll * fx]

        return force

    def _contact_force(self) -> Force:
        """Generalised force on the same joints."""
        press, gap, load = pressing(self.scenario), self._gap, 0.0
        friction = self.friction(lambda: load)

        def force(system: Any, time: Any, item: Any, q: Any, u: Any) -> list[float]:
            nonlocal load
            height, (*_, per_tilt, per_turn) = gap(q)
            rise = u[3] + per_tilt * u[4] + per_turn * u[5]
            _, normal, part, load = press(-height, rise)
            if not part:
                return [0.0] * 6
            forces = [part * each for each in friction(system, time, item, q, u)]
            forces[3] = normal
            forces[4] += per_tilt * normal
            forces[5] += per_turn * normal
            return forces

        return force

    def decode(self, records: Array) -> tuple[Array, Array]:
        return records[:, :6][:, self._back], records[:, 6:12][:, self._back]

    def decode_accelerations(
        self, second_derivatives: Array, coordinates: Floats, rates: Floats
    ) -> Floats:
        spin, *place, tilt, turn = second_derivatives.tolist()
        return *place, spin, tilt, turn


class ContactTree(_Tree):
    """Tree that starts at the contact point: alpha, x_C, y_C, then beta there, then gamma.

    The table's contact is closed by the topology, so that no constraint is left: five minimal
    coordinates, which the engine's explicit integrators can take.
    """

    name = "contact-tree"
    closes_contact = True

    _chain = "RevoluteZ PrismaticX PrismaticY RevoluteX RevoluteZ"

    @classmethod
    def obstacle(cls, scenario: Scenario) -> str:
        if not scenario.disk.is_round_disk:
            return "has a round disk at its end"
        if scenario.constraints != MODELS[1]:
            return f"exists for Model 1 alone, got {scenario.name}"
        if scenario.contact is not None:
            return "closes the contact by its topology and has no room for a penalty contact"
        if scenario.friction.load == "contact":
            return (
                "has no contact constraint whose force the load 'contact' of the friction law "
                "could take"
            )
        return ""

    def friction(self, load: Load) -> Force:
        """Generalised force on the joints (alpha, x_C, y_C, beta, gamma).

        The contact point moves with the joints before gamma, so the slip velocity is the velocity
        of that point plus the rim speed r gamma'.
        """
        r, friction = self.scenario.disk.radius, free_slip_force(self.scenario, self.slip_part)
        # That of the weight alone, which stays.
        weight = load()

        def force(_system: Any, _t: Any, _item: Any, q: Any, u: Any) -> list[float]:
            x, y, spin = q[1], q[2], u[0]
            slip_x = u[1] - y * spin + r * u[4]
            slip_y = u[2] + x * spin
            fx, fy = friction(slip_x, slip_y, weight)
            return [x * fy - y * fx, fx, fy, 0.0, r * fx]

        return force

    def encode(self, coordinates: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        x, y, _, alpha, beta, gamma = coordinates
        xd, yd, _, ad, bd, gd = rates
        r = self.scenario.disk.radius
        return (
            [alpha, x, y - r * cos(beta), beta, gamma],
            [ad, xd, yd + r * sin(beta) * bd, bd, gd],
        )

    def pose_readings(self) -> list[Reading]:
        # No constraint carries the contact force, so it is taken from the accelerations.
        return [*super().pose_readings(), self.system.systemData.GetODE2Coordinates_tt]

    def decode(self, records: Array) -> tuple[Array, Array]:
        r = self.scenario.disk.radius
        alpha, x, y, beta, gamma, ad, xd, yd, bd, gd = records.T[:10]
        sb, cb = np.sin(beta), np.cos(beta)
        coordinates = np.column_stack((x, y + r * cb, r * sb, alpha, beta, gamma))
        rates = np.column_stack((xd, yd - r * sb * bd, r * cb * bd, ad, bd, gd))
        return coordinates, rates

    def decode_accelerations(
        self, second_derivatives: Array, coordinates: Floats, rates: Floats
    ) -> Floats:
        r = self.scenario.disk.radius
        add, xdd, ydd, bdd, gdd = second_derivatives.tolist()
        beta, bd = coordinates[4], rates[4]
        sb, cb = sin(beta), cos(beta)
        back, rise = r * (sb * bdd + cb * bd * bd), r * (cb * bdd - sb * bd * bd)
        return xdd, ydd - back, rise, add, bdd, gdd

    def multipliers(self, carriers: Array, coordinates: Array, rates: Array) -> Array:
        """Normal force: the mass times gravity and the centre of gravity's rise, shape (n, 1)."""
        disk, table = self.scenario.disk, self.scenario.table
        r, e = disk.radius, disk.eccentricity
        beta, gamma, bd, gd = coordinates[:, 4], coordinates[:, 5], rates[:, 4], rates[:, 5]
        bdd, gdd = carriers[:, -2:].T
        sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
        rise = e * (cg * gdd - sg * gd * gd) * sb + 2 * e * cg * gd * cb * bd
        rise += (r + e * sg) * (cb * bdd - sb * bd * bd)
        force: Array = disk.mass * (table.pressing + rise)
        return force[:, None]
