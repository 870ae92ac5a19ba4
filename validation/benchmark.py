"""Speed of single runs, sweeps and ensembles: `tippedisk benchmark`.

Every time is the median of repeats after a warm-up, of processor time but for single compiled
runs; the way to rest is gone once. What is compared is called in turns. Single runs are whole
calls of a `simulate` function for Table 3 over 2 s, sampled every 0.01 s; errors are the largest
in beta and gamma over all samples, against DOP853 with a local tolerance of 3e-14, which differs
by less than 1e-12 rad from Radau. What a run may take grows with what this machine takes for
plain arithmetic.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from math import inf, sin
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import analysis
import mbs_models
from analysis import (
    MODELS,
    Dissipation,
    Ensemble,
    Formulation,
    Scenario,
    Start,
    Trajectory,
    simulate_many,
)
from analysis.simulation.compiled.library import is_installed
from analysis.stability import spectra
from analysis.stability.chart import stability_chart
from mbs_models import Scene
from mbs_models.rest import largest_step
from validation.comparison.differences import deviation
from validation.comparison.limits import holds
from validation.display.progress import counted
from validation.measurement.timing import in_turns
from validation.run import run
from validation.studies.comparisons import engine_matrices
from validation.study import Check
from validation.sweeps.axes import Axis, Design
from validation.sweeps.case import run_chunk
from validation.sweeps.plan import Plan
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep

TIMES = np.linspace(0.0, 2.0, 201)

MODEL_1, MODEL_2, MODEL_3, MODEL_4 = (Scenario(constraints=each) for each in MODELS.values())

How = dict[str, Any]
Timed = Callable[[], object]


PACE = 14.0
"""What `slowness` times takes in ms on the machine that the limits come from."""


def slowness() -> float:
    """Times as long as there that this machine takes for plain arithmetic; 1 at least."""
    (taken,) = milliseconds(lambda: sum(sin(1e-3 * each) for each in range(200_000)), repeats=7)
    return max(1.0, taken / PACE)


def measured(name: str, value: float, unit: str, limit: float = inf) -> Check:
    """A number with its unit, and what it may be at most; one without a limit holds.

    Limits of times are those of the machine they come from, and grow with `slowness`.
    """
    if unit in {"ms", "s"} and limit < inf:
        limit *= slowness()
    reached = limit == inf or holds(value, limit)
    return Check(f"{name} in {unit}" if unit else name, value, limit, "fresh", reached)


def milliseconds(
    *calls: Timed, repeats: int, clock: Callable[[], float] = time.process_time
) -> list[float]:
    """Median times of calls in turns in ms."""

    def taken(call: Timed) -> float:
        begin = clock()
        call()
        return 1e3 * (clock() - begin)

    timed = (partial(taken, call) for call in calls)
    return [median(times) for times in in_turns(*timed, pairs=repeats)]


TREE: How = {"formulation": "contact-tree"}

RUNS: tuple[tuple[str, Scenario, How, float, float], ...] = (
    ("engine, contact tree, step 5 ms", MODEL_1, {**TREE, "step": 5e-3}, 1e-6, 25.0),
    ("engine, contact tree, 2.5 ms", MODEL_1, {**TREE, "step": 2.5e-3}, 1e-9, 60.0),
    *(
        (f"engine, Euler tree, {each.name}, to 1e-6 rad", each,
         {"formulation": "euler-tree", "tolerance": 1e-6}, 1e-6, 800.0)
        for each in (MODEL_2, MODEL_3, MODEL_4)
    ),
    *(
        (f"in-house, {each.name}, {formulation}", each,
         {"source": "in-house", "formulation": formulation, "local_tolerance": local}, 1e-9, limit)
        for each, formulation, local, limit in (
            (MODEL_1, "index-1", 1e-10, 100.0), (MODEL_4, "reduced", 1e-10, 100.0),
            (MODEL_2, "index-1", 3e-12, 150.0), (MODEL_3, "index-1", 1e-11, 150.0),
        )
    ),
)  # fmt: skip
"""Label of a run, its scenario, how it is run, and most of its error in rad and time in ms."""

SWEPT: tuple[tuple[str, Scenario, How], ...] = (
    ("engine, contact tree, step 5 ms", MODEL_1, {"source": "engine", "step": 5e-3}),
    ("engine, local 1e-6", MODEL_1, {"source": "engine", "local_tolerance": 1e-6}),
    ("engine, to 1e-6 rad", MODEL_1, {"source": "engine", "tolerance": 1e-6}),
    ("engine, Euler tree, Model 2, step 5 ms", MODEL_2, {"source": "engine", "step": 5e-3}),
    ("in-house, Model 4, local 1e-6", MODEL_4, {"local_tolerance": 1e-6}),
)
"""Label of a sweep, its scenario and its plan."""

CASES = 10
"""Of a sweep that is timed."""

COMPILED: tuple[tuple[Scenario, Formulation, int], ...] = (
    (MODEL_1, "index-1", 64),
    (MODEL_4, "reduced", 512),
)
"""Scenario and formulation of a system that is compiled, and members of its ensemble."""


COMPILED_RUN: How = {"method": "taylor", "local_tolerance": 1e-9}


@cache
def _truth(scenario: Scenario) -> Trajectory:
    return analysis.simulate(scenario, TIMES, local_tolerance=3e-14)


def single_runs(repeats: int) -> Iterator[Check]:
    """Error and time of runs."""
    for label, scenario, how, error, limit in RUNS:
        call = partial(run, scenario, TIMES, **how)
        yield measured(f"{label}: error", deviation(call(), _truth(scenario)), "rad", error)
        yield measured(label, milliseconds(call, repeats=repeats)[0], "ms", limit)


def stability(repeats: int) -> Iterator[Check]:
    """Times of the eigenvalue work."""
    many, some = np.linspace(0.0, 60.0, 10_000), np.linspace(0.0, 80.0, 200)
    full = partial(spectra.branches, MODEL_1, many, system="full")
    chart = partial(stability_chart, MODEL_1, some, np.geomspace(0.3, 30.0, 200))
    engine = partial(engine_matrices, MODEL_1, np.linspace(0.0, 60.0, 100))
    calls: tuple[Timed, ...] = (full, chart, engine)
    full_time, chart_time, engine_time = milliseconds(*calls, repeats=min(repeats, 3))
    yield measured("10,000 spins of the full system, tracked branches", full_time, "ms", 500.0)
    yield measured("stability chart, 200 x 200", chart_time, "ms", 1000.0)
    yield measured("engine, Model 1, 100 spins", engine_time, "ms", 500.0)


class _Known(Plan):
    """A plan that makes each motion once."""

    motion = cache(Plan.motion)


def sweeps(repeats: int) -> Iterator[Check]:
    """What a sweep takes beside its runs: cases as a worker runs them, and stored.

    With the commits, of which there is one a second.
    """
    for label, scenario, how in SWEPT:
        axis = Axis(field="spin", first=30.0, last=50.0, count=CASES)
        plan, known = (kind(end=2.0, spacing=1e-2, **how) for kind in (Plan, _Known))
        sweep = Sweep(scenario=scenario, design=Design(axes=(axis,)), plan=plan)
        alone = [partial(plan.motion, sweep.scenario_of(n)) for n in range(CASES)]
        with TemporaryDirectory() as folder, Store(Path(folder) / "a.db", sweep) as store:

            def swept(sweep: Sweep, times: int, store: Store = store) -> None:
                for _ in range(times):
                    store.add(run_chunk(sweep, range(CASES)))

            # Some clocks do not tell a few milliseconds.
            ways = partial(swept, sweep, 1), partial(swept, replace(sweep, plan=known), 20)
            taken, beside, *runs = milliseconds(*ways, *alone, repeats=repeats)
        yield measured(f"{label}: over single runs", taken / sum(runs), "", 1.2)
        yield measured(f"{label}: beside each run", beside / (20 * CASES), "ms", 0.6)


def to_rest(_: int) -> Iterator[Check]:
    """The engine's long run to rest: half a minute for a minute of motion, and noise beside."""
    scene = Scene(Scenario.rest(dissipation=Dissipation(rolling_dry=2.5e-4, pivoting=8e-6)))
    begin = time.process_time()
    motion = mbs_models.simulate_to_rest(scene, 120.0, step=0.6 * largest_step(scene.scenario))
    taken = time.process_time() - begin
    if motion.rest_time is None:
        raise ArithmeticError("the disk did not come to rest")
    label = f"engine from Table 3 to rest after {motion.rest_time:.1f} s"
    yield measured(label, taken, "s", 0.6 * motion.rest_time)


