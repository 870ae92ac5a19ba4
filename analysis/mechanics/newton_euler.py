"""Newton's and Euler's equations of a body on a table, for numbers of any kind.

Velocities are those of the centre of gravity S in axes of a frame on the table, which may turn
about the vertical, and the angular velocity in axes of the body. What acts on the disk has a
direction in them: that of a force at a point is the velocity of the point along the force.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from analysis.data.constraint_set import ConstraintSet
from analysis.data.quantities import Load
from analysis.mechanics.attitude import EulerAngles, Moving
from analysis.mechanics.constraints import (
    SLIPS,
    Direction,
    contact_directions,
    directions,
)
from analysis.mechanics.dual import rate
from analysis.mechanics.elimination import solve
from analysis.mechanics.vectors import NONE, Numbers, Vector, add, dot, scaled

Speed = Callable[[Any, Any], Any]
"""Size of a slip from its two parts, one of which is the float 0.0 where slip is held."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IdealContact:
    """Equations of a body on the ideal contact, in numbers of any kind.

    Parameters
    ----------
    constraints : tuple of str
    disk : Body
        Or, of a round disk, what has its mass, radius, eccentricity, `inertia_about_cog` and
        `products`.
    gravity : tuple of 3 numbers
        In m/s², in axes of the table; the first two are the float 0.0 if it is level.
    load : str, optional
        What presses the disk on the table where friction acts; None where there is none.
    speed : callable
        See `Speed`.
    per_speed : callable
        That of the friction law.
    contact_load : callable
        Load in N, from the normal force without friction and from what of it each newton of load
        calls for through friction.
    chart : EulerAngles or EulerTurning
        What a state holds.
    """

    constraints: ConstraintSet
    disk: Any
    gravity: Vector
    load: Load | None
    speed: Speed
    per_speed: Callable[[Any], Any]
    contact_load: Callable[[Any, Any], Any]
    chart: type[EulerAngles] = EulerAngles

    def derivative(self, state: Numbers) -> tuple[list[Any], list[Any], Any]:
        """Time derivative of a state, 12 numbers, the multipliers, and `_slowing`.

        They solve the systems of index 1, with all constraints on acceleration level: Eq. (80),
        Eq. (79) if friction takes the contact force as its load, Eq. (92) for the further
        constraints.

        Parameters
        ----------
        state : sequence of 12 numbers
            See `states`.
        """
        moving = self.chart.moving(state)
        gravity = self.chart.gravity(moving, self.gravity)
        acceleration = free_acceleration(self.disk, gravity, moving)
        held = directions(self.constraints, self.disk, moving.attitude)
        responses = [response(self.disk, each) for each in held]
        matrix = [[each.along(*other) for other in responses] for each in held]
        changes = self._changes(self.constraints, moving)
        sides = [
            [
                -(each.along(*acceleration) + change)
                for each, change in zip(held, changes, strict=True)
            ],
        ]
        if self.load is None:
            (forces,) = solve(matrix, sides)
        else:
            rubbing = response(self.disk, friction(self, moving))
            sides.append([-each.along(*rubbing) for each in held])
            alone, added = solve(matrix, sides)
            load = self._load(alone[0], added[0])
            forces = [force + load * more for force, more in zip(alone, added, strict=True)]
            acceleration = together(acceleration, load, rubbing)
        for force, by_force in zip(forces, responses, strict=True):
            acceleration = together(acceleration, force, by_force)
        multipliers = [each.scale * force for each, force in zip(held, forces, strict=True)]
        derivative = self.chart.derivative(moving, acceleration)
        return derivative, multipliers, self._slowing(moving, acceleration)

    def _changes(self, constraints: ConstraintSet, moving: Moving) -> list[Any]:
        """Changes of what constraints hold, by the turning of their directions alone."""

        def held(angles: Numbers) -> list[Any]:
            every = directions(constraints, self.disk, angles)
            # One with a scale keeps the spin what it is.
            return [dot(each.turning, moving.angular) - each.scale * moving.spin for each in every]

        return rate(held, moving.attitude, moving.rates)

    def _slowing(self, moving: Moving, acceleration: tuple[Vector, Vector]) -> Any:
        """Half the rate of the squared slip speed, which is zero where the slip is least."""
        ways = directions(SLIPS, self.disk, moving.attitude)
        slips = [way.along(moving.velocity, moving.angular) for way in ways]
        turned = self._changes(SLIPS, moving)
        rates = [way.along(*acceleration) + each for way, each in zip(ways, turned, strict=True)]
        return slips[0] * rates[0] + slips[1] * rates[1]

    def _load(self, alone: Any, added: Any) -> Any:
        if self.load == "contact":
            return self.contact_load(alone, added)
        return self.disk.mass * -self.gravity[2]


