"""Compiled runs of many scenarios, as arrays from their fields to their motions.

A single run is a batch of one.
"""

import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from math import asin, inf, isfinite, sin
from types import SimpleNamespace
from typing import Any

import numpy as np

from analysis.mechanics import recorded
from analysis.motion.endings import TIME_LIMIT
from analysis.motion.files import AnyArray
from analysis.motion.quantities import InCoordinates
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array
from analysis.problem.constraints import ConstraintSet
from analysis.problem.elementary import Rows
from analysis.problem.friction import check_slipping
from analysis.problem.limits import CONTACT_JAMS
from analysis.problem.scenario import Scenario
from analysis.problem.variations import Ensemble, one_by_one
from analysis.simulation.compiled import systems
from analysis.simulation.compiled.code import Code, code_for
from analysis.simulation.compiled.library import heyoka
from analysis.simulation.compiled.systems import ALIVE, BESIDE, PACE, REASON, SIGN, WHEN
from analysis.simulation.formulations import check_formulation, default_formulation, pose
from analysis.simulation.request import Request, trajectory
from analysis.solve.effort import longest_step
from analysis.solve.stepping import pulls_at_start
from analysis.solve.to_tolerance import Runs, agree, estimated_errors
from analysis.solve.watch import Watch, intervals

Scenarios = Ensemble | Sequence[Scenario]

LOOKED_AT = 2**14
"""Samples of motions that are looked at at once: they take some 5 MB."""


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

    def watch(self, members: Rows) -> Watch:
        """Who watches a run of some members at once."""
        return Watch(most=float(self.most[members].max()))

    def subset(self, rows: AnyArray) -> "Group":
        """Some of the members."""
        arrays = (getattr(self, field.name)[rows] for field in fields(self)[1:])
        return Group(self.code, *arrays)


@dataclass(frozen=True, slots=True, eq=False)
class Samples(InCoordinates):
    """Samples of k motions as arrays; behind the end of one its last sample is repeated.

    Parameters
    ----------
    scenario : SimpleNamespace
        What has the constraints and the contact of all of them, and their disks and tables, each
        number of shape (k, 1).
    times : ndarray, shape (k, n)
    coordinates, rates : ndarray, shape (k, n, 6)
    multipliers : ndarray, shape (k, n, c)
    """

    scenario: Any
    times: Array
    coordinates: Array
    rates: Array
    multipliers: Array

    @classmethod
    def of(cls, constraints: ConstraintSet, contact: Any, numbers: Any, *arrays: Any) -> "Samples":
        """Samples of scenarios of which `recorded.NUMBERS` are told, shape (k, 12)."""
        constants = np.transpose(numbers)[:, :, None]
        disk, table = recorded.disk_of(constants), SimpleNamespace(vector=constants[9:])
        shared = SimpleNamespace(constraints=constraints, contact=contact, disk=disk, table=table)
        return cls(shared, *map(np.asarray, arrays))


