"""How the critical speeds of a motion move with the disk: logarithmic derivatives.

A value of -0.5 means: 1 % more of the parameter, 0.5 % less critical speed, all other parameters
held. "size" scales all lengths at the same density: radius and eccentricity grow with it, the
mass with its cube, the moments of inertia with its fifth power; the friction law stays.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eig

from analysis.problem.checks import Array, instance
from analysis.problem.scenario import Scenario
from analysis.problem.start import Motion
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Crossing
from analysis.stability.linearisation import spin_scale
from analysis.stability.spectra import System, matrices_over_spin

POWERS = {
    "eccentricity": 1,
    "inertia_x": 5,
    "inertia_y": 5,
    "inertia_z": 5,
    "radius": 1,
    "mass": 3,
}
"""Fields of a disk, and the powers of the size with which they grow."""

_STEP = 1e-5
"""Relative step of the differences of matrices."""

_NOISE = 2e-3
"""Most that rounding may come to in a derivative."""

_APART = 1e-5
"""Distance of eigenvalues within which they move together, in parts of the geometric mean of the
largest and `spin_scale`."""


def sensitivities(
    scenario: Scenario,
    crossing: Crossing,
    system: System | None = None,
    motion: Motion = "inverted",
) -> dict[str, float]:
    """Derivatives d ln(spin) / d ln(parameter) of a critical speed.

    What a parameter does to the real part of the eigenvalue, the spin undoes.

    Parameters
    ----------
    scenario, system, motion
        See `spectra.matrices_over_spin`.
    crossing : Crossing
        One that `critical.critical_speeds` has found for these.

    Returns
    -------
    dict
        For `POWERS`, "friction_gradient" and "size".

    Raises
    ------
    ValueError
        If the system or the motion is unknown, the scenario none of this system, more than one
        eigenvalue crosses there, such as beside one that is always zero, or friction is so steep
        that rounding hides how matrices change.
    """
    instance("crossing", crossing, Crossing)

    def matrix(scenario: Scenario, spin: float = crossing.spin) -> Array:
        result: Array = matrices_over_spin(scenario, system, motion)(np.array([spin]))[0]
        return result

    values, left, right = eig(matrix(scenario), left=True)
    away = np.abs(values - 1j * crossing.frequency)
    critical, *others = np.argsort(away)
    largest, scale = np.max(np.abs(values)), spin_scale(scenario)
    # What moves a slow eigenvalue is as small against the scale as that against the largest one.
    if np.finfo(float).eps / _STEP * (largest / scale) ** 2 > _NOISE:
        raise ValueError(
            "friction must be less steep for critical speeds to have derivatives, got a largest "
            f"eigenvalue of {largest:.3g} 1/s"
        )
    near = _APART * np.sqrt(largest * scale)
    if (count := 1 + int(np.sum(away[others] < near))) > 1:
        raise ValueError(
            "crossing must be that of one eigenvalue or pair for its spin to have derivatives, "
            f"got {count} eigenvalues at the same place at {crossing.spin:.9g} rad/s"
        )
    w, v = left[:, critical].conj(), right[:, critical]

    def growth(behind: Array, ahead: Array) -> float:
        return float((w @ (ahead - behind) @ v / (w @ v)).real)

    sides, disk, gradient = (1.0 - _STEP, 1.0 + _STEP), scenario.disk, scenario.friction.gradient
    changed = {
        name: [
            replace(scenario, disk=replace(disk, **{name: getattr(disk, name) * side}))
            for side in sides
        ]
        for name in POWERS
    }
    changed["friction_gradient"] = [with_gradient(scenario, gradient * side) for side in sides]
    by_spin = growth(*(matrix(scenario, crossing.spin * side) for side in sides))
    found = {name: -growth(*map(matrix, each)) / by_spin for name, each in changed.items()}
    return {**found, "size": sum(power * found[name] for name, power in POWERS.items())}
