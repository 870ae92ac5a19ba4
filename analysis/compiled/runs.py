"""Runs of compiled systems: one at a time, with the endings that single runs have."""

from collections.abc import Callable, Mapping, Sequence
from math import asin
from typing import Any

import numpy as np

from analysis.compiled import systems
from analysis.compiled.code import Code, code_of, values
from analysis.compiled.library import CannotCompileError, heyoka
from analysis.compiled.systems import SIGN, SINGULAR, Structure
from analysis.data.checks import Array
from analysis.data.constraint_set import multiplier_names
from analysis.data.endings import CONTACT_WOULD_PULL, TIME_LIMIT, Condition
from analysis.data.scenario import Scenario
from analysis.data.watch import Watch
from analysis.solve.lookout import intervals
from analysis.solve.stepping import (
    InitialValueProblem,
    Run,
    endings,
    pulls_at_start,
)

MOST_FORCES = 4
"""Constraint forces up to which a disk with products of inertia is compiled within seconds."""


def code_for(
    scenario: Scenario, form: str, conditions: Mapping[str, Condition], *, allow_pulling: bool
) -> Code:
    """Code of the runs of a scenario, or of members that are alike in structure.

    Parameters and errors are those of `CompiledScenario`.
    """
    heyoka()
    if form == "free-body":
        raise CannotCompileError(
            "method 'taylor' knows the ideal contact alone, no form 'free-body'"
        )
    if not scenario.disk.is_round_disk:
        kind = type(scenario.disk).__name__
        raise CannotCompileError(f"method 'taylor' knows round disks alone, got a {kind}")
    if scenario.disk.has_products and len(multiplier_names(scenario.constraints)) > MOST_FORCES:
        raise CannotCompileError(
            "method 'taylor' takes minutes to compile a disk with products of inertia and more "
            f"than {MOST_FORCES} constraint forces, got {scenario.name}"
        )
    if allow_pulling and scenario.rubs and scenario.friction.load == "contact":
        raise CannotCompileError(
            "allow_pulling must be left out with method 'taylor' where friction has the load "
            "'contact', which then comes and goes"
        )
    return code_of(Structure.of(scenario, form, conditions, allow_pulling=allow_pulling))


class CompiledScenario:
    """A scenario whose runs and constraint forces are worked out by compiled code.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact.
    form : {"index-1", "reduced"}
    conditions : mapping
        From reasons to functions of a `State`; a run ends where one turns negative.
    allow_pulling : bool
        Whether to go on where the contact pulls.

    Raises
    ------
    CannotCompileError
        If heyoka is not installed or something cannot be expressed in its symbols.
    """

    def __init__(
        self,
        scenario: Scenario,
        form: str,
        conditions: Mapping[str, Condition],
        *,
        allow_pulling: bool,
    ) -> None:
        self.code = code_for(scenario, form, conditions, allow_pulling=allow_pulling)
        self._allow_pulling = allow_pulling
        self.numbers = np.array(systems.parameters(scenario))

    def integrate(
        self,
        problem: InitialValueProblem,
        times: Array,
        local_tolerance: float,
        watch: Watch | None = None,
    ) -> Run:
        """Integrate and sample at `times`; as `integration.integrate`.

        Raises
        ------
        ArithmeticError
            If the integration fails.
        ToleranceError
            If the call is out of steps.
        ValueError
            If the contact would have to pull at the start and must not.
        """
        watch, lets = watch or Watch(), self._allow_pulling
        pulls = pulls_at_start(problem, allow_pulling=lets)
        edges = [float(times[0])] if pulls else []
        parts: list[Array] = []
        row, steps, ended = 0, 0, None
        with self.code.integrator(local_tolerance) as solver:
            self._set(solver, problem, float(times[0]))
            while row < times.size:
                # A run that goes on does so from between the times asked for.
                between = solver.time < times[row]
                left = np.append(solver.time, times[row:]) if between else times[row:]
                outcome, _, _, taken, _, sampled = solver.propagate_grid(
                    left,
                    max_delta_t=problem.longest_step,
                    max_steps=watch.steps_left,
                    callback=_interruption(watch, float(times[-1])),
                )
                parts.append(sampled[int(between) :])
                steps, row = steps + taken, row + len(parts[-1])
                watch.steps += taken
                if outcome == heyoka().taylor_outcome.step_limit:
                    lean = asin(min(1.0, problem.leaning(solver.state)))
                    watch.flattest = (float(solver.time), lean)
                    raise watch.given_up("taylor")
                ended = _reason(outcome, self.code.reasons, solver)
                if ended != CONTACT_WOULD_PULL or not lets:
                    break
                edges.append(solver.time)
            last, state = float(solver.time), solver.state.copy()
        reached, states = times[:row], parts[0] if len(parts) == 1 else np.concatenate(parts)
        value = 0.0
        if ended is not None:
            if last > reached[-1]:
                reached, states = np.append(reached, last), np.vstack((states, state))
            if ended != TIME_LIMIT:
                value = endings(problem)[ended](state)
        return Run(reached, states, steps, ended, intervals(edges, float(reached[-1])), value)

    def multipliers(self, states: Array) -> Array:
        """Constraint forces at coordinates and rates, shape (n, 12); shape (n, k)."""
        return values(self.code.multipliers, states, self.numbers)

    def _set(self, solver: Any, problem: InitialValueProblem, time: float) -> None:
        solver.time = time
        solver.state[:] = problem.start
        solver.pars[:] = self.numbers[: len(solver.pars)]
        if solver.with_events:
            solver.reset_cooldowns()
        solver.pars[SIGN] = self.code.signs(problem.start[None], self.numbers)[0]


def _reason(outcome: Any, reasons: Sequence[str], solver: Any) -> str | None:
    """Why a solver has stopped, None at the last time asked for."""
    kinds = heyoka().taylor_outcome
    if outcome == kinds.time_limit:
        return None
    if outcome == kinds.cb_stop:
        return TIME_LIMIT
    number = -int(outcome.value) - 1
    if 0 <= number < len(reasons) and reasons[number] != SINGULAR:
        return reasons[number]
    why = "it does not get on"
    if 0 <= number < len(reasons):
        why = "each newton of normal force calls for another one of it through friction"
    elif outcome == kinds.err_nf_state:
        why = "its state is no longer finite"
    raise ArithmeticError(f"taylor stopped after t = {solver.time:g} s: {why}")


def _interruption(watch: Watch, end: float) -> Callable[[Any], bool] | None:
    """What a solver calls after each step; it stops where that is not true."""
    if watch.is_idle:
        return None
    return lambda solver: not watch.is_over(float(solver.time), end)
