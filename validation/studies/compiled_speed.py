"""Compiled runs beside pure ones and beside heyoka driven by hand, in one run.

Driven by hand means: the same symbols, sampled at the same times, with no ending looked out for,
no constraint forces, no check of the accuracy and nothing in between.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from analysis import MODELS, Ensemble, Form, Method, Scenario, Start, simulate, simulate_many
from analysis.compiled import systems
from analysis.compiled.code import code_of, kinks
from analysis.compiled.library import heyoka
from analysis.compiled.places import deeper
from analysis.compiled.systems import SIGN, Structure
from analysis.data.checks import Array
from analysis.models.forms import start_values
from analysis.models.simulation import COMPILED_TOLERANCES
from validation.kit.limits import holds
from validation.kit.references import deviation
from validation.kit.tables import Cell, Table

TIMES = np.linspace(0.0, 2.0, 201)
ERRORS = (1e-6, 1e-9, 1e-12)

Milliseconds = Callable[[Callable[[], object]], float]
"""Median time of a call in ms."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Case:
    """What is run, from Table 3."""

    label: str
    scenario: Scenario
    form: Form
    members: int

    def simulate(self, method: Method, local_tolerance: float) -> Any:
        """Run it once to a local tolerance."""
        return simulate(
            self.scenario, TIMES, form=self.form, method=method, local_tolerance=local_tolerance
        )

    def ensemble(self) -> Ensemble:
        """Spins at which the disk is inverted."""
        base = replace(self.scenario, start=Start(beta=1.5))
        return Ensemble(scenario=base, fields={"spin": np.linspace(34.0, 50.0, self.members)})


CASES = (
    _Case(label="Model 1, index 1", scenario=Scenario(), form="index-1", members=64),
    _Case(
        label="Model 4, reduced",
        scenario=Scenario(constraints=MODELS[4]),
        form="reduced",
        members=512,
    ),
)


def single_runs(milliseconds: Milliseconds) -> Table:
    """Time of single runs to an error: pure, compiled, and by hand."""
    cells: list[list[Cell]] = []
    for case in CASES:
        truth = case.simulate("DOP853", 3e-14)
        for error in ERRORS:
            pure = compiled = hand = None
            local = _first(case, "DOP853", [10.0**-power for power in range(6, 14)], error, truth)
            if local is not None:
                pure = milliseconds(partial(case.simulate, "DOP853", local))
            local = _first(case, "taylor", COMPILED_TOLERANCES, error, truth)
            if local is not None:
                ours = partial(case.simulate, "taylor", local)
                compiled, hand = in_turns(
                    milliseconds, ours, by_hand(case.scenario, case.form, local), calls=10
                )
            ratios = [
                None if above is None or below is None else above / below
                for above, below in ((pure, compiled), (compiled, hand))
            ]
            cells.append([case.label, error, pure, compiled, hand, *ratios])
    return Table(
        name="compiled-runs",
        title="Single runs of 2 s to an error: pure, compiled, heyoka driven by hand",
        columns=(
            "system",
            "error in rad",
            "pure in ms",
            "compiled in ms",
            "by hand in ms",
            "pure / compiled",
            "compiled / by hand",
        ),
        rows=cells,
        note="One run of each, without the second one that a tolerance takes. Truth: DOP853 with "
        "a local tolerance of 3e-14. Compiled code is warm.",
    )


