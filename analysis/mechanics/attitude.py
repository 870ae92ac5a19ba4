"""Charts of the attitude, and states of the equations of motion in them.

A chart, Euler angles or quaternions for a disk that may lie flat, gives the axes of a frame on
the table, seen from the body: e_x and e_y along it and the vertical. The frame may turn about the
vertical; velocities of the centre of gravity are taken in its axes, angular velocities in those of
the body: with these the mass matrix is constant and diagonal.

A state in Euler angles holds the position of the centre of gravity S in axes of the frame R (3),
alpha, beta and gamma, the velocity of S in axes of R (3) and the rates of the angles, or what else
its chart tells the turning by (3). All functions take numbers of any kind, arrays of many states
among them.
"""

from typing import Any, NamedTuple

from analysis.mechanics.linear_algebra import Vector, add, dot, scaled
from analysis.problem.elementary import Numbers, cos, sin


class Frame(NamedTuple):
    """Axes of a frame on the table, in axes of the body."""

    ahead: Vector
    across: Vector
    up: Vector

    def seen(self, vector: Vector) -> Vector:
        """Components along the frame's axes of a vector in axes of the body."""
        return dot(self.ahead, vector), dot(self.across, vector), dot(self.up, vector)

    def in_body(self, vector: Vector) -> Vector:
        """Components along the body's axes of a vector in axes of the frame."""
        x, y, z = vector
        return add(add(scaled(x, self.ahead), scaled(y, self.across)), scaled(z, self.up))


class Moving(NamedTuple):
    """A state taken apart.

    Position and velocity of S in axes of the frame, which turns with `spin`; the attitude as a
    chart tells it, and its rates; the angular velocity in axes of the body.
    """

    position: Vector
    attitude: Numbers
    rates: Numbers
    velocity: Vector
    angular: Vector
    frame: Frame
    spin: Any


class EulerAngles:
    """The paper's angles alpha, beta, gamma in z-x-z order; the frame is R, turned by alpha.

    A state holds the position of S, the angles, the velocity of S and the rates of the angles.
    """

    HOLDS_RATES = True

    @classmethod
    def moving(cls, state: Numbers) -> Moving:
        """A state of 12 numbers taken apart."""
        position, angles, velocity, turning = (tuple(state[k : k + 3]) for k in (0, 3, 6, 9))
        rates = cls.rates(angles, turning)
        angular = cls.angular_velocity(angles, rates) if cls.HOLDS_RATES else turning
        return Moving(position, angles, rates, velocity, angular, cls.frame(angles), rates[0])

    @classmethod
    def derivative(cls, moving: Moving, acceleration: tuple[Vector, Vector]) -> list[Any]:
        """Time derivative of the state, with these changes of its velocities."""
        x, y, _ = moving.position
        u, v, w = moving.velocity
        place = u + moving.spin * y, v - moving.spin * x, w
        linear, change = acceleration
        turning = cls._changes(moving, change) if cls.HOLDS_RATES else change
        return [*place, *moving.rates, *linear, *turning]

    @classmethod
    def rates(cls, angles: Numbers, turning: Numbers) -> Vector:
        """Rates of the angles, from the last three numbers of a state."""
        p, q, s = turning
        if cls.HOLDS_RATES:
            return p, q, s
        _, beta, gamma = angles
        sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
        spin = (sg * p + cg * q) / sb
        return spin, cg * p - sg * q, s - cb * spin

    @staticmethod
    def _changes(moving: Moving, change: Vector) -> Vector:
        """Second derivatives of the angles, from the change of the angular velocity."""
        (_, beta, gamma), (spin, tilting, rolling) = moving.attitude, moving.rates
        p, q, s = change
        sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
        spinning = (sg * p + cg * q + tilting * (rolling - spin * cb)) / sb
        return (
            spinning,
            cg * p - sg * q - spin * rolling * sb,
            s - cb * spinning + sb * spin * tilting,
        )

    @staticmethod
    def gravity(moving: Moving, gravity: Vector) -> Vector:
        """Gravity in axes of the frame, from that in axes of the table."""
        x, y, z = gravity
        sa, ca = sin(moving.attitude[0]), cos(moving.attitude[0])
        return ca * x + sa * y, ca * y - sa * x, z

    @staticmethod
    def frame(angles: Numbers) -> Frame:
        """The frame R."""
        _, beta, gamma = angles
        sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
        return Frame((cg, -sg, 0.0), (cb * sg, cb * cg, -sb), (sb * sg, sb * cg, cb))

    @staticmethod
    def angular_velocity(angles: Numbers, rates: Numbers) -> Vector:
        """Angular velocity in axes of the body."""
        ahead, _, up = EulerAngles.frame(angles)
        alpha_rate, beta_rate, gamma_rate = rates
        return (
            alpha_rate * up[0] + beta_rate * ahead[0],
            alpha_rate * up[1] + beta_rate * ahead[1],
            alpha_rate * up[2] + gamma_rate,
        )


