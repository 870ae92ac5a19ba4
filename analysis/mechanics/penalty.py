"""A body on a table that yields, for numbers of any kind: what acts on it, and what it takes."""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Any, NamedTuple

from analysis.data.contact import PenaltyContact
from analysis.data.dissipation import Dissipation
from analysis.data.elementary import sqrt
from analysis.mechanics.attitude import Chart, Frame, Moving, Quaternion
from analysis.mechanics.constraints import Direction, at_point
from analysis.mechanics.dual import rate
from analysis.mechanics.newton_euler import (
    Friction,
    free_acceleration,
    kinetic_energy,
    response,
    together,
)
from analysis.mechanics.vectors import NONE, Numbers, Vector, add, cross, dot, scaled

READINGS = {
    "positions": 3,
    "velocities": 3,
    "angular_velocities": 3,
    "contact_points": 3,
    "slip_speeds": 1,
    "contour_speeds": 1,
    "normal_force": 1,
    "energies": 3,
}
"""Arrays of a `SpatialMotion` that are read off a state, and their numbers for each sample."""


class Touch(NamedTuple):
    """The contact at one instant.

    `point` is the contact point seen from S in m, in axes of the body, and `ways` are the
    directions in which it moves along the axes of the frame; `gap` is the distance between disk
    and table in m, negative for penetration, and `gap_rate` its rate; `slip` is the horizontal
    velocity of the disk's material there in m/s, `contour` that of the contact point along the
    rim, in axes of the body; `force` is the normal force in N.
    """

    point: Vector
    ways: tuple[Direction, Direction, Direction]
    gap: Any
    gap_rate: Any
    slip: tuple[Any, Any]
    contour: Vector
    force: Any


