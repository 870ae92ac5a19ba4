"""Runs to a tolerance: the local tolerance is tightened until two runs agree."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from analysis.motion.endings import FLAT, TIME_LIMIT
from analysis.motion.files import AnyArray
from analysis.problem.checks import Array, TimeLimitError, ToleranceError
from analysis.problem.elementary import Rows
from analysis.problem.limits import LEAST_TILT
from analysis.solve.stepping import InitialValueProblem, Run

ROUNDING = 1e-14
"""Error in rad that no run is free of, not even one that stands still."""

CAUTION = 2.0
"""Estimated error over the difference of two runs that it is taken from."""

COARSEST = 1e-5
"""Error in a step from which on runs take the longest steps there are, whatever is asked for."""

SHORTER = 0.8
"""Part of the longest step that the next run may take: not both may take the longest there are."""

LEAST_RATE = 1.0
"""Rate in rad/s by which a difference in the time of an ending counts at least."""


@dataclass(frozen=True, slots=True, eq=False)
class Runs:
    """What runs of m members have reached.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Asked for, in s.
    states : ndarray, shape (m, n + 1, d)
        At these times, and at the end; behind the end of a motion they mean nothing.
    ends : ndarray, shape (m,)
        Time of the end in s.
    reasons : ndarray of object, shape (m,)
        Why it ended before the last time asked for, or None.
    steps : ndarray of int, shape (m,)
        Or evaluations of the right-hand side, by solvers that count these.
    pulling : ndarray of object, shape (m,)
        Times in s between which the contact has pulled, or None.
    seconds : ndarray, shape (m,)
        Processor time of each run in s; nan if it is not known.
    local_tolerances, estimates : ndarray, shape (m,)
        Of each run; its estimated error in rad, nan if there is none.
    """

    times: Array
    states: Array
    ends: Array
    reasons: AnyArray
    steps: Rows
    pulling: AnyArray
    seconds: Array
    local_tolerances: Array
    estimates: Array

    @classmethod
    def empty(cls, members: int, times: Array, size: int) -> "Runs":
        """Room for the runs of so many members, of a state of this size."""
        return cls(
            times,
            np.empty((members, times.size + 1, size)),
            np.full(members, times[-1]),
            np.full(members, None),
            np.zeros(members, dtype=int),
            np.full(members, None),
            *np.full((3, members), np.nan),
        )

    @classmethod
    def of(cls, run: Run, times: Array) -> "Runs":
        """The run of one member; behind its end its last state is repeated."""
        rows = np.minimum(np.arange(times.size + 1), run.times.size - 1)
        found = cls.empty(1, times, run.states.shape[1])
        found.states[0], found.ends[0] = run.states[rows], run.times[-1]
        found.reasons[0], found.pulling[0] = run.ended, run.pulling
        found.steps[0], found.seconds[0] = run.evaluations, run.seconds
        return found

    @property
    def last(self) -> Array:
        """States at the end, shape (m, d)."""
        return self.states[:, -1]

    @property
    def counts(self) -> Rows:
        """Number of samples up to each end, shape (m,)."""
        return np.searchsorted(self.times, self.ends, side="right")

    def ended(self, reason: str | None) -> AnyArray:
        """Whether each run ended for this reason, or none, shape (m,)."""
        return self.reasons == reason

    def subset(self, rows: AnyArray) -> "Runs":
        """Those of some members."""
        return Runs(self.times, *(each[rows] for each in self.arrays))

    def put(self, rows: AnyArray, other: "Runs") -> None:
        """Put in those of some members."""
        for each, new in zip(self.arrays, other.arrays, strict=True):
            each[rows] = new

    @property
    def arrays(self) -> tuple[AnyArray, ...]:
        """All of it, one row for each member."""
        return tuple(getattr(self, field.name) for field in fields(self)[1:])

    def cut_to_samples(self, rows: AnyArray) -> None:
        """Let these runs, shape (m,), end at the last of the times asked for that they reached."""
        for row in np.flatnonzero(rows).tolist():
            last = self.counts[row] - 1
            self.ends[row], self.last[row] = self.times[last], self.states[row, last]

    def run(self, row: int) -> Run:
        """Run of one member."""
        count, end = int(self.counts[row]), float(self.ends[row])
        times, states = self.times[:count], self.states[row, :count]
        if end > times[-1]:
            times = np.append(times, end)
            states = self.states[row, [*range(count), -1]]
        pulling = self.pulling[row] or ()
        return Run(
            times,
            states,
            int(self.steps[row]),
            self.reasons[row],
            # A time limit may have cut it off.
            tuple((since, min(until, end)) for since, until in pulling if since < end),
            seconds=float(self.seconds[row]),
            local_tolerance=float(self.local_tolerances[row]),
            estimate=float(self.estimates[row]),
        )


def agree(
    run: Callable[[Rows, float, float], tuple[Runs, dict[int, Exception]]],
    estimated: Callable[[Runs, Runs, Rows], Array],
    members: int,
    tolerance: float,
    local_tolerances: Sequence[float],
    *,
    method: str,
) -> tuple[Runs, dict[int, Exception]]:
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

    Returns
    -------
    Runs
        The last one of each member, with the steps of all.
    dict
        From members to the errors that ended them; their runs mean nothing.
    """
    pending, longest = np.arange(members), 1.0
    failures: dict[int, Exception] = {}
    kept: Runs | None = None
    coarse: Runs | None = None
    for local in local_tolerances:
        fine, failed = run(pending, local, longest)
        fine.local_tolerances[:] = local
        done = np.full(pending.size, len(local_tolerances) == 1)
        limited = fine.ended(TIME_LIMIT)
        if coarse is not None:
            fine.steps[:] += coarse.steps
            fine.estimates[:] = estimated(fine, coarse, pending)
            done = fine.estimates <= needed(tolerance, fine.ended(FLAT))
            fine.cut_to_samples(limited & done)
        for row in np.flatnonzero(limited & ~done).tolist():
            failed[int(pending[row])] = TimeLimitError(
                f"time limit met at t = {fine.ends[row]:.6g} s of a run before two runs agreed to "
                f"{tolerance:g} rad"
            )
        failures |= failed
        if failed:
            done |= np.isin(pending, list(failed))
        if kept is None or (done.all() and pending.size == members):
            kept = fine
        elif done.any():
            kept.put(pending[done], fine.subset(done))
        if done.all():
            break
        coarse = fine.subset(~done) if done.any() else fine
        pending, longest = pending[~done], SHORTER * longest
    else:
        assert coarse is not None
        for member, estimate in zip(pending.tolist(), coarse.estimates.tolist(), strict=True):
            failures[member] = ToleranceError(
                f"tolerance {tolerance:g} rad cannot be reached with {method}: the "
                f"estimated error of the tightest run is {estimate:.1e} rad"
            )
    assert kept is not None
    return kept, failures


