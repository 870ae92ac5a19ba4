"""Runs of the engine's own solvers, one after another on a model."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import ceil, inf, isfinite, sqrt
from typing import Any

import exudyn as exu
import numpy as np
import numpy.typing as npt

from analysis.problem.checks import Array, instance
from analysis.problem.constraints import prescribed
from analysis.problem.start import COORDINATES
from mbs_models.integrators import Integrator
from mbs_models.model import Model
from mbs_models.probe import Probe
from mbs_models.solving import Ended, EngineError, cause_of, quiet, solving

MINIMUM_STEP = 1e-9
"""Step in s at which step control gives up."""

MOST_ITERATIONS = 100
"""Iterations after which a step fails.

The engine's Jacobian leaves out how constraint forces turn with the disk, so that long steps
converge by a constant factor each, and need more than the engine's 25.
"""

Stop = Callable[[float], str | None]
"""Called after each step with the time; why the run ends there, if it does."""

ROUNDINGS = 16.0
"""Last digits that a residual may lose together. Nearly flat on a stiff spring, where rotations
are composed, 14 were seen; which they are differs from one processor to the next."""

_ENDS_EARLY = 1e-10
"""Time in s before the end of a run at which the engine takes no other step."""

_INITIAL = exu.ConfigurationType.Initial


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """What one run has recorded.

    Parameters
    ----------
    records : ndarray, shape (n, k)
        See `Model.record`.
    counts : dict
        Steps, and what they took: evaluations of the right-hand side and rejected steps of
        explicit integrators, Newton iterations and Jacobians of implicit ones.
    seconds : float
        Processor time that the engine's solver took.
    stopped : tuple of float and str, optional
        Time in s at which the run was stopped, and why, if it was.
    failure : EngineError, optional
        Why it broke off, if it did.
    """

    records: Array
    counts: dict[str, int]
    seconds: float
    stopped: tuple[float, str] | None
    failure: EngineError | None


def run(
    model: Model,
    integrator: Integrator,
    times: Array,
    steps: npt.NDArray[np.int_],
    *,
    stop: Stop | None = None,
    most: float = inf,
) -> Recording:
    """Run a model from its initial state and record it at some times, which fall on steps.

    Parameters
    ----------
    model : Model
        Its initial state is that at the first time.
    integrator : Integrator
    times : ndarray, shape (n,)
        Increasing, in s; the run begins at the first.
    steps : ndarray of int, shape (n - 1,)
        Equal ones from each time to the next; the least number of them if the integrator controls
        its step.
    stop : callable, optional
        Ends the run early.
    most : float
        Steps after which step control is given up.

    Returns
    -------
    Recording
        With a row for each time, the first of them at the start, or with those up to where it was
        stopped or broke off, as far as they are finite.
    """
    system, begin, lengths = model.system, float(times[0]), np.diff(times) / steps
    _begin(model, integrator)
    due: list[float] = [*(times - begin).tolist(), inf]
    found, stopped = [model.read()], []
    # Rounding may bring a step to an early end.
    early = 0.0 if integrator.controls_step else 0.5 * float(np.min(lengths))
    awaited, longest = due[1] - early, float(np.max(lengths))
    settings = _settings(model, integrator, *_plan(due, lengths, steps, integrator))
    explicit = settings.timeIntegration.explicit
    # Without a multiplier, a record holds accelerations at the end of a step, which cost a further
    # evaluation, except by DOPRI5, whose last stage is there.
    evaluates_ends = model.closes_contact and integrator.name != "DOPRI5"
    is_end_evaluated = evaluates_ends
    explicit.computeEndOfStepAccelerations = is_end_evaluated

    def after_step(_system: Any, moment: float) -> bool:
        nonlocal awaited, is_end_evaluated
        at = begin + moment
        if moment >= awaited:
            # But for rounding.
            at = float(times[len(found)])
            found.append(model.read())
            # One number that is not finite makes none of all others.
            awaited = due[len(found)] - early if isfinite(found[-1][0][0]) else inf
        # Set at every step, it would cost 2 % of a run.
        if evaluates_ends and is_end_evaluated != (moment + longest >= awaited):
            is_end_evaluated = not is_end_evaluated
            explicit.computeEndOfStepAccelerations = is_end_evaluated
        if stop is not None and (reason := stop(at)) is not None:
            stopped.append((at, reason))
        return not stopped and awaited < inf

    system.SetPostStepUserFunction(after_step)
    if integrator.controls_step:
        _limit_steps(system, lambda: due[len(found)], most)
    elif np.ptp(lengths) > 1e-9 * np.max(lengths):
        _keep_to(system, zip(due, lengths.tolist(), steps.tolist(), strict=False))
    # Of sensors that a scene itself has none of.
    settings.solution.sensors.writePeriod = float(np.min(np.diff(times)))
    seconds, failure = _solved(system, settings, integrator)
    records = _finite(found)
    broken = failure is not None or (len(records) < times.size and not stopped)
    return Recording(
        records=records,
        counts=_counts(system.sys["dynamicSolver"], integrator),
        seconds=seconds,
        stopped=stopped[0] if stopped else None,
        failure=_early_end(system, times, failure) if broken else None,
    )


def _begin(model: Model, integrator: Integrator) -> None:
    """Put a model in its initial state, and tell the engine what it leaves out there."""
    data = model.system.systemData
    # A run before, or a search, may have left it elsewhere.
    data.SetSystemState(data.GetSystemState(_INITIAL))
    if integrator.implicit or model.closes_contact:
        # Out of proportion to the load, full Newton failed in more scenes with it than without.
        newton, law = integrator.newton, model.scenario.friction
        if newton is not None and (newton.modified or law.IS_PROPORTIONAL):
            complete_jacobian(model, Probe(model))
        # The last, since a probe sets back what is settled.
        settle(model)


def _solved(
    system: Any, settings: Any, integrator: Integrator
) -> tuple[float, exu.ExudynError | None]:
    """Processor time in s that the engine's solver takes, and why it breaks off, if it does."""
    clock, failure = time.process_time(), None
    try:
        with solving(system):
            kind = getattr(exu.DynamicSolverType, integrator.name)
            system.SolveDynamic(settings, solverType=kind)
    except exu.ExudynError as error:
        failure = error
    return time.process_time() - clock, failure


