"""How the critical speeds of inverted spinning move with the disk: logarithmic derivatives.

A value of -0.5 means: 1 % more of the parameter, 0.5 % less critical speed, all other parameters
held. "size" scales all lengths at the same density: radius and eccentricity grow with it, the
mass with its cube, the moments of inertia with its fifth power; the friction law stays.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.mechanics.dual import derivatives
from analysis.stability.critical import Crossing, critical_speeds
from analysis.stability.printed import critical_spin, printed_matrices, signed_eccentricity

FIELDS = ("eccentricity", "inertia_x", "inertia_y", "inertia_z", "radius", "mass")
SIZE = (1, 5, 5, 5, 1, 3)
"""Powers of the size with which the fields of a disk grow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """Logarithmic derivatives of one critical speed of the full system.

    Parameters
    ----------
    crossing : Crossing
        The critical speed itself.
    values : mapping
        d ln(spin) / d ln(parameter) for `FIELDS`, the size and the friction gradient.
    """

    crossing: Crossing
    values: Mapping[str, float]


def closed_form_sensitivities(scenario: Scenario) -> dict[str, float]:
    """Logarithmic derivatives of the critical speed (126) of the reduced system.

    Neither A nor C nor friction has an influence, and size enters as 1 / sqrt(size).

    Parameters
    ----------
    scenario : Scenario
        Its disk alone is looked at, as in `critical_speed`.

    Raises
    ------
    ValueError
        If the table leans.
    """
    scenario.require_plain("the closed form")
    given, gravity = _given(scenario), scenario.weight / scenario.disk.mass

    def spin(numbers: Sequence[Any]) -> list[Any]:
        e, _, B, _, r, m = numbers
        return [critical_spin(m, r, e, B, gravity * m)]

    by_field = derivatives(spin, given)[0] * given / spin(given.tolist())[0]
    return _by_name(by_field.tolist(), 0.0)


def full_sensitivities(
    scenario: Scenario,
    interval: tuple[float, float] = (0.0, 60.0),
    motion: Motion = "inverted",
) -> tuple[Sensitivity, ...]:
    """Logarithmic derivatives of every critical speed of the full system in an interval.

    They are exact: what a parameter does to the real part of the eigenvalue, the spin undoes.

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
        If the interval or the motion is out of range, or the scenario is another one.
    """
    found = critical_speeds(scenario, interval, "full", motion)
    return tuple(
        Sensitivity(crossing=crossing, values=_sensitivities(scenario, crossing, motion))
        for crossing in found.crossings
    )


def _given(scenario: Scenario) -> Array:
    return np.array([getattr(scenario.disk, name) for name in FIELDS])


def _by_name(by_field: Sequence[float], by_friction: float) -> dict[str, float]:
    size = sum(power * value for power, value in zip(SIZE, by_field, strict=True))
    values = dict(zip(FIELDS, by_field, strict=True))
    return {**values, "size": size, "friction_gradient": by_friction}


def _sensitivities(scenario: Scenario, crossing: Crossing, motion: Motion) -> dict[str, float]:
    sign = np.sign(signed_eccentricity(scenario.disk, motion))
    gravity = scenario.weight / scenario.disk.mass

    def pencil(numbers: Sequence[Any]) -> list[Any]:
        """Entries of lambda² M + lambda (D + G) + K + N."""
        eigenvalue, Omega, delta, e, A, B, C, r, m = numbers
        mg = gravity * m
        printed = printed_matrices(m=m, r=r, e=sign * e, A=A, B=B, C=C, mg=mg)
        d = delta * mg
        return [
            eigenvalue * eigenvalue * M
            + eigenvalue * (d * D_C + Omega * G_h)
            + Omega * Omega * K_h
            + K_f
            + d * Omega * B_C
            for M, G_h, K_h, K_f, D_C, B_C in zip(
                *(sum(rows, ()) for rows in printed.values()), strict=True
            )
        ]

    given = np.array([crossing.spin, scenario.friction.gradient, *_given(scenario)])
    place = np.array([1j * crossing.frequency, *given])
    left, _, right = np.linalg.svd(np.reshape(pencil(place.tolist()), (4, 4)))
    w, v = left[:, -1].conj(), right[-1].conj()
    slopes = np.einsum("i,ijk,j->k", w, derivatives(pencil, place).reshape(4, 4, -1), v)
    growth = -(slopes[1:] / slopes[0]).real * given
    by_friction, *by_field = (-growth[1:] / growth[0]).tolist()
    return _by_name(by_field, by_friction)
