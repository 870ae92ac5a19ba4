"""Model 4 in minimal coordinates, Eqs. (93)-(110)."""

from collections.abc import Callable, Sequence
from math import cos, sin
from typing import Any

import numpy as np

from analysis.data import elementary
from analysis.data.checks import Array
from analysis.data.disk import Disk
from analysis.data.scenario import Scenario


def acceleration(scenario: Scenario, spin: float, x: Sequence[float]) -> float:
    """Second derivative of beta from Eqs. (102)-(108) in rad/s².

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table; the reduced system knows the weight as load only, and neither the
        constraints nor `friction.load` is looked at.
    spin : float
        Constant spinning speed in rad/s (paper: Omega).
    x : sequence of 3 floats
        Minimal coordinates beta and gamma in rad and the minimal velocity, the rate of beta, in
        rad/s.
    """
    beta, gamma, beta_rate = x
    directions = sin(beta), cos(beta), sin(gamma), cos(gamma)
    per_speed = scenario.friction.per_speed
    return float(
        acceleration_from(
            scenario, spin, directions, beta_rate, lambda slip: per_speed(abs(slip)) * slip
        )
    )


def acceleration_from(
    scenario: Scenario, spin: Any, directions: Sequence[Any], bd: Any, friction: Callable[..., Any]
) -> Any:
    """The same for numbers of any kind: arrays for many states, complex ones for derivatives.

    Parameters
    ----------
    scenario : Scenario
        See `acceleration`; its friction law is not looked at.
    spin : number or array
        In rad/s.
    directions : sequence of 4 numbers or arrays
        Sine and cosine of beta, sine and cosine of gamma.
    bd : number or array
        Rate of beta in rad/s.
    friction : callable
        From the lateral slip in m/s to the force against it for each newton of load.
    """
    disk, weight = scenario.disk, scenario.weight
    m, r, e = disk.mass, disk.radius, disk.eccentricity
    A, B_bar, _ = disk.inertia_about_cog
    Omega = spin
    sb, cb, sg, cg = directions
    height = r + e * sg
    M = A * cg * cg + B_bar * sg * sg + m * height**2 * cb * cb
    h = (
        (A * cg * cg + B_bar * sg * sg) * Omega**2 * sb * cb
        - 2 * (A - B_bar) * Omega * bd * cb * sg * cg
        + m * height**2 * bd * bd * sb * cb
        + m * e * height * Omega**2 * sb * cb**3 * sg
        - m * e * height * (3 * sb * sb - 2) * Omega * bd * cb * cg
    )
    f = -weight * height * cb
    slip = height * bd * sb - e * Omega * sb * sb * cg
    return (h + f - height * sb * weight * friction(slip)) / M


def normal_force(scenario: Scenario, spin: float, x: Sequence[float]) -> float:
    """Normal contact force in N; parameters are those of `acceleration`."""
    beta, gamma, beta_rate = x
    directions = sin(beta), cos(beta), sin(gamma), cos(gamma)
    second = acceleration(scenario, spin, x)
    return float(normal_force_from(scenario, spin, directions, beta_rate, second))


def normal_force_from(
    scenario: Scenario, spin: Any, directions: Sequence[Any], bd: Any, bdd: Any
) -> Any:
    """The mass times gravity and the centre of gravity's rise, for numbers of any kind.

    The centre of gravity is (r + e sin(gamma)) sin(beta) above the table, and
    gamma' = -Omega cos(beta). Parameters are those of `acceleration_from`, and the second
    derivative of beta.
    """
    disk = scenario.disk
    e, Omega = disk.eccentricity, spin
    sb, cb, sg, cg = directions
    gd, gdd = -Omega * cb, Omega * sb * bd
    rise = e * (cg * gdd - sg * gd * gd) * sb + 2 * e * cg * gd * cb * bd
    rise += (disk.radius + e * sg) * (cb * bdd - sb * bd * bd)
    return scenario.weight + disk.mass * rise


def right_hand_side(
    scenario: Scenario, spin: float, x: Sequence[float]
) -> tuple[float, float, float]:
    """Time derivative of the reduced state x = (beta, gamma, beta_rate), Eqs. (102), (109)."""
    return x[2], -spin * cos(x[0]), acceleration(scenario, spin, x)


def expand(disk: Disk, spin: float, alpha: Array, x: Array) -> tuple[Array, Array]:
    """Co-rotating coordinates and rates from reduced states, Eqs. (94), (96), (97).

    Parameters
    ----------
    disk : Disk
    spin : float
        Constant spinning speed in rad/s.
    alpha : ndarray, shape (n,)
        Angle of the R-frame in rad.
    x : ndarray, shape (n, 3)
        beta, gamma and the rate of beta.

    Returns
    -------
    coordinates, rates : ndarray, shape (n, 6)
    """
    result = np.empty((2, len(x), 6))
    for level, values in enumerate(expanded(disk, spin, alpha, x.T)):
        for column, value in enumerate(values):
            result[level, :, column] = value
    return result[0], result[1]


def expanded(
    disk: Disk, spin: Any, alpha: Any, x: Sequence[Any] | Array
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The six coordinates and the six rates of `expand`, for numbers of any kind."""
    r, e = disk.radius, disk.eccentricity
    beta, gamma, beta_rate = x
    sb, cb = elementary.sin(beta), elementary.cos(beta)
    sg, cg = elementary.sin(gamma), elementary.cos(gamma)
    coordinates = (-e * cg, -e * cb * sg, r * sb, alpha, beta, gamma)
    rates = (
        -e * spin * cb * sg,
        # Eq. (97) prints sin(gamma) in the second term; the constraint (83) gives cos(gamma).
        e * sb * sg * beta_rate + e * spin * cb * cb * cg,
        r * cb * beta_rate,
        spin,
        beta_rate,
        -spin * cb,
    )
    return coordinates, rates
