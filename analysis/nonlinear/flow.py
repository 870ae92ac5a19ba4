"""The reduced system as a flow of many states at once, with exact derivatives.

States are deviations from inverted spinning, (beta - pi/2, gamma - pi/2, beta'): in them the flow
is odd. Derivatives come from a complex step, which has no rounding error to speak of. The friction
law may have a kink in its second derivative at zero slip: the force, its slope and so the Jacobian
are continuous there, so that variational equations need no jump conditions.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.mechanics.reduced import acceleration_from
from analysis.stability.scope import require_spinning

_STEP = 1e-100
"""Complex step; its square vanishes beside anything."""

Columns = npt.NDArray[Any]


def require_cycles(scenario: Scenario) -> None:
    """Raise `ValueError` unless the reduced system of a scenario can have periodic motions.

    They are born where inverted spinning loses its stability, which takes friction and an
    eccentricity.
    """
    require_spinning(scenario, "the reduced system", 4)
    if not scenario.friction.is_on:
        raise ValueError("friction must have a positive gradient for periodic motions, got 0")
    if scenario.friction.load != "weight":
        raise ValueError(
            "load must be 'weight' in the reduced system, which does not know the contact force, "
            f"got {scenario.friction.load!r}"
        )
    if scenario.disk.eccentricity == 0.0:
        raise ValueError("eccentricity must be positive for periodic motions, got 0")


def require_steepness(scenario: Scenario, steepest: float) -> None:
    """Raise `ValueError` if friction is steeper, in s/m, than what a method can follow."""
    if scenario.friction.gradient > steepest:
        raise ValueError(
            f"friction must have a gradient of at most {steepest:g} s/m to be followed here, got "
            f"{scenario.friction.gradient:g}; steeper, motions are those of the slow manifold"
        )


def right_hand_side(scenario: Scenario, spin: float, x: Array) -> Array:
    """Time derivative of deviations from inverted spinning.

    Parameters
    ----------
    scenario : Scenario
        See `reduced.acceleration`.
    spin : float
        In rad/s.
    x : ndarray, shape (3, n)
        Deviations of beta and gamma in rad, and the rate of beta in rad/s.

    Returns
    -------
    ndarray, shape (3, n)
    """
    friction = scenario.friction

    def force(slip: Array) -> Array:
        speeds = np.abs(slip)
        result: Array = slip * np.array([friction.per_speed(speed) for speed in speeds.tolist()])
        return result

    return np.array(_derivative(scenario, spin, x, force), dtype=float)


def analytic(
    scenario: Scenario, spin: float, x: Columns, force: Callable[[Columns], Columns]
) -> Columns:
    """Right-hand side at complex deviations, shape (3, n), with an analytic friction force.

    Parameters
    ----------
    scenario, spin, x
        See `right_hand_side`; the friction law of the scenario is not looked at.
    force : callable
        From the slip in m/s to the force against it for each newton of load.
    """
    return np.array(_derivative(scenario, spin, x, force))


def derivatives(scenario: Scenario, spin: float, x: Array) -> tuple[Array, Array, Array]:
    """Right-hand side, shape (3, n), Jacobian, (n, 3, 3), and derivative by the spin, (3, n).

    The parameters are those of `right_hand_side`.
    """
    friction = scenario.friction

    def force(slip: Columns) -> Columns:
        # All rows are one state, stepped in different directions.
        real = slip[0].real
        speeds = np.abs(real).tolist()
        per_speed = np.array([friction.per_speed(speed) for speed in speeds])
        slopes = np.array([friction.per_speed_slope(speed) for speed in speeds])
        result: Columns = real * per_speed + 1j * slip.imag * (per_speed + slopes * speeds)
        return result

    steps = 1j * _STEP * np.eye(4)[:, :, None]
    stepped = x[None, :, :] + steps[:, :3]
    values = _derivative(scenario, spin + steps[:, 3], stepped.transpose(1, 0, 2), force)
    changes = np.array(values).imag / _STEP
    right: Array = np.array([value[0].real for value in values])
    return right, changes[:, :3].transpose(2, 0, 1), changes[:, 3]


def _derivative(
    scenario: Scenario, spin: Any, x: Columns, force: Callable[[Columns], Columns]
) -> list[Columns]:
    tilt, turn, rate = x
    sin_tilt = np.sin(tilt)
    directions = np.cos(tilt), -sin_tilt, np.cos(turn), -np.sin(turn)
    acceleration = acceleration_from(scenario, spin, directions, rate, force)
    zero = 0.0 * sin_tilt
    return [rate + zero, spin * sin_tilt, acceleration]
