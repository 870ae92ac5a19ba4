"""Compiled runs of many members alike in structure, as arrays from start to end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from analysis.compiled.code import Code
from analysis.compiled.library import heyoka
from analysis.compiled.places import Places
from analysis.compiled.systems import ALIVE, REASON, SIGN, SINGULAR, SPIN, WHEN
from analysis.data.agreement import error_at_ending, needed
from analysis.data.checks import Array
from analysis.data.endings import FLAT
from analysis.data.files import AnyArray
from analysis.data.members import Rows
from analysis.solve.stepping import Run
from analysis.solve.to_tolerance import CAUTION, ROUNDING, unreachable

Alone = Callable[[int, float, float, float], Run | Exception]
"""Runs one member with a local tolerance, a part of its longest step and so many steps at most."""

RUNNING = -1
"""In place of the number of an ending, of a motion that has none."""


@dataclass(frozen=True, slots=True, eq=False)
class Lot:
    """Members alike in structure, and how to run one of them alone.

    Parameters
    ----------
    code : Code
    form : str
    starts : ndarray, shape (m, d)
        States at the start.
    numbers : ndarray, shape (m, p)
        Parameters of the code.
    longest : ndarray, shape (m,)
        Longest step in s.
    most : ndarray, shape (m,)
        Steps after which a run is given up.
    alone : callable
        See `Alone`.
    """

    code: Code
    form: str
    starts: Array
    numbers: Array
    longest: Array
    most: Array
    alone: Alone


@dataclass(frozen=True, slots=True, eq=False)
class Reached:
    """What runs of m members have reached.

    Parameters
    ----------
    states : ndarray, shape (m, n, d)
        At the n times asked for; behind the end of a motion they mean nothing.
    last : ndarray, shape (m, d)
        At the end.
    ends : ndarray, shape (m,)
        Time of the end in s.
    reasons : ndarray of int, shape (m,)
        Numbers of the endings of the code, or `RUNNING`.
    steps : ndarray of int, shape (m,)
    """

    states: Array
    last: Array
    ends: Array
    reasons: Rows
    steps: Rows

    @classmethod
    def nothing(cls, members: int, times: Array, size: int) -> "Reached":
        """Room for the runs of so many members, of a state of this size."""
        return cls(
            np.empty((members, times.size, size)),
            np.empty((members, size)),
            np.full(members, times[-1]),
            np.full(members, RUNNING),
            np.zeros(members, dtype=int),
        )

    def part(self, rows: AnyArray) -> "Reached":
        """Those of some members."""
        return Reached(*(each[rows] for each in self.arrays))

    def put(self, rows: AnyArray, other: "Reached") -> None:
        """Put in what some members have reached."""
        for each, new in zip(self.arrays, other.arrays, strict=True):
            each[rows] = new

    @property
    def arrays(self) -> tuple[AnyArray, ...]:
        """All of it, one row for each member."""
        return self.states, self.last, self.ends, self.reasons, self.steps

    def run(self, row: int, times: Array, reasons: Sequence[str]) -> Run:
        """Run of one member; without what the condition says that has ended it."""
        if self.reasons[row] == RUNNING:
            return Run(times, self.states[row], int(self.steps[row]), None, ())
        count = int(np.searchsorted(times, self.ends[row], side="right"))
        reached, states = times[:count], self.states[row, :count]
        if self.ends[row] > reached[-1]:
            reached = np.append(reached, self.ends[row])
            states = np.vstack((states, self.last[row]))
        reason = reasons[self.reasons[row]]
        return Run(reached, states, int(self.steps[row]), reason, ())


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Runs of m members to a tolerance.

    Parameters
    ----------
    reached : Reached
    local_tolerances, estimates : ndarray, shape (m,)
        Of the run that is kept; its estimated error in rad, nan if there is none.
    failures : dict
        From members to the errors that ended them; their rows mean nothing.
    """

    reached: Reached
    local_tolerances: Array
    estimates: Array
    failures: dict[int, Exception]

    def part(self, rows: Rows) -> "Judged":
        """Those of some members, none of which has failed."""
        reached = self.reached.part(rows)
        return Judged(reached, self.local_tolerances[rows], self.estimates[rows], {})


def run_to(lot: Lot, times: Array, ladder: Sequence[float], tolerances: Array) -> Judged:
    """Run members with one local tolerance after the other until two runs of each agree.

    Parameters
    ----------
    lot : Lot
    times : ndarray, shape (n,)
    ladder : sequence of floats
        Local tolerances; one alone gives no estimate.
    tolerances : ndarray, shape (m,)
        Largest errors in beta and gamma in rad.
    """
    members = len(lot.starts)
    judged = Judged(
        Reached.nothing(members, times, lot.starts.shape[1]),
        np.full(members, ladder[0]),
        np.full(members, np.nan),
        {},
    )
    pending, coarse, longest = np.arange(members), judged.reached, 1.0
    steps = np.zeros(members, dtype=int)
    for rung, local in enumerate(ladder):
        fine, failures = run(lot, pending, times, local, longest)
        judged.failures.update(failures)
        steps[pending] += fine.steps
        if rung:
            judged.estimates[pending] = _estimates(fine, coarse, times, lot, pending)
        done = np.isin(pending, list(failures))
        if len(ladder) == 1:
            done[:] = True
        elif rung:
            flat = fine.reasons == lot.code.reasons.index(FLAT)
            done |= judged.estimates[pending] <= needed(tolerances[pending], flat)
        judged.local_tolerances[pending] = local
        if done.all() and pending.size == members:
            judged = replace(judged, reached=fine)
        elif done.any():
            judged.reached.put(pending[done], fine.part(done))
        if done.all():
            pending = pending[:0]
            break
        pending, coarse, longest = pending[~done], fine.part(~done), 0.8 * longest
    judged.reached.steps[:] = steps
    for member in pending.tolist():
        wanted, found = float(tolerances[member]), float(judged.estimates[member])
        judged.failures[member] = unreachable(wanted, "taylor", found)
    return judged


