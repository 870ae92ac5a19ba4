"""States of the disk in the paper's coordinates."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi

import numpy as np

from analysis.data.checks import Array, number
from analysis.data.names import ArgumentError

COORDINATES = ("x", "y", "z", "alpha", "beta", "gamma")
"""The paper's co-rotating coordinates, Eq. (8), in order."""


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
            given = getattr(self, field)
            values = tuple(given) if isinstance(given, Iterable) else ()
            if len(values) != 6:
                raise ArgumentError(field, f"must hold 6 numbers, got {given!r}")
            clean = tuple(
                number(f"{field}[{name}]", value)
                for name, value in zip(COORDINATES, values, strict=True)
            )
            object.__setattr__(self, field, clean)
        if not 0.0 < self.coordinates[4] < pi:
            raise ArgumentError(
                "beta",
                "must lie in the open interval (0, pi), where the Euler angles are regular, "
                f"got {self.coordinates[4]:g}",
            )

    @property
    def vector(self) -> Array:
        """Coordinates and rates in one array, shape (12,)."""
        return np.array(self.coordinates + self.rates)


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
        time = float(times[np.argmax(flat)])
        raise FlatError(
            f"beta leaves the open interval (0, pi) at t = {time:.6g} s: the disk lies flat, and "
            "the Euler angles of the motion end there",
            time,
        )


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
