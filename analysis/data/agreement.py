"""Accuracy of motions by agreement of runs; what makes the runs does not matter."""

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, ToleranceError
from analysis.data.endings import AT_REST, TIME_LIMIT
from analysis.data.limits import LEAST_TILT
from analysis.data.spatial_motion import SpatialMotion

RUNS = 5
"""Runs after which a tolerance counts as out of reach."""

TIGHTEST = 1e-13
"""Local tolerance that no run goes below, because of rounding."""

SENSITIVE = 1e4
"""Difference of two runs over the tolerance of a step, from which on they may agree by chance.

Of such a motion every run ends up somewhere else: from Table 3, two runs over 60 s agreed to 2e-4
where both were off by 2e-3.
"""

LEAST_RATE = 1.0
"""Rate in rad/s by which a difference in the time of an ending counts at least."""


def until_agreement(
    run: Callable[[float], SpatialMotion], first: float, tolerance: float
) -> SpatialMotion:
    """Tighten the local tolerance tenfold until two runs agree, of a sensitive motion three.

    Parameters
    ----------
    run : callable
        From a local tolerance to a motion.
    first : float
        Local tolerance of the first run.
    tolerance : float
        Largest `SpatialMotion.deviation` of the last two runs, and `error_at_ending` where a
        condition ends them.

    Returns
    -------
    SpatialMotion
        The last run, with its deviation from the one before as its error estimate; of a sensitive
        motion it is at least a tenth of the deviation before. A run that met a time limit is
        returned as it is, with an estimate over what it reached if there is another run to
        compare with.

    Raises
    ------
    ToleranceError
        If no two runs agree.
    """
    coarse = run(max(first, 10.0 * TIGHTEST))
    if _cut_short(coarse):
        return coarse
    differences: list[float] = []
    for number in range(1, RUNS):
        local = max(first, 10.0 * TIGHTEST) * 0.1**number
        if local < 0.99 * TIGHTEST:
            break
        fine = run(local)
        before = differences[-1] if differences else inf
        differences.append(difference := _apart(fine, coarse))
        if _cut_short(fine):
            return replace(fine, error_estimate=difference)
        grown = difference / local
        # There is no run beyond the tightest to ask.
        sensitive = grown > SENSITIVE and local > 10.0 * TIGHTEST
        # The difference before leaves a tenth, as the tolerance of a step does.
        told = max(difference, 0.1 * before) if sensitive else difference
        if told <= tolerance:
            return replace(fine, error_estimate=told)
        coarse = fine
    listed = ", ".join(f"{difference:.1e}" for difference in differences)
    raise ToleranceError(
        f"tolerance {tolerance:g} cannot be reached: runs of which each allows a tenth of the "
        f"error in a step differ by {listed}, the last two by {grown:.0e} times what a step "
        "allows; inf stands for two that do not end alike"
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


def needed(tolerance: npt.ArrayLike, flat: npt.ArrayLike) -> Array:
    """Largest errors in rad of runs that are asked for to a tolerance.

    A disk that is said to lie flat has to be told from one that passes by.

    Parameters
    ----------
    tolerance : array_like, shape (...)
        In rad.
    flat : array_like of bool, shape (...)
        Whether a run ends where the disk lies flat.
    """
    return np.where(flat, np.minimum(tolerance, LEAST_TILT), tolerance)


def _apart(fine: SpatialMotion, coarse: SpatialMotion) -> float:
    """How far two runs are apart, in what `SpatialMotion.deviation` is told in."""
    difference = fine.deviation(coarse)
    reasons = {_told(motion) for motion in (fine, coarse)}
    if reasons == {None} or _cut_short(fine):
        return difference
    if len(reasons) > 1:
        return float("inf")
    later = float(fine.times[-1] - coarse.times[-1])
    verticals = [motion.rotations[-1, 2] for motion in (fine, coarse)]
    turning = fine.rotations[-1].T @ fine.angular_velocities[-1]
    ended = error_at_ending(
        [float(np.linalg.norm(verticals[0] - verticals[1]))],
        later,
        [float(np.linalg.norm(np.cross(verticals[0], turning)))],
    )
    left, other = (
        np.append(motion.energies[-1].sum(), motion.dissipated[-1]) for motion in (fine, coarse)
    )
    energy = float(np.max(np.abs(left - other))) / float(fine.energies[0].sum())
    return max(difference, float(ended), energy + LEAST_RATE * abs(later))


def _told(motion: SpatialMotion) -> str | None:
    """The condition that ended a motion, if one did."""
    reason = None if motion.ending is None else motion.ending.reason
    return None if reason in (AT_REST, TIME_LIMIT) else reason


def _cut_short(motion: SpatialMotion) -> bool:
    return motion.ending is not None and motion.ending.reason == TIME_LIMIT
