"""Spins at which a stationary spinning motion is stable as a whole, not in one pair alone."""

from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.critical import spin_interval
from analysis.stability.linearisation import ROUND_OFF
from analysis.stability.spectra import System, helper_spins, matrices_over_spin


def stable_spins(
    scenario: Scenario,
    interval: tuple[float, float] = (0.0, 60.0),
    system: System | None = None,
    motion: Motion = "inverted",
) -> tuple[tuple[float, float], ...]:
    """Intervals of the spin in rad/s in which every eigenvalue has a negative real part.

    The pair that only moves the disk on the table does not count; eigenvalues that are zero at
    every spin, as those of a round disk, do: with them the motion is not asymptotically stable.
    Intervals shorter than the sampling (0.05 rad/s) may be missed.

    Parameters
    ----------
    scenario, system, motion
        See `spectra.matrices_over_spin`.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s, not negative.

    Raises
    ------
    ValueError
        If the interval is empty or not finite, the system or the motion is unknown, or the
        scenario none of this system.
    """
    low, high = spin_interval(interval)
    matrices = matrices_over_spin(scenario, system, motion)

    def growth(spins: Array) -> Array:
        """Largest growth rates in 1/s, above zero also where they only might be."""
        values = np.linalg.eigvals(matrices(spins))
        rates: Array = np.max(values.real, axis=1) + ROUND_OFF * np.max(np.abs(values), axis=1)
        return rates

    spins = helper_spins(low, high)
    rates = growth(spins).tolist()
    pairs = zip(pairwise(spins.tolist()), pairwise(rates), strict=True)
    changes = [
        float(brentq(lambda spin: growth(np.array([spin]))[0], *around, xtol=1e-9))
        for around, (before, after) in pairs
        if (before < 0.0) != (after < 0.0)
    ]
    ends = ([low] if rates[0] < 0.0 else []) + changes
    if rates[-1] < 0.0:
        ends.append(high)
    return tuple(zip(ends[::2], ends[1::2], strict=True))
