"""How fine a map is: the uncertainty exponent of its boundaries.

Source: C. Grebogi, S. W. McDonald, E. Ott and J. A. Yorke, Final state sensitivity: an obstruction
to predictability, Physics Letters A 99 (1983).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from analysis import Scenario
from analysis.problem.checks import Array
from validation.maps.problems import Problem, quickest_plan
from validation.sweeps.axes import Design
from validation.sweeps.sweep import Sweep

DISTANCES = (0.04, 0.04 / 4, 0.04 / 16, 0.04 / 64)
"""Between the two starts of a pair, as parts of the width of a map."""

RESAMPLINGS = 200
"""Of the pairs, for the error of the exponent."""

_STEEPEST = 50.0
"""Slope beyond which no exponent of counted pairs lies."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """Part f of the starts whose class an error of the start changes, f ~ distance**exponent.

    Parameters
    ----------
    parts : ndarray, shape (n,)
        Of pairs of starts so far apart, those of different class.
    exponent : float
        1 for smooth boundaries, less for fractal ones, and for such as are finer than the
        distances.
    error : float
        Standard deviation of the exponent over resampled pairs.
    """

    parts: Array
    exponent: float
    error: float


def shifted_sweeps(
    problem: Problem, scenario: Scenario, *, number: int, **how: Any
) -> list[Sweep]:
    """Sweeps over random starts of a map, and over the same ones at each of `DISTANCES`.

    Parameters
    ----------
    problem : Problem
    scenario : Scenario
    number : int
        Of starts; for 0 there are no sweeps.
    **how
        As in `quickest_plan`.
    """
    plan = quickest_plan(scenario, 0, **how)
    first, last = (float(problem.right.between(part)) for part in (0.0, 1.0))
    sweeps = []
    for distance in (0.0, *DISTANCES) if number else ():
        # The same random numbers between shifted ends are the same starts, shifted.
        shift = distance * (last - first)
        shifted = replace(problem.right, first=first + shift, last=last + shift)
        design = Design(axes=(shifted, problem.up), layout="random", number=number)
        sweeps.append(Sweep(scenario=scenario, design=design, plan=plan))
    return sweeps


def uncertainty(
    outcomes: npt.ArrayLike, distances: Sequence[float] = DISTANCES
) -> Uncertainty | None:
    """Uncertainty exponent from pairs of starts.

    Parameters
    ----------
    outcomes : array_like of str, shape (1 + n, k)
        Of k starts, and of those beside them at n distances. Starts of which one outcome is not
        decided are left out.
    distances : sequence of float

    Returns
    -------
    Uncertainty or None
        None if fewer than two distances have pairs that differ.
    """
    found = np.asarray(outcomes)
    found = found[:, ~np.any(np.isin(found, ("not decided", "failed")), axis=0)]
    differs, apart = found[1:] != found[0], np.array(distances)
    counts, pairs = differs.sum(axis=1), differs.shape[1]
    if np.count_nonzero(counts) < 2:
        return None
    random = np.random.default_rng(0)
    resampled = (
        differs[:, random.integers(pairs, size=pairs)].sum(axis=1) for _ in range(RESAMPLINGS)
    )
    slopes = [_slope(apart, each) for each in resampled if np.count_nonzero(each) > 1]
    return Uncertainty(
        parts=counts / pairs, exponent=_slope(apart, counts), error=float(np.std(slopes))
    )


def _slope(distances: Array, counts: npt.NDArray[np.int_]) -> float:
    """Slope of log(count) over log(distance) of greatest likelihood, for Poisson's distribution.

    A line through the logarithms could make nothing of a count of 0.
    """
    logs = np.log(distances)
    mean = np.average(logs, weights=counts)

    def excess(slope: float) -> float:
        return float(np.average(logs, weights=distances**slope) - mean)

    return float(brentq(excess, -_STEEPEST, _STEEPEST))
