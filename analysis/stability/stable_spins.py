"""Spins at which a stationary spinning motion is stable as a whole, not in one pair alone."""

from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import choice
from analysis.data.disk import Disk
from analysis.data.friction import FrictionLaw
from analysis.stability.critical import spin_interval
from analysis.stability.linear_full import MOTIONS, Motion
from analysis.stability.spectra import SYSTEMS, System, helper_spins, relevant_matrices

_ROUND_OFF = 1e-10
"""Real parts of less than this part of the largest eigenvalue are none."""

_MOST_SAMPLES = 121
"""Spins at which the numerically linearised models are sampled."""


def stable_spins(
    system: System,
    disk: Disk,
    friction: FrictionLaw,
    interval: tuple[float, float] = (0.0, 60.0),
    motion: Motion = "inverted",
) -> tuple[tuple[float, float], ...]:
    """Intervals of the spin in rad/s in which every eigenvalue has a negative real part.

    The pair that only moves the disk on the table does not count; eigenvalues that are zero at
    every spin, as those of a round disk, do: with them the motion is not asymptotically stable.
    Intervals shorter than the sampling (0.05 rad/s, or 0.5 rad/s in Models 2 and 3, up to 60
    rad/s) may be missed.

    Parameters
    ----------
    system : {"full", "reduced", "model1", "model2", "model3", "model4"}
    disk : Disk
    friction : FrictionLaw
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s, not negative.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If the interval is empty or not finite, or the system or the motion is unknown.
    """
    choice("system", system, SYSTEMS)
    choice("motion", motion, MOTIONS)
    low, high = spin_interval(interval)

    def growth(spin: float) -> float:
        """Largest growth rate in 1/s, above zero also where it only might be."""
        values = np.linalg.eigvals(relevant_matrices(system, disk, friction, spin, motion)[0])
        return float(np.max(values.real) + _ROUND_OFF * np.max(np.abs(values)))

    spins = helper_spins(system, low, high).tolist()
    if system not in ("full", "reduced"):
        spins = np.linspace(low, high, min(len(spins), _MOST_SAMPLES)).tolist()
    rates = [growth(spin) for spin in spins]
    pairs = zip(pairwise(spins), pairwise(rates), strict=True)
    changes = [
        float(brentq(growth, *around, xtol=1e-9))
        for around, (before, after) in pairs
        if (before < 0.0) != (after < 0.0)
    ]
    ends = ([low] if rates[0] < 0.0 else []) + changes
    if rates[-1] < 0.0:
        ends.append(high)
    return tuple(zip(ends[::2], ends[1::2], strict=True))
