"""Penalty contact and what goes with it, on a free body in inertial components and on a tree.

With n the disk's axis, e the vertical and k = r² - c², the spheroid of semi-axes r, r, c has its
lowest point at p = -(r² e - k n_z n) / H from its centre, at the height H = sqrt(r² - k n_z²).

A body that turns by w moves its lowest point over its surface by p' - w x p = K (w x e), which is
level. K is symmetric: minus the derivative of p by the direction of the vertical.
"""

from collections.abc import Iterator
from math import cos, hypot, pi, sin, sqrt
from typing import Any

import numpy as np

from analysis.data import frames
from analysis.data.bodies import EllipticDisk, Sphere
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.dissipation import CAUSES
from analysis.data.scenario import Scenario
from mbs_models.friction import Force, euler_tree_force, law_force

_STEP = 1e-3
"""Angle in rad over which the surface of a body of one's own is differentiated."""

Triple = tuple[float, float, float]

Matrix = tuple[float, float, float, float, float, float, float, float, float]
"""A rotation matrix row by row; its columns are the axes of the body."""


class Loads:
    """Force and torque about the geometric centre G from table and air.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact. At a thickness of zero, the disk must not lie flat.
    """

    def __init__(self, scenario: Scenario) -> None:
        disk, dissipation = scenario.disk, scenario.dissipation
        self._scenario, self._contact = scenario, scenario.penalty_contact
        self._loss = dissipation
        self._by_weight = scenario.friction.load == "weight"
        self._weight, self._law = scenario.weight, law_force(scenario.friction)
        self._has_direction = not scenario.friction.IS_ISOTROPIC
        self._square = disk.radius**2
        half = disk.radius if isinstance(disk, Sphere) else self._contact.half_thickness
        self._least, self._flattening = half**2, self._square - half**2
        self._rolls = dissipation.rolling_dry > 0.0 or dissipation.rolling_viscous > 0.0
        half_air = 0.5 * dissipation.air_drag
        self._push = half_air * pi * disk.radius**2
        self._brake = half_air * 8.0 / 15.0 * disk.radius**5
        self._last: tuple[tuple[float, Matrix, Triple, Triple], Loading] | None = None

    def lowest(self, matrix: Matrix) -> Triple:
        """Lowest point from the centre in m, in inertial axes.

        Parameters
        ----------
        matrix : tuple of 9 floats
            Rotation.
        """
        up = matrix[8]
        height = sqrt(self._square - self._flattening * up * up)
        lean = self._flattening * up / height
        return lean * matrix[2], lean * matrix[5], -height

    def spread(self, matrix: Matrix) -> Triple:
        """Entries xx, xy and yy of K in m; see above."""
        x, y = matrix[2], matrix[5]
        xx, xy, yy = (self._flattening * each for each in (x * x, x * y, y * y))
        square = self._least + xx + yy
        ratio = self._square / (square * sqrt(square))
        return ratio * (self._least + yy), -ratio * xy, ratio * (self._least + xx)

    def contour(self, matrix: Matrix, w: Triple) -> tuple[float, float]:
        """Velocity in m/s of the contact point over the surface; it is horizontal.

        Parameters
        ----------
        matrix, w : tuple of 9 and of 3 floats
            As in `at`.
        """
        xx, xy, yy = self.spread(matrix)
        return xx * w[1] - xy * w[0], xy * w[1] - yy * w[0]

    def at(self, centre_height: float, matrix: Matrix, v: Triple, w: Triple) -> "Loading":
        """Force and torque on the disk, and what they tell about the contact.

        The last answer is kept: an engine that integrates the powers too asks twice.

        Parameters
        ----------
        centre_height : float
            Height of G over the table in m.
        matrix : tuple of 9 floats
            Rotation.
        v, w : tuple of 3 floats
            Velocity of G in m/s and angular velocity in rad/s.
        """
        state = (centre_height, matrix, v, w)
        if self._last is None or self._last[0] != state:
            self._last = (state, self._new(*state))
        return self._last[1]

    def over(
        self, place: Array, rotation: Array, velocity: Array, angular: Array
    ) -> Iterator[tuple["Loading", float]]:
        """What acts at each sample of a motion, and the speed over the surface in m/s.

        Parameters
        ----------
        place, velocity, angular : ndarray, shape (n, 3)
            As in `at`, in inertial components.
        rotation : ndarray, shape (n, 3, 3)
        """
        matrices: Any = map(tuple, rotation.reshape(-1, 9).tolist())
        states = zip(place[:, 2].tolist(), velocity.tolist(), angular.tolist(), strict=True)
        for matrix, (height, v, w) in zip(matrices, states, strict=True):
            yield self.at(height, matrix, v, w), hypot(*self.contour(matrix, w))

    @property
    def last(self) -> "Loading":
        """The last answer."""
        assert self._last is not None
        return self._last[1]

    def _new(self, centre_height: float, matrix: Matrix, v: Triple, w: Triple) -> "Loading":
        load = Loading()
        px, py, pz = load.point = self.lowest(matrix)
        # Velocity of the material at the contact point.
        sx = v[0] + w[1] * pz - w[2] * py
        sy = v[1] + w[2] * px - w[0] * pz
        rise = v[2] + w[0] * py - w[1] * px
        normal = self._normal_force(-pz - centre_height, rise, load)
        load.slip = hypot(sx, sy)
        fx, fy = self._friction(matrix, sx, sy, normal)
        load.taken[1] = -(fx * sx + fy * sy)
        load.force = (fx, fy, normal)
        load.torque = (py * normal - pz * fy, pz * fx - px * normal, px * fy - py * fx)
        if self._rolls:
            self._rolling(matrix, w, load)
        if self._loss.pivoting:
            moment = self._loss.pivoting * normal / (abs(w[2]) + self._loss.pivoting_smoothing)
            load.add((0.0, 0.0, 0.0), (0.0, 0.0, -moment * w[2]))
            load.taken[4] = moment * w[2] * w[2]
        if self._push:
            self._air((matrix[2], matrix[5], matrix[8]), v, w, load)
        return load

    def _normal_force(self, depth: float, rise: float, load: "Loading") -> float:
        contact = self._contact
        spring = contact.stiffness * depth
        force = spring - contact.damping * rise
        if not contact.bilateral:
            if depth <= 0.0:
                spring = force = 0.0
            force = max(force, 0.0)
        load.taken[0] = (spring - force) * rise
        load.elastic = 0.5 * spring * depth
        return force

    def _friction(
        self, matrix: Matrix, sx: float, sy: float, normal: float
    ) -> tuple[float, float]:
        """Friction; the weight is its load wherever there is contact at all."""
        if not (normal > 0.0 or self._contact.bilateral):
            return 0.0, 0.0
        load = self._weight if self._by_weight else max(0.0, normal)
        if not self._has_direction:
            return self._law(sx, sy, load)
        # The edge points along the horizontal at a right angle to the axis.
        level = hypot(matrix[2], matrix[5])
        c, s = -matrix[5] / level, matrix[2] / level
        fx, fy = self._law(c * sx + s * sy, c * sy - s * sx, load)
        return c * fx - s * fy, s * fx + c * fy

    def _rolling(self, matrix: Matrix, w: Triple, load: "Loading") -> None:
        """Add the torque of the resistance to the contact point's velocity over the surface.

        A resistance F on it takes F . K (w x e) = w . (e x K F).
        """
        xx, xy, yy = self.spread(matrix)
        x, y = xx * w[1] - xy * w[0], xy * w[1] - yy * w[0]
        speed = hypot(x, y)
        dry = self._loss.rolling_dry * load.force[2] / (speed + self._loss.rolling_smoothing)
        viscous = self._loss.rolling_viscous * load.force[2]
        load.taken[2:4] = dry * speed * speed, viscous * speed * speed
        x, y = (dry + viscous) * x, (dry + viscous) * y
        load.add((0.0, 0.0, 0.0), (xy * x + yy * y, -xx * x - xy * y, 0.0))

    def _air(self, n: Triple, v: Triple, w: Triple, load: "Loading") -> None:
        along = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
        axial = n[0] * w[0] + n[1] * w[1] + n[2] * w[2]
        tx, ty, tz = w[0] - axial * n[0], w[1] - axial * n[1], w[2] - axial * n[2]
        rate = sqrt(tx * tx + ty * ty + tz * tz)
        push, brake = -self._push * abs(along) * along, -self._brake * rate
        load.add((push * n[0], push * n[1], push * n[2]), (brake * tx, brake * ty, brake * tz))
        load.taken[5] = -push * along - brake * rate * rate