class EulerTurning(EulerAngles):
    """The same, with the angular velocity in axes of the body in place of the rates.

    It stays smooth where the disk is nearly flat and the rates of alpha and gamma grow beyond all
    bounds. Elsewhere it changes faster than they do.
    """

    HOLDS_RATES = False


class Quaternion:
    """A quaternion, scalar part first, of any length; the frame is the inertial one.

    A state holds the position of S, the quaternion, the velocity of S and the angular velocity.
    """

    @staticmethod
    def moving(state: Numbers) -> Moving:
        """A state of 13 numbers taken apart."""
        quaternion = tuple(state[3:7])
        position, velocity, angular = (tuple(state[k : k + 3]) for k in (0, 7, 10))
        rates, frame = Quaternion.rates(quaternion, angular), Quaternion.frame(quaternion)
        return Moving(position, quaternion, rates, velocity, angular, frame, 0.0)

    @staticmethod
    def derivative(moving: Moving, acceleration: tuple[Vector, Vector]) -> list[Any]:
        """Time derivative of the state, with these changes of its velocities."""
        linear, turning = acceleration
        return [*moving.velocity, *moving.rates, *linear, *turning]

    @staticmethod
    def gravity(_: Moving, gravity: Vector) -> Vector:
        """Gravity in axes of the frame, which are those of the table."""
        return gravity

    @staticmethod
    def frame(quaternion: Numbers) -> Frame:
        """The inertial frame."""
        w, x, y, z = quaternion
        double = 2.0 / (w * w + x * x + y * y + z * z)
        return Frame(
            (1.0 - double * (y * y + z * z), double * (x * y - w * z), double * (x * z + w * y)),
            (double * (x * y + w * z), 1.0 - double * (x * x + z * z), double * (y * z - w * x)),
            (double * (x * z - w * y), double * (y * z + w * x), 1.0 - double * (x * x + y * y)),
        )

    @staticmethod
    def rates(quaternion: Numbers, angular: Numbers) -> tuple[Any, Any, Any, Any]:
        """Rates of the quaternion."""
        s, x, y, z = quaternion
        p, q, r = (0.5 * each for each in angular)
        return (
            -x * p - y * q - z * r,
            s * p + y * r - z * q,
            s * q + z * p - x * r,
            s * r + x * q - y * p,
        )


Chart = type[EulerAngles] | type[Quaternion]


def state_of(
    disk: Any, coordinates: Numbers, rates: Numbers, chart: type[EulerAngles] = EulerAngles
) -> tuple[Any, ...]:
    """State of the paper's coordinates and their rates, 6 numbers each.

    Parameters
    ----------
    disk : Disk
    coordinates, rates : sequence of 6 numbers
        In m, rad, m/s and rad/s; those of the constraints do not matter.
    chart : EulerAngles or EulerTurning
    """
    (a, b, c), (u, v, w) = _offset(disk, coordinates, rates)
    x, y, z, spin = coordinates[0] + a, coordinates[1] + b, coordinates[2] + c, rates[3]
    velocity = rates[0] + u - spin * y, rates[1] + v + spin * x, rates[2] + w
    angles, turning = coordinates[3:], rates[3:]
    if not chart.HOLDS_RATES:
        turning = chart.angular_velocity(angles, turning)
    return x, y, z, *angles, *velocity, *turning


def paper_of(
    disk: Any, state: Numbers, chart: type[EulerAngles] = EulerAngles
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The paper's coordinates and their rates, 6 numbers each, of a state."""
    turning = chart.rates(state[3:6], state[9:12])
    (a, b, c), (u, v, w) = _offset(disk, state[:6], (*state[6:9], *turning))
    x, y, z, spin = state[0], state[1], state[2], turning[0]
    rates = state[6] + spin * y - u, state[7] - spin * x - v, state[8] - w
    return (x - a, y - b, z - c, *state[3:6]), (*rates, *turning)


def _offset(disk: Any, coordinates: Numbers, rates: Numbers) -> tuple[Vector, Vector]:
    """S seen from G in axes of R, and its velocity there, from the angles and their rates."""
    e, (_, beta, gamma), (_, tilting, rolling) = disk.eccentricity, coordinates[3:], rates[3:]
    sb, cb, sg, cg = sin(beta), cos(beta), e * sin(gamma), e * cos(gamma)
    offset = cg, cb * sg, sb * sg
    moving = (
        -(sg * rolling),
        cb * cg * rolling - sb * sg * tilting,
        sb * cg * rolling + cb * sg * tilting,
    )
    return offset, moving
