"""Ways to a tolerance: fixed steps halved and extrapolated, or steps that are controlled."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from analysis.data.agreement import needed
from analysis.data.checks import TimeLimitError, ToleranceError
from analysis.data.endings import FLAT, TIME_LIMIT
from analysis.data.state import FlatError
from mbs_models.columns import apart
from mbs_models.effort import HALVINGS
from mbs_models.extrapolation import CAUTION, ROUNDING, Ladder
from mbs_models.integrators import Integrator
from mbs_models.passes import Pass
from mbs_models.runs import EngineError
from mbs_models.scene import Scene

PATIENCE = 6
"""Halvings of the step in a row after which a disk that lies all but flat is given up."""

LATE = 5
"""Halvings after which fixed steps are looked at,"""

HOPELESS = 100.0
"""and the estimated error over the tolerance from which on they lead to nothing."""

FIRST_LOCAL = 1e-3
"""Part of the tolerance that the first run under step control allows in a step."""

LEAST_LOCAL = 1e-13
"""Local tolerance below which rounding decides."""

TIGHTENINGS = 8
"""Runs under step control."""

Run = Callable[[Integrator, float, int], Pass]
"""From an integrator, the longest step in s and the number of its halvings to a pass."""


def to_tolerance(
    scene: Scene, run: Run, integrator: Integrator, tolerance: float, *, may_change: bool
) -> tuple[Integrator, Pass, float]:
    """Halve the step and extrapolate until the estimated error is small enough.

    Parameters
    ----------
    scene : Scene
    run : callable
        From an integrator, the longest step in s and the number of its halvings to a pass.
    integrator : Integrator
    tolerance : float
        Largest error in beta and gamma in rad.
    may_change : bool
        Whether step control may take over where fixed steps lead to nothing.

    Returns
    -------
    integrator : Integrator
        What has led there.
    result : Pass
    estimate : float
        Estimated error in rad.

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
    late = LATE if may_change and not scene.has_constraints else HALVINGS
    for halvings in range(HALVINGS):
        if halvings == late and ladder.best_estimate > HOPELESS * tolerance:
            found = _by_step_control(run, tolerance, counts)
            if found is not None:
                return found
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
            return integrator, best, ladder.estimate
        if over:
            what = f"a step of {result.step:.3g} s"
            raise _time_is_over(result, what, tolerance, ladder.best_estimate)
        if ladder.stalled:
            break
    raise failure or ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {integrator.name} on formulation "
        f"{scene.built_as!r}: the best estimated error is {ladder.best_estimate:.1e} rad"
    )


def _by_step_control(
    run: Run, tolerance: float, counts: Counter[str]
) -> tuple[Integrator, Pass, float] | None:
    """Tighten the local tolerance tenfold until two runs agree, if they do."""
    local = FIRST_LOCAL * tolerance
    coarse: Pass | None = None
    for halvings in range(TIGHTENINGS):
        integrator = Integrator(name="DOPRI5", local_tolerance=max(local, LEAST_LOCAL))
        try:
            # Nor do two of them share their longest step: they would agree without being right.
            fine = run(integrator, np.inf, halvings)
        except (EngineError, FlatError):
            return None
        counts.update(fine.counts)
        if fine.ended == TIME_LIMIT:
            raise TimeLimitError(
                f"time limit met at t = {fine.times[-1]:.6g} s of a run with a local tolerance of "
                f"{local:.0e}, before runs agreed to {tolerance:g} rad"
            )
        if coarse is not None and (fine.ended, fine.times.size) == (
            coarse.ended,
            coarse.times.size,
        ):
            one, other = (np.column_stack((each.values, each.times)) for each in (fine, coarse))
            difference = apart(one, other, flat=fine.ended == FLAT)
            estimate = CAUTION * max(difference, ROUNDING)
            if estimate <= needed(tolerance, fine.ended == FLAT):
                return integrator, replace(fine, counts=counts), estimate
        if local < LEAST_LOCAL:
            return None
        coarse, local = fine, 0.1 * local
    return None


def _time_is_over(result: Pass, what: str, tolerance: float, best: float) -> TimeLimitError:
    return TimeLimitError(
        f"time limit met at t = {result.times[-1]:.6g} s of a run with {what}, before runs agreed "
        f"to {tolerance:g} rad; the best estimated error is {best:.1e} rad"
    )
