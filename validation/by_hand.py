"""heyoka driven by hand: what compiled runs are timed against.

The same symbols, sampled at the same times, with no ending looked out for, no constraint forces,
no check of the accuracy and nothing in between.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analysis import Formulation, Scenario
from analysis.problem.checks import Array
from analysis.simulation.compiled import systems
from analysis.simulation.compiled.code import kinks
from analysis.simulation.compiled.ensemble import simulate_compiled
from analysis.simulation.compiled.library import heyoka
from analysis.simulation.request import Request


def single(
    scenario: Scenario, formulation: Formulation, local_tolerance: float, times: Array
) -> Callable[[], Any]:
    """Sampling of one run with an integrator of heyoka."""
    solver, numbers, starts = _solver([scenario], formulation, local_tolerance)

    def call() -> Any:
        solver.time = 0.0
        solver.state[:] = starts[0]
        solver.pars[:] = numbers[0]
        return solver.propagate_grid(times)

    return call


def batches(
    members: Sequence[Scenario], formulation: Formulation, local_tolerance: float, times: Array
) -> Callable[[], Any]:
    """Sampling of many runs with a batch integrator of heyoka."""
    width = heyoka().recommended_simd_size()
    solver, numbers, starts = _solver(members, formulation, local_tolerance, width)
    grid = np.ascontiguousarray(np.broadcast_to(times[:, None], (times.size, width)))

    def call() -> Any:
        samples = []
        for first in range(0, len(members), width):
            solver.set_time(0.0)
            solver.state[:] = starts[first : first + width].T
            solver.pars[:] = numbers[first : first + width].T
            samples.append(solver.propagate_grid(grid)[1])
        return samples

    return call


def _solver(
    members: Sequence[Scenario], formulation: Formulation, local_tolerance: float, width: int = 0
) -> tuple[Any, Array, Array]:
    """An integrator, or one for batches, and parameters and starts of members alike."""
    once = Request(
        times=np.array((0.0, 1e-3)), formulation=formulation, method="taylor", local_tolerance=1e-9
    )
    (part,), _ = simulate_compiled(members, once)
    system, starts = systems.build(part.group.code.structure), part.group.starts
    library = heyoka()
    make, event, state = library.taylor_adaptive, library.t_event, starts[0]
    if width:
        make, event = library.taylor_adaptive_batch, library.t_event_batch
        state = np.zeros((starts.shape[1], width))
    equations = list(zip(system.variables, system.derivatives, strict=True))
    solver = make(equations, state, tol=local_tolerance, t_events=kinks(system, event))
    return solver, part.group.numbers[:, : len(solver.pars)], starts
