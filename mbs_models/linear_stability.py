"""Linear stability of the engine's explicit integrators, measured on the engine."""

from functools import lru_cache

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.problem.checks import Array, choice
from mbs_models.integrators import RULES, IntegratorName
from mbs_models.solving import quiet, solving

STAGES: dict[IntegratorName, int] = {
    name: rule.stages for name, rule in RULES.items() if rule.stages and not rule.controls_step
}
"""Fixed-step explicit integrators and their stages, the degree of the stability function."""


@lru_cache
def stability_polynomial(integrator: IntegratorName) -> Array:
    """Coefficients of the stability function, shape (stages + 1,), lowest degree first.

    One step of length 1 multiplies a state by this polynomial of the system's matrix. A chain, in
    which each variable drives the next, moves its first unit vector by one place for each power
    of that, so that the state after a step lists the coefficients. Those up to the order of the
    method are 1 / k!.

    Raises
    ------
    ValueError
        If the integrator is none of `STAGES`.
    """
    size = STAGES[choice("integrator", integrator, STAGES)] + 1
    container = exu.SystemContainer()
    system = container.AddSystem()
    node = system.AddNode(
        items.NodeGenericODE1(
            numberOfODE1Coordinates=size,
            referenceCoordinates=[0.0] * size,
            initialCoordinates=np.eye(size)[0],
        )
    )
    system.AddObject(items.ObjectGenericODE1(nodeNumbers=[node], systemMatrix=np.eye(size, k=-1)))
    system.Assemble()
    settings = quiet()
    settings.timeIntegration.numberOfSteps = 1
    settings.timeIntegration.endTime = 1.0
    settings.timeIntegration.automaticStepSize = False
    with solving(system):
        system.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, integrator))
    return np.array(system.systemData.GetODE1Coordinates())


def largest_step(integrator: IntegratorName, eigenvalue: complex) -> float:
    """Largest step in s at which a decaying motion decays, `inf` for an eigenvalue of zero.

    Parameters
    ----------
    integrator : {"RK44", "RK67"}
    eigenvalue : complex
        In 1/s, with a real part that is not positive.
    """
    if eigenvalue == 0.0:
        return float("inf")
    direction = eigenvalue / abs(eigenvalue)
    radii = np.linspace(0.0, 10.0, 10001)[1:]
    factors = np.abs(np.polyval(stability_polynomial(integrator)[::-1], radii * direction))
    # Rounding must not count as growth where a step hardly damps.
    unstable = factors > 1.0 + 1e-9
    radius = radii[np.argmax(unstable)] if np.any(unstable) else np.inf
    return float(radius / abs(eigenvalue))
