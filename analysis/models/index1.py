"""The constrained systems of index 1, Eqs. (79), (80) and (92), for any set of constraints."""

from collections.abc import Callable, Sequence
from functools import cache, partial
from math import hypot
from types import SimpleNamespace
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.constraint_set import ConstraintSet, multiplier_names
from analysis.data.elementary import cos, sin
from analysis.data.friction import Load
from analysis.data.scenario import Scenario
from analysis.data.scenario_keys import SIX
from analysis.data.state import COORDINATES
from analysis.models import constraints, equations
from analysis.models.elimination import is_float_zero, solve
from analysis.models.equations import Vector
from analysis.models.recorder import Recorder, call

Speed = Callable[[Any, Any], Any]
"""Size of a slip from its two parts, one of which is 0.0 where slip is held."""

Rows = list[tuple[Any, ...]]
"""A matrix of numbers of any kind."""

Solver = Callable[..., tuple[float, ...]]
"""From co-rotating coordinates and rates, 12 floats, to accelerations and multipliers, 6 + n."""

_DIRECT = {"normal_force": 2, "cog_force_x": 0, "cog_force_y": 1, "spin_torque": 3}
"""Coordinate that a constraint tells directly, with a factor of 1, by its multiplier."""

_TABLE = ("pressing", "along", "across")


def friction_per_load(scenario: Scenario, z: Vector, u: Vector) -> Array:
    """Generalised friction force for a load of 1 N, shape (6,); Eq. (3) without its lambda_N.

    The disk slides where it is not held: Models 1 and 2 in both directions of the table, Models 3
    and 4 along e_y alone.
    """
    return np.array(friction_rows(scenario, z, u, hypot))


def friction_rows(
    scenario: Scenario, z: Sequence[Any] | Array, u: Sequence[Any] | Array, speed: Speed
) -> tuple[Any, ...]:
    """The rows of `friction_per_load`, W_T of Eq. (32) times a force, of numbers of any kind."""
    r, held = scenario.disk.radius, scenario.constraints
    x, side, lift = z[0], r * cos(z[4]) - z[1], r * sin(z[4])
    slip_x = 0.0 if "no-slip-along" in held else u[0] + side * u[3] + r * u[5]
    slip_y = 0.0 if "no-slip-across" in held else u[1] + x * u[3] + lift * u[4]
    factor = -scenario.friction.per_speed(speed(slip_x, slip_y))
    fx, fy = factor * slip_x, factor * slip_y
    return fx, fy, 0.0, side * fx + x * fy, lift * fy, r * fx


def system(
    scenario: Scenario, z: Sequence[Any], u: Sequence[Any], speed: Speed = hypot
) -> tuple[Rows, Rows]:
    """Matrix and right-hand sides for accelerations and multipliers, from numbers of any kind.

    The second and third block row of Eq. (80), of Eq. (79) if the friction law takes the contact
    force as its load, and of Eq. (92) for the further constraints.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact.
    z, u : sequence of 6 numbers
        Co-rotating coordinates and their rates.
    speed : callable
        See `Speed`.

    Returns
    -------
    matrix : 6 + n rows of 6 + n numbers
        For n constraints, in the order of `multiplier_names(scenario.constraints)`.
    right : 6 + n rows of 1 or 2 numbers
        The second column holds the friction for each newton of contact force, if that matters.
    """
    held, disk = scenario.constraints, scenario.disk
    W = constraints.direction_rows(held, disk, z)
    nothing = (0.0,) * len(W)
    matrix = [
        (*entries, *(-direction[row] for direction in W))
        for row, entries in enumerate(equations.mass_rows(disk, z))
    ]
    matrix += [(*direction, *nothing) for direction in W]
    gyroscopic = equations.gyroscopic_rows(disk, z, u)
    gravity = equations.gravity_rows(disk, scenario.table, z)
    forces = [h + f for h, f in zip(gyroscopic, gravity, strict=True)]
    sides = [-term for term in constraints.acceleration_rows(held, disk, z, u)]
    if not scenario.rubs:
        return matrix, [(each,) for each in (*forces, *sides)]
    friction = friction_rows(scenario, z, u, speed)
    if scenario.friction.load == "contact":
        return matrix, list(zip((*forces, *sides), (*friction, *nothing), strict=True))
    load = scenario.weight
    forces = [f + load * part for f, part in zip(forces, friction, strict=True)]
    return matrix, [(each,) for each in (*forces, *sides)]


