"""States of the disk in the paper's coordinates, and the starts used in the study."""

from dataclasses import dataclass
from math import cos, isclose, pi, sin
from typing import Literal, NoReturn, get_args

import numpy as np

from analysis.data.checks import Array, choice, number, within
from analysis.data.disk import Disk
from analysis.data.limits import FASTEST_TURN, LARGEST_ANGLE, LEAST_TILT

COORDINATES = ("x", "y", "z", "alpha", "beta", "gamma")
"""The paper's co-rotating coordinates, Eq. (8), in order."""

Level = Literal[1, 2, 3, 4]
LEVELS: tuple[Level, ...] = get_args(Level)

MULTIPLIERS = ("normal_force", "cog_force_x", "cog_force_y", "tangential_force", "spin_torque")
"""Constraint forces in the order in which the levels add them (Table 2), all in R-frame axes."""

_MULTIPLIER_COUNT = {1: 1, 2: 3, 3: 4, 4: 5}


def multiplier_names(level: Level) -> tuple[str, ...]:
    """Names of the constraint forces of Model `level`, in order."""
    return MULTIPLIERS[: _MULTIPLIER_COUNT[choice("level", level, LEVELS)]]


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """Position and velocity of the disk in the co-rotating coordinates, Eq. (8).

    The geometric centre G is given in the frame R, which is the inertial frame turned by alpha
    about the vertical; alpha, beta, gamma are Euler angles in z-x-z order.

    Parameters
    ----------
    coordinates : tuple of 6 floats
        x, y, z in m and alpha, beta, gamma in rad, beta in the open interval (0, pi).
    rates : tuple of 6 floats
        Their time derivatives.

    Raises
    ------
    ValueError
        If there are not six finite numbers, or beta lies where the Euler angles are singular.
    """

    coordinates: tuple[float, ...]
    rates: tuple[float, ...]

    def __post_init__(self) -> None:
        for field in ("coordinates", "rates"):
            values = tuple(getattr(self, field))
            if len(values) != 6:
                raise ValueError(f"{field} must hold 6 numbers, got {len(values)}")
            clean = tuple(
                number(f"{field}[{name}]", value)
                for name, value in zip(COORDINATES, values, strict=True)
            )
            object.__setattr__(self, field, clean)
        check_tilt("beta", self.coordinates[4])

    @property
    def vector(self) -> Array:
        """Coordinates and rates in one array, shape (12,)."""
        return np.array(self.coordinates + self.rates)


def check_tilt(name: str, beta: float) -> float:
    """Return `beta` if the Euler angles are regular there; `ValueError` otherwise."""
    if not 0.0 < beta < pi:
        raise ValueError(
            f"{name} must lie in the open interval (0, pi), where the Euler angles are regular, "
            f"got {beta:g}"
        )
    return beta


def check_upright(times: Array, coordinates: Array) -> None:
    """Raise if the disk of a motion comes to lie flat, where the Euler angles end.

    Parameters
    ----------
    times : ndarray, shape (n,)
    coordinates : ndarray, shape (n, 6)

    Raises
    ------
    FlatError
        If beta leaves the open interval (0, pi).
    """
    beta = coordinates[:, 4]
    flat = (beta <= 0.0) | (beta >= pi)
    if np.any(flat):
        raise_flat(float(times[np.argmax(flat)]))


class FlatError(ArithmeticError):
    """The disk comes to lie flat, where the Euler angles of a motion end.

    Attributes
    ----------
    time : float
        In s, or shortly after.
    """

    def __init__(self, message: str, time: float) -> None:
        super().__init__(message)
        self.time = time


def raise_flat(time: float) -> NoReturn:
    """Raise that the disk lies flat from `time` in s, or from shortly before."""
    raise FlatError(
        f"beta leaves the open interval (0, pi) at t = {time:.6g} s: the disk lies flat, and the "
        "Euler angles of the motion end there",
        time,
    )


def consistent_start(
    level: Level,
    disk: Disk,
    *,
    beta: float = pi / 2,
    gamma: float = -pi / 2 + 0.1,
    spin: float = 40.0,
    beta_rate: float = 0.0,
    gamma_rate: float | None = None,
) -> State:
    """Start that meets every constraint of Model `level` on position and velocity level.

    The defaults are those of Table 3. The disk touches the table; Models 2 to 4 carry the centre
    of gravity above the origin (Table 3 itself has x = 0, which breaks that constraint by
    e cos(gamma)); Model 1 has no such constraint and starts with G above the origin of R.

    Parameters
    ----------
    level : {1, 2, 3, 4}
        Model of Table 2.
    disk : Disk
    beta, gamma : float
        Inclination and rotation angle in rad.
    spin : float
        Rate of alpha in rad/s.
    beta_rate : float
        Rate of beta in rad/s.
    gamma_rate : float, optional
        Rate of gamma in rad/s; by default -spin cos(beta), as in Table 3. Models 3 and 4 admit
        no other value.

    Raises
    ------
    ValueError
        If an argument is out of range, or `gamma_rate` breaks the rolling constraint.
    """
    choice("level", level, LEVELS)
    beta = check_tilt("beta", number("beta", beta))
    if not LEAST_TILT <= beta <= pi - LEAST_TILT:
        raise ValueError(
            f"beta must keep {LEAST_TILT:g} rad from 0 and pi, where the disk lies flat and the "
            f"Euler angles are singular, got {min(beta, pi - beta):g} rad of it"
        )
    gamma = within("gamma", gamma, -LARGEST_ANGLE, LARGEST_ANGLE)
    spin = within("spin", spin, -FASTEST_TURN, FASTEST_TURN)
    beta_rate = within("beta_rate", beta_rate, -FASTEST_TURN, FASTEST_TURN)
    rolling_rate = -spin * cos(beta)
    if gamma_rate is None:
        gamma_rate = rolling_rate
    gamma_rate = within("gamma_rate", gamma_rate, -FASTEST_TURN, FASTEST_TURN)
    if level >= 3 and not isclose(gamma_rate, rolling_rate, rel_tol=1e-12, abs_tol=1e-12):
        raise ValueError(
            f"gamma_rate must be -spin * cos(beta) = {rolling_rate:g} rad/s in Model {level} "
            f"(no tangential slip), got {gamma_rate:g}"
        )
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    x = y = x_rate = y_rate = 0.0
    if level >= 2:
        e = disk.eccentricity
        x, y = -e * cg, -e * cb * sg
        x_rate = e * sg * gamma_rate
        y_rate = e * (sb * sg * beta_rate - cb * cg * gamma_rate)
    return State(
        coordinates=(x, y, disk.radius * sb, 0.0, beta, gamma),
        rates=(x_rate, y_rate, disk.radius * cb * beta_rate, spin, beta_rate, gamma_rate),
    )