def ensembles(milliseconds: Milliseconds) -> Table:
    """Runs per second on one core: pure, compiled in batches, and batches by hand."""
    cells: list[list[Cell]] = []
    for case in CASES:
        run = partial(simulate_many, times=TIMES, form=case.form, workers=1)
        once = partial(run, method="taylor", local_tolerance=1e-9)
        few, members = list(case.ensemble().part(slice(4))), list(case.ensemble())
        pure = partial(run, few, method="DOP853", tolerance=1e-6)
        checked = partial(_made, case, method="taylor", tolerance=1e-6)
        listed = partial(once, members)
        ours = partial(_made, case, method="taylor", local_tolerance=1e-9)
        turns = in_turns(milliseconds, ours, batches_by_hand(members, case.form, 1e-9))
        taken = [milliseconds(pure) / len(few)]
        taken += [milliseconds(call) / case.members for call in (checked, listed)]
        taken += [each / case.members for each in turns]
        cells.append([case.label, *(round(1e3 / each) for each in taken), turns[0] / turns[1]])
    return Table(
        name="compiled-ensembles",
        title="Ensembles of runs of 2 s on one core, in runs per second",
        columns=(
            "system",
            "pure to 1e-6 rad",
            "compiled to 1e-6 rad",
            "one run each, from a list",
            "one run each",
            "one run each, by hand",
            "compiled / by hand",
        ),
        rows=cells,
        note="Compiled: an `Ensemble`, made and checked anew each time, and the arrays that come "
        "out; from a list: a Scenario and a Trajectory for each. To 1e-6 rad: with the second "
        "run that checks it. One run each: local tolerance 1e-9. By hand, nothing is made of the "
        "sampled states. The ratio is that of times, at most 1.5 to be reached.",
    )


def basin(milliseconds: Milliseconds) -> Table:
    """Time of a map of 100 by 100 starts of the reduced system, from its fields to its classes."""
    gamma, beta = np.meshgrid(
        np.linspace(-np.pi / 2, np.pi / 2, 100), np.linspace(0.87, 2.27, 100)
    )
    scenario = Scenario(constraints=MODELS[4], start=Start(spin=30.0))
    fields = {"gamma": gamma.ravel(), "beta": beta.ravel()}
    times = np.linspace(0.0, 4.0, 801)

    def inverted() -> int:
        starts = Ensemble(scenario=scenario, fields=fields)
        runs = simulate_many(starts, times, form="reduced", tolerance=1e-6, workers=1)
        return int(np.sum(runs.inversions.outcomes == "inverted"))

    seconds = 1e-3 * milliseconds(inverted)
    return Table(
        name="compiled-basin",
        title="Map of 100 by 100 starts of the reduced system, each of 4 s to 1e-6 rad",
        columns=("starts", "inverted for good", "time in s", "at most", "reached"),
        rows=[[gamma.size, inverted(), seconds, 10.0, holds(seconds, 10.0)]],
        note="Processor time on one core, with the second run that checks each.",
    )


def _made(case: _Case, **how: Any) -> Any:
    return simulate_many(case.ensemble(), TIMES, form=case.form, workers=1, **how)


def in_turns(
    milliseconds: Milliseconds,
    ours: Callable[[], object],
    hand: Callable[[], object],
    calls: int = 1,
) -> tuple[float, float]:
    """Times of a call and of one by hand in ms, so that both find the machine alike.

    In turns, for a machine that is busy now and then; and each from four places on the stack:
    batches keep most numbers there, as wide as registers, and where it happens to lie decides
    how many of them straddle two lines of the cache, which takes up to a third of the time.
    The means of both are told.
    """

    def repeated(call: Callable[[], object]) -> None:
        for _ in range(calls):
            call()

    turns: list[list[float]] = []
    both: list[Callable[[], object]] = [partial(repeated, call) for call in (ours, hand)]
    for _ in range(4):
        turns.append([milliseconds(call) / calls for call in both])
        both = [partial(deeper, call) for call in both]
    mean = np.mean(turns, axis=0)
    return float(mean[0]), float(mean[1])


def _first(
    case: _Case, method: Method, ladder: Sequence[float], error: float, truth: Any
) -> float | None:
    """The loosest local tolerance of a ladder with which the error is kept."""
    for local in ladder:
        if local <= 10.0 * error and deviation(case.simulate(method, local), truth) <= error:
            return local
    return None


def by_hand(scenario: Scenario, form: Form, local_tolerance: float) -> Callable[[], Any]:
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
        return solver.propagate_grid(TIMES)

    return call


def batches_by_hand(
    members: Sequence[Scenario], form: Form, local_tolerance: float
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
    grid = np.ascontiguousarray(np.broadcast_to(TIMES[:, None], (TIMES.size, width)))

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
    numbers[:, SIGN] = code_of(structure).signs(starts, numbers)
    return systems.build(structure), numbers, starts