def estimated_errors(
    fine: Runs, coarse: Runs, angles: slice | Sequence[int], rates: Callable[[Runs], Array]
) -> Array:
    """Estimated errors of the finer runs of k members in rad, as far as they can be judged.

    The error in beta and gamma, and in the time of an ending, is infinite if two do not end alike.

    Parameters
    ----------
    fine, coarse : Runs
    angles : slice or sequence of int
        Columns of the states that hold beta and gamma.
    rates : callable
        From the finer runs to the rates of beta and gamma at their ends, shape (k, 2).
    """
    counts, others = fine.counts, coarse.counts
    limited, flat = fine.ended(TIME_LIMIT), fine.ended(FLAT)
    reached = (counts > 1) & (counts <= others)
    alike = np.where(limited, reached, fine.reasons == coarse.reasons)
    apart = np.abs(fine.states[..., angles] - coarse.states[..., angles]).max(axis=2)
    # One of two endings may come before a sample, and the other one after it.
    apart[np.arange(apart.shape[1]) >= np.minimum(counts, others)[:, None]] = 0.0
    worst = apart.max(axis=1)
    ended = ~fine.ended(None) & ~limited
    if ended.any():
        # On a flat disk only the sum or the difference of alpha and gamma has a meaning.
        meant = ~(flat[:, None] & [False, True])
        at_end = meant * (fine.last - coarse.last)[:, angles]
        late = error_at_ending(at_end, fine.ends - coarse.ends, meant * rates(fine))
        worst = np.where(ended, np.maximum(worst, late), worst)
    return np.where(alike, np.maximum(CAUTION * worst, ROUNDING), np.inf)


def error_at_ending(
    apart: npt.ArrayLike, time_apart: npt.ArrayLike, rates: npt.ArrayLike
) -> Array:
    """Difference of two runs where each ends by itself, its time included.

    A condition that ends a run fixes the state there, so that the states of two endings agree
    however far apart their times are. The later of the two states is at most this far from the
    earlier run at the same time.

    Parameters
    ----------
    apart : array_like, shape (..., k)
        Differences of beta and gamma between the two endings in rad.
    time_apart : array_like, shape (...)
        Difference of their times in s.
    rates : array_like, shape (..., k)
        Rates of beta and gamma at an ending in rad/s; `LEAST_RATE` where they are smaller, so
        that the time is as accurate as the angles where these stand still.

    Returns
    -------
    ndarray, shape (...)
        In rad.
    """
    moved = np.maximum(np.abs(rates), LEAST_RATE) * np.abs(time_apart)[..., None]
    return np.max(np.abs(apart) + moved, axis=-1)


def needed(tolerance: npt.ArrayLike, flat: npt.ArrayLike) -> Array:
    """Largest errors in rad of runs that are asked for to a tolerance.

    A disk that is said to lie flat has to be told from one that passes by.

    Parameters
    ----------
    tolerance : array_like, shape (...)
        In rad.
    flat : array_like of bool, shape (...)
        Whether a run ends where the disk lies flat.
    """
    return np.where(flat, np.minimum(tolerance, LEAST_TILT), tolerance)


def run_to(
    run: Callable[[float, float], Run],
    problem: InitialValueProblem,
    times: Array,
    tolerance: float,
    local_tolerances: Sequence[float],
    *,
    method: str,
) -> Run:
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

    Raises
    ------
    TimeLimitError
        If the time limit is met before two runs agree.
    ToleranceError
        If not even the last two do.
    """

    def rates(runs: Runs) -> Array:
        change = np.asarray(problem.right_hand_side(float(runs.ends[0]), runs.last[0]))
        return change[None, problem.angles]

    def alone(_: Rows, local: float, longest: float) -> tuple[Runs, dict[int, Exception]]:
        return Runs.of(run(local, longest), times), {}

    def estimated(fine: Runs, coarse: Runs, _: Rows) -> Array:
        return estimated_errors(fine, coarse, problem.angles, rates)

    found, failures = agree(alone, estimated, 1, tolerance, local_tolerances, method=method)
    for failure in failures.values():
        raise failure
    return found.run(0)


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
