"""Simulation of a scene in the engine, to a step size or to a tolerance."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from math import isnan, sin, sqrt

import numpy as np
import numpy.typing as npt

from analysis.motion.endings import StopWhen, each_condition, named_conditions
from analysis.motion.trajectory import Trajectory, versions
from analysis.problem.checks import (
    Array,
    TimeLimitError,
    ToleranceError,
    increasing_times,
    optional,
    positive,
    switch,
)
from analysis.problem.choices import IntegratorName
from analysis.problem.friction import check_slipping
from analysis.problem.limits import DEFAULT_TOLERANCE
from analysis.problem.scenario import Scenario
from analysis.problem.start import FlatError
from analysis.solve.stepping import Run, integrate, pulls_at_start
from analysis.solve.to_tolerance import run_to, tighter_and_tighter
from analysis.solve.watch import Progress, StateFunction, Watch
from mbs_models.accelerations import TOO_LOW, AccelerationProblem
from mbs_models.effort import simulation_effort, ways
from mbs_models.extrapolation import FINEST, HopelessError, extrapolated
from mbs_models.integrators import FINEST_LOCAL, Integrator, find_integrator
from mbs_models.scene import CLASSES, FREE_BELOW, Scene
from mbs_models.solving import EngineError, SingularError, solving, stepping
from mbs_models.whole_runs import NEARLY_FLAT, Call, run_over

FINE = 3e-9
"""Tolerance in rad from which on a first run allows a step less of it."""

FLAT_ROUNDING = 1e-12
"""Error in rad, times sin² of the inclination at the start, that rounding may leave where a disk
falls on and Euler angles are coordinates: their mass matrix is singular on a flat disk."""

PASSING_ROUNDING = 1e-15
"""The same, times sin² of the least inclination, where a disk passes by flat;"""

STALLING = 1e3
"""and that error, over the one allowed in a step, with which steps become ever shorter there."""


def simulate(
    scene: Scene | Scenario,
    times: npt.ArrayLike,
    *,
    step: float | None = None,
    tolerance: float | None = None,
    integrator: Integrator | IntegratorName | None = None,
    stop_when: StopWhen = (),
    allow_pulling: bool = False,
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """Simulate a scene in the engine.

    Accuracy is asked for in one of two ways. With `step`, there is a single run of one of the
    engine's own integrators. With `tolerance`, there are several: those of the engine's own
    integrators halve their steps again and again and are extrapolated until the estimated error of
    beta and gamma is below it; those that step the engine's accelerations tighten the tolerance of
    a step until two agree, and `step` only limits their steps. Where these come nearly flat, a
    scene whose formulation is left open is begun anew as a free body, which loses fewer digits
    there.

    A run ends where a bilateral contact would have to pull, where the disk lies flat, where it is
    told to, or at its time limit: the trajectory then holds fewer samples than asked for, the
    last one at the ending, and says why.

    Parameters
    ----------
    scene : Scene or Scenario
        A scenario stands for its default scene.
    times : array_like, shape (n,)
        Strictly increasing times in s; the motion starts at the first.
    step : float, optional
        Largest step in s; shortened so that every sample falls on a step.
    tolerance : float, optional
        Largest error in beta and gamma in rad, and in s that of the time at which the motion ends
        by itself; 1e-8 if neither is given.
    integrator : Integrator or str, optional
        With its options, or the name of one of `integrators(scene)` or `ACCELERATED`.
        By default, the first of the former with a step, and with a tolerance on the ideal contact
        where no constraint is left; else DOP853, Radau where friction is stiff, or LSODA where a
        penalty contact is, on the engine's accelerations. Where that leads to nothing, the other
        way is tried. An `Integrator` with a `local_tolerance`, as DOPRI5 always has, takes its
        accuracy from there, and `step` only limits its steps.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there.
    allow_pulling : bool
        Go on where the contact pulls. There is no friction there if its load is "contact"; if it
        is "weight", there is as before.
    time_limit : float, optional
        Processor time in s after which the run ends with what it has reached. Times of pulling
        that fixed steps leave no time to locate are those of straight lines between steps.
    progress : callable, optional
        Called after each step with the time reached and the end of the run in s; a
        tolerance-controlled run passes over its times again and again.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If an argument is out of range, the run would take more than 1e8 steps, or the start
        breaks a constraint, makes constraints depend on each other or needs a contact that
        pulls.
    EngineError
        If the engine does not reach the end.
    FlatError
        If the disk comes so close to lying flat that the Euler angles cannot be followed, or not
        to `tolerance` in the formulation asked for.
    ToleranceError
        If `tolerance` cannot be met, or the run takes far more steps than it should; with a time
        limit it may.
    TimeLimitError
        If the limit is met before there is a result.

    Examples
    --------
    >>> import numpy as np
    >>> import analysis
    >>> from mbs_models import Scene, simulate
    >>> times = np.linspace(0.0, 0.1, 11)
    >>> run = simulate(Scene(), times, tolerance=1e-6)
    >>> check = analysis.simulate(analysis.Scenario(), times)
    >>> bool(np.abs(run.coordinates - check.coordinates)[:, 4:].max() < 1e-6)
    True
    """
    scene, times = Scene.of(scene), increasing_times(times)
    stop_when = each_condition(stop_when)
    allow_pulling = switch("allow_pulling", allow_pulling)
    chosen = find_integrator(scene, integrator)
    step, tolerance = _accuracy(chosen, step, tolerance)
    may_change = integrator is None or chosen.steps_accelerations
    scene, freed = _begun_with(scene, times, tolerance, may_change=may_change)
    tried, most = _attempts(scene, times, integrator, step, tolerance)
    check_slipping(scene.scenario.friction)
    watch = Watch(time_limit, progress, most)
    conditions = named_conditions(stop_when, scene.scenario.initial_state)
    motion = AccelerationProblem(scene, conditions)
    call = Call(
        motion=motion,
        times=times,
        longest=np.inf if step is None else step,
        tolerance=tolerance,
        may_change=freed is not None,
        allow_pulling=allow_pulling,
        watch=watch,
    )
    try:
        with closing(motion.model):
            return _first_that_leads_there(call, tried)
    except FlatError:
        if freed is None:
            raise
    return simulate(
        freed,
        times,
        step=step,
        tolerance=tolerance,
        integrator=integrator,
        stop_when=stop_when,
        allow_pulling=allow_pulling,
        time_limit=None if time_limit is None else max(time_limit - watch.seconds, 1e-3),
        progress=progress,
    )


def _attempts(
    scene: Scene,
    times: Array,
    integrator: Integrator | IntegratorName | None,
    step: float | None,
    tolerance: float | None,
) -> tuple[Sequence[Integrator], float]:
    """Integrators to be tried in turn, and steps after which all of them are given up."""
    effort = simulation_effort(scene, times, integrator, step=step, tolerance=tolerance)
    effort.check()
    usual = find_integrator(scene, integrator)
    if integrator is not None or tolerance is None:
        return [usual], effort.most
    other = simulation_effort(scene, times, usual, tolerance=tolerance)
    return ways(scene, times, tolerance), effort.most + other.most


def _accuracy(
    chosen: Integrator, step: float | None, tolerance: float | None
) -> tuple[float | None, float | None]:
    """Step and tolerance that are asked for, checked; a tolerance by default."""
    if step is not None and tolerance is not None and not chosen.steps_accelerations:
        raise ValueError("give either step or tolerance, not both")
    step = optional(positive, "step", step)
    if chosen.local_tolerance is not None:
        if tolerance is not None:
            raise ValueError(
                f"tolerance must be left out for integrator {chosen.name!r}, which has a "
                f"local_tolerance of its own, got {tolerance!r}"
            )
    elif step is None or chosen.steps_accelerations:
        tolerance = positive("tolerance", DEFAULT_TOLERANCE if tolerance is None else tolerance)
    return step, tolerance


def _begun_with(
    scene: Scene, times: Array, tolerance: float | None, *, may_change: bool
) -> tuple[Scene, Scene | None]:
    """The scene that a run begins with, and the one with which it may be begun anew.

    Raises
    ------
    ToleranceError
        Where rounding hides an error of this size.
    """
    if tolerance is None:
        return scene, None
    finest, where, freed = FINEST, "", scene.freed if may_change else None
    flatness = sin(scene.scenario.initial_state.coordinates[4])
    falls = times[-1] - times[0] > sqrt(2.0 * flatness / scene.scenario.fall)
    if flatness < NEARLY_FLAT and falls and CLASSES[scene.built_as].has_euler_angles:
        finest = FLAT_ROUNDING / flatness**2
        leaning = f"{scene.built_as!r}, which leans by {flatness:.2g} rad and falls"
        where = f" on {leaning}; try {_other_than_angles(scene)}"
    if tolerance >= finest:
        return scene, freed
    if where and freed is not None:
        return _begun_with(freed, times, tolerance, may_change=False)
    leaves = f"rounding leaves {finest:.2g} rad{where}"
    raise ToleranceError(f"tolerance {tolerance:g} rad cannot be reached: {leaves}")


def _first_that_leads_there(call: Call, integrators: Sequence[Integrator]) -> Trajectory:
    """The motion by the first of some integrators that leads there."""
    failed: Exception | None = None
    start = call.motion.scenario.initial_state
    with solving(call.motion.system):
        problem = call.motion.starting_at(start.vector)
        pulls_at_start(problem, allow_pulling=call.allow_pulling)
    for number, integrator in enumerate(integrators, start=1):
        is_last = number == len(integrators)
        try:
            if integrator.steps_accelerations:
                run, step = _stepped(call, integrator), call.longest
            elif call.tolerance is None:
                run, step = run_over(call, integrator, call.longest)
            else:
                run, step = extrapolated(call, integrator, is_last_way=is_last)
            return _trajectory(call, integrator, run, step)
        except HopelessError:
            pass
        except FlatError:
            # Of fixed steps, which nobody may have asked for.
            if failed is None:
                raise
            raise failed from None
        except (EngineError, ToleranceError, TimeLimitError) as error:
            if isinstance(error.__cause__, SingularError):
                # By every way alike.
                raise
            may_go_on, is_late = integrator.steps_accelerations, isinstance(error, TimeLimitError)
            leaning = min(sin(start.coordinates[4]), call.watch.flattest[1])
            hint = advice(call.motion.scene, integrators[0], leaning, is_late=is_late)
            told = type(error)(f"{error}; {hint}")
            if is_last or is_late or not may_go_on:
                raise told from error
            failed = failed or told
    raise AssertionError("the last way has come to nothing without saying so")


def _stepped(call: Call, integrator: Integrator) -> Run:
    """Step a scene's accelerations over all times, to a tolerance if there is one.

    Parameters
    ----------
    call : Call
    integrator : Integrator
        One that steps accelerations. Its local tolerance holds where the call has no tolerance.
    """
    times, tolerance = call.times, call.tolerance
    motion, start = call.motion, call.motion.scenario.initial_state.vector
    problem = motion.starting_at(start)
    problem = replace(problem, longest_step=min(call.longest, problem.longest_step))

    def run(local: float, part: float) -> Run:
        motion.quick = local >= motion.model.quick_from
        found = integrate(
            replace(problem, endings={**problem.endings, **_too_low(call, local)}),
            times,
            integrator.method,
            local,
            part,
            allow_pulling=call.allow_pulling,
            watch=call.watch,
        )
        call.counts.update(steps=found.steps, right_hand_sides=found.evaluations)
        leans = np.sin(found.states[:, problem.angles][:, 0])
        call.watch.flattest = (float(found.times[np.argmin(leans)]), float(np.min(leans)))
        if found.ended == TOO_LOW:
            moment, formulation = float(found.times[-1]), motion.scene.built_as
            raise FlatError(
                f"tolerance {tolerance:g} rad cannot be reached: the disk passes by flat after "
                f"t = {moment:.6g} s, where formulation {formulation!r} loses too many digits; "
                f"try {_other_than_angles(motion.scene)}",
                moment,
            )
        return found

    rungs = [integrator.local_tolerance or FINEST_LOCAL]
    if tolerance is not None:
        # The error of a motion falls more slowly than that of a step.
        first = tolerance / (3.0 if tolerance > FINE else 20.0)
        rungs = tighter_and_tighter(min(first, motion.scenario.finest_slip), FINEST_LOCAL)
    with stepping(motion.system):
        found = run_to(run, problem, times, tolerance or np.inf, rungs, method=integrator.name)
        values = motion.samples(found.states)
    # The first sample is the start itself, without the rounding on the way there.
    values[0, :12] = start
    return replace(found, states=values)


def _too_low(call: Call, local: float) -> dict[str, StateFunction]:
    """What ends a run, with this error allowed in a step, where Euler angles lose its digits."""
    if call.tolerance is None or not call.motion.model.has_euler_angles:
        return {}
    lowest = FREE_BELOW
    if not call.may_change:
        lowest = min(lowest, sqrt(PASSING_ROUNDING / min(call.tolerance, STALLING * local)))
    return {TOO_LOW: partial(call.motion.height_over, lowest)}


def _trajectory(call: Call, integrator: Integrator, run: Run, step: float) -> Trajectory:
    """The motion that a run of an integrator has sampled.

    Parameters
    ----------
    call : Call
    integrator : Integrator
        The one that was asked for; a run to a tolerance has found its own `local_tolerance`.
    run : Run
        Its states are samples: coordinates, their rates and the constraint forces.
    step : float
        Longest step in s, or the limit of step control.

    Raises
    ------
    TimeLimitError
        If there is nothing but the start.
    """
    if len(run.states) < 2:
        raise TimeLimitError("time limit met before the first sample after the start")
    if not isnan(run.local_tolerance):
        integrator = replace(integrator, local_tolerance=run.local_tolerance)
    return run.trajectory(
        call.motion.scenario,
        call.watch,
        source="engine",
        method={
            "formulation": call.motion.scene.built_as,
            **integrator.settings(),
            "step": step,
            "tolerance": call.tolerance,
        },
        counts=dict(call.counts),
        versions=versions("numpy", "exudyn"),
    )


def _other_than_angles(scene: Scene) -> str:
    """What follows a scene where its Euler angles lose digits."""
    free = scene.without_angles
    return f"formulation {free!r}" if free else "the in-house equations (analysis.simulate)"


def advice(scene: Scene, integrator: Integrator, leaning: float, *, is_late: bool = False) -> str:
    """Other ways to simulate the same motion, the most promising one first.

    Parameters
    ----------
    scene : Scene
    integrator : Integrator
        What has been tried.
    leaning : float
        Angle in rad between disk and table where it came nearest to flat.
    is_late : bool
        Whether it has taken too long.
    """
    found, is_flat = [], leaning < NEARLY_FLAT
    if is_flat and scene.without_angles:
        found.append(f"formulation {scene.without_angles!r}, which loses fewer digits nearly flat")
    if scene.scenario.contact is None:
        best = Scene(scene.scenario)
        if not (best.has_constraints or is_flat):
            if scene.built_as != best.built_as:
                found.append(f"formulation {best.built_as!r}, which has no constraints")
            elif not integrator.controls_step:
                found.append("integrator 'DOPRI5', with a local tolerance in place of one")
        found.append("the in-house equations (analysis.simulate, stiff ones with method 'Radau')")
    if is_late:
        found.append("a larger tolerance or step")
    else:
        found.append("another local tolerance" if integrator.controls_step else "a smaller step")
    return f"try {', or '.join(found)}"
