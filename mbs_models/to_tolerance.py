"""The way of the engine's own integrators to a tolerance: fixed steps halved and extrapolated."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from analysis.data.agreement import needed
from analysis.data.checks import TimeLimitError, ToleranceError
from analysis.data.endings import FLAT, TIME_LIMIT
from analysis.data.state import FlatError
from mbs_models.effort import HALVINGS, LATE
from mbs_models.extrapolation import Ladder
from mbs_models.integrators import Integrator
from mbs_models.runs import EngineError
from mbs_models.sampled import Reached, Sampled
from mbs_models.scene import Scene

PATIENCE = 6
"""Halvings of the step in a row after which a disk that lies all but flat is given up."""

HOPELESS = 100.0
"""Estimated error over the tolerance from which on fixed steps lead to nothing."""

Run = Callable[[Integrator, float, int], Sampled]
"""From an integrator, the longest step in s and the number of its halvings to a motion."""


def to_tolerance(
    scene: Scene,
    run: Run,
    integrator: Integrator,
    tolerance: float,
    otherwise: Callable[[], Reached | None] | None = None,
) -> Reached:
    """Halve the step and extrapolate until the estimated error is small enough.

    Parameters
    ----------
    scene : Scene
    run : callable
        From an integrator, the longest step in s and the number of its halvings to a motion.
    integrator : Integrator
    tolerance : float
        Largest error in beta and gamma in rad.
    otherwise : callable, optional
        What is tried where fixed steps lead to nothing; it may come to nothing as well.

    Raises
    ------
    EngineError, FlatError, ToleranceError, TimeLimitError
        See `mbs_models.simulate`.
    """
    empty = partial(Ladder, scene.built_as, integrator.name, scene.scenario.slip_decay)
    ladder = empty()
    counts: Counter[str] = Counter()
    failure: EngineError | FlatError | None = None
    kind: tuple[str | None, int] = (None, 0)
    flat = 0
    for halvings in range(HALVINGS):
        if (
            otherwise is not None
            and halvings == LATE
            and ladder.best_estimate > HOPELESS * tolerance
            and (found := otherwise()) is not None
        ):
            return found._replace(result=found.result.with_work(counts))
        try:
            result = run(integrator, integrator.first_step, halvings)
        except (EngineError, FlatError) as error:
            # A step too long for the iteration is no failure of the tolerance: halve it.
            flat = flat + 1 if isinstance(error, FlatError) else 0
            if flat == PATIENCE:
                raise
            failure, ladder = error, empty()
            continue
        failure = None
        counts.update(result.counts)
        over = result.ended == TIME_LIMIT
        if not over and kind != (result.ended, result.times.size):
            # Runs that end elsewhere are not to be compared.
            kind = (result.ended, result.times.size)
            ladder = empty(flat=result.ended == FLAT)
        ladder.add(result.values, result.times, result.step)
        if ladder.estimate <= needed(tolerance, result.ended == FLAT):
            best = replace(result, times=ladder.best_times, values=ladder.best, counts=counts)
            return Reached(best, integrator, ladder.estimate)
        if over:
            what = f"a step of {result.step:.3g} s"
            raise _time_is_over(result, what, tolerance, ladder.best_estimate)
        if ladder.stalled:
            break
    raise failure or ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {integrator.name} on formulation "
        f"{scene.built_as!r}: the best estimated error is {ladder.best_estimate:.1e} rad"
    )


def _time_is_over(result: Sampled, what: str, tolerance: float, best: float) -> TimeLimitError:
    return TimeLimitError(
        f"time limit met at t = {result.times[-1]:.6g} s of a run with {what}, before runs agreed "
        f"to {tolerance:g} rad; the best estimated error is {best:.1e} rad"
    )
