"""How fine a map is: the uncertainty exponent of its boundaries.

Source: C. Grebogi, S. W. McDonald, E. Ott and J. A. Yorke, Final state sensitivity: an obstruction
to predictability, Physics Letters A 99 (1983).
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analysis import Scenario
from analysis.data.checks import Array
from validation.maps.problems import Problem, quickest_plan
from validation.sweeps.axes import Axis, Design
from validation.sweeps.sweep import Sweep

DISTANCES = (0.1, 0.1 / 8, 0.1 / 64, 0.1 / 512)
"""Between the two starts of a pair, as parts of the width of a map."""

RESAMPLINGS = 500
"""Of the pairs, for the error of the exponent."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """Part f of the starts whose class an error of the start changes, f ~ distance**exponent.

    Parameters
    ----------
    distances : ndarray, shape (n,)
    parts : ndarray, shape (n,)
        Of pairs of starts so far apart, those of different class.
    exponent : float
        1 for smooth boundaries, less for fractal ones, and for such as are finer than the
        distances.
    error : float
        Standard deviation of the exponent over resampled pairs.
    """

    distances: Array
    parts: Array
    exponent: float
    error: float


def shifted_sweeps(
    problem: Problem, scenario: Scenario, *, number: int, end: float
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
    """
    (field, first, last), other = problem.axes
    plan = quickest_plan(scenario, end, 0)
    sweeps = []
    for distance in (0.0, *DISTANCES) if number else ():
        # The same random numbers between shifted ends are the same starts, shifted.
        shift = distance * (last - first)
        axes = (
            Axis(field=field, first=first + shift, last=last + shift),
            Axis(field=other[0], first=other[1], last=other[2]),
        )
        design = Design(axes=axes, layout="random", number=number)
        sweeps.append(Sweep(scenario=scenario, design=design, plan=plan))
    return sweeps


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
    random = np.random.default_rng(0)
    parts = differs.mean(axis=1)
    if np.count_nonzero(parts) < 2:
        return None
    count = differs.shape[1]
    slopes = [
        _slope(distances, differs[:, random.integers(count, size=count)].mean(axis=1), count)
        for _ in range(RESAMPLINGS)
    ]
    return Uncertainty(
        distances=distances,
        parts=parts,
        exponent=_slope(distances, parts, count),
        error=float(np.std(slopes)),
    )


def _slope(distances: Array, parts: Array, count: int) -> float:
    """Slope of log(part) over log(distance), weighted by the binomial error of the parts."""
    # Half a pair in place of none and of all, which have no logarithm or no error.
    kept = np.clip(parts, 0.5 / count, 1.0 - 0.5 / count)
    weights = np.sqrt(count * kept / (1.0 - kept))
    return float(np.polyfit(np.log(distances), np.log(kept), 1, w=weights)[0])