@dataclass(frozen=True, slots=True, kw_only=True)
class YieldingTable:
    """Equations of a body on a spring, in numbers of any kind.

    Parameters
    ----------
    disk : Body
    rim : PenaltyContact
    gravity : tuple of 3 numbers
        In m/s², in axes of the table.
    dissipation : Dissipation
    spring : callable
        Force of the spring in N from the gap.
    normal_force : callable
        Force of spring and damper in N from the gap and its rate.
    friction : callable
        See `newton_euler.Friction`, with the normal force in place of the load.
    speed : callable
        Size of a velocity from its two parts.
    """

    disk: Any
    rim: PenaltyContact
    gravity: Vector
    dissipation: Dissipation
    spring: Callable[[Any], Any]
    normal_force: Callable[[Any, Any], Any]
    friction: Friction
    speed: Callable[[Any, Any], Any]

    def derivative(self, chart: Chart, state: Numbers) -> tuple[list[Any], Touch, list[Any]]:
        """Time derivative of a state, the contact, and the power in W taken by each of `CAUSES`.

        Parameters
        ----------
        chart : EulerAngles or Quaternion
        state : sequence of 12 or 13 numbers
        """
        moving = chart.moving(state)
        touch = self.touch(moving)
        loads, powers = self._loads(moving, touch)
        gravity = chart.gravity(moving, self.gravity)
        free = free_acceleration(self.disk, gravity, moving)
        acceleration = together(free, 1.0, response(self.disk, loads))
        return chart.derivative(moving, acceleration), touch, powers

    def touch(self, moving: Moving) -> Touch:
        """Contact in this state."""
        disk, up = self.disk, moving.frame.up
        x, y, z = self._lowest(up)
        point = (x - disk.eccentricity, y, z)
        ways = at_point(point, moving.frame)
        slip_x, slip_y, gap_rate = (way.along(moving.velocity, moving.angular) for way in ways)
        gap = moving.position[2] + dot(point, up)
        # In axes of the body the vertical turns backwards.
        contour = self._carried(up, cross(up, moving.angular))
        force = self.normal_force(gap, gap_rate)
        return Touch(point, ways, gap, gap_rate, (slip_x, slip_y), contour, force)

    def _lowest(self, up: Numbers) -> Vector:
        point: Vector = self.disk.lowest_point(up, self.rim.half_thickness)
        return point

    def _carried(self, up: Vector, change: Vector) -> Vector:
        """Change of the lowest point by one of the vertical; linear, symmetric and horizontal."""
        x, y, z = rate(self._lowest, up, change)
        return x, y, z

    def _loads(self, moving: Moving, touch: Touch) -> tuple[Direction, list[Any]]:
        """Force in axes of the frame and torque in those of the body, and powers taken."""
        x, y = self.friction(*touch.slip, touch.force)
        powers = [
            (self.spring(touch.gap) - touch.force) * touch.gap_rate,
            -(x * touch.slip[0] + y * touch.slip[1]),
            *(0.0, 0.0, 0.0, 0.0),
        ]
        force = (x, y, touch.force)
        torque = cross(touch.point, moving.frame.in_body(force))
        torque = add(torque, self._rolling(moving.frame, touch, powers))
        torque = add(torque, self._pivoting(moving, touch, powers))
        drag, brake = self._drag(moving, powers)
        return Direction(add(force, drag), add(torque, brake)), powers

    def _rolling(self, frame: Frame, touch: Touch, powers: list[Any]) -> Vector:
        """Torque of the rolling resistance, that which the force on the contour does work by."""
        loss = self.dissipation
        if not (loss.rolling_dry or loss.rolling_viscous):
            return NONE
        square = dot(touch.contour, touch.contour)
        dry = loss.rolling_dry * touch.force / (sqrt(square) + loss.rolling_smoothing)
        viscous = loss.rolling_viscous * touch.force
        powers[2], powers[3] = dry * square, viscous * square
        # contour = S (u x w) with S symmetric, so the torque -F is conjugate to is (S F) x u.
        carried = self._carried(frame.up, touch.contour)
        return scaled(dry + viscous, cross(frame.up, carried))

    def _pivoting(self, moving: Moving, touch: Touch, powers: list[Any]) -> Vector:
        """Torque against the spin about the vertical."""
        loss = self.dissipation
        if not loss.pivoting:
            return NONE
        spin = dot(moving.frame.up, moving.angular)
        speed = self.speed(0.0, spin)
        moment = loss.pivoting * touch.force * spin / (speed + loss.pivoting_smoothing)
        powers[4] = moment * spin
        return scaled(-moment, moving.frame.up)

    def _drag(self, moving: Moving, powers: list[Any]) -> tuple[Vector, Vector]:
        """Force and torque of the air, as pressure 1/2 air_drag v |v| on the moving faces."""
        half = 0.5 * self.dissipation.air_drag
        if not half:
            return NONE, NONE
        radius, e = self.disk.radius, self.disk.eccentricity
        p, q, _ = moving.angular
        # Velocity of the geometric centre along the axis, and the tumbling rate.
        along = moving.frame.in_body(moving.velocity)[2] + e * q
        tumbling = self.speed(p, q)
        push = -(half * pi * radius**2) * self.speed(0.0, along) * along
        moment = half * 8.0 / 15.0 * radius**5 * tumbling
        powers[5] = moment * (tumbling * tumbling) - push * along
        force = moving.frame.seen((0.0, 0.0, push))
        return force, (-(moment * p), push * e - moment * q, 0.0)

    def readings(self, state: Numbers) -> list[Any]:
        """The numbers of `READINGS` of a state of `Quaternion`.

        The kinetic, gravitational (counted from the table) and elastic energies are in J.
        """
        moving = Quaternion.moving(state)
        touch, frame, e = self.touch(moving), moving.frame, self.disk.eccentricity
        _, q, s = moving.angular
        spring = self.spring(touch.gap)
        return [
            *add(moving.position, frame.seen((-e, 0.0, 0.0))),
            *add(moving.velocity, frame.seen((0.0, -(e * s), e * q))),
            *frame.seen(moving.angular),
            *add(moving.position, frame.seen(touch.point)),
            self.speed(*touch.slip),
            sqrt(dot(touch.contour, touch.contour)),
            touch.force,
            kinetic_energy(self.disk, moving.velocity, moving.angular),
            -(self.disk.mass * dot(self.gravity, moving.position)),
            0.5 / self.rim.stiffness * (spring * spring),
        ]