def compiled_runs(repeats: int) -> Iterator[Check]:
    """Single compiled runs with an error of 1e-9 rad.

    One run of each, without the second one that a tolerance takes. Compiled code is warm.
    """
    for scenario, formulation, _ in COMPILED:
        label = f"{scenario.name}, {formulation}"
        how = COMPILED_RUN | {"formulation": formulation}
        call = partial(analysis.simulate, scenario, TIMES, **how)
        error = deviation(call(), _truth(scenario))
        yield measured(f"{label}, compiled: error", error, "rad", 1e-9)

        def ten(call: Timed = call) -> None:
            for _ in range(10):
                call()

        # Ten in a row, as in a loop: alone, a call waits for memory longer than it computes. By
        # the clock, since heyoka reads many states off on several threads, which wait for work.
        (taken,) = milliseconds(ten, repeats=repeats, clock=time.perf_counter)
        yield measured(f"{label}: compiled", 0.1 * taken, "ms")


def ensembles(repeats: int) -> Iterator[Check]:
    """Runs per second: pure, and compiled in batches.

    Compiled: an `Ensemble`, made and checked anew each time, and the arrays that come out; from a
    list: a Scenario and a Trajectory for each. To 1e-6 rad: with the second run that checks it.
    One run each: local tolerance 1e-9.
    """

    def many(formulation: Formulation, made: Callable[[], Any], how: How) -> object:
        return simulate_many(made(), TIMES, formulation=formulation, workers=1, **how)

    for scenario, formulation, size in COMPILED:
        base, spins = replace(scenario, start=Start(beta=1.5)), np.linspace(34.0, 50.0, size)
        anew = partial(Ensemble, scenario=base, fields={"spin": spins})
        members = list(anew())
        ways: dict[str, tuple[Callable[[], Any], How]] = {
            "pure to 1e-6 rad": (members[:4].copy, {"method": "DOP853", "tolerance": 1e-6}),
            "compiled to 1e-6 rad": (anew, {"method": "taylor", "tolerance": 1e-6}),
            "one run each, from a list": (members.copy, COMPILED_RUN),
            "one run each": (anew, COMPILED_RUN),
        }
        calls = (partial(many, formulation, *way) for way in ways.values())
        times = milliseconds(*calls, repeats=repeats)
        for (label, (made, _)), taken in zip(ways.items(), times, strict=True):
            yield measured(f"{scenario.name}: {label}", 1e3 * len(made()) / taken, "1/s")


