"""The reduced system as a flow of many states at once, with exact derivatives.

States are deviations from inverted spinning, (beta - pi/2, gamma - pi/2, beta'): in them the flow
is odd. Derivatives come from dual numbers. The friction law may have a kink in its second
derivative at zero slip: the force, its slope and so the Jacobian are continuous there, so that
variational equations need no jump conditions.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from analysis.mechanics import reduced
from analysis.mechanics.dual import of_duals, rate
from analysis.problem.checks import Array, within
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.stability.linearisation import require_spinning


def require_cycles(scenario: Scenario, steepest: float = np.inf) -> None:
    """Raise `ValueError` unless the reduced system of a scenario can have periodic motions.

    They are born where inverted spinning loses its stability, which takes friction and an
    eccentricity; friction must not be steeper, in s/m, than what a method can follow.
    """
    require_spinning(scenario, "the reduced system", 4)
    if not scenario.friction.is_simple:
        fault = "must be isotropic and in proportion to the load for periodic motions, got "
        raise ArgumentError("friction", f"{fault}{scenario.friction!r}")
    if not scenario.friction_gradient > 0.0:
        raise ArgumentError(
            "friction", "must have a positive gradient for periodic motions, got 0"
        )
    if scenario.friction.load != "weight":
        fault = (
            "must be 'weight' in the reduced system, which does not know the contact force, got "
        )
        raise ArgumentError("load", f"{fault}{scenario.friction.load!r}")
    if scenario.disk.eccentricity == 0.0:
        raise ArgumentError("eccentricity", "must be positive for periodic motions, got 0")
    if scenario.friction.gradient > steepest:
        raise ArgumentError(
            "friction",
            f"must have a gradient of at most {steepest:g} s/m to be followed here, got "
            f"{scenario.friction.gradient:g}; steeper, motions are those of the slow manifold",
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
    return np.array(reduced.solver(scenario, spin, of_duals, about_inverted=True)(*x))


def jacobian(scenario: Scenario, spin: float, x: Array) -> Array:
    """Derivative of `right_hand_side` by each state and by the spin, shape (n, 3, 4)."""

    def moved(moving: Sequence[Any]) -> tuple[Any, ...]:
        *state, turning = moving
        return reduced.solver(scenario, turning, of_duals, about_inverted=True)(*state)

    changes = rate(moved, (*x, spin), np.eye(4)[:, :, None])
    every = np.broadcast_arrays(*changes, np.empty((4, x.shape[1])))[:3]
    return np.array(every).transpose(2, 0, 1)
