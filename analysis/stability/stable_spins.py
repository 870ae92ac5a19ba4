"""Spins at which a stationary spinning motion is stable as a whole, not in one pair alone."""

from itertools import pairwise

import numpy as np

from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import ROUND_OFF
from analysis.stability.spectra import System, matrices_over_spin


def stable_spins(
    scenario: Scenario,
    interval: tuple[float, float] = (0.0, 60.0),
    system: System | None = None,
    motion: Motion = "inverted",
) -> tuple[tuple[float, float], ...]:
    """Intervals of the spin in rad/s in which every eigenvalue has a negative real part.

    The pair that only moves the disk on the table does not count; eigenvalues that are zero at
    every spin, as those of a round disk, do: with them the motion is not asymptotically stable.

    Parameters
    ----------
    scenario, interval, system, motion
        See `critical_speeds`, between whose crossings nothing changes; so are the errors.
    """
    found = critical_speeds(scenario, interval, system, motion)
    matrices = matrices_over_spin(scenario, system, motion)
    ends = [found.interval[0], *(each.spin for each in found.crossings), found.interval[1]]

    def decays(spin: float) -> bool:
        values = np.linalg.eigvals(matrices(np.array([spin]))[0])
        return bool(np.max(values.real) + ROUND_OFF * np.max(np.abs(values)) < 0.0)

    return tuple((low, high) for low, high in pairwise(ends) if decays((low + high) / 2.0))
