"""How the critical speeds of inverted spinning move with the disk: logarithmic derivatives.

A value of -0.5 means: 1 % more of the parameter, 0.5 % less critical speed, all other parameters
held. "size" scales all lengths at the same density: radius and eccentricity grow with it, the
mass with its cube, the moments of inertia with its fifth power; the friction law stays.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import exp, log
from types import MappingProxyType

import numpy as np
from scipy.optimize import brentq

from analysis.data.disk import Disk
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.chart import static_gradient
from analysis.stability.critical import Crossing, critical_speeds
from analysis.stability.hopf_points import ExtendedSystem
from analysis.stability.scope import spin_scale

DISK_PARAMETERS: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {
        "eccentricity": {"eccentricity": 1},
        "inertia_x": {"inertia_x": 1},
        "inertia_y": {"inertia_y": 1},
        "inertia_z": {"inertia_z": 1},
        "radius": {"radius": 1},
        "mass": {"mass": 1},
        "size": {
            "radius": 1,
            "eccentricity": 1,
            "mass": 3,
            "inertia_x": 5,
            "inertia_y": 5,
            "inertia_z": 5,
        },
    }
)
"""Parameters of the sensitivities and the powers with which the fields of the disk follow."""

FRICTION_GRADIENT = "friction_gradient"
"""The one further parameter of the full system, mu / epsilon."""

_STEP = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """Logarithmic derivatives of one critical speed of the full system.

    Parameters
    ----------
    crossing : Crossing
        The critical speed itself.
    values : mapping
        d ln(spin) / d ln(parameter) for `DISK_PARAMETERS` and the friction gradient.
    """

    crossing: Crossing
    values: Mapping[str, float]


def closed_form_sensitivities(scenario: Scenario) -> dict[str, float]:
    """Logarithmic derivatives of the critical speed (126) of the reduced system.

    With ln Omega_crit = ln(r + e) - ln(r) / 2 + ln(m g) / 2 - ln(B - m e²) / 2 they follow by
    hand. Neither A nor C nor friction has an influence, and size enters as 1 / sqrt(size).

    Parameters
    ----------
    scenario : Scenario
        Its disk alone is looked at, as in `critical_speed`.

    Raises
    ------
    ValueError
        If the table leans.
    """
    scenario.require_horizontal_table("the closed form")
    disk = scenario.disk
    m, r, e, B = disk.mass, disk.radius, disk.eccentricity, disk.inertia_y
    B_bar = disk.inertia_about_cog[1]
    return {
        "eccentricity": e / (r + e) + m * e**2 / B_bar,
        "inertia_x": 0.0,
        "inertia_y": -0.5 * B / B_bar,
        "inertia_z": 0.0,
        "radius": r / (r + e) - 0.5,
        "mass": 0.5 * B / B_bar,
        "size": -0.5,
        FRICTION_GRADIENT: 0.0,
    }


def full_sensitivities(
    scenario: Scenario,
    interval: tuple[float, float] = (0.0, 60.0),
    motion: Motion = "inverted",
) -> tuple[Sensitivity, ...]:
    """Logarithmic derivatives of every critical speed of the full system in an interval.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s.
    motion : {"inverted", "noninverted"}

    Raises
    ------
    ValueError
        If the interval or the motion is out of range, the scenario is another one, or the disk
        stands at a bound of what a rigid body can be, so that a parameter cannot be varied to
        both sides.
    """
    found = critical_speeds(scenario, interval, "full", motion)
    return tuple(
        Sensitivity(crossing=crossing, values=_sensitivities(scenario, crossing, motion))
        for crossing in found.crossings
    )


def _sensitivities(scenario: Scenario, crossing: Crossing, motion: Motion) -> dict[str, float]:
    gradient = scenario.friction.gradient

    def by_disk(parameter: str) -> float:
        def speed(change: float) -> float:
            disk = _scaled(scenario.disk, parameter, exp(change))
            return _speed(replace(scenario, disk=disk), gradient, crossing, motion)

        return _slope(speed)

    def by_friction(change: float) -> float:
        return _speed(scenario, gradient * exp(change), crossing, motion)

    result = {name: by_disk(name) for name in DISK_PARAMETERS}
    result[FRICTION_GRADIENT] = _slope(by_friction)
    return result


def _slope(speed: Callable[[float], float]) -> float:
    """Derivative of the logarithm of `speed` at 0 by central differences of fourth order."""
    fine = log(speed(_STEP) / speed(-_STEP)) / (2 * _STEP)
    coarse = log(speed(2 * _STEP) / speed(-2 * _STEP)) / (4 * _STEP)
    return (4 * fine - coarse) / 3


def _scaled(disk: Disk, parameter: str, factor: float) -> Disk:
    """Disk with one of `DISK_PARAMETERS` multiplied by `factor`."""
    changes = {
        field: getattr(disk, field) * factor**power
        for field, power in DISK_PARAMETERS[parameter].items()
    }
    try:
        return replace(disk, **changes)
    except ValueError as error:
        raise ValueError(f"{parameter} cannot be varied by {factor - 1:+.1%}: {error}") from None


def _speed(scenario: Scenario, gradient: float, near: Crossing, motion: Motion) -> float:
    """Critical speed in rad/s next to that of a neighbouring disk or gradient."""
    if near.kind == "static":
        return float(
            brentq(
                lambda spin: float(static_gradient(scenario, spin, motion)[0]) - gradient,
                0.95 * near.spin,
                1.05 * near.spin,
                xtol=1e-13,
            )
        )
    scale = spin_scale(scenario)
    guess = np.array((near.spin / scale, log(gradient), near.frequency / scale))
    found = ExtendedSystem(scenario, motion, guess).correct(guess, np.eye(3)[1], guess[1])
    if found is None:
        raise ArithmeticError(f"critical speed near {near.spin:g} rad/s lost")
    return float(found[0][0] * scale)
