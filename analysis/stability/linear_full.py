"""The full system linearised about inverted and noninverted spinning, Eqs. (48)-(55).

M z'' + (D + G) z' + (K + N) z = 0 with z = (x, y, beta - pi/2, gamma -+ pi/2): horizontal
position of the geometric centre G in the co-rotating frame and deviations of the angles.

Turning the body frame by pi about its z axis swaps the two motions and the sign of the
eccentricity and changes nothing else, so noninverted spinning has the same matrices with -e.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, choice, float_array, within
from analysis.data.disk import Disk
from analysis.data.quantities import FASTEST_TURN
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.stability.scope import require_spinning

FULL_COORDINATES = ("x", "y", "beta", "gamma")
"""Coordinates of the full linear system, in order; its states add their rates."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FullLinearSystem:
    """Matrices of Eq. (55) for a stack of spins.

    Parameters
    ----------
    motion : {"inverted", "noninverted"}
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s (paper: Omega).
    mass : ndarray, shape (n, 4, 4)
        Symmetric mass matrix M, Eq. (49).
    damping : ndarray, shape (n, 4, 4)
        Symmetric damping matrix D, Eq. (53).
    gyroscopic : ndarray, shape (n, 4, 4)
        Skew-symmetric gyroscopic matrix G, Eq. (50).
    stiffness : ndarray, shape (n, 4, 4)
        Symmetric stiffness matrix K: Eqs. (51), (52) and the symmetric part of (54).
    circulatory : ndarray, shape (n, 4, 4)
        Skew-symmetric circulatory matrix N, the skew part of Eq. (54).
    """

    motion: Motion
    spins: Array
    mass: Array
    damping: Array
    gyroscopic: Array
    stiffness: Array
    circulatory: Array

    @property
    def state_matrices(self) -> Array:
        """Matrices of the first-order form in (z, z'), shape (n, 8, 8)."""
        result = np.zeros((self.spins.size, 8, 8))
        result[:, :4, 4:] = np.eye(4)
        result[:, 4:, :4] = -np.linalg.solve(self.mass, self.stiffness + self.circulatory)
        result[:, 4:, 4:] = -np.linalg.solve(self.mass, self.damping + self.gyroscopic)
        return result


def spin_array(spins: npt.ArrayLike) -> Array:
    """Return `spins` as a float array, shape (n,), n >= 1; a single number gives n = 1.

    Raises
    ------
    ValueError
        If it holds no real numbers, is empty, has more than one dimension, is not finite or
        exceeds `FASTEST_TURN`.
    """
    result = np.atleast_1d(float_array("spins", spins))
    if result.ndim != 1 or result.size == 0:
        raise ValueError(
            f"spins must be one-dimensional with at least 1 entry, got shape {result.shape}"
        )
    if not np.all(np.isfinite(result)):
        worst = result[~np.isfinite(result)][0]
        raise ValueError(f"spins must be finite numbers in rad/s, got {worst}")
    fastest = float(result[np.argmax(np.abs(result))])
    within("spins", fastest, -FASTEST_TURN, FASTEST_TURN)
    return result


def signed_eccentricity(disk: Disk, motion: Motion) -> float:
    """Height of S above G in m: +e for inverted, -e for noninverted spinning.

    Raises
    ------
    ValueError
        If the motion is unknown.
    """
    choice("motion", motion, MOTIONS)
    return disk.eccentricity if motion == "inverted" else -disk.eccentricity


def full_system(
    scenario: Scenario,
    spins: npt.ArrayLike,
    motion: Motion = "inverted",
    *,
    gradient: float | None = None,
) -> FullLinearSystem:
    """Linearise the full system about a spinning motion, Eqs. (48)-(55).

    With the signs of Eq. (48), friction enters as + D_C and + B_C: the paper prints (53) and (54)
    with a minus, which would feed energy in. Load "weight" and load "contact" have the same
    linearisation, because the contact force is m g up to second order, Eq. (40).

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}
    gradient : float, optional
        Friction gradient mu / epsilon in s/m, in place of that of the scenario's law.

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown or the scenario another one.
    """
    require_spinning(scenario, "the full system", 1)
    disk, Omega = scenario.disk, spin_array(spins)
    e = signed_eccentricity(disk, motion)
    m, r, mg, me = disk.mass, disk.radius, scenario.weight, disk.mass * e
    A, B, C = disk.inertia_x, disk.inertia_y, disk.inertia_z
    d = (scenario.friction.gradient if gradient is None else gradient) * mg
    D = A - B - C
    M = ((m, 0, 0, -me), (0, m, -me, 0), (0, -me, B, 0), (-me, 0, 0, C))
    G_h = ((0, -2 * m, 2 * me, 0), (2 * m, 0, 0, -2 * me), (-2 * me, 0, 0, -D), (0, 2 * me, D, 0))
    K_h = ((-m, 0, 0, me), (0, -m, me, 0), (0, me, A - C, 0), (me, 0, 0, A - B))
    K_f = np.diag((0.0, 0.0, -mg * (e + r), -mg * e))
    D_C = d * np.array(((1, 0, 0, r), (0, 1, r, 0), (0, r, r * r, 0), (r, 0, 0, r * r)))
    B_C = d * np.array(((0, -1, -r, 0), (1, 0, 0, 0), (r, 0, 0, 0), (0, -r, -r * r, 0)))
    first, second = Omega[:, None, None], Omega[:, None, None] ** 2
    ones = np.ones_like(first)
    return FullLinearSystem(
        motion=motion,
        spins=Omega,
        mass=ones * np.array(M),
        damping=ones * D_C,
        gyroscopic=first * np.array(G_h),
        stiffness=second * np.array(K_h) + K_f + first * (B_C + B_C.T) / 2,
        circulatory=first * (B_C - B_C.T) / 2,
    )


def without_drift(spins: Array, matrices: Array) -> Array:
    """Take the drift out of state matrices of the full system: shape (n, 8, 8) to (n, 6, 6).

    The table is homogeneous: a disk spinning elsewhere spins just as well. In the R-frame, which
    turns with the disk, a place fixed on the table circles with -Omega, which gives every
    (n, 8, 8) matrix the pair of eigenvalues +-i Omega exactly, whatever the friction. In the
    states (beta, gamma, inertial velocity of G along e_x^R and e_y^R, rates of beta and gamma)
    the place does not occur any more, and the other six eigenvalues stand alone.

    Parameters
    ----------
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s.
    matrices : ndarray, shape (n, 8, 8)
        State matrices in (x, y, beta, gamma) and their rates.

    Raises
    ------
    ArithmeticError
        If the place does matter, so that the matrices are not those of a homogeneous table.
    """
    change = np.zeros((spins.size, 8, 8))
    change[:, 4, 1], change[:, 5, 0] = -spins, spins
    turned = (np.eye(8) + change) @ matrices @ (np.eye(8) - change)
    scale = np.max(np.abs(turned), axis=(1, 2))
    coupling = np.max(np.abs(turned[:, 2:, :2]), axis=(1, 2)) / scale
    if np.max(coupling) > 1e-6:
        raise ArithmeticError(
            f"drift does not separate: relative coupling to the place {np.max(coupling):.1e}"
        )
    return np.ascontiguousarray(turned[:, 2:, 2:])
