"""Code compiled of systems of symbols, kept for all runs alike in structure."""

from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from analysis.motion.endings import CONTACT_WOULD_PULL
from analysis.problem.checks import Array
from analysis.problem.constraints import multiplier_names
from analysis.simulation.compiled import systems
from analysis.simulation.compiled.library import heyoka
from analysis.simulation.compiled.systems import ALIVE, REASON, SIGN, WHEN, Structure

WIDEST_INDEX_1 = 4
"""Most members of a batch of an index-1 system.

Its code keeps most numbers on the stack, where LLVM lets wider ones straddle two lines of the
cache; batches of eight take 15 to 45 % longer for each member.
"""

MUTED = 1e-100
"""What the numbers that events look at are multiplied by: a step of heyoka errs by a part of the
largest number there is, theirs among them, such as the force of a heavy disk."""

COOLDOWN = 1e-9
"""Time in s after an event in which it is no other one; heyoka would guess it from the size of the
largest number there is, so long that a kink may lie within."""

COMPACT = False
"""Whether to compile in a quarter of the time for runs that take two to four times as long."""


Integrator = tuple[Any, list[list[float]]]
"""A `taylor_adaptive_batch` of heyoka, and of each run in it the times at which the contact has
begun or ceased to pull, if it may."""


class Code:
    """What is compiled of one structure; heyoka keeps it, too, on disk.

    Parameters
    ----------
    structure : Structure

    Attributes
    ----------
    structure : Structure
    reasons : ndarray of object
        Why a run may end.
    size : int
        Numbers of a state.
    angles : slice
        Columns of beta and gamma in it.
    """

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self._system = systems.build(structure)
        self.reasons = np.array(list(self._system.endings), dtype=object)
        self.size = len(self._system.variables)
        self.angles = slice(0, 2) if structure.formulation == "reduced" else slice(4, 6)
        self._held = 12 + len(multiplier_names(structure.equations.constraints))
        self._idle: defaultdict[tuple[float, int], list[Integrator]] = defaultdict(list)

    def __reduce__(self) -> tuple[Any, ...]:
        # What is compiled stays in its process; another one has its own, of all its runs.
        return code_for, (self.structure,)

    @contextmanager
    def integrator(self, local_tolerance: float, width: int) -> Iterator[Integrator]:
        """An integrator of so many runs at once that nobody else uses meanwhile."""
        idle = self._idle[local_tolerance, width]
        try:
            integrator = idle.pop()
        except IndexError:
            integrator = self._made(local_tolerance, width)
        yield integrator
        idle.append(integrator)

    def _made(self, local_tolerance: float, width: int) -> Integrator:
        library, system = heyoka(), self._system
        edges: list[list[float]] = [[] for _ in range(width)]
        events = []
        for number, (reason, symbol) in enumerate(system.endings.items()):
            direction, callback = library.event_direction.negative, _stop(number)
            if reason == CONTACT_WOULD_PULL and self.structure.allow_pulling:
                direction, callback = library.event_direction.any, _note(edges)
            how = {"direction": direction, "callback": callback, "cooldown": COOLDOWN}
            events.append(library.t_event_batch(MUTED * symbol, **how))
        # A step across friction's kink, or close by, has an error that its size does not show.
        # Where both slips come close to zero, one of them passes through it no farther from the
        # kink than the kink is off. The sign of one of two slips is of no use, and noting it
        # takes as long as half a step.
        passed = _flip if len(system.kinks) == 1 else _go_on
        how = {"callback": passed, "cooldown": COOLDOWN}
        events += [library.t_event_batch(MUTED * slip, **how) for slip in system.kinks]
        derivatives = system.derivatives
        if width > 1:
            derivatives = [library.par[ALIVE] * derivative for derivative in derivatives]
        solver = library.taylor_adaptive_batch(
            list(zip(system.variables, derivatives, strict=True)),
            np.zeros((len(derivatives), width)),
            tol=local_tolerance,
            t_events=events,
            compact_mode=COMPACT,
        )
        return solver, edges

    @property
    def width(self) -> int:
        """Members of a batch."""
        widest: int = heyoka().recommended_simd_size()
        return min(widest, WIDEST_INDEX_1) if self.structure.formulation == "index-1" else widest

    @cached_property
    def _readings(self) -> Any:
        return heyoka().cfunc(self._system.readings, self._system.variables, compact_mode=COMPACT)

    def readings(self, states: Array, times: Array, numbers: Array) -> tuple[Array, ...]:
        """What k members are at n states each.

        Parameters
        ----------
        states : ndarray, shape (k, n, d)
        times : ndarray, shape (k, n)
        numbers : ndarray, shape (k, p)

        Returns
        -------
        coordinates, rates : ndarray, shape (k, n, 6)
        multipliers, slips : ndarray, shapes (k, n, c) and (k, n, 0), (k, n, 1) or (k, n, 2)
        """
        function = self._readings
        given = np.repeat(numbers[:, : function.nparams].T, times.shape[1], axis=1)
        columns = np.ascontiguousarray(states.reshape(-1, states.shape[2]).T)
        found = function(columns, pars=given, time=times.reshape(-1))
        rows = np.ascontiguousarray(found.T).reshape(*times.shape, -1)
        held = self._held
        return rows[..., :6], rows[..., 6:12], rows[..., 12:held], rows[..., held:]


@lru_cache(maxsize=64)
def code_for(structure: Structure) -> Code:
    """Code of runs of this structure, which is compiled when a run first asks for it."""
    return Code(structure)


def _go_on(*_: Any) -> bool:
    return True


def _flip(solver: Any, direction: int, lane: int) -> bool:
    """Note the sign that a slip has from now on; the run goes on in a new step."""
    if direction != 0:
        solver.pars[SIGN, lane] = direction
    return True


def _stop(number: int) -> Callable[[Any, int, int], bool]:
    """What ends one run of a batch: its state stays what it is, and the others go on."""

    def stop(solver: Any, _: int, lane: int) -> bool:
        if solver.pars[ALIVE, lane] != 0.0:
            solver.pars[ALIVE, lane] = 0.0
            solver.pars[REASON, lane] = number
            solver.pars[WHEN, lane] = solver.time[lane]
        return bool(solver.pars[ALIVE].any())

    return stop


def _note(edges: list[list[float]]) -> Callable[[Any, int, int], bool]:
    """What notes when the contact of one run of a batch begins or ceases to pull."""

    def note(solver: Any, _: int, lane: int) -> bool:
        edges[lane].append(float(solver.time[lane]))
        return True

    return note
