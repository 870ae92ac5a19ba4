"""Newton-Euler equations of the disk on a table, regular in every attitude.

The state holds, in this order, the position of the centre of gravity S in the inertial frame (3),
the attitude as a quaternion (4, scalar first), the velocity of S (3) and the angular velocity (3)
in the body frame, and the energy taken so far by each of `dissipation.CAUSES` (6). Nothing but
the vertical in the body frame enters the forces, so that no frame is built for the contact.
"""

from math import pi, sqrt
from typing import NamedTuple

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.rest.spheroid import Vector3, contact_point, contour_velocity, support_height


class Contact(NamedTuple):
    """The contact at one instant, vectors in the body frame.

    `upward` is the vertical, `point` the contact point seen from S in m, `gap` the distance
    between disk and table in m, negative for penetration, `gap_rate` its rate, `slip` the
    horizontal velocity of the disk's material at the contact point in m/s, `contour` that of the
    contact point along the rim in m/s, `force` the normal force in N.
    """

    upward: Vector3
    point: Vector3
    gap: float
    gap_rate: float
    slip: Vector3
    contour: Vector3
    force: float


class FreeDisk:
    """A disk on a table with what acts on it.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.

    Raises
    ------
    ValueError
        If the contact is the ideal one.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.contact = scenario.penalty_contact
        self.disk, self.friction, self.dissipation = (
            scenario.disk,
            scenario.friction,
            scenario.dissipation,
        )
        self._weight, self._gravity = scenario.weight, scenario.table.vector
        self._leans = not scenario.table.is_horizontal

    def touch(self, state: list[float]) -> Contact:
        """Contact in this state."""
        disk, rim = self.disk, self.contact
        upward = vertical(state)
        velocity: Vector3 = (state[7], state[8], state[9])
        angular: Vector3 = (state[10], state[11], state[12])
        x, y, z = contact_point(disk.radius, rim.half_thickness, upward)
        point = (x - disk.eccentricity, y, z)
        gap = (
            state[2]
            - disk.eccentricity * upward[0]
            - support_height(disk.radius, rim.half_thickness, upward)
        )
        material = add(velocity, cross(angular, point))
        gap_rate = dot(material, upward)
        slip = add_scaled(material, -gap_rate, upward)
        contour = contour_velocity(disk.radius, rim.half_thickness, upward, cross(upward, angular))
        force = -rim.stiffness * gap - rim.damping * gap_rate
        if not rim.bilateral and (gap > 0.0 or force < 0.0):
            force = 0.0
        return Contact(upward, point, gap, gap_rate, slip, contour, force)

    def derivative(self, _: float, state: Array) -> list[float]:
        """Time derivative of the state."""
        values = state.tolist()
        disk = self.disk
        contact = self.touch(values)
        force, torque, powers = self._loads(contact, values)
        v, w = values[7:10], values[10:13]
        a, b, c = disk.inertia_about_cog
        return [
            *to_inertial(values[3:7], v),
            *quaternion_rate(values[3:7], w),
            force[0] / disk.mass - w[1] * v[2] + w[2] * v[1],
            force[1] / disk.mass - w[2] * v[0] + w[0] * v[2],
            force[2] / disk.mass - w[0] * v[1] + w[1] * v[0],
            (torque[0] - (c - b) * w[1] * w[2]) / a,
            (torque[1] - (a - c) * w[2] * w[0]) / b,
            (torque[2] - (b - a) * w[0] * w[1]) / c,
            *powers,
        ]

    def _loads(
        self, contact: Contact, values: list[float]
    ) -> tuple[Vector3, Vector3, list[float]]:
        """Force, torque about S, and the power taken by each of `CAUSES`."""
        upward, normal = contact.upward, contact.force
        load = max(0.0, normal)
        if self.friction.load == "weight" and (normal > 0.0 or self.contact.bilateral):
            load = self._weight
        speed = norm(contact.slip)
        factor = load * self.friction.per_speed(speed)
        at_point = add_scaled(scaled(normal, upward), -factor, contact.slip)
        torque = cross(contact.point, at_point)
        force = add_scaled(at_point, -self._weight, upward)
        if self._leans:
            along = to_body(values[3:7], (self._gravity[0], self._gravity[1], 0.0))
            force = add_scaled(force, self.disk.mass, along)
        powers = [self._damping(contact), factor * speed * speed, 0.0, 0.0, 0.0, 0.0]
        loss = self.dissipation
        if loss.rolling_dry or loss.rolling_viscous:
            torque = add(torque, self._rolling(contact, powers))
        if loss.pivoting:
            spin = dot(upward, (values[10], values[11], values[12]))
            moment = loss.pivoting * normal * spin / (abs(spin) + loss.pivoting_smoothing)
            torque = add_scaled(torque, -moment, upward)
            powers[4] = moment * spin
        if loss.air_drag:
            drag, brake = self._drag(values, powers)
            force, torque = add(force, drag), add(torque, brake)
        return force, torque, powers

    def _damping(self, contact: Contact) -> float:
        """Power taken by the contact's damper: what the force takes and the spring keeps not."""
        spring = -self.contact.stiffness * contact.gap
        if not self.contact.bilateral and contact.gap > 0.0:
            spring = 0.0
        return (spring - contact.force) * contact.gap_rate

    def _rolling(self, contact: Contact, powers: list[float]) -> Vector3:
        """Torque of the rolling resistance, that which the force on the contour does work by."""
        loss = self.dissipation
        speed = norm(contact.contour)
        dry = loss.rolling_dry * contact.force / (speed + loss.rolling_smoothing)
        viscous = loss.rolling_viscous * contact.force
        powers[2], powers[3] = dry * speed * speed, viscous * speed * speed
        # contour = S (u x w) with S symmetric, so the torque -F is conjugate to is (S F) x u.
        radius, thickness = self.disk.radius, self.contact.half_thickness
        carried = contour_velocity(radius, thickness, contact.upward, contact.contour)
        return scaled(dry + viscous, cross(contact.upward, carried))

    def _drag(self, values: list[float], powers: list[float]) -> tuple[Vector3, Vector3]:
        """Force and torque of the air, as pressure 1/2 air_drag v |v| on the moving faces."""
        disk = self.disk
        # Velocity of the geometric centre along the axis, and the tumbling rate.
        along = values[9] + values[11] * disk.eccentricity
        p, q = values[10], values[11]
        tumbling = sqrt(p * p + q * q)
        half = 0.5 * self.dissipation.air_drag
        push = -half * pi * disk.radius**2 * abs(along) * along
        moment = half * 8.0 / 15.0 * disk.radius**5 * tumbling
        powers[5] = -push * along + moment * tumbling * tumbling
        return (0.0, 0.0, push), (-moment * p, -moment * q + push * disk.eccentricity, 0.0)

    def energies(self, state: list[float]) -> Vector3:
        """Kinetic, gravitational (counted from the table) and elastic energy in J."""
        disk = self.disk
        a, b, c = disk.inertia_about_cog
        vx, vy, vz, wx, wy, wz = state[7:13]
        kinetic = 0.5 * disk.mass * (vx * vx + vy * vy + vz * vz)
        kinetic += 0.5 * (a * wx * wx + b * wy * wy + c * wz * wz)
        gap = self.touch(state).gap
        touching = self.contact.bilateral or gap < 0.0
        elastic = 0.5 * self.contact.stiffness * gap * gap if touching else 0.0
        gx, gy, gz = self._gravity
        potential = -disk.mass * (gx * state[0] + gy * state[1] + gz * state[2])
        return kinetic, potential, elastic


