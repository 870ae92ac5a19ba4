"""How fine a map is: the uncertainty exponent of its boundaries.

Source: C. Grebogi, S. W. McDonald, E. Ott and J. A. Yorke, Final state sensitivity: an obstruction
to predictability, Physics Letters A 99 (1983).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from analysis import Scenario
from analysis.data.checks import Array
from validation.maps.panel import run_panel
from validation.maps.problems import Problem, quickest_plan
from validation.sweeps.axes import Axis, Design
from validation.sweeps.pools import Pool
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
    problem: Problem, scenario: Scenario, *, number: int, end: float, compiled: bool = False
) -> list[Sweep]:
    """Sweeps over random starts of a map, and over the same ones at each of `DISTANCES`.

    Parameters
    ----------
    problem : Problem
    scenario : Scenario
    number : int
        Of starts; for 0 there are no sweeps.
    end : float
        Of each motion in s.
    compiled : bool
        See `quickest_plan`.
    """
    (field, first, last), (other, low, high) = problem.right, problem.up
    plan = quickest_plan(scenario, end, 0, compiled=compiled)
    sweeps = []
    for distance in (0.0, *DISTANCES) if number else ():
        # The same random numbers between shifted ends are the same starts, shifted.
        shift = distance * (last - first)
        axes = (
            Axis(field=field, first=first + shift, last=last + shift),
            Axis(field=other, first=low, last=high),
        )
        design = Design(axes=axes, layout="random", number=number)
        sweeps.append(Sweep(scenario=scenario, design=design, plan=plan))
    return sweeps


def run_pairs(sweeps: Sequence[Sweep], folder: Path, pool: Pool, **how: Any) -> Uncertainty | None:
    """Uncertainty exponent of a map from `shifted_sweeps`, each with a store in a folder.

    `how` goes to `run_panel`.
    """
    panels = [
        run_panel(sweep, folder / f"pairs-{index}.db", pool, **how)
        for index, sweep in enumerate(sweeps)
    ]
    outcomes = [panel.cells["outcome"] for panel in panels]
    return uncertainty(np.array(DISTANCES), pairs_that_differ(outcomes))


def pairs_that_differ(outcomes: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    """Whether starts end differently at each distance, shape (n, m).

    Parameters
    ----------
    outcomes : array_like of str, shape (1 + n, k)
        Of k starts, and of those beside them at n distances. Starts of which one outcome is not
        decided are left out.
    """
    found = np.asarray(outcomes)
    decided = ~np.any(np.isin(found, ("not decided", "failed")), axis=0)
    differs: npt.NDArray[np.bool_] = found[1:, decided] != found[0, decided]
    return differs


def uncertainty(distances: Array, differs: npt.NDArray[np.bool_]) -> Uncertainty | None:
    """Uncertainty exponent from pairs of starts.

    Parameters
    ----------
    distances : ndarray, shape (n,)
    differs : ndarray of bool, shape (n, m)
        Whether the classes of m pairs differ at each distance.

    Returns
    -------
    Uncertainty or None
        None if fewer than two distances have pairs that differ.
    """
    counts = differs.sum(axis=1)
    if np.count_nonzero(counts) < 2:
        return None
    random = np.random.default_rng(0)
    pairs = differs.shape[1]
    resampled = (
        differs[:, random.integers(pairs, size=pairs)].sum(axis=1) for _ in range(RESAMPLINGS)
    )
    slopes = [_slope(distances, each) for each in resampled if np.count_nonzero(each) > 1]
    return Uncertainty(
        parts=counts / pairs,
        exponent=_slope(distances, counts),
        error=float(np.std(slopes)),
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
