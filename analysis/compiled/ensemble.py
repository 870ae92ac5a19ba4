"""Compiled runs of many scenarios, as arrays from their fields to their motions."""

import time
from collections import defaultdict
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from typing import Any

import numpy as np

from analysis.compiled import systems
from analysis.compiled.code import Code, code_for
from analysis.compiled.runs import Group, integrate
from analysis.compiled.systems import SIGN
from analysis.data.checks import Array
from analysis.data.ensemble import Ensemble, one_by_one
from analysis.data.files import AnyArray
from analysis.data.members import Rows, in_columns
from analysis.data.samples import Samples, blocks
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Trajectory
from analysis.data.watch import Watch
from analysis.models.forms import check_form, default_form, pose
from analysis.models.request import Request, trajectory
from analysis.solve.effort import longest_step
from analysis.solve.stepping import pulls_at_start
from analysis.solve.to_tolerance import Runs, agree, estimated_errors

Scenarios = Ensemble | Sequence[Scenario]


@dataclass(frozen=True, slots=True, eq=False)
class CompiledPart:
    """Members that are alike in structure and were run together.

    Parameters
    ----------
    rows : ndarray of int, shape (k,)
    ensemble : Ensemble
        Of these members alone; or a list of them.
    request : Request
    group : Group
    runs : Runs
    watch : Watch, optional
        Of a single member.
    seconds : float, optional
        Processor time of the last run of a single member.
    """

    rows: Rows
    ensemble: Any
    request: Request
    group: Group
    runs: Runs
    watch: Watch | None
    seconds: float | None

    def moved(self, by: int) -> "CompiledPart":
        """The same with larger numbers of members."""
        return replace(self, rows=self.rows + by)

    def some(self, rows: Rows) -> "CompiledPart":
        """The same without some of its members."""
        return replace(
            self,
            rows=self.rows[rows],
            ensemble=_part(self.ensemble, rows),
            group=self.group.part(rows),
            runs=self.runs.part(rows),
        )

    @property
    def times(self) -> Array:
        """Times asked for in s, shape (n,)."""
        return self.runs.times

    @property
    def ends(self) -> Array:
        """Time of each end in s."""
        return self.runs.ends

    @property
    def error_estimates(self) -> Array:
        """Estimated errors in rad, or nan."""
        return self.runs.estimates

    @property
    def endings(self) -> AnyArray:
        """Reasons, or None."""
        # The last one is that of `RUNNING`, -1.
        names = np.array([*self.runs.names, None], dtype=object)
        found: AnyArray = names[self.runs.reasons]
        return found

    def samples(self, some: slice) -> Samples:
        """Samples of some at the times asked for, and at their ends."""
        runs, group = self.runs, self.group.part(some)
        times, ends = np.append(self.times, np.inf), self.ends[some, None]
        states = np.append(runs.states[some], runs.last[some, None], axis=1)
        states = np.where((times > ends)[..., None], runs.last[some, None], states)
        times = np.minimum(times, ends)
        coordinates, rates, forces, _ = group.code.readings(states, times, group.numbers)
        return Samples(times, coordinates, rates, forces)

    def trajectory(self, row: int) -> Trajectory:
        """Motion of one of them."""
        return self._trajectory(row, self.samples(slice(row, row + 1)), 0)

    def outcomes(self) -> Iterator[Trajectory | Exception]:
        """Motion of each of them, or why it has none, worked out in blocks."""
        for some in blocks(len(self.rows), self.times.size):
            samples = self.samples(some)
            for place in range(len(samples.times)):
                try:
                    yield self._trajectory(some.start + place, samples, place)
                except (ArithmeticError, ValueError) as error:
                    yield error

    def _trajectory(self, row: int, samples: Samples, place: int) -> Trajectory:
        run, scenario = self.runs.run(row), self.ensemble[row]
        sampled = (samples.coordinates, samples.rates, samples.multipliers)
        coordinates, rates, forces = (each[place, : run.times.size] for each in sampled)
        if self.group.code.form == "index-1":
            # The first sample is the start itself, without the rounding on the way to it and back.
            start = scenario.initial_state
            coordinates[0], rates[0] = start.coordinates, start.rates
        return trajectory(
            scenario,
            self.request,
            run,
            (coordinates, rates, forces),
            method="taylor",
            watch=self.watch,
            seconds=self.seconds,
        )


