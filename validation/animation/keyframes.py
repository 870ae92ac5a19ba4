"""A motion as an animation needs it: sampled so densely that lines may lie between samples."""

from dataclasses import asdict
from typing import Any

import numpy as np

from analysis import Scenario, SpatialMotion, StoredRun, Trajectory
from analysis.problem.checks import Array, ToleranceError, within
from analysis.problem.limits import MOST_KEYFRAMES
from analysis.problem.names import ArgumentError

SHORT = 5.0
"""Longest motion in s that is played slowly from begin to end."""

SLOW = 0.1
"""Speed at which the eye can follow a disk that turns six times a second."""

_TURN_BETWEEN = 0.2
"""Angle in rad the disk may turn between keyframes."""

_COARSEST = 0.5
"""Error in rad that interpolation between samples may have, by an estimate some ten times too
large."""


def keyframes(
    motion: StoredRun, begin: float | None = None, end: float | None = None
) -> StoredRun:
    """A motion, or a part of it, sampled densely enough for lines between the samples.

    Parameters
    ----------
    motion : Trajectory or SpatialMotion
        It may be sampled coarsely, as `resampled` interpolates it.
    begin, end : float, optional
        Part of it in s, by default all.

    Raises
    ------
    ValueError
        If the part is empty or reaches outside the motion, its samples are too far apart to tell
        the motion between them, or it needs more than `MOST_KEYFRAMES`.
    """
    first, last = motion.times[[0, -1]].tolist()
    begin = first if begin is None else within("begin", begin, first, last)
    end = last if end is None else within("end", end, first, last)
    if begin >= end:
        raise ArgumentError("begin", f"must lie before {end:g}, got {begin:g}")
    inside = motion.times[(motion.times > begin) & (motion.times < end)]
    return between(motion, _dense(motion, np.concatenate(([begin], inside, [end]))))


def between(motion: StoredRun, times: Array) -> StoredRun:
    """A motion at other times; `ValueError` if its samples do not tell what it is there."""
    try:
        return motion.resampled(times, tolerance=_COARSEST)
    except ToleranceError as error:
        raise ValueError(f"the motion cannot be animated: {error}") from None


def phases(motion: StoredRun) -> dict[str, float]:
    """Phases of a motion by their names, and the times in s at which they begin."""
    if isinstance(motion, SpatialMotion):
        starts = {name.replace("_", " "): time for name, time in asdict(motion.phases).items()}
    else:
        starts = {"inversion": motion.inversion_time}
    return {name: time for name, time in starts.items() if time is not None}


def source(motion: StoredRun) -> str:
    """Who simulated what, in a few words."""
    words: tuple[Any, ...] = (motion.source, "on a unilateral contact")
    if isinstance(motion, Trajectory):
        words = (motion.source, motion.scenario.name, motion.method.get("formulation"))
    return ", ".join(str(each) for each in (*words, seen_from(motion.scenario)) if each)


def seen_from(scenario: Scenario) -> str:
    """What is to be said beside a picture, which draws a table level; empty if it is."""
    lean = scenario.table.inclination
    return f"seen from a table leaning by {lean:.3g} rad" if lean else ""


def _dense(motion: StoredRun, times: Array) -> Array:
    """As many times as the fastest turning or rolling needs: others between them, or fewer."""
    angles = np.max(np.diff(times)) * np.abs(motion.poses.angular_velocities)
    ways = np.abs(np.diff(motion.contact_points, axis=0)) / motion.scenario.disk.radius
    turn = max(float(np.max(angles)), float(np.max(ways)))
    if not turn / _TURN_BETWEEN * times.size < MOST_KEYFRAMES:
        raise ValueError(
            f"the disk turns by {turn:.3g} rad between two samples, which would take more than "
            f"{MOST_KEYFRAMES} keyframes"
        )
    every = int(_TURN_BETWEEN / max(turn, 1.0 / times.size))
    if every > 1:
        return np.append(times[:-1:every], times[-1])
    parts = max(1, int(np.ceil(turn / _TURN_BETWEEN)))
    rows = np.arange(parts * (times.size - 1) + 1)
    return np.interp(rows / parts, np.arange(times.size), times)
