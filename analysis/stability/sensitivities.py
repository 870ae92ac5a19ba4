"""How the critical speeds of a motion move with the disk: exact logarithmic derivatives.

A value of -0.5 means: 1 % more of the parameter, 0.5 % less critical speed, all other parameters
held. "size" scales all lengths at the same density: radius and eccentricity grow with it, the
mass with its cube, the moments of inertia with its fifth power; the friction law stays.

The equations of motion are differentiated by dual numbers, whose values are dual numbers along the
eigenvector. The radius is left to the others: lengths count in the size and times in its square
root, in whose units size**(1/2) * mu / epsilon is the friction, so that the size itself has
-1/2 + 1/2 of what the friction has.
"""

import numpy as np

from analysis.mechanics import recorded
from analysis.mechanics.dual import Dual, dual, of_slope, value_of
from analysis.mechanics.newton_euler import Structure
from analysis.problem.checks import instance
from analysis.problem.scenario import Scenario
from analysis.problem.start import Motion
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Crossing
from analysis.stability.linearisation import (
    ComplexArray,
    Linearisation,
    eigenvectors,
    require_spinning,
    spin_scale,
    spinning,
    turning_state,
)

POWERS = {
    "mass": 3,
    "radius": 1,
    "eccentricity": 1,
    **dict.fromkeys(("inertia_x", "inertia_y", "inertia_z"), 5),
}
"""Fields of a disk, and the powers of the size with which they grow."""

_PARAMETERS = (
    *("mass", "eccentricity", "inertia_x", "inertia_y", "inertia_z"),
    *("products", "gradient", "spin"),
)
"""What the equations are differentiated by; all products of inertia grow together."""

_APART = 1e-5
"""Distance of eigenvalues within which they move together, in parts of the geometric mean of the
largest and `spin_scale`."""


def sensitivities(
    scenario: Scenario, crossing: Crossing, motion: Motion = "inverted"
) -> dict[str, float]:
    """Derivatives d ln(spin) / d ln(parameter) of a critical speed.

    What a parameter does to the real part of the eigenvalue, the spin undoes.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact and any constraints.
    crossing : Crossing
        One that `critical.critical_speeds` has found for it, in whichever system.
    motion : {"inverted", "noninverted"}

    Returns
    -------
    dict
        For mass, radius, eccentricity, the moments of inertia and what else is listed in `POWERS`
        of this module, "friction_gradient" and "size". The radius of another body than a round
        disk stands for all lengths of its surface, in proportion.

    Raises
    ------
    ValueError
        If the motion is unknown, the scenario another one, its friction law has no gradient, or
        more than one eigenvalue crosses there, such as beside one that is always zero.
    """
    instance("crossing", crossing, Crossing)
    require_spinning(scenario, "sensitivities")
    system = spinning(scenario, motion)
    (matrix,) = system.matrices(np.array([crossing.spin]))
    values = np.linalg.eigvals(matrix)
    away = np.abs(values - 1j * crossing.frequency)
    critical, *others = np.argsort(away)
    near = _APART * np.sqrt(np.max(np.abs(values)) * spin_scale(scenario))
    if (count := 1 + int(np.sum(away[others] < near))) > 1:
        raise ValueError(
            "crossing must be that of one eigenvalue or pair for its spin to have derivatives, "
            f"got {count} eigenvalues at the same place at {crossing.spin:.9g} rad/s"
        )
    left, v = eigenvectors(matrix, values[critical])
    w = left.conj()
    changes = _changes(scenario, system, crossing.spin, *system.spread(crossing.spin, w, v))
    growths = (changes / (w @ v)).real
    *fields, products, gradient, _ = (-growths / growths[-1]).tolist()
    found = dict(zip(_PARAMETERS, fields, strict=False))
    size = 0.5 * gradient - 0.5
    radius = size - 5 * products - sum(POWERS[name] * found[name] for name in found)
    return {**found, "radius": radius, "friction_gradient": gradient, "size": size}


def _changes(
    scenario: Scenario,
    system: Linearisation,
    spin: float,
    weights: ComplexArray,
    deviation: ComplexArray,
) -> ComplexArray:
    """Changes of a weighted sum of slopes with each of `_PARAMETERS`, over its own: shape (8,)."""

    def changing(name: str, value: float) -> Dual:
        return Dual(value, value * np.equal(_PARAMETERS, name))

    disk, gradient = scenario.disk, scenario.friction.gradient
    m, e, x, y, z = (changing(name, getattr(disk, name)) for name in _PARAMETERS[:5])
    about_cog = x, y - m * e * e, z - m * e * e
    products = (changing("products", each) for each in disk.products)
    # Gravity, and the surface.
    others = recorded.numbers(scenario)[9:]
    numbers = (m, disk.radius, e, *about_cog, *products, *others)
    # At no slip a law is its slope, and the load the weight, Eq. (40).
    structure = Structure.of(with_gradient(scenario, gradient))
    solve = recorded.formula(structure)(*numbers, **of_slope(changing("gradient", gradient)))
    moving_disk = recorded.disk_of(numbers, structure.body)
    state = turning_state(scenario, system.place, changing("spin", spin), moving_disk)
    moving = [
        Dual(Dual(value_of(each), along), dual(each).change)
        for each, along in zip(state, deviation.tolist(), strict=True)
    ]
    found = system.equations(moving_disk, solve, moving)
    slopes = [dual(dual(each).change).change * np.ones(len(_PARAMETERS)) for each in found]
    return weights @ np.array(slopes)
