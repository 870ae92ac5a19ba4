"""Closed forms of a centred disk that rolls without slip, and its final stage, fitted.

Notation: A, C moments of inertia across and along the axis about the centre, m mass, r radius,
beta inclination, Omega precession (rate of alpha), w3 = Omega cos(beta) + rate of gamma, the
spin along the axis. The contact carries the weight m g in every stationary motion.
"""

from math import cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from analysis.motion import frames
from analysis.motion.spatial_motion import SpatialMotion
from analysis.problem.body import Body
from analysis.problem.checks import (
    Array,
    increasing_times,
    instance,
    number,
    positive,
    real_array,
    turn_rate,
    within,
)
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario, require_plain
from analysis.problem.start import Start


def axial_spin(scenario: Scenario, beta: float, precession: float) -> float:
    """Spin w3 in rad/s along the axis of a stationary rolling motion.

    It solves A Omega² sin(beta) cos(beta) - (C + m r²) Omega w3 sin(beta) = m g r cos(beta),
    the balance of angular momentum about the line through the contact point across the disk.

    Parameters
    ----------
    scenario : Scenario
        With a centred disk on a horizontal table; that it rolls without slip is taken for granted.
    beta : float
        Inclination in rad, in the open interval (0, pi).
    precession : float
        Rate Omega of alpha in rad/s, not zero.

    Raises
    ------
    ValueError
        If an argument is out of range or the disk is eccentric.
    """
    (tipping, A), disk = _moments(scenario), scenario.disk
    rolling = disk.inertia_z + disk.mass * disk.radius**2
    sb, cb = sin(_inclination(beta)), cos(beta)
    Omega = _precession(precession)
    return (A * Omega**2 * sb * cb - tipping * cb) / (rolling * Omega * sb)


def rolling_start(disk: Body, beta: float, precession: float, spin: float) -> Start:
    """Start of a centred disk that rolls without slip on a circle about the origin.

    Parameters
    ----------
    disk : Body
    beta : float
        Inclination in rad.
    precession, spin : float
        Angular velocities in rad/s about the vertical and about the axis; see `axial_spin`.

    Raises
    ------
    ValueError
        If the disk is not centred, the precession is zero, or a number is out of range.
    """
    _across(instance("disk", disk, Body))
    rate, spin = _precession(precession), turn_rate("spin", spin)
    return Start(
        beta=_inclination(beta),
        gamma=0.0,
        spin=rate,
        beta_rate=0.0,
        gamma_rate=spin - rate * cos(beta),
        y=disk.radius * spin / rate,
        y_rate=0.0,
    )


def euler_disk_precession(scenario: Scenario, beta: float) -> float:
    """Precession in rad/s with w3 = 0: Omega² = m g r / (A sin(beta)); `ValueError` as above."""
    tipping, A = _moments(scenario)
    return sqrt(tipping / (A * sin(_inclination(beta))))


def euler_disk_energy(scenario: Scenario, beta: float) -> float:
    """Energy in J with w3 = 0, from the table: E = 3/2 m g r sin(beta)."""
    tipping, _ = _moments(scenario)
    return 1.5 * tipping * sin(_inclination(beta))


def upright_rolling_spin(scenario: Scenario) -> float:
    """Smallest stable spin in rad/s of a disk that rolls upright along a line.

    w3² = A m g r / (C (C + m r²)), which is g / (3 r) for a thin disk.
    """
    (tipping, A), disk = _moments(scenario), scenario.disk
    C = disk.inertia_z
    return sqrt(A * tipping / (C * (C + disk.mass * disk.radius**2)))


def time_to_flat(scenario: Scenario, beta: float) -> float:
    """Time in s that a slowly sinking Euler's disk has left at a small inclination.

    The energy 3/2 m g r beta falls by the power of one rolling resistance on the contour speed
    r Omega. Viscous: beta² = 4/3 c m g r² / A * time to go, so that beta goes with its power
    1/2 and Omega with -1/4. Dry: beta^(3/2) = c sqrt(m g r / A) * time to go, so that they go
    with 2/3 and -1/3, and as long again as viscous resistance of c over the smoothing takes.

    Raises
    ------
    ValueError
        If not exactly one of the rolling resistances is on, or anything else takes energy.
    """
    (tipping, A), dissipation = _moments(scenario), scenario.dissipation
    dry, viscous = dissipation.rolling_dry, dissipation.rolling_viscous
    if (dry > 0.0) == (viscous > 0.0):
        raise ValueError(
            "dissipation must have either rolling_dry or rolling_viscous, "
            f"got {dry:g} and {viscous:g}"
        )
    for name in ("pivoting", "air_drag"):
        if (taken := getattr(dissipation, name)) > 0.0:
            why = f"must be 0, as one rolling resistance alone has a closed form, got {taken:g}"
            raise ArgumentError(name, why)
    beta = positive("beta", beta)
    slow = 0.75 * beta * beta * A / (tipping * scenario.disk.radius)
    if viscous:
        return slow / viscous
    return (beta * sqrt(beta * A / tipping) + dissipation.rolling_smoothing * slow) / dry


