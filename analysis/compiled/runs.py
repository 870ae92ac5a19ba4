"""Runs of compiled systems: one at a time, with the endings that single runs have."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from analysis.compiled import systems
from analysis.compiled.library import heyoka
from analysis.compiled.systems import SIGN, SINGULAR, Structure
from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL, TIME_LIMIT, Condition
from analysis.data.limits import MOST_STEPS
from analysis.data.scenario import Scenario
from analysis.data.watch import Watch
from analysis.models.integration import (
    InitialValueProblem,
    Run,
    endings,
    intervals,
    pulls_at_start,
)

COMPACT = False
"""Whether to compile in a quarter of the time for runs that take four times as long."""


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
    ValueError
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
        heyoka()
        if form == "free-body":
            raise ValueError("method 'taylor' knows the ideal contact alone, no form 'free-body'")
        if allow_pulling and scenario.rubs and scenario.friction.load == "contact":
            raise ValueError(
                "allow_pulling must be left out with method 'taylor' where friction has the load "
                "'contact', which then comes and goes"
            )
        structure = Structure.of(scenario, form, conditions, allow_pulling=allow_pulling)
        self._compiled = _compiled(structure, COMPACT)
        self._allow_pulling = allow_pulling
        self._parameters = np.array(systems.parameters(scenario))

    def integrate(
        self, problem: InitialValueProblem, times: Array, local_tolerance: float, watch: Watch
    ) -> Run:
        """Integrate and sample at `times`; as `integration.integrate`.

        Raises
        ------
        ArithmeticError
            If the integration fails.
        ValueError
            If the contact would have to pull at the start and must not.
        """
        lets = self._allow_pulling
        pulls = pulls_at_start(problem, allow_pulling=lets)
        edges = [float(times[0])] if pulls else []
        parts: list[Array] = []
        row, steps, ended = 0, 0, None
        with self._compiled.integrator(local_tolerance) as solver:
            self._set(solver, problem, float(times[0]))
            while row < times.size:
                # A run that goes on does so from between the times asked for.
                between = [solver.time] if solver.time < times[row] else []
                outcome, _, _, taken, _, sampled = solver.propagate_grid(
                    np.concatenate((between, times[row:])),
                    max_delta_t=problem.longest_step,
                    max_steps=MOST_STEPS,
                    callback=_interruption(watch, float(times[-1])),
                )
                parts.append(sampled[len(between) :])
                steps, row = steps + taken, row + len(parts[-1])
                ended = _reason(outcome, self._compiled.reasons, solver)
                if ended != CONTACT_WOULD_PULL or not lets:
                    break
                edges.append(solver.time)
            last, state = float(solver.time), solver.state.copy()
        reached, states = times[:row], np.concatenate(parts)
        value = 0.0
        if ended is not None:
            if last > reached[-1]:
                reached, states = np.append(reached, last), np.vstack((states, state))
            if ended != TIME_LIMIT:
                value = endings(problem)[ended](state)
        return Run(reached, states, steps, ended, intervals(edges, float(reached[-1])), value)

    def multipliers(self, states: Array) -> Array:
        """Constraint forces at coordinates and rates, shape (n, 12); shape (n, k)."""
        return _values(self._compiled.multipliers, states, self._parameters)

    def _set(self, solver: Any, problem: InitialValueProblem, time: float) -> None:
        solver.time = time
        solver.state[:] = problem.start
        solver.pars[:] = self._parameters[: len(solver.pars)]
        if solver.with_events:
            solver.reset_cooldowns()
        if self._compiled.slip is not None:
            slip = _values(self._compiled.slip, problem.start[None], self._parameters)
            solver.pars[SIGN] = -1.0 if slip[0, 0] < 0.0 else 1.0


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
    why = f"it took {MOST_STEPS:.0e} steps"
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


class _Compiled:
    """What is compiled of one structure; heyoka keeps it, too, on disk.

    Parameters
    ----------
    structure : Structure
    compact : bool
        See `COMPACT`.
    """

    def __init__(self, structure: Structure, compact: bool) -> None:
        self._structure, self._compact = structure, compact
        self._system = systems.build(structure)
        self.reasons = tuple(self._system.endings)
        self._idle: defaultdict[float, list[Any]] = defaultdict(list)

    @contextmanager
    def integrator(self, local_tolerance: float) -> Iterator[Any]:
        """An integrator that nobody else uses meanwhile."""
        idle = self._idle[local_tolerance]
        try:
            solver = idle.pop()
        except IndexError:
            solver = self._integrator(local_tolerance)
        yield solver
        idle.append(solver)

    def _integrator(self, local_tolerance: float) -> Any:
        library, system = heyoka(), self._system
        falling, either = library.event_direction.negative, library.event_direction.any
        events = []
        for reason, symbol in system.endings.items():
            lets = reason == CONTACT_WOULD_PULL and self._structure.allow_pulling
            events.append(library.t_event(symbol, direction=either if lets else falling))
        if system.slip is not None:
            events.append(library.t_event(system.slip, callback=_flip))
        return library.taylor_adaptive(
            list(zip(system.variables, system.derivatives, strict=True)),
            [0.0] * len(system.variables),
            tol=local_tolerance,
            t_events=events,
            compact_mode=self._compact,
        )

    @cached_property
    def multipliers(self) -> Any:
        """Function of coordinates and rates."""
        variables, forces = systems.multipliers(self._structure)
        return heyoka().cfunc(forces, variables, compact_mode=self._compact)

    @cached_property
    def slip(self) -> Any:
        """Function of the state: slip in the one direction in which the friction has a kink."""
        symbols = [] if self._system.slip is None else [self._system.slip]
        return heyoka().cfunc(symbols, self._system.variables) if symbols else None


_compiled = lru_cache(maxsize=64)(_Compiled)


def _flip(solver: Any, direction: int) -> bool:
    """Give the slip the sign it has from now on; the run goes on."""
    if direction != 0:
        solver.pars[SIGN] = direction
    return True


def _values(function: Any, states: Array, numbers: Array) -> Array:
    """Values of a compiled function at states, shape (n, m); shape (n, k)."""
    repeated = np.repeat(numbers[: function.nparams, None], len(states), axis=1)
    found: Array = function(np.ascontiguousarray(states.T), pars=repeated)
    return np.ascontiguousarray(found.T)