def _estimates(fine: Reached, coarse: Reached, times: Array, lot: Lot, members: Rows) -> Array:
    """Estimated errors of the finer runs of some members in rad; see `to_tolerance.compare`."""
    columns = slice(0, 2) if lot.form == "reduced" else slice(4, 6)
    grid = [np.searchsorted(times, each.ends, side="right") for each in (fine, coarse)]
    alike = (fine.reasons == coarse.reasons) & (grid[0] == grid[1])
    apart = np.abs(fine.states[:, :, columns] - coarse.states[:, :, columns]).max(axis=2)
    apart[np.arange(times.size) >= grid[0][:, None]] = 0.0
    apart_at_end = fine.last[:, columns] - coarse.last[:, columns]
    if lot.form == "reduced":
        spins = lot.numbers[members, SPIN]
        rates = np.column_stack((fine.last[:, 2], -spins * np.cos(fine.last[:, 0])))
    else:
        rates = fine.last[:, 10:12]
    # Where the disk lies flat, only the sum or the difference of alpha and gamma has a meaning.
    flat = fine.reasons == lot.code.reasons.index(FLAT)
    apart_at_end[flat, 1] = 0.0
    rates = np.where(flat[:, None] & [False, True], 0.0, rates)
    worst = np.maximum(
        apart.max(axis=1), error_at_ending(apart_at_end, fine.ends - coarse.ends, rates)
    )
    return np.where(alike, np.maximum(CAUTION * worst, ROUNDING), np.inf)


def run(
    lot: Lot, rows: Rows, times: Array, local_tolerance: float, longest: float
) -> tuple[Reached, dict[int, Exception]]:
    """Run some members of a lot once, in batches.

    Parameters
    ----------
    lot : Lot
    rows : ndarray of int, shape (k,)
        Its members.
    times : ndarray, shape (n,)
    local_tolerance : float
    longest : float
        Part of their longest steps that may be taken.

    Returns
    -------
    Reached
        Of those members.
    dict
        From members to the errors that ended them.
    """
    found = Reached.nothing(rows.size, times, lot.starts.shape[1])
    failed: list[int] = []
    places = Places()
    with lot.code.integrator(local_tolerance, batch=True) as solver:
        width = solver.batch_size
        # A batch that is not full repeats its last member.
        padded = np.append(rows, np.repeat(rows[-1:], -rows.size % width))
        starts, numbers = lot.starts[padded], lot.numbers[padded]
        numbers[:, SIGN] = lot.code.signs(starts, numbers)
        states = np.ascontiguousarray(starts.T)
        parameters = np.ascontiguousarray(numbers[:, : len(solver.pars)].T)
        steps = (longest * lot.longest[padded]).tolist()
        grid = np.ascontiguousarray(np.broadcast_to(times[:, None], (times.size, width)))
        for first in range(0, rows.size, width):
            some = slice(first, first + width)
            solver.set_time(float(times[0]))
            solver.state[:] = states[:, some]
            solver.pars[:] = parameters[:, some]
            solver.reset_cooldowns()
            propagate = partial(solver.propagate_grid, grid, max_delta_t=steps[some])
            most = int(lot.most[padded[some]].max())
            _, samples = places.call(partial(propagate, max_steps=most))
            failed += _take(found, solver, samples, first, lot.code.reasons)
    errors: dict[int, Exception] = {}
    for row in failed:
        member = int(rows[row])
        alone = lot.alone(member, local_tolerance, longest, float(lot.most[member]))
        if isinstance(alone, Exception):
            errors[member] = alone
        else:
            _put(found, row, alone, times, lot.code.reasons)
    return found, errors


def _take(
    found: Reached, solver: Any, samples: Array, first: int, reasons: Sequence[str]
) -> list[int]:
    """Take over what a batch has reached; returns the rows that have failed."""
    count = min(solver.batch_size, len(found.ends) - first)
    rows = slice(first, first + count)
    results = solver.propagate_res
    complete = heyoka().taylor_outcome.time_limit
    if any(each[0] != complete for each in results):
        # What went wrong in one of them must not touch the others.
        return list(range(first, first + count))
    # As a matrix, for a sixth of the time.
    flat = samples.reshape(-1, solver.batch_size).T
    found.states.reshape(len(found.ends), -1)[rows] = flat[:count]
    found.last[rows] = solver.state.T[:count]
    found.steps[rows] = [each[3] for each in results[:count]]
    alive = solver.pars[ALIVE, :count]
    if np.count_nonzero(alive) == count:
        return []
    ended = np.flatnonzero(alive == 0.0)
    found.ends[first + ended] = solver.pars[WHEN, ended]
    found.reasons[first + ended] = solver.pars[REASON, ended]
    why = [reasons[number] for number in found.reasons[rows].tolist()]
    return [first + row for row in ended.tolist() if why[row] == SINGULAR]


def _put(found: Reached, row: int, alone: Run, times: Array, reasons: Sequence[str]) -> None:
    """Put in what one member has reached alone."""
    count = int(np.searchsorted(times, alone.times[-1], side="right"))
    found.states[row, :count] = alone.states[:count]
    found.last[row], found.ends[row] = alone.states[-1], alone.times[-1]
    found.steps[row] = alone.evaluations
    found.reasons[row] = RUNNING if alone.ended is None else reasons.index(alone.ended)
