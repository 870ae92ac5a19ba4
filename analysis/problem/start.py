"""States in the paper's coordinates, and starts: what a user chooses, the rest by constraints."""

from dataclasses import dataclass
from math import pi
from typing import Any, Literal, get_args

import numpy as np

from analysis.problem.body import Body
from analysis.problem.checks import Array, Described, checked, choice, numbers
from analysis.problem.constraints import FOLLOWING, ConstraintSet, demanded, set_name
from analysis.problem.elementary import cos, sin
from analysis.problem.limits import LEAST_TILT
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import QUANTITIES, default

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
            clean = numbers(field, getattr(self, field), COORDINATES)
            object.__setattr__(self, field, clean)
        checked(QUANTITIES["start.beta"], self.coordinates[4])

    @property
    def vector(self) -> Array:
        """Coordinates and rates in one array, shape (12,)."""
        return np.array(self.coordinates + self.rates)


def check_leaning(beta: Any) -> None:
    """Raise `ValueError` if a disk that starts with this beta in rad lies flat."""
    # By the sine, of which solvers look for the end of a motion.
    if not sin(beta) > LEAST_TILT:
        raise ArgumentError(
            "beta",
            f"must keep more than {LEAST_TILT:g} rad from 0 and pi, where the disk lies flat and "
            f"the Euler angles are singular, got {min(beta, pi - beta):g} rad of it",
        )


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


Motion = Literal["inverted", "noninverted"]
MOTIONS: tuple[Motion, ...] = get_args(Motion)
"""The stationary motions, Eq. (5): the centre of gravity above or below the geometric centre."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Start(Described):
    """A start that meets every constraint; the defaults are those of Table 3.

    What is None follows from the others and from the constraints. A held centre of gravity lies
    above the origin (Table 3 itself has x = 0, which breaks that constraint by e cos(gamma));
    without that constraint the geometric centre does.

    Parameters
    ----------
    beta, gamma : float
        Inclination and rotation angle in rad.
    spin : float
        Rate of alpha in rad/s.
    alpha : float
        In rad.
    beta_rate : float, optional
        In rad/s; by default 0, or what the constraints leave.
    gamma_rate : float, optional
        In rad/s; by default -spin cos(beta), as in Table 3.
    x, y : float, optional
        Position of the geometric centre in the R-frame in m.
    x_rate, y_rate : float, optional
        Their rates in m/s; by default 0, or what the constraints leave.
    height : float, optional
        Of the disk's lowest point over the table in m, on a penalty contact. By default it
        presses into such a contact until that carries the weight; on an ideal one it is 0.

    Raises
    ------
    ValueError
        If a value is out of range.

    Examples
    --------
    >>> from analysis import Scenario, Start
    >>> Scenario(start=Start(spin=20.0)).initial_state.rates[3]
    20.0
    """

    TABLE = "start"

    beta: float = default("start.beta")
    gamma: float = default("start.gamma")
    spin: float = default("start.spin")
    alpha: float = default("start.alpha")
    beta_rate: float | None = None
    gamma_rate: float | None = None
    x: float | None = None
    y: float | None = None
    x_rate: float | None = None
    y_rate: float | None = None
    height: float | None = None

    def __post_init__(self) -> None:
        check_leaning(self.beta)

    @classmethod
    def stationary(cls, spin: float, motion: Motion = "inverted") -> "Start":
        """Start on inverted or noninverted spinning, Eq. (5).

        Parameters
        ----------
        spin : float
            In rad/s.
        motion : {"inverted", "noninverted"}
        """
        choice("motion", motion, MOTIONS)
        return cls(beta=pi / 2, gamma=pi / 2 if motion == "inverted" else -pi / 2, spin=spin)

    def state(
        self,
        constraints: ConstraintSet,
        disk: Body,
        half_thickness: float = 0.0,
        height: float = 0.0,
    ) -> State:
        """State of the disk at this start.

        Parameters
        ----------
        constraints : tuple of str
        disk : Body
        half_thickness : float
            Of a rounded rim in m.
        height : float
            Of the disk's lowest point over the table in m, unless the start tells its own.

        Raises
        ------
        ValueError
            If the start breaks a constraint.
        """
        beta, gamma = self.beta, self.gamma
        given = [getattr(self, field) for field in FOLLOWING]
        # As in Table 3.
        usual = (0.0, 0.0, 0.0, 0.0, 0.0, -self.spin * cos(beta))
        free = tuple(
            other if each is None else each for each, other in zip(given, usual, strict=True)
        )
        found = demanded(constraints, disk, (beta, gamma, self.spin), free)
        for field, wanted, value in zip(FOLLOWING, given, found, strict=True):
            if wanted is not None and not abs(wanted - value) <= 1e-12 * max(1.0, abs(value)):
                told = round(value, 12) + 0.0  # less than what is told apart is 0, and not -0
                fault = f"must be {told:g} in {set_name(constraints)}, or left out"
                raise ArgumentError(field, f"{fault}, got {wanted:g}")
        x, y, x_rate, y_rate, beta_rate, gamma_rate = found
        lift = height if self.height is None else self.height
        clearance, per_tilt, per_turn = disk.clearance(beta, gamma, half_thickness)
        rise = per_tilt * beta_rate + per_turn * gamma_rate
        return State(
            coordinates=(x, y, clearance + lift, self.alpha, self.beta, self.gamma),
            rates=(x_rate, y_rate, rise, self.spin, beta_rate, gamma_rate),
        )