def _plan(
    due: Sequence[float], lengths: Array, steps: npt.NDArray[np.int_], integrator: Integrator
) -> tuple[float, int]:
    """Duration in s and steps that the engine is told: beyond the last record, where it stops.

    It takes no step that begins less than `_ENDS_EARLY` before the end.
    """
    last, margin = float(lengths[-1]), 2.0 * _ENDS_EARLY
    further = ceil(margin / last) if last < margin else 0
    duration = due[-2] + further * last
    if integrator.controls_step:
        return duration, ceil(duration / float(np.max(lengths)) - 1e-9)
    return duration, int(np.sum(steps)) + further


def _finite(found: Sequence[Sequence[Array]]) -> Array:
    """Records, as far as they are finite, from n of `Model.read`."""
    # So much faster than by `numpy.array`.
    parts = [np.concatenate(each).reshape(len(found), -1) for each in zip(*found, strict=True)]
    records: Array = np.hstack(parts)
    good = int(np.argmin(np.append(np.isfinite(records).all(axis=1), False)))
    return records[:good]


def _keep_to(system: Any, stretches: Iterable[tuple[float, float, int]]) -> None:
    """Give each step its length: that of so many in a stretch that begins at a time in s."""
    plan = (
        (length, begin + (step + 1) * length)
        for begin, length, steps in stretches
        for step in range(steps)
    )

    def keep(system: Any, _t: float) -> bool:
        iteration = system.sys["dynamicSolver"].it
        iteration.currentStepSize, iteration.currentTime = next(plan)
        return True

    system.SetPreStepUserFunction(keep)


def _limit_steps(system: Any, due: Callable[[], float], most: float) -> None:
    """Shorten the steps of step control so that the next record, when it is due, falls on a step.

    Left to itself the engine would also go on at its minimum step, with a larger error, and
    without end.
    """
    steps = 0

    def limit(system: Any, _t: float) -> bool:
        """Replace the step that the engine has just proposed."""
        nonlocal steps
        steps += 1
        if steps > most:
            raise Ended(f"it has taken {most:.1e} steps, far more than expected")
        iteration = system.sys["dynamicSolver"].it
        step = iteration.currentStepSize
        start = iteration.currentTime - step
        rest = due() - start
        if step <= 1.001 * MINIMUM_STEP < rest:
            raise Ended(f"step control came down to its minimum step of {MINIMUM_STEP:g} s")
        # Equal steps to the next record: a short last one would hold up the step control.
        parts = ceil(rest / step - 1e-9)
        iteration.currentStepSize = rest / parts
        iteration.currentTime = due() if parts == 1 else start + rest / parts
        return True

    system.SetPreStepUserFunction(limit)


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


def settle(model: Model) -> None:
    """Give the engine its own accurate accelerations at the start, and forces for a record there.

    Left to itself the engine starts from a contact force of zero, which a friction law may want
    to know, and leaves out terms of velocity-level joints. The one makes every later result
    first-order accurate; by the other, constraint forces of undamped solvers go up and down from
    step to step, however short. Constraint forces are set in the current state alone: a solver
    begins without, which its accelerations make good.

    To be called before a solver of the engine, whose settings are to leave
    `timeIntegration.generalizedAlpha.computeInitialAccelerations` off; assembling the system
    forgets it.

    Parameters
    ----------
    model : Model
        Its current state is set to its initial state.

    Raises
    ------
    ArithmeticError
        If its equations are singular there.

    Examples
    --------
    >>> from analysis import Scenario
    >>> from mbs_models import build, settle
    >>> model = build(Scenario())
    >>> settle(model)
    >>> bool(any(model.system.systemData.GetODE2Coordinates_tt()))
    True
    """
    data, probe = instance("model", model, Model).system.systemData, Probe(model)
    with solving(model.system):
        second_derivatives, algebraic = probe.solved()
    data.SetODE2Coordinates_tt(second_derivatives.tolist(), _INITIAL)
    # What is recorded at the start.
    data.SetODE2Coordinates_tt(second_derivatives.tolist())
    data.SetAECoordinates(algebraic.tolist())