def friction(contact: IdealContact, moving: Moving) -> Direction:
    """Friction for each newton of load; the disk slides where it is not held."""
    frame, held = moving.frame, contact.constraints
    ahead, across, _ = contact_directions(contact.disk, frame)
    along, sideways = (way.along(moving.velocity, moving.angular) for way in (ahead, across))
    slip_x = 0.0 if "no-slip-along" in held else along
    slip_y = 0.0 if "no-slip-across" in held else sideways
    factor = -contact.per_speed(contact.speed(slip_x, slip_y))
    x, y = factor * slip_x, factor * slip_y
    return Direction((x, y, 0.0), add(scaled(x, ahead.turning), scaled(y, across.turning)))


def free_acceleration(disk: Any, gravity: Vector, moving: Moving) -> tuple[Vector, Vector]:
    """Acceleration by gravity and inertia alone, in axes of the frame and of the body."""
    p, q, s = moving.angular
    (a, b, c), (d, e, f) = disk.inertia_about_cog, disk.products
    (x, y, z), (u, v, _), spin = gravity, moving.velocity, moving.spin
    # The torque -w x I w by the products of the angular velocity, each with a constant vector.
    parts = (
        (q * s, (b - c, -d, e)),
        (s * p, (d, c - a, -f)),
        (p * q, (-e, f, a - b)),
        *((s * s - q * q, (f, 0.0, 0.0)), (p * p - s * s, (0.0, e, 0.0))),
        (q * q - p * p, (0.0, 0.0, d)),
    )
    turning = NONE
    for product, torque in parts:
        turning = add(turning, scaled(product, turned_by(disk, torque)))
    return (x + spin * v, y - spin * u, z), turning


def turned_by(body: Any, torque: Vector) -> Vector:
    """Angular acceleration by a torque on a body that does not turn, both in its axes."""
    (p, q, s), (a, b, c), (d, e, f) = torque, body.inertia_about_cog, body.products
    if all(isinstance(each, float) and each == 0.0 for each in (d, e, f)):
        return p / a, q / b, s / c
    # The cofactors of the inertia.
    xx, yy, zz = b * c - f * f, a * c - e * e, a * b - d * d
    xy, xz, yz = e * f - c * d, d * f - b * e, d * e - a * f
    whole = a * xx + d * xy + e * xz
    return (
        xx / whole * p + xy / whole * q + xz / whole * s,
        xy / whole * p + yy / whole * q + yz / whole * s,
        xz / whole * p + yz / whole * q + zz / whole * s,
    )


def kinetic_energy(disk: Any, velocity: Vector, angular: Vector) -> Any:
    """Kinetic energy in J, of S with a velocity in any axes, and of turning in the body's."""
    (a, b, c), (d, e, f) = disk.inertia_about_cog, disk.products
    p, q, s = angular
    axial = disk.mass * dot(velocity, velocity) + a * (p * p) + b * (q * q) + c * (s * s)
    return 0.5 * axial + (d * (p * q) + e * (p * s) + f * (q * s))


def response(disk: Any, direction: Direction) -> tuple[Vector, Vector]:
    """Acceleration by a unit force along a direction."""
    (x, y, z), turning, _ = direction
    return (x / disk.mass, y / disk.mass, z / disk.mass), turned_by(disk, turning)


def together(
    acceleration: tuple[Vector, Vector], force: Any, by_force: tuple[Vector, Vector]
) -> tuple[Vector, Vector]:
    """An acceleration and what is added to it by a force."""
    linear, turning = acceleration
    return add(linear, scaled(force, by_force[0])), add(turning, scaled(force, by_force[1]))
