"""Accuracy of motions by agreement of runs; what makes the runs does not matter."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from analysis.data.checks import Array, ToleranceError
from analysis.data.endings import TIME_LIMIT, Condition, Ending
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.state import FlatError

RUNS = 5
"""Runs after which a tolerance counts as out of reach."""

TIGHTEST = 1e-13
"""Local tolerance that no run goes below, because of rounding."""

LEAST_RATE = 1.0
"""Rate in rad/s by which a difference in the time of an ending counts at least."""


def until_agreement(
    run: Callable[[float], SpatialMotion], first: float, tolerance: float
) -> SpatialMotion:
    """Tighten the local tolerance tenfold until two runs agree.

    Parameters
    ----------
    run : callable
        From a local tolerance to a motion.
    first : float
        Local tolerance of the first run.
    tolerance : float
        Largest `SpatialMotion.deviation` of the last two runs.

    Returns
    -------
    SpatialMotion
        The last run, with its deviation from the one before as its error estimate. A run that
        met a time limit is returned as it is, with an estimate over what it reached if there is
        another run to compare with.

    Raises
    ------
    ToleranceError
        If no two runs agree.
    """
    coarse = run(max(first, 10.0 * TIGHTEST))
    if _cut_short(coarse):
        return coarse
    differences = []
    for number in range(1, RUNS):
        local = max(first, 10.0 * TIGHTEST) * 0.1**number
        if local < 0.99 * TIGHTEST:
            break
        fine = run(local)
        differences.append(fine.deviation(coarse))
        if differences[-1] <= tolerance or _cut_short(fine):
            return replace(fine, error_estimate=differences[-1])
        coarse = fine
    listed = ", ".join(f"{difference:.1e}" for difference in differences)
    raise ToleranceError(
        f"tolerance {tolerance:g} cannot be reached: runs of which each allows a tenth of the "
        f"error in a step differ by {listed}; a motion that depends on its impacts in such a way "
        "cannot be predicted"
    )


def error_at_ending(
    apart: npt.ArrayLike, time_apart: npt.ArrayLike, rates: npt.ArrayLike
) -> Array:
    """Difference of two runs where each ends by itself, its time included.

    A condition that ends a run fixes the state there, so that the states of two endings agree
    however far apart their times are. The later of the two states is at most this far from the
    earlier run at the same time.

    Parameters
    ----------
    apart : array_like, shape (..., k)
        Differences of beta and gamma between the two endings in rad.
    time_apart : array_like, shape (...)
        Difference of their times in s.
    rates : array_like, shape (..., k)
        Rates of beta and gamma at an ending in rad/s; `LEAST_RATE` where they are smaller, so
        that the time is as accurate as the angles where these stand still.

    Returns
    -------
    ndarray, shape (...)
        In rad.
    """
    moved = np.maximum(np.abs(rates), LEAST_RATE) * np.abs(time_apart)[..., None]
    found: Array = np.max(np.abs(apart) + moved, axis=-1)
    return found


def _cut_short(motion: SpatialMotion) -> bool:
    return motion.ending is not None and motion.ending.reason == TIME_LIMIT


def located(
    motion: SpatialMotion, conditions: Mapping[str, Condition], tolerance: float | None = None
) -> SpatialMotion:
    """The same motion up to where a condition turns negative before its last sample.

    Parameters
    ----------
    motion : SpatialMotion
        Ended at the first sample that meets one of the conditions, or for another reason.
    conditions : mapping
        By name, as `named_conditions` makes it.
    tolerance : float, optional
        Largest error that interpolation may add, as in `SpatialMotion.at`.

    Returns
    -------
    SpatialMotion
        With its last sample moved to that time; as it was where the samples do not determine the
        motion between them to the tolerance, as after an impact.
    """
    if motion.ending is None or motion.ending.reason not in conditions:
        return motion
    reason = motion.ending.reason
    begin, end = motion.times[-2:].tolist()

    def says(time: float) -> float:
        return float(conditions[reason](motion.at(time, tolerance=tolerance)))

    try:
        if says(begin) < 0.0:
            return motion
        time = float(brentq(says, begin, end, xtol=1e-12, rtol=1e-12))
        value = says(time)
        ended = motion.resampled(np.append(motion.times[:-1], time), tolerance=tolerance)
    except (ToleranceError, FlatError):
        return motion
    return replace(ended, ending=Ending(reason=reason, time=time, value=value))
