"""Closed forms of a centred disk that rolls without slip, and its final stage, fitted.

They hold on a horizontal table for a disk without eccentricity whose A and B are the same.

Notation: A, C moments of inertia across and along the axis about the centre, m mass, r radius,
beta inclination, Omega precession (rate of alpha), w3 = Omega cos(beta) + rate of gamma, the
spin along the axis. The contact carries the weight m g in every stationary motion.
"""

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from analysis.motion import frames
from analysis.motion.spatial_motion import SpatialMotion
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.scenario import Scenario
from analysis.problem.start import Start


def axial_spin(scenario: Scenario, beta: float, precession: float) -> float:
    """Spin w3 in rad/s along the axis of a stationary rolling motion.

    It solves A Omega² sin(beta) cos(beta) - (C + m r²) Omega w3 sin(beta) = m g r cos(beta),
    the balance of angular momentum about the line through the contact point across the disk.

    Parameters
    ----------
    scenario : Scenario
        That the disk rolls without slip is taken for granted.
    beta : float
        Inclination in rad, in the open interval (0, pi).
    precession : float
        Rate Omega of alpha in rad/s, not zero.
    """
    disk = scenario.disk
    rolling = (disk.inertia_z + disk.mass * disk.radius**2) * precession * sin(beta)
    turning = disk.inertia_x * precession**2 * sin(beta)
    return (turning - _tipping(scenario)) * cos(beta) / rolling


def rolling_start(disk: Body, beta: float, precession: float, spin: float) -> Start:
    """Start of a centred disk that rolls without slip on a circle about the origin.

    Parameters
    ----------
    disk : Body
    beta : float
        Inclination in rad.
    precession, spin : float
        Angular velocities in rad/s about the vertical and about the axis; see `axial_spin`.
    """
    return Start(
        beta=beta,
        gamma=0.0,
        spin=precession,
        beta_rate=0.0,
        gamma_rate=spin - precession * cos(beta),
        y=disk.radius * spin / precession,
        y_rate=0.0,
    )


def euler_disk_precession(scenario: Scenario, beta: float) -> float:
    """Precession in rad/s with w3 = 0: Omega² = m g r / (A sin(beta))."""
    return sqrt(_tipping(scenario) / (scenario.disk.inertia_x * sin(beta)))


def euler_disk_energy(scenario: Scenario, beta: float) -> float:
    """Energy in J with w3 = 0, from the table: E = 3/2 m g r sin(beta)."""
    return 1.5 * _tipping(scenario) * sin(beta)


def upright_rolling_spin(scenario: Scenario) -> float:
    """Smallest stable spin in rad/s of a disk that rolls upright along a line.

    w3² = A m g r / (C (C + m r²)), which is g / (3 r) for a thin disk.
    """
    disk = scenario.disk
    rolling = disk.inertia_z + disk.mass * disk.radius**2
    return sqrt(disk.inertia_x * _tipping(scenario) / (disk.inertia_z * rolling))


def time_to_flat(scenario: Scenario, beta: float) -> float:
    """Time in s that a slowly sinking Euler's disk has left at a small inclination.

    The energy 3/2 m g r beta falls by the power of one rolling resistance on the contour speed
    r Omega. Viscous: beta² = 4/3 c m g r² / A * time to go, so that beta goes with its power
    1/2 and Omega with -1/4. Dry: beta^(3/2) = c sqrt(m g r / A) * time to go, so that they go
    with 2/3 and -1/3.
    """
    disk, loss = scenario.disk, scenario.dissipation
    slowness = beta * disk.inertia_x / _tipping(scenario)
    if viscous := loss.rolling_viscous:
        return 0.75 * beta * slowness / (viscous * disk.radius)
    return beta * sqrt(slowness) / loss.rolling_dry


def _tipping(scenario: Scenario) -> float:
    """Moment m g r in N m of the weight about the rim of a flat disk."""
    return scenario.weight * scenario.disk.radius


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
    """
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
