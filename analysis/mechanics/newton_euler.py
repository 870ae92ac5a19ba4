"""Newton's and Euler's equations of a body on a table, for numbers of any kind.

Velocities are those of the centre of gravity S in axes of a frame on the table, which may turn
about the vertical, and the angular velocity in axes of the body. What acts on the disk has a
direction in them: that of a force at a point is the velocity of the point along the force.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from analysis.mechanics.attitude import EulerAngles, Moving
from analysis.mechanics.constraints import SLIPS, Direction, contact_directions, directions
from analysis.mechanics.dual import rate
from analysis.mechanics.linear_algebra import NONE, Vector, add, dot, scaled, solve
from analysis.problem.body import Body
from analysis.problem.constraints import PRESCRIBED, ConstraintSet, multiplier_names
from analysis.problem.elementary import Numbers
from analysis.problem.friction import FrictionLaw, SmoothCoulomb
from analysis.problem.quantities import Load
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES
from analysis.problem.user_modules import reads

Friction = Callable[[Any, Any, Any], tuple[Any, Any]]
"""From two parts of a slip and a load to the force against it: `FrictionLaw.force`. A slip that is
held is the float 0.0."""


class Structure(NamedTuple):
    """What decides which equations a body on the ideal contact has.

    Parameters
    ----------
    constraints : tuple of str
    load : str, optional
        What presses the disk on the table where friction acts; None where there is none.
    law : type
        Of the friction: whether it is isotropic and in proportion to the load.
    horizontal : bool
        Whether the table is level.
    products : bool
        Whether the disk has products of inertia.
    body : type or Body, optional
        Other than a round disk: its class, of which all have one code, or one without a `SURFACE`.
    chart : EulerAngles or EulerTurning
        What a state holds.
    read : tuple
        What the surface of a body depends on besides the body.
    """

    constraints: ConstraintSet
    load: Load | None = None
    law: type[FrictionLaw] = SmoothCoulomb
    horizontal: bool = True
    products: bool = False
    body: type[Body] | Body | None = None
    chart: type[EulerAngles] = EulerAngles
    read: tuple[Any, ...] = ()

    @classmethod
    def of(cls, scenario: Scenario, chart: type[EulerAngles] = EulerAngles) -> "Structure":
        """That of a scenario, or of `Members` that are alike in it."""
        disk = scenario.disk
        body = disk if disk.SURFACE is None else type(disk)
        return cls(
            scenario.constraints,
            scenario.friction.load if scenario.rubs else None,
            type(scenario.friction),
            bool(scenario.table.is_horizontal),
            disk.has_products,
            None if disk.is_round_disk else body,
            chart,
            () if disk.is_round_disk else reads(type(disk).lowest_point, type(disk)),
        )


def derivative(
    structure: Structure,
    disk: Any,
    state: Numbers,
    *,
    gravity: Vector,
    friction: Friction,
    contact_load: Callable[..., Any],
) -> tuple[list[Any], list[Any], list[Any]]:
    """Time derivative of a state of a body on the ideal contact, multipliers, and slips that rub.

    They solve the systems of index 1 (64), with all constraints on acceleration level: of Model 1
    Eq. (80), or Eq. (79) if friction takes the contact force as its load, of Model 4 Eq. (92).

    Parameters
    ----------
    structure : Structure
    disk : Body
        Or, of a round disk, what has its mass, radius, eccentricity, `inertia_about_cog` and
        `products`, of any kind.
    state : sequence of 12 numbers
        See `state_of`.
    gravity : tuple of 3 numbers
        In m/s², in axes of the table; the first two are the float 0.0 if it is level.
    friction : callable
        See `Friction`.
    contact_load : callable
        Load in N, from the normal force without friction and what each newton of load adds to it
        through friction; where that is not in proportion to the load, the normal force, from what
        each newton of friction along and across the edge adds to it, and the two slips.
    """
    moving = structure.chart.moving(state)
    acceleration = free_acceleration(disk, structure.chart.gravity(moving, gravity), moving)
    # The disk slides where it is not held.
    free = [
        Direction(NONE, NONE) if name in structure.constraints else way
        for name, way in zip(SLIPS, contact_directions(disk, moving.frame), strict=False)
    ]
    along, across = (way.along(moving.velocity, moving.angular) for way in free)
    if structure.load == "weight":
        weight = disk.mass * -gravity[2]
        rubbing = response(disk, _sum(free, friction(along, across, weight)))
        acceleration = together(acceleration, [1.0], [rubbing])
    held = directions(structure.constraints, disk, moving.attitude)
    responses = [response(disk, each) for each in held]
    matrix = [[each.along(*other) for other in responses] for each in held]
    changing = zip(held, _changes(structure.constraints, disk, moving), strict=True)
    sides = [[-(each.along(*acceleration) + change) for each, change in changing]]
    slips = () if structure.law.IS_PROPORTIONAL else (along, across)
    ways: list[Direction] = []
    if structure.load == "contact":
        ways = free if slips else [_sum(free, friction(along, across, 1.0))]
    rubbings = [response(disk, way) for way in ways]
    sides += [[-each.along(*rubbing) for each in held] for rubbing in rubbings]
    forces, *added = solve(matrix, sides)
    # How much there is of each friction that knows the contact force, which it changes.
    sizes: Sequence[Any] = ()
    if ways:
        load = contact_load(forces[0], *(each[0] for each in added), *slips)
        sizes = friction(along, across, load) if slips else (load,)
    for size, more in zip(sizes, added, strict=True):
        forces = [force + size * each for force, each in zip(forces, more, strict=True)]
    if ways and slips:
        # But for rounding, by which a contact that all but lets go would pull.
        forces[0] = load
    acceleration = together(acceleration, [*sizes, *forces], [*rubbings, *responses])
    multipliers = [each.scale * force for each, force in zip(held, forces, strict=True)]
    both = zip(SLIPS, (along, across), strict=True)
    rubs = [slip for name, slip in both if structure.load and name not in structure.constraints]
    return structure.chart.derivative(moving, acceleration), multipliers, rubs


def _changes(constraints: ConstraintSet, disk: Any, moving: Moving) -> list[Any]:
    """Changes of what constraints hold, by the turning of their directions alone."""
    known = dict(zip(COORDINATES[3:], moving.rates, strict=True))
    # What has a scale holds a rate, which stays as it is.
    kept = [known.get(PRESCRIBED.get(name, ""), 0.0) for name in multiplier_names(constraints)]

    def held(angles: Numbers) -> list[Any]:
        every = zip(directions(constraints, disk, angles), kept, strict=True)
        return [dot(each.turning, moving.angular) - each.scale * still for each, still in every]

    return rate(held, moving.attitude, moving.rates)


def _sum(ways: Sequence[Direction], forces: Sequence[Any]) -> Direction:
    """Direction of forces along some directions together."""
    return Direction(*together((NONE, NONE), forces, [(way.linear, way.turning) for way in ways]))


def free_acceleration(disk: Any, gravity: Vector, moving: Moving) -> tuple[Vector, Vector]:
    """Acceleration by gravity and inertia alone, in axes of the frame and of the body."""
    p, q, s = moving.angular
    (a, b, c), (d, e, f) = disk.inertia_about_cog, disk.products
    (x, y, z), (u, v, _), spin = gravity, moving.velocity, moving.spin
    # The torque -w x I w by the products of the angular velocity, each with a constant vector.
    products = q * s, s * p, p * q, s * s - q * q, p * p - s * s, q * q - p * p
    torques = (
        *((b - c, -d, e), (d, c - a, -f), (-e, f, a - b)),
        *((f, 0.0, 0.0), (0.0, e, 0.0), (0.0, 0.0, d)),
    )
    turning = NONE
    for product, torque in zip(products, torques, strict=True):
        turning = add(turning, scaled(product, turned_by(disk, torque)))
    return (x + spin * v, y - spin * u, z), turning


def turned_by(body: Any, torque: Vector) -> Vector:
    """Angular acceleration by a torque on a body that does not turn, both in its axes."""
    (a, b, c), (d, e, f) = body.inertia_about_cog, body.products
    ((p, q, s),) = solve(((a, d, e), (d, b, f), (e, f, c)), (torque,))
    return p, q, s


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
    start: tuple[Vector, Vector], forces: Sequence[Any], by_force: Sequence[tuple[Vector, Vector]]
) -> tuple[Vector, Vector]:
    """What is there without forces, linear and turning, and what each unit of them adds to it."""
    linear, turning = start
    for force, (moved, turned) in zip(forces, by_force, strict=True):
        linear, turning = add(linear, scaled(force, moved)), add(turning, scaled(force, turned))
    return linear, turning
