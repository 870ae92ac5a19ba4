"""The unilateral penalty form of the contact."""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from analysis.checks import Array, not_negative, positive
from analysis.disk import Disk
from analysis.state import State

LARGEST_PART = 0.01
"""Largest resting penetration as a part of the radius; beyond, it is another disk's motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PenaltyContact:
    """Unilateral contact with force max(0, stiffness * penetration + damping * its rate).

    The penetration is that of the disk's lowest point. The disk may lift off; then neither the
    contact nor friction acts.

    Parameters
    ----------
    stiffness : float
        In N/m, positive.
    damping : float
        In N s/m, not negative.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness))
        object.__setattr__(self, "damping", not_negative("damping", self.damping))

    @classmethod
    def damped(cls, stiffness: float, disk: Disk, ratio: float = 0.5) -> "PenaltyContact":
        """Contact on which the upright disk bounces with this part of the critical damping.

        Parameters
        ----------
        stiffness : float
            In N/m.
        disk : Disk
        ratio : float
            Damping ratio, not negative.
        """
        stiffness = positive("stiffness", stiffness)
        damping = 2.0 * not_negative("ratio", ratio) * sqrt(stiffness * disk.mass)
        return cls(stiffness=stiffness, damping=damping)

    def resting_penetration(self, disk: Disk) -> float:
        """Penetration in m at which the contact carries the weight of the disk."""
        return disk.weight / self.stiffness

    def lowered(self, disk: Disk, start: State) -> State:
        """The start, lowered by the resting penetration.

        A start that just touches the table would fall into it and bounce.

        Parameters
        ----------
        disk : Disk
        start : State
            Touching the table, as `analysis.consistent_start` makes it.
        """
        x, y, z, *angles = start.coordinates
        return replace(start, coordinates=(x, y, z - self.resting_penetration(disk), *angles))

    def check(self, disk: Disk) -> None:
        """Raise `ValueError` if the disk sinks in by more than a small part of its radius."""
        least = disk.weight / (LARGEST_PART * disk.radius)
        if self.stiffness < least:
            raise ValueError(
                f"stiffness must be at least weight / ({LARGEST_PART:g} radius) = {least:.4g} N/m "
                f"so that the disk does not sink into the table, got {self.stiffness:g}"
            )

    def forces(self, disk: Disk, coordinates: Array, rates: Array) -> Array:
        """Normal force in N, shape (n,).

        Parameters
        ----------
        disk : Disk
        coordinates, rates : ndarray, shape (n, 6)
            Co-rotating coordinates and their rates.
        """
        r, beta = disk.radius, coordinates[:, 4]
        penetration = r * np.sin(beta) - coordinates[:, 2]
        rate = r * np.cos(beta) * rates[:, 4] - rates[:, 2]
        result: Array = np.maximum(0.0, self.stiffness * penetration + self.damping * rate)
        return result
