"""The tippedisk rolling without any slip, v_C = 0, the limit of a large friction gradient.

The paper mentions it in Sect. 4.3. Both components of the slip velocity W_T^T u, Eq. (32), are
constraints beside the contact; there is no friction law.
"""

from math import cos, pi, sin

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from analysis.data.checks import Array, increasing_times, number, positive
from analysis.data.disk import STEEL_DISK, Disk
from analysis.models import equations
from analysis.models.equations import Vector


def accelerations(disk: Disk, z: Vector, u: Vector) -> tuple[Array, Array]:
    """Accelerations, shape (6,), and the three contact forces normal, along e_x and e_y in N.

    Parameters
    ----------
    disk : Disk
    z, u : array_like, shape (6,)
        Co-rotating coordinates and their rates.
    """
    r, sb, cb = disk.radius, sin(z[4]), cos(z[4])
    xd, yd, _, ad, bd, _ = u
    W = np.column_stack(
        (equations.normal_direction(disk, z), equations.tangential_directions(disk, z))
    )
    matrix = np.zeros((9, 9))
    matrix[:6, :6] = equations.mass_matrix(disk, z)
    matrix[:6, 6:] = -W
    matrix[6:, :6] = W.T
    terms = (r * sb * bd * bd, -(r * sb * bd + yd) * ad, xd * ad + r * cb * bd * bd)
    forces = equations.gyroscopic_forces(disk, z, u) + equations.gravity_forces(disk, z)
    solution = np.linalg.solve(matrix, np.concatenate((forces, np.negative(terms))))
    return solution[:6], solution[6:]


def simulate_pure_rolling(
    times: npt.ArrayLike,
    spin: float,
    *,
    disk: Disk = STEEL_DISK,
    gamma: float = -pi / 2 + 0.1,
    local_tolerance: float = 1e-8,
) -> tuple[Array, Array]:
    """Roll without slip from an upright disk that spins on the spot, as in Table 3.

    Parameters
    ----------
    times : array_like, shape (n,)
        Strictly increasing times in s.
    spin : float
        Rate of alpha in rad/s.
    disk : Disk
    gamma : float
        Rotation angle at the start in rad.
    local_tolerance : float

    Returns
    -------
    coordinates, rates : ndarray, shape (n, 6)

    Raises
    ------
    ValueError
        If an argument is out of range.
    ArithmeticError
        If the integration fails.
    """
    times, spin = increasing_times(times), number("spin", spin)
    place = (0.0, 0.0, disk.radius, 0.0, pi / 2, number("gamma", gamma))

    def right_hand_side(_: float, state: Array) -> Array:
        values = state.tolist()
        return np.concatenate((values[6:], accelerations(disk, values[:6], values[6:])[0]))

    result = solve_ivp(
        right_hand_side,
        (times[0], times[-1]),
        (*place, 0.0, 0.0, 0.0, spin, 0.0, 0.0),
        method="DOP853",
        t_eval=times,
        rtol=positive("local_tolerance", local_tolerance),
        atol=local_tolerance,
        max_step=2.0 / max(abs(spin), 1.0),
    )
    if not result.success:
        raise ArithmeticError(f"rolling stopped before the end: {result.message}")
    return result.y.T[:, :6], result.y.T[:, 6:]
