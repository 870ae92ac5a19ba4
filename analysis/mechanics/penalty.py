"""A body on a table that yields, for numbers of any kind, and its equations as code."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Any, NamedTuple

import numpy as np

from analysis.mechanics.attitude import Chart, EulerAngles, Frame, Moving, Quaternion
from analysis.mechanics.constraints import Direction, at_point
from analysis.mechanics.dual import Functions, rate
from analysis.mechanics.linear_algebra import Vector, add, cross, dot, scaled
from analysis.mechanics.newton_euler import (
    Friction,
    free_acceleration,
    kinetic_energy,
    response,
    together,
)
from analysis.mechanics.recorder import Recorder, Symbol, call, pair
from analysis.problem.bodies import noting
from analysis.problem.checks import Array
from analysis.problem.contact import FULL_GRIP
from analysis.problem.elementary import Numbers, hypot, sqrt
from analysis.problem.friction import asked
from analysis.problem.scenario import Scenario


class Touch(NamedTuple):
    """The contact at one instant.

    `point` is the contact point seen from S in m, in axes of the body; `gap` is the distance
    between disk and table in m, negative for penetration, and `gap_rate` its rate; `slip` is the
    horizontal velocity of the disk's material there in m/s, `contour` that of the contact point
    along the rim, in axes of the body; `force` is the normal force in N.
    """

    point: Vector
    gap: Any
    gap_rate: Any
    slip: tuple[Any, Any]
    contour: Vector
    force: Any


@dataclass(frozen=True, slots=True)
class YieldingTable:
    """Equations of a body on a spring, in numbers of any kind.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.
    spring : callable
        Force of the spring in N from the gap.
    normal_force : callable
        Force of spring and damper in N from the gap and its rate.
    """

    scenario: Scenario
    spring: Callable[[Any], Any]
    normal_force: Callable[[Any, Any], Any]

    @classmethod
    def of(cls, scenario: Scenario) -> "YieldingTable":
        """That of a scenario, in arrays."""
        forces = contact_functions(scenario)
        names = ("spring", "normal_force")
        return cls(scenario, *(np.vectorize(forces[name], otypes=[float]) for name in names))

    def derivative(
        self, chart: Chart, state: Numbers, friction: Friction
    ) -> tuple[list[Any], Touch, list[Any]]:
        """Time derivative of a state, the contact, and the power in W taken by each of `CAUSES`.

        Parameters
        ----------
        chart : EulerAngles or Quaternion
        state : sequence of 12 or 13 numbers
        friction : callable
            See `newton_euler.Friction`, with the normal force in place of the load.
        """
        moving = chart.moving(state)
        touch = self.touch(moving)
        loads, powers = self._loads(moving, touch, friction(*touch.slip, touch.force))
        disk, gravity = self.scenario.disk, chart.gravity(moving, self.scenario.table.vector)
        free = free_acceleration(disk, gravity, moving)
        acceleration = together(free, [1.0], [response(disk, loads)])
        return chart.derivative(moving, acceleration), touch, powers

    def touch(self, moving: Moving) -> Touch:
        """Contact in this state."""
        up, disk = moving.frame.up, self.scenario.disk
        x, y, z = disk.lowest_point(up, self.scenario.half_thickness)
        point = (x - disk.eccentricity, y, z)
        gap = moving.position[2] + dot(point, up)
        slip_x, slip_y, gap_rate = (
            way.along(moving.velocity, moving.angular) for way in at_point(point, moving.frame)
        )
        # In axes of the body the vertical turns backwards.
        contour = self._carried(up, cross(up, moving.angular))
        force = self.normal_force(gap, gap_rate)
        return Touch(point, gap, gap_rate, (slip_x, slip_y), contour, force)

    def _lowest(self, up: Numbers) -> Vector:
        return self.scenario.disk.lowest_point(up, self.scenario.half_thickness)

    def _carried(self, up: Vector, change: Vector) -> Vector:
        """Change of the lowest point by one of the vertical; linear, symmetric and horizontal."""
        x, y, z = rate(self._lowest, up, change)
        return x, y, z

    def _loads(self, moving: Moving, touch: Touch, rubbing: Any) -> tuple[Direction, list[Any]]:
        """Force in axes of the frame and torque in those of the body, and powers taken."""
        x, y = rubbing
        rolling, *by_rolling = self._rolling(moving.frame, touch)
        pivoting, by_pivoting = self._pivoting(moving, touch)
        drag, brake, by_air = self._drag(moving)
        force = (x, y, touch.force)
        torque = cross(touch.point, moving.frame.in_body(force))
        for each in (rolling, pivoting, brake):
            torque = add(torque, each)
        by_damper = (self.spring(touch.gap) - touch.force) * touch.gap_rate
        by_slip = -(x * touch.slip[0] + y * touch.slip[1])
        powers = [by_damper, by_slip, *by_rolling, by_pivoting, by_air]
        return Direction(add(force, drag), torque), powers

    # What a loss that is 0 multiplies is left out of the recorded code.

    def _rolling(self, frame: Frame, touch: Touch) -> tuple[Vector, Any, Any]:
        """Torque of the rolling resistance, that which the force on the contour does work by.

        And the powers that its dry and its viscous part take.
        """
        loss, square = self.scenario.dissipation, dot(touch.contour, touch.contour)
        dry = loss.rolling_dry * touch.force / (sqrt(square) + loss.rolling_smoothing)
        viscous = loss.rolling_viscous * touch.force
        # contour = S (u x w) with S symmetric, so the torque -F is conjugate to is (S F) x u.
        carried = self._carried(frame.up, touch.contour)
        torque = scaled(dry + viscous, cross(frame.up, carried))
        return torque, dry * square, viscous * square

    def _pivoting(self, moving: Moving, touch: Touch) -> tuple[Vector, Any]:
        """Torque against the spin about the vertical, and the power that it takes."""
        loss, spin = self.scenario.dissipation, dot(moving.frame.up, moving.angular)
        speed = hypot(0.0, spin)
        moment = loss.pivoting * touch.force * spin / (speed + loss.pivoting_smoothing)
        return scaled(-moment, moving.frame.up), moment * spin

    def _drag(self, moving: Moving) -> tuple[Vector, Vector, Any]:
        """Force and torque of the air, as pressure 1/2 air_drag v |v| on the moving faces.

        And the power that it takes.
        """
        half = 0.5 * self.scenario.dissipation.air_drag
        radius, e = self.scenario.disk.radius, self.scenario.disk.eccentricity
        p, q, _ = moving.angular
        # Velocity of the geometric centre along the axis, and the tumbling rate.
        along = moving.frame.in_body(moving.velocity)[2] + e * q
        tumbling = hypot(p, q)
        push = -(half * pi * radius**2) * hypot(0.0, along) * along
        moment = half * 8.0 / 15.0 * radius**5 * tumbling
        force = moving.frame.seen((0.0, 0.0, push))
        torque = (-(moment * p), push * e - moment * q, 0.0)
        return force, torque, moment * (tumbling * tumbling) - push * along

    def readings(self, states: Array) -> dict[str, Array]:
        """Arrays of a `SpatialMotion` by their names, from n states of 13 numbers or more."""
        moving = Quaternion.moving(states.T)
        touch, frame, angular = self.touch(moving), moving.frame, moving.angular
        disk, contact = self.scenario.disk, self.scenario.penalty_contact
        e, (_, q, s), spring = disk.eccentricity, angular, self.spring(touch.gap)
        energies = (
            kinetic_energy(disk, moving.velocity, angular),
            -(disk.mass * dot(self.scenario.table.vector, moving.position)),
            0.5 / contact.stiffness * (spring * spring),
        )
        return {
            "positions": np.transpose(add(moving.position, frame.seen((-e, 0.0, 0.0)))),
            "velocities": np.transpose(add(moving.velocity, frame.seen((0.0, -(e * s), e * q)))),
            "angular_velocities": np.transpose(frame.seen(angular)),
            "contact_points": np.transpose(add(moving.position, frame.seen(touch.point))),
            "slip_speeds": hypot(*touch.slip),
            "contour_speeds": sqrt(dot(touch.contour, touch.contour)),
            "normal_force": touch.force,
            "energies": np.transpose(energies),
        }


Solver = Callable[..., tuple[Any, ...]]
"""From the numbers of a state to its time derivative and what else follows from it."""


def free_solver(scenario: Scenario, chart: Chart, functions: Functions) -> Solver:
    """Function from a state to its derivative and, behind that, what its chart is asked for.

    From Euler angles, 12 numbers, that is the normal force in N, slip along and across in m/s, and
    the gap in m and its rate; from a quaternion, 13 numbers, the power in W taken by each of
    `CAUSES`.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.
    chart : EulerAngles or Quaternion
    functions : mapping
        Of the numbers.
    """
    is_simple, in_angles = scenario.friction.is_simple, chart is EulerAngles
    force = friction_of(is_simple=is_simple)

    def friction(along: Symbol, across: Symbol, normal_force: Symbol) -> tuple[Any, Any]:
        return force(along, across, call("load", normal_force) if is_simple else normal_force)

    recorder = Recorder((), [f"s{number}" for number in range(12 if in_angles else 13)])
    spring, normal_force = (partial(call, name) for name in ("spring", "normal_force"))
    table = YieldingTable(scenario, spring, normal_force)
    with noting(scenario.disk):
        derivative, touch, powers = table.derivative(chart, recorder.variables, friction)
    asked = [touch.force, *touch.slip, touch.gap, touch.gap_rate] if in_angles else powers
    return recorder.code([*derivative, *asked])(**functions, **contact_functions(scenario))


def friction_of(*, is_simple: bool) -> Friction:
    """Symbols of friction; a law that is not isotropic and in proportion is called as it is."""

    def simple(along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        factor = -(call("per_speed", call("speed", along, across)) * load)
        return factor * along, factor * across

    return simple if is_simple else partial(pair, "force")


def kinks(scenario: Scenario, solved: Solver) -> Callable[[Array], list[float]]:
    """Function of a state, shape (12,), of which a number changes its sign at jumps and bends.

    Those are both slips in m/s, where they rub, and what presses over the weight, if the contact
    may open. It closes where the disk touches the table, with the damper's force at once, and
    opens where the force comes to nothing, before the spring does. Where friction fades with it,
    it ceases to beyond a part of the weight.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.
    solved : callable
        Its `free_solver` from Euler angles.
    """
    contact, weight = scenario.penalty_contact, scenario.weight
    rubs, may_open, fades = scenario.rubs, not scenario.may_pull, scenario.friction_fades

    def numbers(state: Array) -> list[float]:
        normal_force, along, across, gap, gap_rate = solved(*state.tolist())[12:]
        spring = -contact.stiffness * gap
        pressing = min(spring, spring - contact.damping * gap_rate) / weight
        gripping = normal_force / weight - FULL_GRIP
        return [along, across] * rubs + [pressing] * may_open + [gripping] * fades

    return numbers


def contact_functions(scenario: Scenario) -> Functions:
    """Functions of floats that know whether the contact may open, by their names in the code.

    "spring", of the gap, and "normal_force", of the gap and its rate, are the forces in N of the
    spring and of spring and damper; an ideal contact has neither. "load" is the load in N of a law
    that is in proportion to it, from the normal force in N, and "force" is `newton_euler.Friction`
    with the normal force in place of the load.
    """
    contact: Any = scenario.contact
    weight, law = scenario.weight, scenario.friction
    asks = asked(law, "force")
    holds, fades = scenario.may_pull, scenario.friction_fades

    def spring(gap: Any) -> Any:
        return 0.0 if gap > 0.0 and not holds else -contact.stiffness * gap

    def normal_force(gap: Any, gap_rate: Any) -> Any:
        force = -contact.stiffness * gap - contact.damping * gap_rate
        lifted = not holds and (gap > 0.0 or force < 0.0)
        return 0.0 if lifted else force

    def grip(force: Any) -> Any:
        return min(1.0, force / (FULL_GRIP * weight)) if fades else 1.0

    def pressing(force: Any) -> Any:
        return weight if law.load == "weight" else max(0.0, force)

    def load(force: Any) -> Any:
        return pressing(force) * grip(force)

    def force(along: Any, across: Any, normal: Any) -> tuple[Any, Any]:
        if not (normal > 0.0 or holds):
            return 0.0, 0.0
        x, y = asks(along, across, pressing(normal))
        part = grip(normal)
        return part * x, part * y

    return {"spring": spring, "normal_force": normal_force, "load": load, "force": force}
