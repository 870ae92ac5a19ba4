"""Runs on the engine's own accelerations, stepped by SciPy's solvers."""

import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from analysis.data.checks import Array, TimeLimitError
from analysis.data.endings import Condition
from analysis.data.watch import Watch
from analysis.solve.stepping import Run, integrate
from analysis.solve.to_tolerance import run_to, tighter_and_tighter
from mbs_models.accelerations import AccelerationProblem
from mbs_models.integrators import FINEST_LOCAL, Integrator
from mbs_models.sampled import Sampled
from mbs_models.scene import Scene
from mbs_models.solving import stepping

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
    longest: float,
    stop_when: Mapping[str, Condition],
    allow_pulling: bool,
    watch: Watch,
    counts: Counter[str],
) -> Sampled:
    """Step a scene's accelerations over all times, to a tolerance if there is one.

    The arguments are those of `mbs_models.simulate`, with an integrator that steps accelerations,
    whose local tolerance holds where no tolerance is given. The work is added to `counts`. The
    integrator of what is returned has the local tolerance that has led there.
    """
    motion = AccelerationProblem(scene, stop_when)
    motion.check_start()
    problem = motion.initial_value_problem
    problem = replace(problem, longest_step=min(longest, problem.longest_step))
    begin = time.process_time()

    def run(local: float, part: float) -> Run:
        motion.quick = local >= QUICK
        shortened, name = problem.with_steps_up_to(part), integrator.method
        found = integrate(shortened, times, name, local, allow_pulling=allow_pulling, watch=watch)
        counts.update(steps=found.steps, right_hand_sides=found.evaluations)
        return found

    estimate, local = None, integrator.local_tolerance
    with stepping(motion.model.system):
        if tolerance is None:
            found = run(local or FINEST_LOCAL, 1.0)
        else:
            # The error of a motion falls more slowly than that of a step.
            first = tolerance / (3.0 if tolerance > FINE else 20.0)
            rungs = tighter_and_tighter(first, FINEST_LOCAL)
            found, local, estimate = run_to(run, problem, tolerance, rungs, integrator.name)
        values = motion.samples(found.states)
    # The first sample is the start itself, without the rounding on the way there.
    values[0, :12] = scene.scenario.initial_state.vector
    if len(values) < 2:
        raise TimeLimitError("time limit met before the first sample after the start")
    return Sampled(
        times=found.times,
        values=values,
        integrator=replace(integrator, local_tolerance=local),
        step=longest,
        seconds=time.process_time() - begin,
        ended=found.ended,
        pulling=found.pulling,
        estimate=estimate,
    )
