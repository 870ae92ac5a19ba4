"""heyoka driven by hand: what compiled runs are timed against.

The same symbols, sampled at the same times, with no ending looked out for, no constraint forces,
no check of the accuracy and nothing in between.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analysis import Form, Scenario
from analysis.compiled import systems
from analysis.compiled.code import kinks
from analysis.compiled.ensemble import simulate_compiled
from analysis.compiled.library import heyoka
from analysis.compiled.systems import Structure
from analysis.data.checks import Array
from analysis.models.request import Request


def single(
    scenario: Scenario, form: Form, local_tolerance: float, times: Array
) -> Callable[[], Any]:
    """Sampling of one run with an integrator of heyoka."""
    system, numbers, start = _pieces([scenario], form)
    library = heyoka()
    solver = library.taylor_adaptive(
        list(zip(system.variables, system.derivatives, strict=True)),
        start[0],
        tol=local_tolerance,
        t_events=kinks(system, library.t_event),
    )

    def call() -> Any:
        solver.time = 0.0
        solver.state[:] = start[0]
        solver.pars[:] = numbers[0, : len(solver.pars)]
        return solver.propagate_grid(times)

    return call


def batches(
    members: Sequence[Scenario], form: Form, local_tolerance: float, times: Array
) -> Callable[[], Any]:
    """Sampling of many runs with a batch integrator of heyoka."""
    system, numbers, starts = _pieces(members, form)
    library = heyoka()
    width = library.recommended_simd_size()
    solver = library.taylor_adaptive_batch(
        list(zip(system.variables, system.derivatives, strict=True)),
        np.zeros((starts.shape[1], width)),
        tol=local_tolerance,
        t_events=kinks(system, library.t_event_batch),
    )
    grid = np.ascontiguousarray(np.broadcast_to(times[:, None], (times.size, width)))

    def call() -> Any:
        samples = []
        for first in range(0, len(members), width):
            solver.set_time(0.0)
            solver.state[:] = starts[first : first + width].T
            solver.pars[:] = numbers[first : first + width, : len(solver.pars)].T
            samples.append(solver.propagate_grid(grid)[1])
        return samples

    return call


def _pieces(members: Sequence[Scenario], form: Form) -> tuple[systems.System, Array, Array]:
    """Symbols, parameters and starts of members alike in structure."""
    structure = Structure.of(members[0], form, {}, allow_pulling=False)
    once = Request(times=np.array((0.0, 1e-3)), form=form, method="taylor", local_tolerance=1e-9)
    (part,), _ = simulate_compiled(members, once)
    return systems.build(structure), part.group.numbers, part.group.starts