def vertical(state: list[float]) -> Vector3:
    """Upward unit vector in the body frame."""
    w, x, y, z = state[3:7]
    square = w * w + x * x + y * y + z * z
    return (
        2.0 * (x * z - w * y) / square,
        2.0 * (y * z + w * x) / square,
        (w * w - x * x - y * y + z * z) / square,
    )


def to_inertial(quaternion: list[float], v: list[float]) -> Vector3:
    """Inertial components of a vector in the body frame."""
    w, x, y, z = quaternion
    square = w * w + x * x + y * y + z * z
    tx = 2.0 * (y * v[2] - z * v[1]) / square
    ty = 2.0 * (z * v[0] - x * v[2]) / square
    tz = 2.0 * (x * v[1] - y * v[0]) / square
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


def to_body(quaternion: list[float], v: Vector3) -> Vector3:
    """Components in the body frame of an inertial vector."""
    w, x, y, z = quaternion
    return to_inertial([w, -x, -y, -z], list(v))


def quaternion_rate(quaternion: list[float], w: list[float]) -> tuple[float, float, float, float]:
    """Rate of the quaternion at the angular velocity `w` in the body frame."""
    s, x, y, z = quaternion
    p, q, r = 0.5 * w[0], 0.5 * w[1], 0.5 * w[2]
    return (
        -x * p - y * q - z * r,
        s * p + y * r - z * q,
        s * q + z * p - x * r,
        s * r + x * q - y * p,
    )


def add(a: Vector3, b: Vector3) -> Vector3:
    """Sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def add_scaled(a: Vector3, factor: float, b: Vector3) -> Vector3:
    """Sum of a vector and a multiple of another."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


def scaled(factor: float, a: Vector3) -> Vector3:
    """Multiple of a vector."""
    return factor * a[0], factor * a[1], factor * a[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector3, b: Vector3) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: Vector3) -> float:
    """Length."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