class Loading:
    """What acts on the disk at one instant.

    Attributes
    ----------
    force, torque : tuple of 3 floats
        On the disk at its centre in N and N m, without its weight.
    point : tuple of 3 floats
        Contact point from the centre in m.
    slip : float
        Speed in m/s of the material at the contact point.
    elastic : float
        Energy in J in the contact's spring.
    taken : list of 6 floats
        Power in W taken by each of `CAUSES`.
    """

    __slots__ = ("elastic", "force", "point", "slip", "taken", "torque")

    def __init__(self) -> None:
        self.force = self.torque = self.point = (0.0, 0.0, 0.0)
        self.slip = self.elastic = 0.0
        self.taken = [0.0] * len(CAUSES)

    def add(self, force: Triple, torque: Triple) -> None:
        """Add a force at the centre and a torque."""
        a, b = self.force, self.torque
        self.force = (a[0] + force[0], a[1] + force[1], a[2] + force[2])
        self.torque = (b[0] + torque[0], b[1] + torque[1], b[2] + torque[2])


def euler_tree_contact(scenario: Scenario) -> Force:
    """Generalised contact force on the joints (alpha, x, y, z, beta, gamma) of an Euler tree."""
    contact = scenario.penalty_contact
    r, always = scenario.disk.radius, contact.bilateral
    stiffness, damping = contact.stiffness, contact.damping
    by_weight, weight = scenario.friction.load == "weight", scenario.weight
    load = 0.0
    friction = euler_tree_force(scenario, lambda: load)

    def force(system: Any, time: Any, item: Any, q: Any, u: Any) -> list[float]:
        nonlocal load
        side, height = r * cos(q[4]), q[3] - r * sin(q[4])
        normal = -stiffness * height - damping * (u[3] - side * u[4])
        if not always:
            normal = max(0.0, normal) if height < 0.0 else 0.0
        # A contact that pulls is no load; the weight is one wherever there is contact at all.
        if not (always or normal > 0.0):
            return [0.0] * 6
        load = weight if by_weight else max(0.0, normal)
        forces = friction(system, time, item, q, u)
        forces[3] = normal
        forces[4] -= side * normal
        return forces

    return force


