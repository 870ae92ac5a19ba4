"""The engine's integrators the study uses, and single runs with them."""

import time
from dataclasses import dataclass
from math import ceil, floor
from typing import Any, Literal, get_args

import exudyn as exu
import numpy as np

from analysis.checks import Array, choice, number, positive
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.quiet import quiet
from mbs_models.scene import Formulation

IntegratorName = Literal["RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha"]
INTEGRATORS: tuple[IntegratorName, ...] = get_args(IntegratorName)

_IMPLICIT = ("TrapezoidalIndex2", "GeneralizedAlpha")

MINIMUM_STEP = 1e-9
"""Step in s at which step control gives up."""


class EngineError(ArithmeticError):
    """The engine ended a run early, or gave up on the way."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Newton:
    """How the nonlinear equations of an implicit step are solved.

    Parameters
    ----------
    modified : bool
        Keep the Jacobian for several iterations and steps instead of renewing it every time.
    relative : float
        Iterations end when the residual has fallen by this factor, positive.
    absolute : float
        Or when it is below this part of the disk's weight, positive.

    Raises
    ------
    ValueError
        If a tolerance is not positive.
    """

    modified: bool = True
    relative: float = 1e-12
    absolute: float = 2e-14

    def __post_init__(self) -> None:
        object.__setattr__(self, "relative", positive("relative", self.relative))
        object.__setattr__(self, "absolute", positive("absolute", self.absolute))


@dataclass(frozen=True, slots=True, kw_only=True)
class Integrator:
    """An engine integrator and its options.

    Parameters
    ----------
    name : {"RK44", "RK67", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha"}
        The engine's name of it. The first three are explicit and need a scene without
        constraints; DOPRI5 controls its step, the others keep it.
    newton : Newton, optional
        Of implicit integrators.
    spectral_radius : float, optional
        Numerical damping of GeneralizedAlpha from 0 (strongest) to 1 (none); 0.9 by default.
    local_tolerance : float, optional
        Absolute error that DOPRI5 allows in a step, in m, rad, m/s and rad/s; 1e-8 by default.

    Raises
    ------
    ValueError
        If the name is unknown, a value is out of range, or an option belongs to another
        integrator.
    """

    name: IntegratorName
    newton: Newton | None = None
    spectral_radius: float | None = None
    local_tolerance: float | None = None

    def __post_init__(self) -> None:
        choice("integrator", self.name, INTEGRATORS)
        self._fill("newton", self.implicit, Newton())
        self._fill("spectral_radius", self.name == "GeneralizedAlpha", 0.9)
        self._fill("local_tolerance", self.controls_step, 1e-8)
        if self.spectral_radius is not None:
            radius = number("spectral_radius", self.spectral_radius)
            if not 0.0 <= radius <= 1.0:
                raise ValueError(f"spectral_radius must lie in [0, 1], got {radius:g}")
        if self.local_tolerance is not None:
            positive("local_tolerance", self.local_tolerance)

    def _fill(self, option: str, applies: bool, default: object) -> None:
        """Fill in the default of an option; raise if it is given but does not apply."""
        value = getattr(self, option)
        if value is None and applies:
            object.__setattr__(self, option, default)
        if value is not None and not applies:
            raise ValueError(f"{option} is no option of integrator {self.name!r}, got {value!r}")

    @property
    def implicit(self) -> bool:
        """Whether it takes constraints."""
        return self.name in _IMPLICIT

    @property
    def controls_step(self) -> bool:
        """Whether it chooses its steps by itself."""
        return self.name == "DOPRI5"

    @property
    def first_step(self) -> float:
        """Step in s with which a tolerance-controlled run starts for the paper's disk."""
        return 5e-3 if self.implicit else 1e-2

    def settings(self) -> dict[str, str | float | int | None]:
        """Name and options, as they go with a trajectory."""
        result: dict[str, str | float | int | None] = {"integrator": self.name}
        if self.newton is not None:
            result["newton_modified"] = self.newton.modified
            result["newton_relative"] = self.newton.relative
            result["newton_absolute"] = self.newton.absolute
        if self.spectral_radius is not None:
            result["spectral_radius"] = self.spectral_radius
        if self.local_tolerance is not None:
            result["local_tolerance"] = self.local_tolerance
        return result


def integrators(
    formulation: Formulation, *, constrained: bool | None = None
) -> tuple[IntegratorName, ...]:
    """Integrators that can take a formulation; the first is the default.

    Parameters
    ----------
    formulation : str
    constrained : bool, optional
        Whether algebraic equations are left (`Scene.has_constraints`); by default whether the
        formulation has any on the ideal contact.
    """
    if formulation == "contact-tree":
        return ("RK67", "RK44", "DOPRI5", "TrapezoidalIndex2", "GeneralizedAlpha")
    if constrained is None or constrained:
        return ("TrapezoidalIndex2", "GeneralizedAlpha")
    return ("TrapezoidalIndex2", "GeneralizedAlpha", "RK44", "RK67", "DOPRI5")


def find_integrator(
    formulation: Formulation,
    wanted: Integrator | IntegratorName | None,
    *,
    constrained: bool | None = None,
) -> Integrator:
    """Integrator as wanted, by name with its default options, or the default one.

    Raises
    ------
    ValueError
        If it is unknown, or cannot take the constraints of the formulation.
    """
    available = integrators(formulation, constrained=constrained)
    if wanted is None:
        wanted = available[0]
    chosen = wanted if isinstance(wanted, Integrator) else Integrator(name=wanted)
    if chosen.name not in available:
        raise ValueError(
            f"integrator {chosen.name!r} is explicit and cannot take the constraints of "
            f"formulation {formulation!r}; use one of {', '.join(available)}"
        )
    return chosen


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
        Steps, and what they took: evaluations of the right-hand side and rejected steps of
        explicit integrators, Newton iterations and Jacobians of implicit ones.
    seconds : float
        Processor time that the engine's solver took.
    """

    records: Array
    algebraic: Array
    counts: dict[str, int]
    seconds: float


def run(
    model: Model, integrator: Integrator, *, spacing: float, intervals: int, substeps: int
) -> Samples:
    """Run a model from its initial state and sample it evenly; samples fall on steps.

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
        Steps per interval; the least number of them if the integrator controls its step.

    Returns
    -------
    Samples
        With `intervals + 1` rows, the first of them at the start.

    Raises
    ------
    EngineError
        If the run did not reach its end with finite results, or step control gave up.
    """
    system = model.system
    sensor = model.add_sensor()
    start = _set_initial_accelerations(model) if integrator.implicit else None
    settings = _settings(model, integrator, spacing * intervals, intervals * substeps)
    settings.solution.sensors.writePeriod = spacing
    limiter = _StepLimiter(spacing)
    if integrator.controls_step:
        system.SetPreStepUserFunction(limiter.limit)
    begin = time.process_time()
    try:
        with quiet():
            system.SolveDynamic(
                settings, solverType=getattr(exu.DynamicSolverType, integrator.name)
            )
    except exu.ExudynError as error:
        raise _early_end(model, spacing * intervals, error, limiter) from error
    seconds = time.process_time() - begin
    stored = np.array(system.GetSensorStoredData(sensor))
    if len(stored) != intervals + 1 or not np.all(np.isfinite(stored)):
        raise _early_end(model, spacing * intervals, None, limiter)
    unknowns = len(model.record())
    if start is not None:
        stored[0, 1 + unknowns :] = start
    return Samples(
        records=stored[:, 1 : 1 + unknowns],
        algebraic=stored[:, 1 + unknowns :],
        counts=_counts(system.sys["dynamicSolver"], integrator),
        seconds=seconds,
    )


class _StepLimiter:
    """Shortens the steps of step control so that every sample falls on a step.

    Left to itself the engine writes a sample at the first step past its time.

    Parameters
    ----------
    spacing : float
        Time between samples in s.

    Attributes
    ----------
    stalled : bool
        Whether step control has come down to its minimum step, where the engine would go on
        with a larger error.
    """

    def __init__(self, spacing: float) -> None:
        self._spacing = spacing
        self.stalled = False

    def limit(self, system: Any, _t: float) -> bool:
        """Replace the step that the engine has just proposed; its function before each step."""
        iteration = system.sys["dynamicSolver"].it
        step = iteration.currentStepSize
        start = iteration.currentTime - step
        sample = (floor(start / self._spacing + 1e-9) + 1) * self._spacing
        rest = sample - start
        if step <= 1.001 * MINIMUM_STEP < rest:
            self.stalled = True
            raise EngineError("minimum step")
        # Equal steps to the next sample: a short last one would hold up the step control.
        steps = ceil(rest / step - 1e-9)
        iteration.currentStepSize = rest / steps
        iteration.currentTime = sample if steps == 1 else start + rest / steps
        return True


def _counts(solver: Any, integrator: Integrator) -> dict[str, int]:
    iteration = solver.it
    # The engine's index is that of the step to come.
    steps = int(iteration.currentStepIndex) - 1
    if integrator.implicit:
        return {
            "steps": steps,
            "newton_iterations": int(iteration.newtonStepsCount),
            "jacobians": int(iteration.newtonJacobiCount),
        }
    rejected = int(iteration.rejectedAutomaticStepSizeSteps)
    return {
        "steps": steps,
        "rejected_steps": rejected,
        "right_hand_sides": int(solver.GetNumberOfStages()) * (steps + rejected),
    }


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


def _settings(model: Model, integrator: Integrator, duration: float, steps: int) -> Any:
    settings = exu.SimulationSettings()
    stepping = settings.timeIntegration
    stepping.endTime = duration
    stepping.numberOfSteps = steps
    stepping.verboseMode = 0
    # A failing step must end the run instead of going on with another size.
    stepping.adaptiveStep = False
    stepping.automaticStepSize = integrator.controls_step
    if integrator.newton is not None:
        stepping.newton.useModifiedNewton = integrator.newton.modified
        stepping.newton.relativeTolerance = integrator.newton.relative
        absolute = integrator.newton.absolute * model.scene.disk.weight
        stepping.newton.absoluteTolerance = max(absolute, model.force_rounding)
    if integrator.spectral_radius is not None:
        stepping.generalizedAlpha.spectralRadius = integrator.spectral_radius
    if integrator.local_tolerance is not None:
        stepping.absoluteTolerance = integrator.local_tolerance
        # The engine scales it with signed coordinates, so that it cancels the other below zero.
        stepping.relativeTolerance = 0.0
        stepping.minimumStepSize = MINIMUM_STEP
        stepping.initialStepSize = min(1e-3, duration / steps)
    stepping.generalizedAlpha.computeInitialAccelerations = False
    stepping.generalizedAlpha.resetAccelerations = False
    # Nothing reads them, and the next step's first stage computes them anyway.
    stepping.explicit.computeEndOfStepAccelerations = False
    settings.solution.file.write = False
    return settings


def _early_end(
    model: Model, end: float, error: Exception | None, limiter: _StepLimiter
) -> EngineError:
    solver = model.system.sys["dynamicSolver"]
    cause = "the result is not finite"
    if limiter.stalled:
        cause = f"step control came down to its minimum step of {MINIMUM_STEP:g} s"
    elif error is not None:
        cause = str(error).split(" [Python file")[0].strip().splitlines()[0]
        if solver.conv.newtonSolutionDiverged or solver.conv.stepReductionFailed:
            cause = f"Newton's iteration did not converge (residual {solver.conv.residual:.1e})"
        elif solver.conv.linearSolverFailed:
            cause = "the system matrix is singular"
    return EngineError(
        f"engine run stopped at t = {solver.it.currentTime:.6g} s of {end:.6g} s: {cause}"
    )
