"""Samples of many motions in the paper's coordinates, as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from analysis.mechanics import recorded
from analysis.motion.quantities import InCoordinates
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array
from analysis.problem.constraints import ConstraintSet
from analysis.problem.contact import PenaltyContact


@dataclass(frozen=True, slots=True, eq=False)
class Samples(InCoordinates):
    """Samples of k motions; behind the end of one its last sample is repeated.

    Parameters
    ----------
    scenario : SimpleNamespace
        See `stand_in`.
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
    def of(cls, motions: Sequence[Trajectory], count: int | None = None) -> "Samples":
        """So many samples of each motion, by default those of the longest one.

        All have the same constraints, and all or none a penalty contact.
        """
        count = count or max(motion.times.size for motion in motions)
        first = motions[0].scenario
        # Surfaces are left out, which differ in how many numbers they have.
        size = len(recorded.NUMBERS)
        numbers = np.array([recorded.numbers(motion.scenario)[:size] for motion in motions])
        rows = [(each, np.minimum(np.arange(count), each.times.size - 1)) for each in motions]
        arrays = (
            np.array([getattr(motion, name)[some] for motion, some in rows])
            for name in ("times", "coordinates", "rates", "multipliers")
        )
        return cls(stand_in(first.constraints, first.contact, numbers), *arrays)


def stand_in(
    constraints: ConstraintSet, contact: PenaltyContact | None, numbers: Array
) -> SimpleNamespace:
    """What has constraints and contact of k scenarios, and their numbers, each shape (k, 1).

    Parameters
    ----------
    constraints : tuple of str
    contact : PenaltyContact or None
        Of one of them.
    numbers : ndarray, shape (k, n)
        Those of `recorded.NUMBERS`.
    """
    columns = numbers.T[:, :, None]
    return SimpleNamespace(
        constraints=constraints,
        contact=contact,
        disk=recorded.disk_of(columns),
        table=SimpleNamespace(vector=columns[9:]),
    )