@dataclass(frozen=True, slots=True, eq=False)
class CompiledRuns:
    """Members that are alike in structure and were run together.

    Parameters
    ----------
    request : Request
    group : Group
    runs : Runs
    watch : Watch, optional
        Of a single member.
    """

    request: Request
    group: Group
    runs: Runs
    watch: Watch | None

    def samples(self, some: slice) -> Samples:
        """Samples of some, at the times asked for and at their ends."""
        runs, code, numbers = self.runs, self.group.code, self.group.numbers[some]
        times = np.minimum(np.append(runs.times, np.inf), runs.ends[some, None])
        coordinates, rates, forces, _ = code.readings(runs.states[some], times, numbers)
        shared, constants = code.structure.equations, numbers[:, systems.CONSTANTS]
        return Samples.of(shared.constraints, None, constants, times, coordinates, rates, forces)

    def blocks(self) -> Iterator[tuple[slice, Samples]]:
        """Samples of all, some at a time."""
        size = max(1, LOOKED_AT // self.runs.times.size)
        for first in range(0, len(self.group), size):
            some = slice(first, first + size)
            yield some, self.samples(some)

    def trajectory(self, member: int, scenario: Scenario) -> Trajectory:
        """Motion of a member, which has this scenario."""
        row = int(np.argmax(self.group.rows == member))
        run, samples = self.runs.run(row), self.samples(slice(row, row + 1))
        found = samples.coordinates, samples.rates, samples.multipliers
        values = np.concatenate(found, axis=-1)[0, : run.times.size]
        if self.group.code.structure.formulation == "index-1":
            # The first sample is the start itself, without the rounding on the way to it and back.
            values[0, :12] = scenario.initial_state.vector
        run = replace(run, states=values)
        return trajectory(scenario, self.request, run, "taylor", self.watch)


def simulate_compiled(
    scenarios: Scenarios, request: Request, first: int = 0
) -> tuple[list[CompiledRuns], dict[int, Exception]]:
    """Motions of scenarios, those alike in structure together.

    Parameters
    ----------
    scenarios : Ensemble or sequence of Scenario
        The m members.
    request : Request
    first : int
        Number of the first one.

    Returns
    -------
    list of CompiledRuns
    dict
        From members to the errors that ended them; they are those of `simulate`.
    """
    failures: dict[int, Exception] = {}
    pieces: defaultdict[Code, list[tuple[Rows, Array]]] = defaultdict(list)
    columns = partial(_columns, request)
    every = (
        scenarios.map_groups(columns)
        if isinstance(scenarios, Ensemble)
        else one_by_one(columns, scenarios, range(len(scenarios)))
    )
    for rows, found in every:
        if isinstance(found, Exception):
            failures[first + int(rows[0])] = found
            continue
        code, numbers = found
        # Of some members a number is one for all, or a `Members`.
        array = np.empty((rows.size, len(numbers)))
        for column, values in zip(array.T, numbers, strict=True):
            column[:] = values
        pieces[code].append((first + rows, array))
    compiled = []
    for code, some in pieces.items():
        rows, array = (np.concatenate(each) for each in zip(*some, strict=True))
        group = _group(code, rows, array, float(request.times[0]))
        if group.pulled.any() and not code.structure.allow_pulling:
            failures |= _refused(group, scenarios, first)
            group = group.subset(~np.isin(group.rows, list(failures)))
        if len(group):
            made, failed = _run(group, request)
            failures |= failed
            compiled.append(made)
    return compiled, failures


Columns = tuple[Code, Sequence[float]]


def _columns(request: Request, scenario: Scenario) -> Columns:
    """Code of a scenario, or of `Members`, and its numbers: see `_group`."""
    formulation = request.formulation or default_formulation(scenario)
    code = code_for(systems.Structure.of(scenario, formulation, request))
    check_formulation(scenario, formulation)
    check_slipping(scenario.friction)
    effort = request.effort(scenario, "taylor")
    numbers = systems.parameters(scenario, float(request.times[0]))
    start = systems.start(scenario, formulation)
    return code, (longest_step(scenario), effort.most, *numbers, *start)


def _group(code: Code, rows: Rows, array: Array, begin: float) -> Group:
    """Members with these longest and most steps, parameters and starts, shape (m, 2 + p + d)."""
    numbers, starts = array[:, 2 : -code.size], array[:, -code.size :]
    _, _, forces, slips = code.readings(starts[:, None], np.full((len(array), 1), begin), numbers)
    beside = -BESIDE * numbers[:, PACE]
    numbers[:, SIGN] = np.where(slips[:, 0].sum(axis=1) < beside, -1.0, 1.0)
    return Group(code, rows, starts, numbers, array[:, 0], array[:, 1], ~(forces[:, 0, 0] >= 0.0))


def _refused(group: Group, scenarios: Scenarios, first: int) -> dict[int, Exception]:
    """What is wrong with the start of members whose contact seems to pull there."""

    def check(scenario: Scenario) -> None:
        problem, _ = pose(scenario, group.code.structure.formulation, {})
        pulls_at_start(problem, allow_pulling=False)

    pulled = (group.rows[group.pulled] - first).tolist()
    checked = one_by_one(check, scenarios, pulled)
    return {first + int(row): error for (row,), error in checked if error is not None}


def _run(group: Group, request: Request) -> tuple[CompiledRuns, dict[int, Exception]]:
    """Run a group, its single member as a call that is watched; errors are those of members."""
    watch = request.watch(float(group.most[0])) if len(group) == 1 else None
    run = partial(integrate, group, request.times, watch=watch)

    def estimated(fine: Runs, coarse: Runs, some: Rows) -> Array:
        def rates(runs: Runs) -> Array:
            readings = group.code.readings(
                runs.last[:, None], runs.ends[:, None], group.numbers[some]
            )
            return readings[1][:, 0, 4:]

        return estimated_errors(fine, coarse, group.code.angles, rates)

    rungs, tolerance = request.local_tolerances("taylor"), request.tolerance or inf
    runs, failed = agree(run, estimated, len(group), tolerance, rungs, method="taylor")
    failures = {int(group.rows[row]): error for row, error in failed.items()}
    if failed:
        left = np.setdiff1d(np.arange(len(group)), list(failed))
        group, runs = group.subset(left), runs.subset(left)
    return CompiledRuns(request, group, runs, watch), failures


def integrate(
    group: Group,
    times: Array,
    members: Rows,
    local_tolerance: float,
    step_fraction: float,
    *,
    watch: Watch | None = None,
) -> tuple[Runs, dict[int, Exception]]:
    """Run some members of a group once.

    Parameters
    ----------
    group : Group
    times : ndarray, shape (n,)
    members : ndarray of int, shape (k,)
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
            limit = watch or group.watch(lanes[some])
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
    for row in np.flatnonzero(found.ended(CONTACT_JAMS)).tolist():
        why = f"taylor stopped after t = {found.ends[row]:g} s, where {CONTACT_JAMS}"
        errors[int(members[row])] = ArithmeticError(why)
    for row in np.flatnonzero(~found.ended(None)).tolist():
        # A sample at the ending itself may have come too late.
        found.states[row, :-1][times >= found.ends[row]] = found.last[row]
    for row in failed:
        member = members[row : row + 1]
        single, fault = integrate(
            group, times, member, local_tolerance, step_fraction, watch=group.watch(member)
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
        watch.flattest = moment, asin(leaning)
        return watch.given_up("taylor")
    is_lost = outcome == kinds.err_nf_state
    why = "its state is no longer finite" if is_lost else "it does not get on"
    # With the state, the time may have been lost.
    place = f" after t = {moment:g} s" if isfinite(moment) else ""
    return ArithmeticError(f"taylor stopped{place}: {why}")


def _interruption(watch: Watch, end: float) -> Callable[[Any], bool] | None:
    """What a solver calls after each step; it stops where that is not true."""
    if watch.is_idle:
        return None
    return lambda solver: not watch.is_over(float(solver.time[0]), end)
