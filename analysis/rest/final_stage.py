"""Power laws fitted to the final stage, when the disk shudders to rest."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from analysis.data import frames
from analysis.data.checks import Array, increasing_times
from analysis.data.spatial_motion import SpatialMotion


class PowerLaw(NamedTuple):
    """value = scale * (end - time) ** exponent, fitted to samples.

    Parameters
    ----------
    exponent : float
    end : float
        Time in s at which the law ends.
    error : float
        Largest relative deviation of a sample.
    decades : float
        Decades of time to go that the fit spans.
    """

    exponent: float
    end: float
    error: float
    decades: float


def fit_power_law(times: Array, values: Array, end: float | None = None) -> PowerLaw:
    """Fit a power of the time to go by least squares in the logarithm of the values.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Increasing, in s.
    values : ndarray, shape (n,)
        Positive.
    end : float, optional
        Time at which the law ends; fitted too if it is not given.

    Raises
    ------
    ValueError
        If a value is not positive, or `end` does not lie behind all times.
    """
    times = increasing_times(times)
    if np.any(values <= 0.0):
        raise ValueError(f"values must be positive, got {np.min(values):g}")
    if end is not None and end <= times[-1]:
        raise ValueError(f"end must lie behind the last time {times[-1]:g}, got {end:g}")
    logs, duration = np.log(values), times[-1] - times[0]

    def line(candidate: float) -> tuple[Array, Array]:
        matrix = np.column_stack((np.log(candidate - times), np.ones(times.size)))
        solution: Array = np.linalg.lstsq(matrix, logs, rcond=None)[0]
        return solution, matrix @ solution - logs

    if end is None:
        # The end may lie from close behind the last sample to a hundred durations away.
        found = minimize_scalar(
            lambda beyond: float(np.sum(line(times[-1] + duration * np.exp(beyond))[1] ** 2)),
            bounds=(-9.0, 4.6),
            method="bounded",
            options={"xatol": 1e-8},
        )
        end = float(times[-1] + duration * np.exp(found.x))
    (exponent, _), residual = line(end)
    worst, left = np.expm1(np.max(np.abs(residual))), end - times[[0, -1]]
    return PowerLaw(float(exponent), end, float(worst), float(np.log10(left[0] / left[1])))


def precession(motion: SpatialMotion) -> Array:
    """Rate in rad/s at which the disk's axis goes round the vertical, shape (n,).

    Not defined for a disk that lies exactly flat.
    """
    _, rates = frames.from_poses(*motion.poses)
    return rates[:, 3]
