"""Runs on the engine's own accelerations, stepped by SciPy's solvers."""

import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from math import inf

import exudyn as exu

from analysis.data.checks import Array, TimeLimitError
from analysis.data.endings import Condition
from analysis.data.watch import Watch
from analysis.solve.stepping import Run, SolverError, integrate
from analysis.solve.to_tolerance import run_to, tighter_and_tighter
from mbs_models.accelerations import AccelerationProblem
from mbs_models.integrators import FINEST_LOCAL, Integrator
from mbs_models.probe import SingularError
from mbs_models.runs import EngineError
from mbs_models.sampled import Reached, Sampled
from mbs_models.scene import Scene
from mbs_models.solving import solving

QUICK = 3e-12
"""Error in a step from which on accelerations may be noisier."""

FINE = 3e-9
"""Tolerance in rad from which on a first run allows a step less of it."""


def stepped(
    scene: Scene,
    times: Array,
    integrator: Integrator,
    tolerance: float | None,
    *,
    longest: float = inf,
    stop_when: Mapping[str, Condition] | None = None,
    allow_pulling: bool = False,
    watch: Watch | None = None,
) -> Reached:
    """Step a scene's accelerations over all times.

    Parameters
    ----------
    scene : Scene
    times : ndarray, shape (n,)
        In s.
    integrator : Integrator
        One that steps accelerations. What it says of a local tolerance holds where no tolerance
        is given.
    tolerance : float or None
        Largest error of beta and gamma in rad, kept by runs that agree.
    longest : float
        Longest step in s.
    stop_when : mapping, optional
        Conditions by the reason that they give.
    allow_pulling : bool
    watch : Watch, optional

    Returns
    -------
    Reached
        Its integrator has the local tolerance that has led there.

    Raises
    ------
    ValueError
        If the start breaks a constraint, or needs a contact that pulls.
    EngineError
        If the solver gives up.
    ToleranceError, TimeLimitError
        If no two runs agree, for their noise or in time.
    """
    watch, counts = watch or Watch(), Counter[str]()
    begin = time.process_time()
    motion = AccelerationProblem(scene, stop_when or {})
    motion.check_start()
    problem = motion.initial_value_problem
    problem = replace(problem, longest_step=min(longest, problem.longest_step))
    built = time.process_time()

    def run(local: float, part: float) -> Run:
        motion.quick = local >= QUICK
        found = integrate(
            problem.with_steps_up_to(part),
            times,
            integrator.method,
            local,
            allow_pulling=allow_pulling,
            watch=watch,
        )
        counts.update(steps=found.steps, right_hand_sides=found.evaluations)
        return found

    estimate, local = None, integrator.local_tolerance
    try:
        with solving(motion.model.system):
            if tolerance is None:
                found = run(local or FINEST_LOCAL, 1.0)
            else:
                # The error of a motion falls more slowly than that of a step.
                first = tolerance / (3.0 if tolerance > FINE else 20.0)
                rungs = tighter_and_tighter(first, FINEST_LOCAL)
                found, local, estimate = run_to(
                    run, problem, times, tolerance, rungs, method=integrator.name
                )
            values = motion.samples(found.states)
            # The first sample is the start itself, without the rounding on the way there.
            values[0, :12] = scene.scenario.initial_state.vector
    except (SolverError, SingularError, exu.ExudynError) as error:
        cause = str(error).split(" [Python file")[0].strip().splitlines()[0]
        raise EngineError(f"run on the engine's accelerations: {cause}") from error
    if len(values) < 2:
        raise TimeLimitError("time limit met before the first sample after the start")
    result = Sampled(
        times=found.times,
        values=values,
        step=longest,
        counts=counts,
        setup_seconds=built - begin,
        seconds=time.process_time() - built,
        ended=found.ended,
        pulling=found.pulling,
    )
    return Reached(result, replace(integrator, local_tolerance=local), estimate)
