"""Compiled runs of many scenarios at once: in batches as wide as the processor's registers."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.compiled.code import Code
from analysis.compiled.library import heyoka
from analysis.compiled.runs import CompiledScenario
from analysis.compiled.systems import ALIVE, REASON, SIGN, SINGULAR, WHEN
from analysis.data.checks import Array, positive
from analysis.data.endings import Condition
from analysis.data.limits import MOST_STEPS
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Trajectory
from analysis.models.effort import simulation_effort
from analysis.models.forms import Form, PosedForm, default_form, pose
from analysis.models.integration import Run, endings, pulls_at_start
from analysis.models.simulation import (
    check_local_tolerance,
    compare,
    local_tolerances,
    trajectory,
    unreachable,
)

Outcome = Trajectory | Exception
"""Of one member: its motion, or the error that ended it."""


@dataclass(slots=True, eq=False)
class _Member:
    """One run of many: what it starts from, and what it has reached."""

    number: int
    scenario: Scenario
    form: Form
    tolerance: float | None
    compiled: CompiledScenario
    posed: PosedForm
    steps: int = 0
    run: Run | None = None


def simulate_batches(
    tasks: Iterable[tuple[Scenario, float | None]],
    times: Array,
    *,
    form: Form | None,
    local_tolerance: float | None,
    conditions: Mapping[str, Condition],
) -> list[Outcome]:
    """Outcomes of many scenarios, each as `simulate` with Taylor's method gives it.

    Parameters
    ----------
    tasks : iterable of pairs
        Scenarios and their tolerances.
    times, form, local_tolerance
        As in `simulate`.
    conditions : mapping
        From reasons to functions of a `State`.
    """
    outcomes: dict[int, Outcome] = {}
    groups: defaultdict[Any, list[_Member]] = defaultdict(list)
    for number, (scenario, tolerance) in enumerate(tasks):
        try:
            member = _member(number, scenario, form, conditions)
            ladder = _ladder(member, times, tolerance, local_tolerance)
        except (ArithmeticError, ValueError) as error:
            outcomes[number] = error
        else:
            groups[member.compiled.code, ladder].append(member)
    for (_, ladder), members in groups.items():
        outcomes |= _climb(members, times, ladder)
    return [outcomes[number] for number in range(len(outcomes))]


def _member(
    number: int, scenario: Scenario, form: Form | None, conditions: Mapping[str, Condition]
) -> _Member:
    form = default_form(scenario) if form is None else form
    compiled = CompiledScenario(scenario, form, conditions, allow_pulling=False)
    posed = pose(scenario, form, conditions, compiled.multipliers)
    pulls_at_start(posed.problem, allow_pulling=False)
    return _Member(number, scenario, form, None, compiled, posed)


def _ladder(
    member: _Member, times: Array, tolerance: float | None, local_tolerance: float | None
) -> tuple[float, ...]:
    """Local tolerances to run a member with, in turn; one alone gives no estimate."""
    if local_tolerance is not None:
        if tolerance is not None:
            raise ValueError("give either tolerance or local_tolerance, not both")
        ladder = [check_local_tolerance("local_tolerance", local_tolerance)]
    else:
        member.tolerance = positive("tolerance", 1e-8 if tolerance is None else tolerance)
        ladder = local_tolerances(member.tolerance, "taylor")
    simulation_effort(
        member.scenario,
        times,
        method="taylor",
        tolerance=member.tolerance,
        local_tolerance=local_tolerance,
    ).check()
    return tuple(ladder)


def _climb(members: list[_Member], times: Array, ladder: Sequence[float]) -> dict[int, Outcome]:
    """Outcomes of members alike in structure and local tolerances, by number."""
    outcomes: dict[int, Outcome] = {}
    estimates = dict.fromkeys((member.number for member in members), np.inf)
    longest = 1.0
    for local in ladder:
        pending = []
        for member, found in zip(members, _runs(members, times, local, longest), strict=True):
            if isinstance(found, Exception):
                outcomes[member.number] = found
                continue
            coarse, member.run = member.run, found
            member.steps += found.evaluations
            if len(ladder) == 1:
                outcomes[member.number] = _outcome(member, local, None)
                continue
            if coarse is not None:
                _, estimate = compare(found, coarse, member.posed.attitudes)
                estimates[member.number] = estimate
                if member.tolerance is not None and estimate <= member.tolerance:
                    outcomes[member.number] = _outcome(member, local, estimate)
                    continue
            pending.append(member)
        members, longest = pending, 0.8 * longest
    for member in members:
        wanted = member.tolerance or 0.0
        outcomes[member.number] = unreachable(wanted, "taylor", estimates[member.number])
    return outcomes


def _outcome(member: _Member, local_tolerance: float, estimate: float | None) -> Outcome:
    settings = {
        "form": member.form,
        "method": "taylor",
        "tolerance": member.tolerance,
        "local_tolerance": local_tolerance,
    }
    assert member.run is not None
    run = replace(member.run, evaluations=member.steps)
    try:
        return trajectory(member.scenario, member.posed, run, settings, estimate)
    except (ArithmeticError, ValueError) as error:
        return error


def _runs(
    members: list[_Member], times: Array, local_tolerance: float, longest: float
) -> list[Run | Exception]:
    """Runs of members alike in structure, a batch at a time."""
    width = heyoka().recommended_simd_size()
    found: list[Run | Exception] = []
    for first in range(0, len(members), width):
        some = members[first : first + width]
        found += _batch(some, times, local_tolerance, longest)
    return found


def _batch(
    members: list[_Member], times: Array, local_tolerance: float, longest: float
) -> list[Run | Exception]:
    code: Code = members[0].compiled.code
    with code.integrator(local_tolerance, batch=True) as solver:
        # A batch that is not full repeats its last member.
        lanes = members + members[-1:] * (solver.batch_size - len(members))
        starts = np.array([lane.posed.problem.start for lane in lanes])
        numbers = np.array([lane.compiled.numbers for lane in lanes])
        numbers[:, SIGN] = code.signs(starts, numbers)
        solver.set_time(float(times[0]))
        solver.state[:] = starts.T
        solver.pars[:] = numbers[:, : len(solver.pars)].T
        solver.reset_cooldowns()
        _, samples = solver.propagate_grid(
            np.ascontiguousarray(np.broadcast_to(times[:, None], (times.size, len(lanes)))),
            max_delta_t=[longest * lane.posed.problem.longest_step for lane in lanes],
            max_steps=MOST_STEPS,
        )
        results, last = solver.propagate_res, solver.state.T.copy()
        marks = solver.pars[[ALIVE, REASON, WHEN]].T.tolist()
    if any(outcome != heyoka().taylor_outcome.time_limit for outcome, *_ in results):
        return [_alone(member, times, local_tolerance, longest) for member in members]
    found: list[Run | Exception] = []
    for lane, member in enumerate(members):
        alive, number, when = marks[lane]
        states, steps = samples[:, :, lane], results[lane][3]
        if alive:
            found.append(Run(times, states, steps, None, ()))
            continue
        reason = code.reasons[int(number)]
        if reason == SINGULAR:
            found.append(_alone(member, times, local_tolerance, longest))
            continue
        row = int(np.searchsorted(times, when, side="right"))
        value = endings(member.posed.problem)[reason](last[lane])
        reached, states = times[:row], states[:row]
        if when > reached[-1]:
            reached, states = np.append(reached, when), np.vstack((states, last[lane]))
        found.append(Run(reached, states, steps, reason, (), value))
    return found


def _alone(
    member: _Member, times: Array, local_tolerance: float, longest: float
) -> Run | Exception:
    """The run of one member; where it fails, it must not take its batch with it."""
    problem = member.posed.problem.with_steps_up_to(longest)
    try:
        return member.compiled.integrate(problem, times, local_tolerance)
    except (ArithmeticError, ValueError) as error:
        return error
