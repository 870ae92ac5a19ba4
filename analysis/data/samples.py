"""Samples of many motions at once, as arrays."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.motion_quantities import InCoordinates
from analysis.data.trajectory import Trajectory


@dataclass(frozen=True, slots=True, eq=False)
class Samples(InCoordinates):
    """Samples of k motions; behind the end of one its last sample is repeated.

    Parameters
    ----------
    scenario : Scenario
        Of the one motion there is; or what has its constraints, contact, and numbers of disk and
        table, each shape (k, 1).
    times : ndarray, shape (k, n)
    coordinates, rates : ndarray, shape (k, n, 6)
    multipliers : ndarray, shape (k, n, c)
    """

    scenario: Any
    times: Array
    coordinates: Array
    rates: Array
    multipliers: Array

    @classmethod
    def of(cls, motion: Trajectory, count: int) -> "Samples":
        """So many samples of one motion, k = 1."""
        rows = np.minimum(np.arange(count), motion.times.size - 1)[None]
        arrays = (motion.times, motion.coordinates, motion.rates, motion.multipliers)
        return cls(motion.scenario, *(each[rows] for each in arrays))
