"""heyoka driven by hand: what compiled runs are timed against.

The same symbols, sampled at the same times, with no ending looked out for, no constraint forces,
no check of the accuracy and nothing in between.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analysis import Form, Scenario
from analysis.compiled import systems
from analysis.compiled.code import code_for, kinks
from analysis.compiled.library import heyoka
from analysis.compiled.systems import SIGN, Structure
from analysis.data.checks import Array
from analysis.models.forms import start_values


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
    numbers = np.array([systems.parameters(member) for member in members])
    starts = np.array([start_values(member, form) for member in members])
    numbers[:, SIGN] = code_for(members[0], form, {}, allow_pulling=False).signs(starts, numbers)
    return systems.build(structure), numbers, starts
