"""Linear stability of the engine's explicit integrators, measured on the test equation."""

from cmath import exp
from functools import lru_cache
from math import pi

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import numpy.typing as npt

from analysis.data.checks import choice
from mbs_models.integrators import RULES, IntegratorName
from mbs_models.solving import solving

STAGES: dict[IntegratorName, int] = {
    name: rule.stages for name, rule in RULES.items() if rule.stages and not rule.controls_step
}
"""Fixed-step explicit integrators and their stages, the degree of the stability function."""


def amplification(integrator: IntegratorName, z: complex) -> complex:
    """Factor by which one step of the engine multiplies a motion exp(lambda t).

    Parameters
    ----------
    integrator : {"RK44", "RK67"}
    z : complex
        Step times lambda.

    Raises
    ------
    ValueError
        If the integrator has no stability function of its own to measure.
    """
    choice("integrator", integrator, STAGES)
    # An oscillator with the eigenvalues z and conj(z) starts as the eigenvector (1, z).
    first, second = (_one_step(integrator, z, start) for start in ((1.0, 0.0), (0.0, 1.0)))
    return complex(first + z * second)


def _one_step(integrator: IntegratorName, z: complex, start: tuple[float, float]) -> float:
    container = exu.SystemContainer()
    system = container.AddSystem()
    node = system.AddNode(
        items.NodeGenericODE2(
            numberOfODE2Coordinates=1,
            referenceCoordinates=[0.0],
            initialCoordinates=[start[0]],
            initialCoordinates_t=[start[1]],
        )
    )
    system.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=[node],
            massMatrix=np.eye(1),
            stiffnessMatrix=np.array([[abs(z) ** 2]]),
            dampingMatrix=np.array([[-2.0 * z.real]]),
        )
    )
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = 1
    settings.timeIntegration.endTime = 1.0
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.automaticStepSize = False
    settings.solution.file.write = False
    with solving(system):
        system.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, integrator))
    return float(system.systemData.GetODE2Coordinates()[0])


@lru_cache
def stability_polynomial(integrator: IntegratorName) -> npt.NDArray[np.float64]:
    """Coefficients of the stability function, shape (stages + 1,), lowest degree first.

    From its values on a circle; those up to the order of the method are 1 / k!.
    """
    count = STAGES[choice("integrator", integrator, STAGES)] + 1
    points = [exp(2j * pi * k / count) for k in range(count)]
    values = np.array([amplification(integrator, z) for z in points])
    coefficients: npt.NDArray[np.float64] = np.fft.fft(values).real / count
    return coefficients


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
