"""The full system linearised about inverted and noninverted spinning, Eqs. (48)-(55).

M z'' + (D + G) z' + (K + N) z = 0 with z = (x, y, beta - pi/2, gamma -+ pi/2): horizontal
position of the geometric centre G in the co-rotating frame and deviations of the angles.

Turning the body frame by pi about its z axis swaps the two motions and the sign of the
eccentricity and changes nothing else, so noninverted spinning has the same matrices with -e.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from analysis.data.body import Body
from analysis.data.checks import Array, choice
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.stability.linearisation import require_spinning, spin_array

Matrix = tuple[tuple[Any, ...], ...]


def printed_matrices(
    *, m: Any, r: Any, e: Any, A: Any, B: Any, C: Any, mg: Any, D: Any = None
) -> dict[str, Matrix]:
    """Entries of Eqs. (48)-(54), of numbers of any kind, by the paper's names.

    With the signs of Eq. (48), friction enters as + d D_C and + d Omega B_C with the force d =
    mu m g / epsilon: the paper prints (53) and (54) with a minus, which would feed energy in. The
    powers of Omega are left out: D + G = d D_C + Omega G_h and K + N = Omega² K_h + K_f + d Omega
    B_C. M is Eq. (49), G_h (50), K_h (51), K_f (52), D_C (53) and B_C (54); D abbreviates A - B -
    C, unless another number is given.
    """
    me, D = m * e, A - B - C if D is None else D
    return {
        "M": ((m, 0, 0, -me), (0, m, -me, 0), (0, -me, B, 0), (-me, 0, 0, C)),
        "G_h": (
            (0, -2 * m, 2 * me, 0),
            (2 * m, 0, 0, -2 * me),
            (-2 * me, 0, 0, -D),
            (0, 2 * me, D, 0),
        ),
        "K_h": ((-m, 0, 0, me), (0, -m, me, 0), (0, me, A - C, 0), (me, 0, 0, A - B)),
        "K_f": ((0, 0, 0, 0), (0, 0, 0, 0), (0, 0, -mg * (e + r), 0), (0, 0, 0, -mg * e)),
        "D_C": ((1, 0, 0, r), (0, 1, r, 0), (0, r, r * r, 0), (r, 0, 0, r * r)),
        "B_C": ((0, -1, -r, 0), (1, 0, 0, 0), (r, 0, 0, 0), (0, -r, -r * r, 0)),
    }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FullLinearSystem:
    """Eq. (55) for a stack of spins.

    Parameters
    ----------
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s (paper: Omega).
    mass : ndarray, shape (4, 4)
        M.
    by_rate, by_place : ndarray, shape (n, 4, 4)
        D + G and K + N.
    """

    spins: Array
    mass: Array
    by_rate: Array
    by_place: Array

    @classmethod
    def of(cls, printed: Mapping[str, npt.ArrayLike], spins: Array, d: float) -> Self:
        """System of `printed_matrices` with a friction force d in N s/m."""
        M, G_h, K_h, K_f, D_C, B_C = (np.array(each, dtype=float) for each in printed.values())
        Omega = spins[:, None, None]
        by_place = Omega**2 * K_h + K_f + d * Omega * B_C
        return cls(spins=spins, mass=M, by_rate=d * D_C + Omega * G_h, by_place=by_place)

    @property
    def state_matrices(self) -> Array:
        """Matrices of the first-order form in (z, z'), shape (n, 8, 8)."""
        result = np.zeros((self.spins.size, 8, 8))
        result[:, :4, 4:] = np.eye(4)
        result[:, 4:, :4] = -np.linalg.solve(self.mass, self.by_place)
        result[:, 4:, 4:] = -np.linalg.solve(self.mass, self.by_rate)
        return result

    @property
    def relevant_matrices(self) -> Array:
        """The same without the drift, shape (n, 6, 6).

        The table is homogeneous: a disk spinning elsewhere spins just as well. In the R-frame,
        which turns with the disk, a place fixed on the table circles with -Omega, which gives
        every (8, 8) matrix the pair of eigenvalues +-i Omega exactly, whatever the friction. In
        the states (beta, gamma, inertial velocity of G along e_x^R and e_y^R, rates of beta and
        gamma) the place does not occur any more, and the other six eigenvalues stand alone.
        """
        change = np.zeros((self.spins.size, 8, 8))
        change[:, 4, 1], change[:, 5, 0] = -self.spins, self.spins
        turned = (np.eye(8) + change) @ self.state_matrices @ (np.eye(8) - change)
        return np.ascontiguousarray(turned[:, 2:, 2:])


def signed_eccentricity(disk: Body, motion: Motion) -> float:
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

    Load "weight" and load "contact" have the same linearisation, because the contact force is m g
    up to second order, Eq. (40).

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
    spins = spin_array(spins)
    d = (scenario.friction.gradient if gradient is None else gradient) * scenario.weight
    return FullLinearSystem.of(printed_matrices(**paper_numbers(scenario, motion)), spins, d)


def paper_numbers(scenario: Scenario, motion: Motion = "inverted") -> dict[str, float]:
    """Numbers of `printed_matrices` by the paper's names."""
    disk = scenario.disk
    return {
        "m": disk.mass,
        "r": disk.radius,
        "e": signed_eccentricity(disk, motion),
        "A": disk.inertia_x,
        "B": disk.inertia_y,
        "C": disk.inertia_z,
        "mg": scenario.weight,
    }
