"""A periodic motion of the reduced system."""

from dataclasses import dataclass

import numpy as np
from numpy.linalg import eigvals

from analysis.data.checks import Array
from analysis.data.scenario import Scenario

INVERTED: Array = np.array((np.pi / 2, np.pi / 2, 0.0))
"""Inverted spinning: beta and gamma in rad, and the rate of beta."""

_NEUTRAL = 1e-6
"""Distance of a multiplier from 1 below which a cycle is called neither stable nor unstable."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cycle:
    """A periodic motion about inverted spinning that is its own mirror image half a period later.

    Parameters
    ----------
    scenario : Scenario
    spin : float
        Constant spinning speed in rad/s.
    amplitude : float
        Largest deviation of gamma from pi/2 in rad.
    period : float
        In s.
    times : ndarray, shape (n,)
        From 0 to half a period in s.
    states : ndarray, shape (n, 3)
        beta, gamma in rad and the rate of beta in rad/s at `times`; gamma is largest at the first.
    half_multiplier : float
        The larger of the two multipliers, over half a period with the mirror image. The cycle
        meets others in a fold where it is 1, and loses its mirror symmetry where it is -1. Both
        are real, since their product is negative: the mirror image turns all three directions
        round and the flow none, and the third multiplier, along the motion, is 1.
    log_strong : float
        Logarithm of the size of the other Floquet multiplier, which mostly is below rounding.
    method : {"collocation", "shooting"}
    """

    scenario: Scenario
    spin: float
    amplitude: float
    period: float
    times: Array
    states: Array
    half_multiplier: float
    log_strong: float
    method: str

    @property
    def multiplier(self) -> float:
        """Size of the larger nontrivial Floquet multiplier, over a whole period."""
        return self.half_multiplier**2

    @property
    def strong_half_multiplier(self) -> float:
        """The smaller one over half a period; 0 where it is too small for a float."""
        return -float(np.copysign(np.exp(self.log_strong / 2.0), self.half_multiplier))

    @property
    def stable(self) -> bool | None:
        """Whether both multipliers lie inside the unit circle; None if too close to tell."""
        return is_stable(self.multiplier)

    @property
    def full(self) -> tuple[Array, Array]:
        """Times, shape (2 n - 1,), and states, (2 n - 1, 3), over the whole period."""
        mirrored = 2.0 * INVERTED - self.states[1:]
        times = np.concatenate((self.times, self.times[-1] + self.times[1:]))
        return times, np.concatenate((self.states, mirrored))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WholePeriod:
    """A periodic motion that is told over its whole period.

    Parameters
    ----------
    scenario : Scenario
    spin : float
        Constant spinning speed in rad/s.
    period : float
        In s.
    times : ndarray, shape (n,)
        Over a period in s.
    states : ndarray, shape (n, 3)
        beta, gamma in rad and the rate of beta in rad/s.
    multiplier : float
        The larger of the two nontrivial Floquet multipliers: 1 at a fold, -1 where the period
        doubles.
    log_strong : float
        Logarithm of the size of the other one.
    """

    scenario: Scenario
    spin: float
    period: float
    times: Array
    states: Array
    multiplier: float
    log_strong: float


def is_stable(multiplier: float) -> bool | None:
    """Whether the size of the largest multiplier is below 1; None if too close to tell."""
    return None if abs(multiplier - 1.0) < _NEUTRAL else multiplier < 1.0


def multipliers(
    transfers: Array, rates: Array, log_determinant: float, *, mirrored: bool = True
) -> tuple[float, float]:
    """Larger multiplier over half a period or a whole one, and logarithm of the other's size.

    Deviations along the motion are left out (the linear Poincaré flow), since the trivial
    multiplier they have would hide a small one behind rounding. Over half a period a deviation
    is carried on and mirrored, so that the whole monodromy matrix is a square.

    Parameters
    ----------
    transfers : ndarray, shape (n, 3, 3)
        Solutions of the variational equations over successive parts of the time.
    rates : ndarray, shape (n + 1, 3)
        Time derivatives of the state at the ends of these parts.
    log_determinant : float
        Integral of the trace of the Jacobian over that time. The strong multiplier is below
        rounding in the matrices, but not in this number (Liouville).
    mirrored : bool
        Whether the time is half a period, after which the motion is its own mirror image.
    """
    frames = np.linalg.qr(rates[:, :, None], mode="complete")[0]
    # The motion ends in the direction in which it began, or in the opposite one.
    frames[-1] = frames[0]
    normal = frames[:, :, 1:]
    product, log_size = np.eye(2), 0.0
    for part in normal[1:].transpose(0, 2, 1) @ transfers @ normal[:-1]:
        product = part @ product
        size = np.max(np.abs(product))
        product, log_size = product / size, log_size + np.log(size)
    values = eigvals(-product if mirrored else product).real
    larger = float(values[np.argmax(np.abs(values))] * np.exp(log_size))
    return larger, log_determinant - float(np.log(abs(larger)))
