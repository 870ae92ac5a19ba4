"""The reduced system as a flow of many states at once, with exact derivatives.

States are deviations from inverted spinning, (beta - pi/2, gamma - pi/2, beta'): in them the flow
is odd. Derivatives come from dual numbers. The friction law may have a kink in its second
derivative at zero slip: the force, its slope and so the Jacobian are continuous there, so that
variational equations need no jump conditions.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from analysis.mechanics.dual import Dual, dual, per_speed_and_slope
from analysis.mechanics.linear_algebra import Numbers
from analysis.mechanics.reduced import acceleration_from
from analysis.problem.checks import Array, within
from analysis.problem.elementary import cos, sin
from analysis.problem.scenario import Scenario
from analysis.stability.linearisation import require_spinning

_NO_SLIP = 1e-12
"""Slip over the finest speed of a law at least: where there is none, 0 / 0 is no force."""


def require_cycles(scenario: Scenario, steepest: float = np.inf) -> None:
    """Raise `ValueError` unless the reduced system of a scenario can have periodic motions.

    They are born where inverted spinning loses its stability, which takes friction and an
    eccentricity; friction must not be steeper, in s/m, than what a method can follow.
    """
    require_spinning(scenario, "the reduced system", 4)
    if not scenario.friction.is_simple:
        raise ValueError(
            "friction must be isotropic and in proportion to the load for periodic motions, got "
            f"{scenario.friction!r}"
        )
    if not scenario.friction.is_on:
        raise ValueError("friction must have a positive gradient for periodic motions, got 0")
    if scenario.friction.load != "weight":
        raise ValueError(
            "load must be 'weight' in the reduced system, which does not know the contact force, "
            f"got {scenario.friction.load!r}"
        )
    if scenario.disk.eccentricity == 0.0:
        raise ValueError("eccentricity must be positive for periodic motions, got 0")
    if scenario.friction.gradient > steepest:
        raise ValueError(
            f"friction must have a gradient of at most {steepest:g} s/m to be followed here, got "
            f"{scenario.friction.gradient:g}; steeper, motions are those of the slow manifold"
        )


def open_amplitude(value: float) -> float:
    """Return an amplitude in rad; `ValueError` unless it lies between 0 and pi, both excluded."""
    why = "between the Hopf point and the connection"
    return within("amplitude", value, 0.0, np.pi, is_above=True, is_below=True, why=why)


def right_hand_side(scenario: Scenario, spin: float, x: Array) -> Array:
    """Time derivative of deviations from inverted spinning.

    Parameters
    ----------
    scenario : Scenario
        See `reduced.solver`.
    spin : float
        In rad/s.
    x : ndarray, shape (3, n)
        Deviations of beta and gamma in rad, and the rate of beta in rad/s.

    Returns
    -------
    ndarray, shape (3, n)
    """

    def force(slip: Array) -> Any:
        return slip * _friction(scenario, slip)[0]

    return np.array(derivative(scenario, spin, x, force), dtype=float)


def derivatives(scenario: Scenario, spin: float, x: Array) -> tuple[Array, Array, Array]:
    """Right-hand side, shape (3, n), Jacobian, (n, 3, 3), and derivative by the spin, (3, n).

    The parameters are those of `right_hand_side`.
    """

    def force(slip: Dual) -> Dual:
        per_speed, slope = _friction(scenario, slip.value)
        change = per_speed + np.abs(slip.value) * slope
        return Dual(slip.value * per_speed, change * slip.change)

    *state, turning = (
        Dual(value, axis) for value, axis in zip((*x, spin), np.eye(4)[:, :, None], strict=True)
    )
    rates = [dual(rate) for rate in derivative(scenario, turning, state, force)]
    changes = np.array([np.broadcast_to(rate.change, (4, x.shape[1])) for rate in rates])
    right: Array = np.array([rate.value for rate in rates])
    return right, changes[:, :3].transpose(2, 0, 1), changes[:, 3]


def derivative(
    scenario: Scenario, spin: Any, x: Numbers, force: Callable[[Any], Any]
) -> tuple[Any, Any, Any]:
    """Time derivative of deviations from inverted spinning, for numbers of any kind.

    Parameters
    ----------
    scenario : Scenario
        Its friction law is not looked at.
    spin : number
        In rad/s.
    x : sequence of 3 numbers
        See `right_hand_side`.
    force : callable
        From the slip in m/s to the force against it for each newton of load.
    """
    tilt, turn, rate = x
    sin_tilt = sin(tilt)
    directions = cos(tilt), -sin_tilt, cos(turn), -sin(turn)
    acceleration = acceleration_from(scenario, spin, directions, rate, force)
    return rate, spin * sin_tilt, acceleration


def _friction(scenario: Scenario, slip: Array) -> tuple[Any, Any]:
    """Force for each newton of load and each m/s of slips, and its slope by their size."""
    law = scenario.friction
    return per_speed_and_slope(law, np.maximum(np.abs(slip), _NO_SLIP * law.finest_speed))