def solution(
    scenario: Scenario,
    z: Sequence[Any],
    u: Sequence[Any],
    speed: Speed,
    is_zero: Callable[[Any], bool] = is_float_zero,
) -> list[list[Any]]:
    """Accelerations and multipliers that solve `system`, from symbols.

    Elimination takes the coordinates that a constraint tells directly by that constraint. What is
    left of the mass matrix is that of the other coordinates alone, positive definite, and what is
    left of the other constraints after them is negative definite, so no pivot vanishes as long as
    the disk does not lie flat.

    Parameters
    ----------
    scenario, z, u, speed
        Those of `system`.
    is_zero : callable
        Whether an entry is zero whatever the symbols are.

    Returns
    -------
    list of 1 or 2 columns of 6 + n symbols
        The second one is what each newton of contact force adds by friction, if that matters.
    """
    matrix, right = system(scenario, z, u, speed)
    pivots: list[tuple[int, int]] = []
    for row, name in enumerate(multiplier_names(scenario.constraints), start=6):
        if name in _DIRECT:
            pivots += [(row, _DIRECT[name]), (_DIRECT[name], row)]
    taken = {column for _, column in pivots}
    pivots += [(each, each) for each in range(len(matrix)) if each not in taken]
    return solve(matrix, right, pivots, is_zero)


def loaded(columns: Sequence[Sequence[Any]], load: Any) -> list[Any]:
    """Accelerations and multipliers with friction at a contact force, from both columns."""
    return [alone + load * added for alone, added in zip(*columns, strict=True)]


def solver(scenario: Scenario) -> Solver:
    """Function that solves `system` at one state after the other, fast.

    The equations are recorded on symbols once for each structure, see `Recorder`. A contact that
    pulls (negative normal force) is no load: friction never gives energy.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact.

    Returns
    -------
    callable
        From 12 floats, z and u, to the accelerations and then the multipliers. It raises
        `ArithmeticError` where `accelerations` does.
    """
    table, law = scenario.table, scenario.friction
    load = law.load if scenario.rubs else None
    numbers = [getattr(scenario.disk, name) for name in SIX]
    code = recorded(scenario.constraints, load, horizontal=table.is_horizontal)
    formula = code(*numbers, table.pressing, *table.vector[:2], law.per_speed)

    def solve_at(*state: float) -> tuple[float, ...]:
        try:
            result: tuple[float, ...] = formula(*state)
        except ArithmeticError as error:
            cause = "" if isinstance(error, ZeroDivisionError) else f": {error}"
            raise ArithmeticError(
                f"singular index-1 system of {scenario.name} at coordinates {list(state[:6])}"
                + cause
            ) from error
        return result

    return solve_at


@cache
def recorded(held: ConstraintSet, load: Load | None, *, horizontal: bool) -> Callable[..., Solver]:
    """Code of the index-1 system of a structure, to be bound to the numbers of a scenario.

    Parameters
    ----------
    held : tuple of str
        Constraints.
    load : str, optional
        What presses the disk on the table where friction acts; None where there is none.
    horizontal : bool
        Whether the table is level.

    Returns
    -------
    callable
        From the numbers of the disk and of the table and `per_speed` of a law to a `Solver`.
    """
    rates = [f"{name}_rate" for name in COORDINATES]
    recorder = Recorder((*SIX, *_TABLE, "per_speed"), (*COORDINATES, *rates))
    *numbers, pressing, along, across, _ = recorder.constants
    disk: Any = SimpleNamespace(**dict(zip(SIX, numbers, strict=True)))
    stand_in: Any = SimpleNamespace(
        constraints=held,
        disk=disk,
        table=SimpleNamespace(
            pressing=pressing, vector=(along, across, -pressing), is_horizontal=horizontal
        ),
        weight=disk.mass * pressing,
        rubs=load is not None,
        friction=SimpleNamespace(load=load, per_speed=partial(call, "per_speed")),
    )
    z, u = recorder.variables[:6], recorder.variables[6:]
    columns = solution(stand_in, z, u, partial(call, "hypot"))
    result = columns[0]
    if load == "contact":
        result = loaded(columns, call("_contact_load", columns[0][6], columns[1][6]))
    return recorder.code(result, hypot=hypot, _contact_load=_contact_load)


def _contact_load(frictionless: float, feedback: float) -> float:
    """Normal force in N that friction takes as its load, from that without friction."""
    if feedback >= 1.0:
        raise ArithmeticError(
            f"each newton of normal force calls for {feedback:.3g} N of it through friction"
        )
    return frictionless / (1.0 - feedback) if frictionless > 0.0 else 0.0


def accelerations(scenario: Scenario, z: Vector, u: Vector) -> tuple[Array, Array]:
    """Accelerations and multipliers with all constraints on acceleration level, at one state.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact.
    z, u : array_like, shape (6,)
        Co-rotating coordinates and their rates.

    Returns
    -------
    accelerations : ndarray, shape (6,)
    multipliers : ndarray, shape (n,)
        Constraint forces in the order of `multiplier_names(scenario.constraints)`.

    Raises
    ------
    ArithmeticError
        If the matrix is singular, or if the friction of each newton of normal force calls for a
        newton more of it: Eq. (79) then has no solution, or two.
    """
    result = np.array(solver(scenario)(*map(float, z), *map(float, u)))
    return result[:6], result[6:]