def _moments(scenario: Scenario) -> tuple[float, float]:
    """Moment m g r in N m of the weight about the rim of a flat disk, and A of a centred one."""
    instance("scenario", scenario, Scenario)
    require_plain(scenario, "a closed form of rolling")
    return scenario.weight * scenario.disk.radius, _across(scenario.disk)


def _across(disk: Body) -> float:
    """Moment of inertia A across the axis of a centred disk."""
    uneven = abs(disk.inertia_x - disk.inertia_y) > 1e-9 * disk.inertia_x
    if disk.eccentricity or uneven or not disk.is_plain:
        raise ValueError(
            "disk must be a round one, centred with inertia_x = inertia_y, got eccentricity "
            f"{disk.eccentricity:g}, inertia_x {disk.inertia_x:g}, inertia_y {disk.inertia_y:g}"
        )
    return disk.inertia_x


def _precession(precession: float) -> float:
    if (rate := turn_rate("precession", precession)) == 0.0:
        raise ArgumentError("precession", f"must not be 0, got {precession!r}")
    return rate


def _inclination(beta: float) -> float:
    why = "where a disk leans"
    return within("beta", beta, 0.0, pi, is_above=True, is_below=True, why=why)


NEAREST, FARTHEST = 1e-4, 100.0
"""Where the end of a power law is looked for, in durations of the samples behind the last one."""


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
        Increasing, in s; more than what is fitted.
    values : ndarray, shape (n,)
        Positive.
    end : float, optional
        Time at which the law ends; by default fitted too, from 1e-4 to 100 times the whole time
        behind the last.

    Raises
    ------
    ValueError
        If there are too few samples, a value is not positive, or `end` does not lie behind all
        times.
    ArithmeticError
        If the fit ends at the nearest or the farthest end.
    """
    times, values = increasing_times(times), real_array("values", values)
    if values.shape != times.shape:
        raise ArgumentError("values", f"must have shape {times.shape}, got {values.shape}")
    if np.any(values <= 0.0):
        raise ArgumentError("values", f"must be positive, got {np.min(values):g}")
    if end is not None and number("end", end) <= times[-1]:
        raise ValueError(f"end must lie behind the last time {times[-1]:g}, got {end:g}")
    if times.size < (least := 3 + (end is None)):
        raise ArgumentError("times", f"must be {least} or more, got {times.size}")
    logs, duration = np.log(values), times[-1] - times[0]

    def line(candidate: float) -> tuple[Array, Array]:
        matrix = np.column_stack((np.log(candidate - times), np.ones(times.size)))
        solution: Array = np.linalg.lstsq(matrix, logs, rcond=None)[0]
        return solution, matrix @ solution - logs

    if end is None:
        found = minimize_scalar(
            lambda beyond: float(np.sum(line(times[-1] + duration * np.exp(beyond))[1] ** 2)),
            bounds=np.log((NEAREST, FARTHEST)),
            method="bounded",
            options={"xatol": 1e-8},
        )
        part = float(np.exp(found.x))
        if not 1.001 * NEAREST < part < 0.999 * FARTHEST:
            raise ArithmeticError(
                f"the samples follow no power of a time to go that ends between {NEAREST:g} and "
                f"{FARTHEST:g} of their {duration:.6g} s behind the last"
            )
        end = float(times[-1] + duration * part)
    (exponent, _), residual = line(end)
    worst, left = np.expm1(np.max(np.abs(residual))), end - times[[0, -1]]
    return PowerLaw(float(exponent), end, float(worst), float(np.log10(left[0] / left[1])))


def precession(motion: SpatialMotion) -> Array:
    """Rate in rad/s at which the disk's axis goes round the vertical, shape (n,).

    Not defined for a disk that lies exactly flat.
    """
    _, rates = frames.from_poses(*motion.poses)
    return rates[:, 3]
