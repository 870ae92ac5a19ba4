"""Code compiled of systems of symbols, kept for all runs alike in structure."""

from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from analysis.compiled import systems
from analysis.compiled.library import heyoka
from analysis.compiled.systems import ALIVE, REASON, SIGN, WHEN, Structure, System
from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL

WIDEST_INDEX_1 = 4
"""Most members of a batch of an index-1 system.

Its code keeps most numbers on the stack, where LLVM lets wider ones straddle two lines of the
cache; batches of eight take 15 to 45 % longer for each member.
"""

COMPACT = False
"""Whether to compile in a quarter of the time for runs that take two to four times as long."""


class Code:
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
        self._idle: defaultdict[tuple[float, bool], list[Any]] = defaultdict(list)

    @contextmanager
    def integrator(self, local_tolerance: float, *, batch: bool = False) -> Iterator[Any]:
        """An integrator, of one run or of a batch, that nobody else uses meanwhile."""
        idle = self._idle[local_tolerance, batch]
        try:
            solver = idle.pop()
        except IndexError:
            make = self._batch_integrator if batch else self._integrator
            solver = make(local_tolerance)
        yield solver
        idle.append(solver)

    def _integrator(self, local_tolerance: float) -> Any:
        library, system = heyoka(), self._system
        falling, either = library.event_direction.negative, library.event_direction.any
        events = []
        for reason, symbol in system.endings.items():
            lets = reason == CONTACT_WOULD_PULL and self._structure.allow_pulling
            events.append(library.t_event(symbol, direction=either if lets else falling))
        events += kinks(system, library.t_event)
        return library.taylor_adaptive(
            list(zip(system.variables, system.derivatives, strict=True)),
            [0.0] * len(system.variables),
            tol=local_tolerance,
            t_events=events,
            compact_mode=self._compact,
        )

    def _batch_integrator(self, local_tolerance: float) -> Any:
        library, system = heyoka(), self._system
        falling, alive = library.event_direction.negative, library.par[ALIVE]
        events = [
            library.t_event_batch(symbol, direction=falling, callback=_stop(number))
            for number, symbol in enumerate(system.endings.values())
        ]
        events += kinks(system, library.t_event_batch)
        derivatives = [alive * derivative for derivative in system.derivatives]
        return library.taylor_adaptive_batch(
            list(zip(system.variables, derivatives, strict=True)),
            np.zeros((len(system.variables), self._width)),
            tol=local_tolerance,
            t_events=events,
            compact_mode=self._compact,
        )

    @property
    def _width(self) -> int:
        """Members of a batch."""
        widest: int = heyoka().recommended_simd_size()
        return min(widest, WIDEST_INDEX_1) if self._structure.form == "index-1" else widest

    @cached_property
    def multipliers(self) -> Any:
        """Function of states of the index-1 system."""
        variables, forces = systems.multipliers(self._structure)
        return heyoka().cfunc(forces, variables, compact_mode=self._compact)

    def multipliers_of(self, variables: Array, numbers: Array) -> Array:
        """Constraint forces of k members at n states each, shape (c, k, n).

        Parameters
        ----------
        variables : ndarray, shape (12, k, n)
            States of the index-1 system.
        numbers : ndarray, shape (k, p)
        """
        function, shape = self.multipliers, variables.shape
        given = np.repeat(numbers[:, : function.nparams].T, shape[2], axis=1)
        found: Array = function(variables.reshape(12, -1), pars=given)
        return found.reshape(-1, *shape[1:])

    @cached_property
    def _slip(self) -> Any:
        return heyoka().cfunc([self._system.kink], self._system.variables)

    def signs(self, states: Array, numbers: Array) -> Array:
        """Signs of a slip in one direction at states, shape (n, m); shape (n,)."""
        if not self._system.flips:
            return np.ones(len(states))
        return np.where(values(self._slip, states, numbers)[:, 0] < 0.0, -1.0, 1.0)


def code_of(structure: Structure) -> Code:
    """Code of a structure, compiled or made to be when it is first asked for.

    Raises
    ------
    CannotCompileError
        If heyoka is not installed or something cannot be expressed in its symbols.
    """
    return _code(structure, COMPACT)


_code = lru_cache(maxsize=64)(Code)


def values(function: Any, states: Array, numbers: Array) -> Array:
    """Values of a compiled function at states, shape (n, m); shape (n, k).

    Parameters
    ----------
    function : compiled function
    states : ndarray, shape (n, m)
    numbers : ndarray, shape (p,) or (n, p)
        Parameters, for all states or for each.
    """
    given = numbers[..., : function.nparams].reshape(-1, function.nparams)
    parameters = np.empty((function.nparams, len(states)))
    parameters[:] = given.T
    found: Array = function(np.ascontiguousarray(states.T), pars=parameters)
    return np.ascontiguousarray(found.T)


def kinks(system: System, event: Callable[..., Any]) -> list[Any]:
    """Event, of heyoka's kind for one run or for batches, that ends a step at friction's kink.

    A step across it has an error that its size does not show.
    """
    if system.kink is None:
        return []
    directions = heyoka().event_direction
    turning = directions.any if system.flips else directions.positive
    return [event(system.kink, callback=_flip, direction=turning)]


def _flip(solver: Any, direction: int, *lane: int) -> bool:
    """Give a slip in one direction the sign it has from now on; the run goes on in a new step."""
    if direction != 0:
        solver.pars[(SIGN, *lane)] = direction
    return True


def _stop(number: int) -> Callable[[Any, int, int], bool]:
    """What ends one run of a batch: its state stays what it is, and the others go on."""

    def stop(solver: Any, _: int, lane: int) -> bool:
        if solver.pars[ALIVE, lane] != 0.0:
            solver.pars[ALIVE, lane] = 0.0
            solver.pars[REASON, lane] = number
            solver.pars[WHEN, lane] = solver.time[lane]
        return True

    return stop
