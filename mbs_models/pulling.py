"""Where an ideal contact would have to pull: found among samples, then located by short runs."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from analysis.data.checks import Array


class Dip(NamedTuple):
    """Where the normal force is negative, or may be between two samples.

    Parameters
    ----------
    row : int
        Sample before it, with a force that is not negative.
    width : float
        Sampling intervals after it that hold the dip.
    sure : bool
        Whether the force is negative at the end of them.
    """

    row: int
    width: float
    sure: bool


def dips(forces: Array) -> Iterator[Dip]:
    """Places to look at, in order, up to the first sample with a negative force.

    Parameters
    ----------
    forces : ndarray, shape (n,)
        Normal force at even spacing; the first one is not negative.
    """
    for row in range(1, forces.size):
        before, here = float(forces[row - 1]), float(forces[row])
        if here < 0.0:
            yield Dip(row - 1, 1.0, sure=True)
            return
        if row + 1 == forces.size:
            return
        after = float(forces[row + 1])
        curvature = before - 2.0 * here + after
        if min(before, after) < here or after < 0.0 or curvature <= 0.0:
            continue
        vertex = here - (after - before) ** 2 / (8.0 * curvature)
        if vertex < 0.1 * (max(before, after) - here):
            yield Dip(row - 1, 2.0, sure=False)


def zero(
    force: Callable[[float], float], begin: float, width: float, *, sure: bool
) -> float | None:
    """First time in [0, width] at which a force turns negative, if it does.

    Parameters
    ----------
    force : callable
        Normal force in N at a positive time in s.
    begin : float
        That at time 0, not negative.
    width : float
        In s.
    sure : bool
        Whether it is known to be negative at `width`, up to rounding.
    """
    last = width
    if not sure:
        least = minimize_scalar(
            force, bounds=(0.0, width), method="bounded", options={"xatol": 1e-3 * width}
        )
        last = float(least.x)
        if force(last) >= 0.0:
            return None
    elif force(last) >= 0.0:
        return last
    return float(
        brentq(lambda time: force(time) if time else begin, 0.0, last, xtol=1e-13, rtol=1e-13)
    )


def pulling_times(
    moments: Sequence[float], forces: Sequence[float]
) -> tuple[tuple[float, float], ...]:
    """Times in s between which a force is negative, by linear interpolation of samples.

    Parameters
    ----------
    moments : sequence of n floats
        Increasing times in s.
    forces : sequence of n floats
        In N.
    """
    times, values = np.asarray(moments), np.asarray(forces)
    negative = values < 0.0
    if not np.any(negative):
        return ()
    edges = np.flatnonzero(negative[1:] != negative[:-1])
    share = values[edges] / (values[edges] - values[edges + 1])
    crossings = (times[edges] + share * np.diff(times)[edges]).tolist()
    if negative[0]:
        crossings.insert(0, float(times[0]))
    if negative[-1]:
        crossings.append(float(times[-1]))
    return tuple(zip(crossings[::2], crossings[1::2], strict=True))
