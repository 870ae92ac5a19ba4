"""How the critical speeds of inverted spinning move with the disk: logarithmic derivatives.

A value of -0.5 means: 1 % more of the parameter, 0.5 % less critical speed, all other parameters
held. "size" scales all lengths at the same density: radius and eccentricity grow with it, the
mass with its cube, the moments of inertia with its fifth power; the friction law stays.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.mechanics.dual import derivatives
from analysis.stability.critical import Crossing, critical_speeds
from analysis.stability.linear_full import printed_matrices, signed_eccentricity

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

_FIELDS = ("eccentricity", "inertia_x", "inertia_y", "inertia_z", "radius", "mass")


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
    scenario.require_plain("the closed form")
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


def _sensitivities(scenario: Scenario, crossing: Crossing, motion: Motion) -> dict[str, float]:
    disk, sign = scenario.disk, np.sign(signed_eccentricity(scenario.disk, motion))
    gravity = scenario.weight / disk.mass

    def pencil(numbers: Sequence[Any]) -> list[Any]:
        """Entries of lambda² M + lambda (D + G) + K + N."""
        eigenvalue, Omega, delta, e, A, B, C, r, m = numbers
        mg = gravity * m
        printed = printed_matrices(m=m, r=r, e=sign * e, A=A, B=B, C=C, mg=mg)
        M, G_h, K_h, K_f, D_C, B_C = (sum(rows, ()) for rows in printed.values())
        square, turning, rubbing = eigenvalue * eigenvalue, Omega * Omega, delta * mg
        return [
            square * M[k]
            + eigenvalue * (rubbing * D_C[k] + Omega * G_h[k])
            + turning * K_h[k]
            + K_f[k]
            + rubbing * Omega * B_C[k]
            for k in range(16)
        ]

    given = [crossing.spin, scenario.friction.gradient, *(getattr(disk, n) for n in _FIELDS)]
    place = np.array([1j * crossing.frequency, *given])
    left, _, right = np.linalg.svd(np.reshape(pencil(place.tolist()), (4, 4)))
    w, v = left[:, -1].conj(), right[-1].conj()
    slopes = np.einsum("i,ijk,j->k", w, derivatives(pencil, place).reshape(4, 4, -1), v)
    growth = -(slopes[1:] / slopes[0]).real * given
    by_friction, *by_field = (-growth[1:] / growth[0]).tolist()
    by_name = dict(zip(_FIELDS, by_field, strict=True))
    values = {
        name: sum(power * by_name[field] for field, power in fields.items())
        for name, fields in DISK_PARAMETERS.items()
    }
    return {**values, FRICTION_GRADIENT: by_friction}
