"""When each phase of the motion until rest began."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array

Flags = npt.NDArray[np.bool_]

ROLLING = 0.1
"""Rolling: the slip speed stays below this part of the contour speed."""

MEAN_TIME = 0.5
"""Time in s over which both speeds are averaged; nutation takes either to zero at instants."""

FLAT = 2.0
"""Flat: the tangent of the leaning is below so often half_thickness / radius, where the
spheroid's shape rules."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Phases:
    """Times in s at which the phases begin; None if one never does.

    The first two lie between samples, see `Inversion`; the others are those of samples.

    Parameters
    ----------
    inversion : float, optional
        The disk is inverted; see `analysis.data.inversion.DEFINITION`.
    inversion_lost : float, optional
        Its centre of gravity comes below the geometric centre again.
    rolling : float, optional
        From here until flat, the mean slip speed over half a second is below a tenth of the mean
        contour speed.
    flat : float, optional
        From here on the tangent of the disk's leaning is below 2 half_thickness / radius. One
        too thick to lie on a face, such as a sphere, is never flat.
    rest : float, optional
        From here on it is at rest.
    """

    inversion: float | None
    inversion_lost: float | None
    rolling: float | None
    flat: float | None
    rest: float | None


def phases_of(motion: Any) -> Phases:
    """When the phases of a `SpatialMotion` begin."""
    scenario, times, leaning = motion.scenario, motion.times, motion.leaning
    contact, disk = scenario.penalty_contact, scenario.disk
    limit = np.arctan(FLAT * contact.half_thickness / disk.radius) if contact.lies(disk) else 0.0
    flat = _from_here_on(times, leaning < limit)
    upto = times <= (np.inf if flat is None else flat)
    slip, contour = (_running_mean(times, s) for s in (motion.slip_speeds, motion.contour_speeds))
    inversion = motion.inversion
    return Phases(
        inversion=inversion.time,
        inversion_lost=inversion.lost,
        rolling=_from_here_on(times[upto], (slip < ROLLING * contour)[upto]),
        flat=flat,
        rest=motion.rest_time,
    )


def _from_here_on(times: Array, condition: Flags) -> float | None:
    """First time from which on the condition holds to the end."""
    if not condition[-1]:
        return None
    broken = np.flatnonzero(~condition)
    return float(times[broken[-1] + 1 if broken.size else 0])


def _running_mean(times: Array, values: Array) -> Array:
    """Mean over `MEAN_TIME` around each sample; over what there is of it at the ends."""
    integral = np.concatenate(
        ([0.0], np.cumsum(0.5 * np.diff(times) * (values[1:] + values[:-1])))
    )
    low = np.maximum(times - 0.5 * MEAN_TIME, times[0])
    high = np.minimum(times + 0.5 * MEAN_TIME, times[-1])
    difference = np.interp(high, times, integral) - np.interp(low, times, integral)
    result: Array = difference / (high - low)
    return result