def simulate_compiled(
    scenarios: Scenarios, request: Request
) -> tuple[list[CompiledPart], dict[int, Exception]]:
    """Motions of scenarios, those alike in structure together.

    Parameters
    ----------
    scenarios : Ensemble or sequence of Scenario
        The m members.
    request : Request

    Returns
    -------
    list of CompiledPart
    dict
        From members to the errors that ended them; they are those of `simulate`.
    """
    failures: dict[int, Exception] = {}
    groups: defaultdict[Code, list[tuple[Rows, Array]]] = defaultdict(list)
    columns = partial(_columns, request)
    every = (
        scenarios.alike(columns)
        if isinstance(scenarios, Ensemble)
        else one_by_one(columns, scenarios, np.arange(len(scenarios)))
    )
    for rows, found in every:
        if isinstance(found, Exception):
            failures[int(rows[0])] = found
            continue
        code, numbers = found
        groups[code].append((rows, in_columns(numbers, rows.size)))
    parts = []
    for code, pieces in groups.items():
        rows, array = (np.concatenate(each) for each in zip(*pieces, strict=True))
        group = _group(code, array, float(request.times[0]))
        refused = {} if code.allow_pulling else _refused(group, scenarios, rows)
        if refused:
            left = _without(refused, rows.size)
            group, failures = group.part(left), failures | _by_member(refused, rows)
            rows = rows[left]
        if rows.size:
            part, failed = _run((rows, _part(scenarios, rows)), group, request)
            failures |= _by_member(failed, rows)
            if len(failed) < rows.size:
                parts.append(part.some(_without(failed, rows.size)) if failed else part)
    return parts, failures


def _without(dropped: Container[int], count: int) -> Rows:
    return np.array([row for row in range(count) if row not in dropped], dtype=int)


def _by_member(errors: Mapping[int, Exception], rows: Rows) -> dict[int, Exception]:
    return {int(rows[row]): error for row, error in errors.items()}


def _part(scenarios: Scenarios, rows: Rows) -> Scenarios:
    if isinstance(scenarios, Ensemble):
        return scenarios.part(rows)
    return [scenarios[row] for row in rows.tolist()]


Columns = tuple[Code, Sequence[float]]


def _columns(request: Request, scenario: Scenario) -> Columns:
    """Code of a scenario, or of `Members`, and its numbers: see `_group`."""
    form = request.form or default_form(scenario)
    code = code_for(scenario, form, request.conditions, allow_pulling=request.allow_pulling)
    check_form(scenario, form)
    effort = request.effort(scenario, "taylor")
    numbers = systems.parameters(scenario, float(request.times[0]))
    start = systems.start(scenario, form)
    return code, (longest_step(scenario), effort.most, *numbers, *start)


def _group(code: Code, array: Array, begin: float) -> Group:
    """Members with these longest and most steps, parameters and starts, shape (m, 2 + p + d)."""
    numbers, starts = array[:, 2 : -code.size], array[:, -code.size :]
    _, _, forces, slips = code.readings(starts[:, None], np.full((len(array), 1), begin), numbers)
    numbers[:, SIGN] = np.where(slips[:, 0].sum(axis=1) < 0.0, -1.0, 1.0)
    return Group(code, starts, numbers, array[:, 0], array[:, 1], ~(forces[:, 0, 0] >= 0.0))


def _refused(group: Group, scenarios: Scenarios, rows: Rows) -> dict[int, Exception]:
    """What is wrong with the start of members whose contact seems to pull there."""
    found: dict[int, Exception] = {}
    for row in np.flatnonzero(group.pulled).tolist():
        try:
            problem = pose(scenarios[rows[row]], group.code.form, {}).problem
            pulls_at_start(problem, allow_pulling=False)
        except (ArithmeticError, ValueError) as error:
            found[row] = error
    return found


def _run(
    members: tuple[Rows, Scenarios], group: Group, request: Request
) -> tuple[CompiledPart, dict[int, Exception]]:
    """Run a group; its single member as a call that is watched."""
    watch = request.watch(float(group.most[0])) if len(group) == 1 else None
    seconds: float | None = None

    def run(some: Rows, local: float, longest: float) -> tuple[Runs, dict[int, Exception]]:
        nonlocal seconds
        begin = time.thread_time()
        found = integrate(group, some, request.times, local, longest, watch=watch)
        seconds = None if watch is None else time.thread_time() - begin
        return found

    def estimated(fine: Runs, coarse: Runs, some: Rows) -> Array:
        def rates(runs: Runs) -> Array:
            told = group.code.readings(runs.last[:, None], runs.ends[:, None], group.numbers[some])
            return told[1][:, 0, 4:]

        columns = group.code.attitudes
        return estimated_errors(fine, coarse, lambda states: states[..., columns], rates)

    rungs, tolerance = request.local_tolerances("taylor"), request.tolerance or inf
    runs, failures = agree(run, estimated, len(group), tolerance, rungs, method="taylor")
    return CompiledPart(*members, request, group, runs, watch, seconds), failures
