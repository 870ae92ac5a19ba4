"""Compiled runs of members alike in structure, as arrays; a single run is a batch of one."""

import time
from collections.abc import Callable
from dataclasses import dataclass, fields
from math import asin, sin
from typing import Any

import numpy as np

from analysis.motion.endings import TIME_LIMIT
from analysis.motion.files import AnyArray
from analysis.problem.checks import Array
from analysis.problem.elementary import Rows
from analysis.simulation.compiled.code import Code
from analysis.simulation.compiled.library import heyoka
from analysis.simulation.compiled.systems import ALIVE, REASON, WHEN
from analysis.solve.to_tolerance import Runs
from analysis.solve.watch import Watch, intervals


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Members alike in structure.

    Parameters
    ----------
    code : Code
    rows : ndarray of int, shape (m,)
        Numbers of the members.
    starts : ndarray, shape (m, d)
        States at the start.
    numbers : ndarray, shape (m, p)
        Parameters of the code.
    longest : ndarray, shape (m,)
        Longest step in s.
    most : ndarray, shape (m,)
        Steps after which a run is given up.
    pulled : ndarray of bool, shape (m,)
        Whether the contact seems to pull at the start.
    """

    code: Code
    rows: Rows
    starts: Array
    numbers: Array
    longest: Array
    most: Array
    pulled: AnyArray

    def __len__(self) -> int:
        return len(self.starts)

    def subset(self, rows: AnyArray) -> "Group":
        """Some of the members."""
        arrays = (getattr(self, field.name)[rows] for field in fields(self)[1:])
        return Group(self.code, *arrays)


def integrate(
    group: Group,
    members: Rows,
    times: Array,
    local_tolerance: float,
    step_fraction: float,
    *,
    watch: Watch | None = None,
) -> tuple[Runs, dict[int, Exception]]:
    """Run some members of a group once.

    Parameters
    ----------
    group : Group
    members : ndarray of int, shape (k,)
    times : ndarray, shape (n,)
    local_tolerance : float
    step_fraction : float
        Of their longest steps that may be taken.
    watch : Watch, optional
        Of a call that has this one member.

    Returns
    -------
    Runs
        Of those members.
    dict
        From members to the errors that ended them; their runs mean nothing.
    """
    begun = time.thread_time()
    code, begin, end = group.code, float(times[0]), float(times[-1])
    width = code.width if watch is None else 1
    # A batch that is not full repeats its last member.
    size = members.size + -members.size % width
    lanes = members[np.minimum(np.arange(size), members.size - 1)]
    longest, grid = (step_fraction * group.longest[lanes]).tolist(), np.repeat(times, width)
    found = Runs.empty(members.size, times, code.size)
    failed, errors = list[int](), dict[int, Exception]()
    with code.integrator(local_tolerance, width) as (solver, edges):
        for first in range(0, members.size, width):
            some = slice(first, first + width)
            _start(solver, edges, group, lanes[some], begin)
            limit = watch or Watch(most=float(group.most[lanes[some]].max()))
            _, samples = solver.propagate_grid(
                grid.reshape(-1, width),
                max_delta_t=longest[some],
                max_steps=limit.steps_left,
                callback=_interruption(limit, end),
            )
            failed += _take(found, code.reasons, solver, samples, first)
            if code.structure.allow_pulling:
                for row, each in enumerate(edges[: members.size - first], first):
                    found.pulling[row] = intervals(each, float(found.ends[row]))
        if watch is not None:
            watch.steps += int(found.steps[0])
            error = _fault(found, solver, watch, group) if failed else None
            errors = {} if error is None else {int(members[0]): error}
            failed, found.seconds[:] = [], time.thread_time() - begun
    for row in np.flatnonzero(~found.ended(None)).tolist():
        # A sample at the ending itself may have come too late.
        found.states[row, :-1][times >= found.ends[row]] = found.last[row]
    for row in failed:
        member = members[row : row + 1]
        alone = Watch(most=float(group.most[member[0]]))
        single, fault = integrate(
            group, member, times, local_tolerance, step_fraction, watch=alone
        )
        found.put(np.array([row]), single)
        errors |= fault
    return found, errors


def _start(solver: Any, edges: list[list[float]], group: Group, lanes: Rows, begin: float) -> None:
    """Put a solver to the start of its members."""
    solver.set_time(begin)
    solver.state[:] = group.starts[lanes].T
    solver.pars[:] = group.numbers[lanes].T[: len(solver.pars)]
    solver.reset_cooldowns()
    if group.code.structure.allow_pulling:
        for each, is_pulled in zip(edges, group.pulled[lanes].tolist(), strict=True):
            each[:] = [begin] * is_pulled


def _take(found: Runs, reasons: AnyArray, solver: Any, samples: Array, first: int) -> list[int]:
    """Take over what a batch has reached; returns the rows that must be run alone."""
    count = min(solver.batch_size, len(found.ends) - first)
    rows = slice(first, first + count)
    results = solver.propagate_res
    # As a matrix, for a sixth of the time.
    flat = samples.reshape(-1, solver.batch_size).T
    found.states.reshape(len(found.ends), -1)[rows, : flat.shape[1]] = flat[:count]
    found.last[rows] = solver.state.T[:count]
    found.steps[rows] = [each[3] for each in results[:count]]
    alive = solver.pars[ALIVE, :count]
    complete = heyoka().taylor_outcome.time_limit
    if alive.any() and any(each[0] != complete for each in results):
        # What went wrong in one of them must not touch the others.
        return list(range(first, first + count))
    ended = np.flatnonzero(alive == 0.0)
    stopped = first + ended
    found.ends[stopped] = solver.pars[WHEN, ended]
    found.reasons[stopped] = reasons[solver.pars[REASON, ended].astype(int)]
    return []


def _fault(found: Runs, solver: Any, watch: Watch, group: Group) -> Exception | None:
    """What is wrong with a watched run that has broken off; None if it has met its time limit."""
    kinds, outcome = heyoka().taylor_outcome, solver.propagate_res[0][0]
    if outcome == kinds.cb_stop:
        found.ends[0], found.reasons[0] = solver.time[0], TIME_LIMIT
        return None
    moment, leaning = float(solver.time[0]), sin(found.last[0, group.code.angles][0])
    found.states[:] = np.nan
    if outcome == kinds.step_limit:
        watch.flattest = (moment, asin(min(1.0, leaning)))
        return watch.given_up("taylor")
    is_lost = outcome == kinds.err_nf_state
    why = "its state is no longer finite" if is_lost else "it does not get on"
    return ArithmeticError(f"taylor stopped after t = {moment:g} s: {why}")


def _interruption(watch: Watch, end: float) -> Callable[[Any], bool] | None:
    """What a solver calls after each step; it stops where that is not true."""
    if watch.is_idle:
        return None
    return lambda solver: not watch.is_over(float(solver.time[0]), end)