def loads_of(scenario: Scenario) -> Loads:
    """What acts on a body on its penalty contact."""
    body = scenario.disk
    if body.is_round_disk or isinstance(body, Sphere):
        return Loads(scenario)
    return _EllipticLoads(scenario) if isinstance(body, EllipticDisk) else _OwnLoads(scenario)


class _EllipticLoads(Loads):
    """An elliptic disk, rounded or not.

    With the semi-axes a as inertial vectors and B = sum a aᵀ, the lowest point is at p = -B e / H
    from the centre, at the depth H = sqrt(e . B e), and K = (B - B e (B e)ᵀ / H²) / H.
    """

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(scenario)
        body = scenario.disk
        assert isinstance(body, EllipticDisk)
        a, b, angle = body.radius, body.other_radius, body.long_axis
        # Columns of a rotation matrix make the semi-axes.
        self._first = a * cos(angle), a * sin(angle)
        self._second = -b * sin(angle), b * cos(angle)
        self._third = self._contact.half_thickness

    def _semi_axes(self, matrix: Matrix) -> tuple[Triple, Triple, Triple]:
        """The x, y and z components of the three."""
        (a, b), (c, d), third = self._first, self._second, self._third
        x, y, z = (
            (a * matrix[k] + b * matrix[k + 1], c * matrix[k] + d * matrix[k + 1],
             third * matrix[k + 2])
            for k in (0, 3, 6)
        )  # fmt: skip
        return x, y, z

    def lowest(self, matrix: Matrix) -> Triple:
        x, y, z = self._semi_axes(matrix)
        depth = sqrt(_dot(z, z))
        return -_dot(x, z) / depth, -_dot(y, z) / depth, -depth

    def spread(self, matrix: Matrix) -> Triple:
        x, y, z = self._semi_axes(matrix)
        square, along, across = _dot(z, z), _dot(x, z), _dot(y, z)
        xx, xy, yy = (
            _dot(x, x) - along * along / square,
            _dot(x, y) - along * across / square,
            _dot(y, y) - across * across / square,
        )
        depth = sqrt(square)
        return xx / depth, xy / depth, yy / depth


class _OwnLoads(Loads):
    """A body of one's own, whose lowest point is the one that it says."""

    def lowest(self, matrix: Matrix) -> Triple:
        return self._lowest(matrix, (0.0, 0.0, 1.0))

    def spread(self, matrix: Matrix) -> Triple:
        s, c, s2, c2 = (f(k * _STEP) for k in (1, 2) for f in (sin, cos))

        def slope(x: float, y: float) -> tuple[float, float]:
            """Minus the change of the lowest point as the vertical leans that way."""
            ahead, back, far, behind = (
                self._lowest(matrix, (x * level, y * level, up))
                for level, up in ((s, c), (-s, c), (s2, c2), (-s2, c2))
            )
            first, second = (
                (far[k] - behind[k] - 8.0 * (ahead[k] - back[k])) / (12.0 * _STEP) for k in (0, 1)
            )
            return first, second

        return *slope(1.0, 0.0), slope(0.0, 1.0)[1]

    def _lowest(self, matrix: Matrix, up: Triple) -> Triple:
        """Lowest point from the centre in m for a vertical in this direction."""
        rows = matrix[:3], matrix[3:6], matrix[6:]
        a, b, c = (_dot(up, column) for column in zip(*rows, strict=True))
        point = self._scenario.disk.lowest_point((a, b, c), self._contact.half_thickness)
        x, y, z = (_dot(row, point) for row in rows)
        return x, y, z


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def forces_on(scenario: Scenario, z: Array, u: Array) -> Array:
    """Normal force in N, shape (n,), of coordinates z and rates u, shape (n, 6) each."""
    (place, rotation), (velocity, angular) = frames.poses(z), frames.twists(z, u)
    loadings = loads_of(scenario).over(place, rotation, velocity, angular)
    return np.array([load.force[2] for load, _ in loadings])


def largest_lever(body: Body, leaning: float, half_thickness: float) -> float:
    """Largest rate of the contact point over the surface in m/s, for each rad/s of turning.

    Parameters
    ----------
    body : Body
    leaning : float
        Sine of the smallest inclination, 0 flat.
    half_thickness : float
        Of the contact in m.
    """
    if not body.has_edge:
        return body.radius
    least = body.other_radius if isinstance(body, EllipticDisk) else body.radius
    return body.radius**2 / hypot(least * leaning, half_thickness)
