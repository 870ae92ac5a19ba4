"""The engine's integrators the study uses, and single runs with a fixed step."""

from dataclasses import dataclass
from typing import Any, Literal, get_args

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.checks import Array, choice
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.quiet import quiet
from mbs_models.scene import Formulation

IntegratorName = Literal["RK44", "RK67", "TrapezoidalIndex2", "GeneralizedAlpha"]
INTEGRATORS: tuple[IntegratorName, ...] = get_args(IntegratorName)


class EngineError(ArithmeticError):
    """The engine ended a run early, or gave up on the way."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Integrator:
    """An engine integrator with a fixed step.

    Parameters
    ----------
    name : str
        The engine's name of it.
    implicit : bool
        Implicit integrators take constraints; explicit ones need a scene without.
    first_step : float
        Step in s with which a tolerance-controlled run starts for the paper's disk.
    """

    name: IntegratorName
    implicit: bool
    first_step: float


_INTEGRATORS = {
    "RK44": Integrator(name="RK44", implicit=False, first_step=1e-2),
    "RK67": Integrator(name="RK67", implicit=False, first_step=1e-2),
    "TrapezoidalIndex2": Integrator(name="TrapezoidalIndex2", implicit=True, first_step=5e-3),
    "GeneralizedAlpha": Integrator(name="GeneralizedAlpha", implicit=True, first_step=5e-3),
}


def integrators(formulation: Formulation) -> tuple[IntegratorName, ...]:
    """Integrators that can take a formulation; the first is the default."""
    if formulation == "contact-tree":
        return ("RK67", "RK44", "TrapezoidalIndex2", "GeneralizedAlpha")
    return ("TrapezoidalIndex2", "GeneralizedAlpha")


def find_integrator(formulation: Formulation, name: IntegratorName | None) -> Integrator:
    """Integrator of this name, or the default one.

    Raises
    ------
    ValueError
        If it is unknown, or cannot take the constraints of the formulation.
    """
    available = integrators(formulation)
    name = available[0] if name is None else choice("integrator", name, INTEGRATORS)
    if name not in available:
        raise ValueError(
            f"integrator {name!r} is explicit and cannot take the constraints of formulation "
            f"{formulation!r}; use one of {', '.join(available)}"
        )
    return _INTEGRATORS[name]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """What one run has recorded.

    Parameters
    ----------
    records : ndarray, shape (n, k)
        See `Model.record`.
    algebraic : ndarray, shape (n, m)
        Algebraic coordinates.
    counts : dict
        Steps, Newton iterations and Jacobians.
    """

    records: Array
    algebraic: Array
    counts: dict[str, int]


def run(
    model: Model, integrator: Integrator, *, spacing: float, intervals: int, substeps: int
) -> Samples:
    """Run a model from its initial state with a fixed step, and sample it evenly.

    Parameters
    ----------
    model : Model
        A newly built one; it cannot be run twice.
    integrator : Integrator
    spacing : float
        Time between samples in s.
    intervals : int
        Number of such intervals.
    substeps : int
        Steps per interval.

    Returns
    -------
    Samples
        With `intervals + 1` rows, the first of them at the start.

    Raises
    ------
    EngineError
        If the run did not reach its end with finite results.
    """
    system = model.system
    sensor = _add_sensor(model)
    start = _set_initial_accelerations(model) if integrator.implicit else None
    settings = _settings(model, spacing * intervals, intervals * substeps)
    settings.solution.sensors.writePeriod = spacing
    try:
        with quiet():
            system.SolveDynamic(
                settings, solverType=getattr(exu.DynamicSolverType, integrator.name)
            )
    except exu.ExudynError as error:
        raise _early_end(model, spacing * intervals, error) from error
    stored = np.array(system.GetSensorStoredData(sensor))
    if len(stored) != intervals + 1 or not np.all(np.isfinite(stored)):
        raise _early_end(model, spacing * intervals, None)
    unknowns = len(model.record())
    if start is not None:
        stored[0, 1 + unknowns :] = start
    iteration = system.sys["dynamicSolver"].it
    return Samples(
        records=stored[:, 1 : 1 + unknowns],
        algebraic=stored[:, 1 + unknowns :],
        counts={
            "steps": int(iteration.currentStepIndex),
            "newton_iterations": int(iteration.newtonStepsCount),
            "jacobians": int(iteration.newtonJacobiCount),
        },
    )


def _add_sensor(model: Model) -> Any:
    """Add the one sensor of a run: everything that is sampled, read at the same instant."""
    data = model.system.systemData

    def sample(*_unused: Any) -> Array:
        return np.concatenate((model.record(), data.GetAECoordinates()))

    sensor = model.system.AddSensor(
        items.SensorUserFunction(
            sensorNumbers=[],
            factors=[],
            storeInternal=True,
            writeToFile=False,
            sensorUserFunction=sample,
        )
    )
    model.system.Assemble()
    return sensor


def _set_initial_accelerations(model: Model) -> Array:
    """Give the engine its own accurate initial accelerations; return the multipliers, (m,).

    Left to itself the engine starts from a contact force of zero, which a friction law may want
    to know, and leaves out terms of velocity-level joints. Either makes every later result
    first-order accurate.
    """
    second_derivatives, algebraic = Probe(model).solve()
    model.system.systemData.SetODE2Coordinates_tt(
        second_derivatives.tolist(), exu.ConfigurationType.Initial
    )
    return algebraic


def _settings(model: Model, duration: float, steps: int) -> Any:
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.endTime = duration
    time.numberOfSteps = steps
    time.verboseMode = 0
    # A failing step must end the run instead of going on with another size.
    time.adaptiveStep = False
    time.newton.useModifiedNewton = True
    time.newton.relativeTolerance = 1e-12
    time.newton.absoluteTolerance = 2e-14 * model.scene.disk.weight
    time.generalizedAlpha.computeInitialAccelerations = False
    time.generalizedAlpha.resetAccelerations = False
    settings.solution.file.write = False
    return settings


def _early_end(model: Model, end: float, error: Exception | None) -> EngineError:
    solver = model.system.sys["dynamicSolver"]
    cause = "the result is not finite"
    if error is not None:
        cause = str(error).split(" [Python file")[0].strip().splitlines()[0]
        if solver.conv.newtonSolutionDiverged or solver.conv.stepReductionFailed:
            cause = f"Newton's iteration did not converge (residual {solver.conv.residual:.1e})"
        elif solver.conv.linearSolverFailed:
            cause = "the system matrix is singular"
    return EngineError(
        f"engine run stopped at t = {solver.it.currentTime:.6g} s of {end:.6g} s: {cause}"
    )
