"""What is asked of runs, and the sampled motions that they give."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

from analysis.data.agreement import error_at_ending
from analysis.data.checks import Array
from analysis.data.endings import Condition
from analysis.data.state import State
from analysis.data.watch import Watch
from mbs_models.integrators import Integrator
from mbs_models.scene import Scene

COORDINATES = slice(0, 6)
RATES = slice(6, 12)
FORCES = slice(12, None)

ALPHA, BETA, GAMMA = 3, 4, 5
TURNING = [ALPHA, GAMMA]
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


def leaning(rows: Array) -> Array:
    """Angle in rad between disk and table in samples.

    It is negative where beta lies outside (0, pi), by whole turns if a run has failed.
    """
    tilts = rows[..., BETA]
    result: Array = np.minimum(tilts, pi - tilts)
    return result


def state_of(row: Array) -> State:
    """State of a sample."""
    values = row.tolist()
    return State(coordinates=tuple(values[COORDINATES]), rates=tuple(values[RATES]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Call:
    """What a call of `mbs_models.simulate` asks of every run that it takes.

    Parameters
    ----------
    scene : Scene
    times : ndarray, shape (n,)
        In s.
    longest : float
        Longest step in s.
    tolerance : float or None
        Largest error in rad, if the runs are to have one.
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative.
    allow_pulling : bool
        Whether to go on where the contact pulls.
    watch : Watch
    counts : Counter
        To which the work of the runs is added.
    """

    scene: Scene
    times: Array
    longest: float
    tolerance: float | None
    conditions: Mapping[str, Condition]
    allow_pulling: bool
    watch: Watch
    counts: Counter[str] = field(default_factory=Counter)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sampled:
    """A motion over all times, and what has led there.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Those asked for, up to where it ended, and the time of that ending.
    values : ndarray, shape (n, 12 + k)
        Co-rotating coordinates, their rates, and the constraint forces.
    integrator : Integrator
    step : float
        Longest step in s, or the limit of step control.
    seconds : float
        Processor time that the solver took.
    ended : str or None
        Why it ended before the last time asked for.
    pulling : tuple of pairs of floats
        Times in s between which the contact has pulled.
    estimate : float, optional
        Estimated error in rad.
    """

    times: Array
    values: Array
    integrator: Integrator
    step: float
    seconds: float
    ended: str | None
    pulling: tuple[tuple[float, float], ...] = ()
    estimate: float | None = None
