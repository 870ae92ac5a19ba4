"""Samples of many motions at once, as arrays."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analysis.data.checks import Array
from analysis.data.motion_quantities import InCoordinates
from analysis.data.trajectory import Trajectory

_BLOCK = 2**14
"""Samples of motions that are looked at at once: they take some 5 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples(InCoordinates):
    """Samples of k motions; behind the end of one its last sample is repeated.

    Parameters
    ----------
    times : ndarray, shape (k, n)
    coordinates, rates : ndarray, shape (k, n, 6)
    multipliers : ndarray, shape (k, n, c)
    """

    times: Array
    coordinates: Array
    rates: Array
    multipliers: Array

    @classmethod
    def of(cls, motion: Trajectory, count: int) -> "Samples":
        """So many samples of one motion, k = 1."""
        rows = np.minimum(np.arange(count), motion.times.size - 1)[None]
        arrays = (motion.times, motion.coordinates, motion.rates, motion.multipliers)
        return cls(*(each[rows] for each in arrays))


def blocks(rows: int, samples: int) -> Iterator[slice]:
    """Rows with so many samples, some at a time."""
    size = max(1, _BLOCK // samples)
    return (slice(first, first + size) for first in range(0, rows, size))
