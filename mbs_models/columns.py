"""Columns of a sample: co-rotating coordinates, their rates, and the constraint forces."""

import numpy as np

from analysis.data.checks import Array

COORDINATES = slice(0, 6)
RATES = slice(6, 12)
FORCES = slice(12, None)

ALPHA, BETA, GAMMA = 3, 4, 5
TURNING = [ALPHA, GAMMA]
BETA_RATE = 10
NORMAL_FORCE = 12


def apart(first: Array, second: Array) -> float:
    """Largest difference of beta and gamma in rad, which is what tolerances speak of.

    Parameters
    ----------
    first, second : ndarray, shape (n, 6 or more)
        Samples at the same times.
    """
    angles = slice(BETA, GAMMA + 1)
    return float(np.max(np.abs(first[:, angles] - second[:, angles])))
