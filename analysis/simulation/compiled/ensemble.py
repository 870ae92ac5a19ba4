"""Compiled runs of many scenarios, as arrays from their fields to their motions."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf

import numpy as np

from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array
from analysis.problem.elementary import Rows, in_columns
from analysis.problem.scenario import Scenario
from analysis.problem.variations import Ensemble, one_by_one
from analysis.simulation.compiled import systems
from analysis.simulation.compiled.code import Code, code_for
from analysis.simulation.compiled.runs import Group, integrate
from analysis.simulation.compiled.systems import SIGN
from analysis.simulation.formulations import check_formulation, default_formulation, pose
from analysis.simulation.request import Request, trajectory
from analysis.simulation.samples import Samples, stand_in
from analysis.solve.effort import longest_step
from analysis.solve.stepping import pulls_at_start
from analysis.solve.to_tolerance import Runs, agree, estimated_errors
from analysis.solve.watch import Watch

Scenarios = Ensemble | Sequence[Scenario]

_BLOCK = 2**14
"""Samples of motions that are looked at at once: they take some 5 MB."""


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

    def blocks(self) -> Iterator[tuple[slice, Samples]]:
        """Samples of some at a time, at the times asked for and at their ends."""
        size = max(1, _BLOCK // self.runs.times.size)
        for first in range(0, len(self.group), size):
            some = slice(first, first + size)
            constraints = self.group.code.structure.equations.constraints
            numbers = self.group.numbers[some, systems.CONSTANTS]
            yield some, Samples(stand_in(constraints, None, numbers), *self._sampled(some))

    def _sampled(self, some: slice) -> tuple[Array, Array, Array, Array]:
        """Times, coordinates, rates and constraint forces of some."""
        runs, group = self.runs, self.group
        times = np.minimum(np.append(runs.times, np.inf), runs.ends[some, None])
        coordinates, rates, forces, _ = group.code.readings(
            runs.states[some], times, group.numbers[some]
        )
        return times, coordinates, rates, forces

    def trajectory(self, row: int, scenario: Scenario) -> Trajectory:
        """Motion of one of them, which has this scenario."""
        _, *arrays = self._sampled(slice(row, row + 1))
        return self._trajectory(row, scenario, [each[0] for each in arrays])

    def outcomes(self, scenarios: Sequence[Scenario]) -> Iterator[Trajectory | Exception]:
        """Motion of each of them, or why it has none, worked out in blocks.

        Parameters
        ----------
        scenarios : sequence of Scenario
            Of all members, not of these alone.
        """
        for some, samples in self.blocks():
            sampled = zip(samples.coordinates, samples.rates, samples.multipliers, strict=True)
            for row, arrays in enumerate(sampled, some.start):
                try:
                    yield self._trajectory(row, scenarios[int(self.group.rows[row])], arrays)
                except (ArithmeticError, ValueError) as error:
                    yield error

    def _trajectory(self, row: int, scenario: Scenario, arrays: Sequence[Array]) -> Trajectory:
        run = self.runs.run(row)
        coordinates, rates, forces = (each[: run.times.size] for each in arrays)
        if self.group.code.structure.formulation == "index-1":
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
        )


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
        pieces[code].append((first + rows, in_columns(numbers, rows.size)))
    compiled = []
    for code, some in pieces.items():
        rows, array = (np.concatenate(each) for each in zip(*some, strict=True))
        group = _group(code, rows, array, float(request.times[0]))
        if not code.structure.allow_pulling:
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
    structure = systems.Structure.of(
        scenario, formulation, request.conditions, allow_pulling=request.allow_pulling
    )
    code = code_for(structure)
    check_formulation(scenario, formulation)
    effort = request.effort(scenario, "taylor")
    numbers = systems.parameters(scenario, float(request.times[0]))
    start = systems.start(scenario, formulation)
    return code, (longest_step(scenario), effort.most, *numbers, *start)


def _group(code: Code, rows: Rows, array: Array, begin: float) -> Group:
    """Members with these longest and most steps, parameters and starts, shape (m, 2 + p + d)."""
    numbers, starts = array[:, 2 : -code.size], array[:, -code.size :]
    _, _, forces, slips = code.readings(starts[:, None], np.full((len(array), 1), begin), numbers)
    numbers[:, SIGN] = np.where(slips[:, 0].sum(axis=1) < 0.0, -1.0, 1.0)
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

    def run(some: Rows, local: float, longest: float) -> tuple[Runs, dict[int, Exception]]:
        return integrate(group, some, request.times, local, longest, watch=watch)

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
