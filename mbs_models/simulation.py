"""Simulation of a scene in the engine, to a step size or to a tolerance."""

import numpy as np
import numpy.typing as npt

from analysis.data.checks import (
    TimeLimitError,
    ToleranceError,
    increasing_times,
    positive,
    switch,
)
from analysis.data.endings import (
    CONTACT_WOULD_PULL,
    TIME_LIMIT,
    Ending,
    StopWhen,
    named_conditions,
)
from analysis.data.friction import check_slipping
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Trajectory, versions
from analysis.data.watch import Progress, Watch
from mbs_models import columns
from mbs_models.advice import advice
from mbs_models.effort import simulation_effort
from mbs_models.extrapolation import FINEST
from mbs_models.integrators import Integrator, IntegratorName, find_integrator
from mbs_models.passes import Pass, one_pass
from mbs_models.runs import EngineError
from mbs_models.scene import Scene
from mbs_models.to_tolerance import to_tolerance


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

    Accuracy is asked for in one of two ways. With `step`, there is a single run. With
    `tolerance`, runs with steps halved again and again are extrapolated until the estimated
    error of beta and gamma is below it.

    A run ends where a bilateral contact would have to pull, where the disk lies flat, where it is
    told to, or at its time limit: the trajectory then holds fewer samples than asked for, the
    last one at the ending, and says why.

    Parameters
    ----------
    scene : Scene or Scenario
        A scenario stands for its default scene.
    times : array_like, shape (n,)
        Strictly increasing times in s; the motion starts at the first. Each stretch of evenly
        spaced times is one engine run, so even spacing is fastest.
    step : float, optional
        Largest step in s; shortened so that every sample falls on a step.
    tolerance : float, optional
        Largest error in beta and gamma in rad, and in s that of the time at which the motion ends
        by itself; 1e-8 if neither is given.
    integrator : Integrator or str, optional
        With its options, or the name of one of `integrators(scene.built_as)`; by default the
        first of them, and DOPRI5 where it can be taken and halving fixed steps leads to nothing.
        DOPRI5 takes its accuracy from `Integrator.local_tolerance`, and `step`
        only limits its steps.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there.
    allow_pulling : bool
        Go on where the contact pulls. Friction with the load "contact" rubs with none there;
        with the load "weight" it rubs under the weight as before.
    time_limit : float, optional
        Processor time in s after which the run ends with what it has reached.
    progress : callable, optional
        Called after each step with the time reached and the end of the run in s; a
        tolerance-controlled run passes over its times again and again.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If an argument is out of range, the run would take more than `MOST_STEPS`, or the start
        breaks a constraint or needs a contact that pulls.
    EngineError
        If the engine does not reach the end.
    FlatError
        If the disk comes so close to lying flat that the Euler angles cannot be followed.
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
    allow_pulling = switch("allow_pulling", allow_pulling)
    chosen = find_integrator(scene.built_as, integrator, constrained=scene.has_constraints)
    if step is not None and tolerance is not None:
        raise ValueError("give either step or tolerance, not both")
    if tolerance is not None and chosen.controls_step:
        raise ValueError(
            f"tolerance must be left out for integrator {chosen.name!r}, which has a "
            f"local_tolerance of its own, got {tolerance!r}"
        )
    if step is not None:
        step = positive("step", step)
    elif not chosen.controls_step:
        tolerance = positive("tolerance", 1e-8 if tolerance is None else tolerance)
    if tolerance is not None and tolerance < FINEST:
        raise ToleranceError(
            f"tolerance {tolerance:g} rad cannot be reached: rounding leaves {FINEST:g} rad"
        )
    told = None if integrator is None else chosen
    effort = simulation_effort(scene, times, told, step=step, tolerance=tolerance)
    effort.check()
    check_slipping(scene.scenario.friction)
    conditions = named_conditions(stop_when, scene.scenario.initial_state)
    watch = Watch(time_limit, progress, effort.most)

    def run(way: Integrator, largest: float, halvings: int = 0) -> Pass:
        return one_pass(
            scene,
            times,
            way,
            largest,
            halvings,
            stop_when=conditions,
            allow_pulling=allow_pulling,
            watch=watch,
        )

    estimate = None
    try:
        if tolerance is None:
            result = run(chosen, np.inf if step is None else step)
        else:
            chosen, result, estimate = to_tolerance(
                scene, run, chosen, tolerance, may_change=integrator is None
            )
    except (EngineError, ToleranceError, TimeLimitError) as error:
        raise type(error)(f"{error}; {advice(scene, chosen)}") from error
    return trajectory(scene, chosen, result, watch=watch, tolerance=tolerance, estimate=estimate)


def trajectory(
    scene: Scene,
    integrator: Integrator,
    result: Pass,
    *,
    watch: Watch | None = None,
    tolerance: float | None = None,
    estimate: float | None = None,
) -> Trajectory:
    """Trajectory from the samples of a pass."""
    ending = None
    if result.ended is not None:
        seconds = (watch or Watch()).seconds
        force = float(result.values[-1, columns.NORMAL_FORCE])
        values = {TIME_LIMIT: seconds, CONTACT_WOULD_PULL: force}
        value = values.get(result.ended, 0.0)
        ending = Ending(reason=result.ended, time=float(result.times[-1]), value=value)
    return Trajectory(
        times=result.times,
        coordinates=result.values[:, columns.COORDINATES],
        rates=result.values[:, columns.RATES],
        multipliers=result.values[:, columns.FORCES],
        scenario=scene.scenario,
        source="engine",
        method={
            "formulation": scene.built_as,
            **integrator.settings(),
            "step": result.step,
            "tolerance": tolerance,
        },
        error_estimate=estimate,
        counts=dict(result.counts),
        versions=versions("numpy", "exudyn"),
        ending=ending,
        pulling=result.pulling,
        solver_seconds=result.seconds,
    )
