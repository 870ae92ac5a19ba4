"""Runs to a tolerance: the local tolerance is tightened until two runs agree."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.data.agreement import error_at_ending, needed
from analysis.data.checks import Array, TimeLimitError, ToleranceError
from analysis.data.endings import FLAT, TIME_LIMIT
from analysis.data.members import Rows
from analysis.solve.runs import RUNNING, Runs
from analysis.solve.stepping import InitialValueProblem, Run, endings

ROUNDING = 1e-14
"""Error in rad that no run is free of, not even one that stands still."""

CAUTION = 2.0
"""Estimated error over the difference of two runs that it is taken from."""

COARSEST = 1e-5
"""Error in a step from which on runs take the longest steps there are, whatever is asked for."""

SHORTER = 0.8
"""Part of the longest step that the next run may take: not both may take the longest there are."""

_MOMENT = 1e-7
"""Time in s over which rates are told by a difference."""


@dataclass(frozen=True, slots=True, eq=False)
class Agreed:
    """Runs of m members to a tolerance.

    Parameters
    ----------
    runs : Runs
    local_tolerances, estimates : ndarray, shape (m,)
        Of the run that is kept; its estimated error in rad, nan if there is none.
    failures : dict
        From members to the errors that ended them; their rows mean nothing.
    """

    runs: Runs
    local_tolerances: Array
    estimates: Array
    failures: dict[int, Exception]

    def part(self, rows: Rows) -> "Agreed":
        """Those of some members, none of which has failed."""
        return Agreed(self.runs.part(rows), self.local_tolerances[rows], self.estimates[rows], {})


def agree(
    run: Callable[[Rows, float, float], tuple[Runs, dict[int, Exception]]],
    estimated: Callable[[Runs, Runs, Rows], Array],
    members: int,
    tolerance: float,
    local_tolerances: Sequence[float],
    *,
    method: str,
) -> Agreed:
    """Run members with one local tolerance after the other until two runs of each agree.

    Parameters
    ----------
    run : callable
        From some of the members, a local tolerance and a part of the longest step to their runs,
        and from members to the errors that ended them.
    estimated : callable
        From two runs of some members, the finer one first, and these to the estimated errors of
        the finer one; see `estimated_errors`.
    members : int
        Number of them.
    tolerance : float
        Largest error in beta and gamma in rad.
    local_tolerances : sequence of floats
        In turn; see `tighter_and_tighter`. One alone gives no estimate.
    method : str
        What runs, for messages.
    """
    pending, steps, longest = np.arange(members), np.zeros(members, dtype=int), 1.0
    used, estimates = np.zeros(members), np.full(members, np.nan)
    failures: dict[int, Exception] = {}
    kept: Runs | None = None
    coarse: Runs | None = None
    for local in local_tolerances:
        fine, failed = run(pending, local, longest)
        used[pending], steps[pending] = local, steps[pending] + fine.steps
        done = np.full(pending.size, len(local_tolerances) == 1)
        if coarse is not None:
            estimates[pending] = estimated(fine, coarse, pending)
            done = estimates[pending] <= needed(tolerance, fine.ended(FLAT))
        limited = fine.ended(TIME_LIMIT)
        for row in np.flatnonzero(limited & ~done).tolist():
            failed[int(pending[row])] = _in_time(fine.ends[row], tolerance)
        if coarse is not None and limited.any():
            fine.cut_to_samples(limited & done)
        if failed:
            failures |= failed
            done |= np.isin(pending, list(failed))
        if kept is None or (done.all() and pending.size == members):
            kept = fine
        elif done.any():
            kept.put(pending[done], fine.part(done))
        if done.all():
            break
        coarse = fine.part(~done) if done.any() else fine
        pending, longest = pending[~done], SHORTER * longest
    else:
        for member in pending.tolist():
            failures[member] = ToleranceError(
                f"tolerance {tolerance:g} rad cannot be reached with {method}: the "
                f"estimated error of the tightest run is {estimates[member]:.1e} rad"
            )
    assert kept is not None
    return Agreed(replace(kept, steps=steps), used, estimates, failures)


def _in_time(moment: float, tolerance: float) -> TimeLimitError:
    return TimeLimitError(
        f"time limit met at t = {moment:.6g} s of a run before two runs agreed to "
        f"{tolerance:g} rad"
    )


def estimated_errors(
    fine: Runs,
    coarse: Runs,
    attitudes: Callable[[Array], Array],
    rates: Callable[[Runs], Array],
) -> Array:
    """Estimated errors of the finer runs of k members in rad, as far as they can be judged.

    The error in beta and gamma, and in the time of an ending, is infinite if two do not end alike.

    Parameters
    ----------
    fine, coarse : Runs
    attitudes : callable
        From states, shape (..., d), to beta and gamma, shape (..., 2).
    rates : callable
        From the finer runs to the rates of beta and gamma at their ends, shape (k, 2).
    """
    counts, others = fine.counts, coarse.counts
    limited, flat = fine.ended(TIME_LIMIT), fine.ended(FLAT)
    alike = (fine.reasons == coarse.reasons) & (counts == others)
    alike = np.where(limited, (counts > 1) & (counts <= others), alike)
    apart = np.abs(attitudes(fine.states) - attitudes(coarse.states)).max(axis=2)
    apart[np.arange(apart.shape[1]) >= counts[:, None]] = 0.0
    worst = apart.max(axis=1)
    ended = (fine.reasons != RUNNING) & ~limited
    if ended.any():
        # On a flat disk only the sum or the difference of alpha and gamma has a meaning.
        meant = ~(flat[:, None] & [False, True])
        at_end = meant * (attitudes(fine.last) - attitudes(coarse.last))
        late = error_at_ending(at_end, fine.ends - coarse.ends, meant * rates(fine))
        worst = np.where(ended, np.maximum(worst, late), worst)
    return np.where(alike, np.maximum(CAUTION * worst, ROUNDING), np.inf)


def run_to(
    run: Callable[[float, float], Run],
    problem: InitialValueProblem,
    times: Array,
    tolerance: float,
    local_tolerances: Sequence[float],
    *,
    method: str,
) -> tuple[Run, float, float]:
    """Run a problem with one local tolerance after the other until two runs agree.

    Parameters
    ----------
    run : callable
        From a local tolerance and a part of the longest step to a run.
    problem : InitialValueProblem
        What is run.
    times : ndarray, shape (n,)
        At which it is sampled.
    tolerance, local_tolerances, method
        As in `agree`.

    Returns
    -------
    run : Run
    local_tolerance : float
        That of this run.
    estimate : float
        Its estimated error in rad.

    Raises
    ------
    TimeLimitError
        If the time limit is met before two runs agree.
    ToleranceError
        If not even the last two do.
    """
    reasons = (*endings(problem), TIME_LIMIT)

    def rates(runs: Runs) -> Array:
        change = problem.right_hand_side(float(runs.ends[0]), runs.last[0])
        moved = runs.last + _MOMENT * np.asarray(change)
        return (problem.attitudes(moved) - problem.attitudes(runs.last)) / _MOMENT

    def alone(_: Rows, local: float, longest: float) -> tuple[Runs, dict[int, Exception]]:
        runs = Runs.empty(1, times, problem.start.size, reasons)
        runs.put_run(0, run(local, longest))
        return runs, {}

    def estimated(fine: Runs, coarse: Runs, _: Rows) -> Array:
        return estimated_errors(fine, coarse, problem.attitudes, rates)

    found = agree(alone, estimated, 1, tolerance, local_tolerances, method=method)
    for failure in found.failures.values():
        raise failure
    return found.runs.run(0), float(found.local_tolerances[0]), float(found.estimates[0])


def tighter_and_tighter(first: float, tightest: float) -> list[float]:
    """Local tolerances of the runs to a tolerance, in turn, none below the tightest.

    Two runs of nearly the same one would agree without being right.
    """
    local = max(min(first, COARSEST), 10.0 * tightest)
    tolerances = [local]
    while local >= 3.0 * tightest:
        local /= 10.0
        tolerances.append(max(local, tightest))
    return tolerances