def complete_jacobian(model: Model, probe: Probe) -> None:
    """Add to the engine's Jacobian how friction grows with the contact force.

    The engine differentiates user functions by coordinates and velocities alone. Without this
    column, friction with the contact force as its load converges by a constant factor for each
    iteration, however short the step.
    """
    contact, data = probe.load_equation, model.system.systemData
    if contact is None:
        return

    def column(*_unused: Any) -> Any:
        forces = probe.forces_per_newton().tolist()
        size = len(forces) + len(data.GetAECoordinates())
        entries = [[row, len(forces) + contact, force] for row, force in enumerate(forces)]
        matrix = exu.MatrixContainer()
        # Written into a dense matrix, the engine fails.
        matrix.SetWithSparseMatrix(entries, size, size, useDenseMatrix=False)
        return matrix

    model.system.SetSystemJacobianUserFunction(column)


def _settings(model: Model, integrator: Integrator, duration: float, steps: int) -> Any:
    settings = quiet()
    stepping = settings.timeIntegration
    stepping.endTime = duration
    stepping.numberOfSteps = steps
    # A failing step must end the run instead of going on with another size.
    stepping.adaptiveStep = False
    stepping.automaticStepSize = integrator.controls_step
    if integrator.newton is not None:
        newton, wanted = stepping.newton, integrator.newton
        newton.useModifiedNewton = wanted.modified
        newton.maxIterations = MOST_ITERATIONS
        newton.relativeTolerance = wanted.relative
        asked = (wanted.absolute or 0.0) * model.scenario.weight
        newton.absoluteTolerance = max(asked, force_rounding(model))
    if integrator.spectral_radius is not None:
        stepping.generalizedAlpha.spectralRadius = integrator.spectral_radius
    if integrator.local_tolerance is not None:
        stepping.absoluteTolerance = integrator.local_tolerance
        # The engine scales it with signed coordinates, so that it cancels the other below zero.
        stepping.relativeTolerance = 0.0
        stepping.minimumStepSize = MINIMUM_STEP
        stepping.initialStepSize = min(1e-3, duration / steps)
    stepping.generalizedAlpha.resetAccelerations = False
    return settings


def force_rounding(model: Model) -> float:
    """Residual in N that rounding leaves, below which Newton's iteration cannot get.

    The last digits of the forces: the weight, and what turns a disk as fast as the start, or
    a fall from upright, makes it turn. A stiff contact turns the last digit of a height into
    a force, and steep friction that of a slip speed. The engine adds the residuals of the
    algebraic equations, whatever their unit: speeds, that of the spin, and the norm of the
    Euler parameters, which is one, or its rate. On a light disk their last digits are larger
    than those of the forces.
    """
    scenario = model.scenario
    disk, friction, contact = scenario.disk, scenario.friction, scenario.contact
    gravity, rates = scenario.table.gravity, model.start.rates[3:]
    fastest = sqrt(sum(rate * rate for rate in rates) + scenario.fall)
    rim_speed = disk.radius * fastest
    largest = [disk.mass * (gravity + rim_speed * fastest)]
    if model.has_norm:
        largest.append(max(1.0, fastest))
    if model.has_constraints(scenario):
        largest.append(rim_speed)
        held = prescribed(scenario.constraints).values()
        largest += [abs(model.start.rates[COORDINATES.index(name)]) for name in held]
    lost = friction.slope(scenario.weight) * rim_speed
    if contact is not None:
        lost += contact.stiffness * disk.radius
    return ROUNDINGS * float(np.finfo(float).eps) * max(lost, *largest)


def _early_end(system: Any, times: Array, error: Exception | None) -> EngineError:
    solver = system.sys["dynamicSolver"]
    cause = "the result is not finite" if error is None else cause_of(error)
    if error is not None and (
        solver.conv.newtonSolutionDiverged or solver.conv.stepReductionFailed
    ):
        cause = f"Newton's iteration did not converge (residual {solver.conv.residual:.1e})"
    elif error is not None and solver.conv.linearSolverFailed:
        cause = "the system matrix is singular"
    ended = EngineError(
        f"engine run stopped at t = {times[0] + solver.it.currentTime:.6g} s, before the end at "
        f"{times[-1]:.6g} s: {cause}"
    )
    ended.__cause__ = error
    return ended