def basin(repeats: int) -> Iterator[Check]:
    """A map of 100 by 100 starts of the reduced system, 4 s to 1e-6 rad, to its outcomes."""
    gamma, beta = np.meshgrid(
        np.linspace(-np.pi / 2, np.pi / 2, 100), np.linspace(0.87, 2.27, 100)
    )
    scenario = replace(MODEL_4, start=Start(spin=30.0))
    fields = {"gamma": gamma.ravel(), "beta": beta.ravel()}
    times = np.linspace(0.0, 4.0, 801)

    def judge() -> object:
        starts, how = Ensemble(scenario=scenario, fields=fields), {"formulation": "reduced"}
        found = simulate_many(starts, times, tolerance=1e-6, workers=1, **how)
        return found.inversions.outcomes

    (taken,) = milliseconds(judge, repeats=min(repeats, 3))
    yield measured("10,000 starts of the reduced system", 1e-3 * taken, "s", 10.0)


# --- All of it -----------------------------------------------------------------------------------

PARTS: tuple[Callable[[int], Iterator[Any]], ...] = (
    *(single_runs, stability, sweeps, to_rest),
    *((compiled_runs, ensembles, basin) if is_installed() else ()),
)


def measured_parts(repeats: int) -> dict[str, list[Check]]:
    """What is measured by so many calls each, by what it is about."""
    return {
        part.__name__.replace("_", " "): list(part(repeats)) for part in counted(PARTS, "parts")
    }
