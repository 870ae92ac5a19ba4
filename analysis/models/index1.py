"""The constrained systems of index 1, Eqs. (79), (80) and (92), for any set of constraints."""

from collections.abc import Callable
from math import hypot
from typing import Any

import numpy as np
from scipy.linalg.lapack import dgesv

from analysis.data.checks import Array
from analysis.data.elementary import cos, sin
from analysis.data.scenario import Scenario
from analysis.models import constraints, equations
from analysis.models.equations import Vector

Speed = Callable[[Any, Any], Any]
"""Size of a slip from its two parts, one of which is 0.0 where slip is held."""


def friction_per_load(scenario: Scenario, z: Vector, u: Vector, speed: Speed = hypot) -> Array:
    """Generalised friction force for a load of 1 N, shape (6,); Eq. (3) without its lambda_N.

    The disk slides where it is not held: Models 1 and 2 in both directions of the table, Models 3
    and 4 along e_y alone. The products with W_T of Eq. (32) are written out: as array products
    they take a sixth of the time of a simulation.
    """
    return np.array(friction_rows(scenario, z, u, speed))


def friction_rows(scenario: Scenario, z: Vector, u: Vector, speed: Speed) -> tuple[Any, ...]:
    """The rows of `friction_per_load`, of numbers of any kind."""
    r, held = scenario.disk.radius, scenario.constraints
    x, side, lift = z[0], r * cos(z[4]) - z[1], r * sin(z[4])
    slip_x = 0.0 if "no-slip-along" in held else u[0] + side * u[3] + r * u[5]
    slip_y = 0.0 if "no-slip-across" in held else u[1] + x * u[3] + lift * u[4]
    factor = -scenario.friction.per_speed(speed(slip_x, slip_y))
    fx, fy = factor * slip_x, factor * slip_y
    return fx, fy, 0.0, side * fx + x * fy, lift * fy, r * fx


def system(scenario: Scenario, z: Vector, u: Vector, speed: Speed = hypot) -> tuple[Array, Array]:
    """Matrix and right-hand sides for accelerations and multipliers, from numbers of any kind.

    The second and third block row of Eq. (80), of Eq. (79) if the friction law takes the contact
    force as its load, and of Eq. (92) for the further constraints.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact.
    z, u : array_like, shape (6,)
        Co-rotating coordinates and their rates.
    speed : callable
        See `Speed`.

    Returns
    -------
    matrix : ndarray, shape (6 + n, 6 + n)
        For n constraints, in the order of `multiplier_names(scenario.constraints)`.
    right : ndarray, shape (6 + n, 1) or (6 + n, 2)
        The second column holds the friction for each newton of contact force, if that matters.
    """
    held, disk = scenario.constraints, scenario.disk
    mass, W = equations.mass_matrix(disk, z), constraints.directions(held, disk, z)
    n = len(W)
    matrix = np.zeros((6 + n, 6 + n), order="F", dtype=mass.dtype)
    matrix[:6, :6] = mass
    matrix[:6, 6:] = -W.T
    matrix[6:, :6] = W
    rubs = scenario.rubs
    by_contact = rubs and scenario.friction.load == "contact"
    right = np.zeros((6 + n, 2 if by_contact else 1), order="F", dtype=mass.dtype)
    # Rows are added as numbers: six are too few for arrays to pay.
    gyroscopic = equations.gyroscopic_rows(disk, z, u)
    gravity = equations.gravity_rows(disk, scenario.table, z)
    forces = [h + f for h, f in zip(gyroscopic, gravity, strict=True)]
    if rubs:
        friction = friction_rows(scenario, z, u, speed)
        if by_contact:
            right[:6, 1] = friction
        else:
            load = scenario.weight
            forces = [f + load * part for f, part in zip(forces, friction, strict=True)]
    chi = constraints.acceleration_rows(held, disk, z, u)
    right[:, 0] = forces + [-term for term in chi]
    return matrix, right


def loaded(solution: Array) -> Array:
    """Accelerations and multipliers where friction knows the contact force, shape (6 + n,).

    Parameters
    ----------
    solution : ndarray, shape (6 + n, 2)
        Of `system`: without friction, and what each newton of contact force adds.
    """
    frictionless, feedback = solution[6]
    result: Array = solution[:, 0] + frictionless / (1.0 - feedback) * solution[:, 1]
    return result


def accelerations(scenario: Scenario, z: Vector, u: Vector) -> tuple[Array, Array]:
    """Accelerations and multipliers with all constraints on acceleration level.

    Solves `system`. A contact that pulls (negative normal force) rubs with no load: friction
    never gives energy.

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
    matrix, right = system(scenario, z, u)
    _, _, solution, info = dgesv(matrix, right, overwrite_a=True, overwrite_b=True)
    if info != 0:
        raise ArithmeticError(
            f"singular index-1 system of {scenario.name} at coordinates {list(z)}"
        )
    result = solution[:, 0]
    if right.shape[1] == 2:
        frictionless, feedback = solution[6]
        if feedback >= 1.0:
            raise ArithmeticError(
                f"singular index-1 system (79) of {scenario.name}: at coordinates {list(z)} each "
                f"newton of normal force calls for {feedback:.3g} N of it through friction"
            )
        if frictionless > 0.0:
            result = loaded(solution)
    return result[:6], result[6:]
