"""Columns of a sample: co-rotating coordinates, their rates, and the constraint forces."""

import numpy as np

from analysis.data.agreement import error_at_ending
from analysis.data.checks import Array

COORDINATES = slice(0, 6)
RATES = slice(6, 12)
FORCES = slice(12, None)

ALPHA, BETA, GAMMA = 3, 4, 5
TURNING = [ALPHA, GAMMA]
BETA_RATE = 10
NORMAL_FORCE = 12

ANGLES, ANGLE_RATES = slice(4, 6), slice(10, 12)
"""Those of beta and gamma."""


def apart(first: Array, second: Array, *, flat: bool = False) -> float:
    """Largest difference of beta and gamma in rad, which is what tolerances speak of.

    Parameters
    ----------
    first, second : ndarray, shape (n, 12 + k)
        Samples with their times as the last column; those of the last may differ.
    flat : bool
        Whether the disk lies flat at the last sample: gamma means nothing there.
    """
    gaps, rates = first[:, ANGLES] - second[:, ANGLES], second[:, ANGLE_RATES].copy()
    if flat:
        gaps[-1, 1] = rates[-1, 1] = 0.0
    return float(np.max(error_at_ending(gaps, first[:, -1] - second[:, -1], rates)))
