"""The constrained systems of index 1, Eqs. (79), (80) and (92), for Models 1 to 4."""

from math import cos, hypot, sin

import numpy as np
from scipy.linalg.lapack import dgesv

from analysis.data.checks import Array
from analysis.data.disk import Disk
from analysis.data.friction import FrictionLaw
from analysis.data.state import Level, multiplier_names
from analysis.models import constraints, equations
from analysis.models.equations import Vector


def friction_per_load(
    level: Level, disk: Disk, friction: FrictionLaw, z: Vector, u: Vector
) -> Array:
    """Generalised friction force for a load of 1 N, shape (6,); Eq. (3) without its lambda_N.

    Models 1 and 2 slide in both directions of the table; Models 3 and 4 roll along e_x and slide
    along e_y alone. The products with W_T of Eq. (32) are written out: as array products
    they take a sixth of the time of a simulation.
    """
    x, side, lift = z[0], disk.radius * cos(z[4]) - z[1], disk.radius * sin(z[4])
    slip_x = 0.0 if level >= 3 else u[0] + side * u[3] + disk.radius * u[5]
    slip_y = u[1] + x * u[3] + lift * u[4]
    factor = -friction.per_speed(hypot(slip_x, slip_y))
    fx, fy = factor * slip_x, factor * slip_y
    return np.array((fx, fy, 0.0, side * fx + x * fy, lift * fy, disk.radius * fx))


def accelerations(
    level: Level, disk: Disk, friction: FrictionLaw, z: Vector, u: Vector
) -> tuple[Array, Array]:
    """Accelerations and multipliers of Model `level` with its constraints on acceleration level.

    Solves the second and third block row of Eq. (80), of Eq. (79) if the friction law takes the
    contact force as its load, and of Eq. (92) for the further constraints. A contact that pulls
    (negative normal force) rubs with no load: friction never gives energy.

    Parameters
    ----------
    level : {1, 2, 3, 4}
    disk : Disk
    friction : FrictionLaw
    z, u : array_like, shape (6,)
        Co-rotating coordinates and their rates.

    Returns
    -------
    accelerations : ndarray, shape (6,)
    multipliers : ndarray, shape (n,)
        Constraint forces in the order of `multiplier_names(level)`.

    Raises
    ------
    ArithmeticError
        If the matrix is singular, or if the friction of each newton of normal force calls for a
        newton more of it: Eq. (79) then has no solution, or two.
    """
    n = len(multiplier_names(level))
    W = constraints.directions(level, disk, z)
    matrix = np.zeros((6 + n, 6 + n), order="F")
    matrix[:6, :6] = equations.mass_matrix(disk, z)
    matrix[:6, 6:] = -W.T
    matrix[6:, :6] = W
    by_contact = friction.is_on and friction.load == "contact"
    right = np.zeros((6 + n, 2 if by_contact else 1), order="F")
    right[:6, 0] = equations.gyroscopic_forces(disk, z, u) + equations.gravity_forces(disk, z)
    right[6:, 0] = -constraints.acceleration_terms(level, disk, z, u)
    if by_contact:
        right[:6, 1] = friction_per_load(level, disk, friction, z, u)
    elif friction.is_on:
        right[:6, 0] += disk.weight * friction_per_load(level, disk, friction, z, u)
    _, _, solution, info = dgesv(matrix, right, overwrite_a=True, overwrite_b=True)
    if info != 0:
        raise ArithmeticError(f"singular index-1 system of Model {level} at coordinates {list(z)}")
    result = solution[:, 0]
    if by_contact:
        frictionless, feedback = solution[6]
        if feedback >= 1.0:
            raise ArithmeticError(
                f"singular index-1 system (79) of Model {level}: at coordinates {list(z)} each "
                f"newton of normal force calls for {feedback:.3g} N of it through friction"
            )
        if frictionless > 0.0:
            result = result + frictionless / (1.0 - feedback) * solution[:, 1]
    return result[:6], result[6:]
