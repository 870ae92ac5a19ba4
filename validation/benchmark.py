"""Speed and memory of single runs: `python -m validation.benchmark`.

Every time is the median processor time of repeats after a warm-up, in one thread, of one whole
call of a `simulate` function for Table 3 over 2 s, sampled every 0.01 s; errors are the largest
in beta and gamma over all samples, against a run of the other side's equations where there is
one.
"""

import argparse
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import analysis
import mbs_models
from analysis import (
    MODELS,
    STEEL_DISK,
    Dissipation,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Trajectory,
)
from analysis.compiled.library import is_installed
from analysis.stability import spectra
from analysis.stability.chart import stability_chart
from mbs_models import Integrator, Scene
from mbs_models.own_runs import run_over
from mbs_models.rest_run import largest_step
from validation.kit.limits import holds
from validation.kit.provenance import machine
from validation.kit.references import deviation
from validation.kit.tables import Cell, Table
from validation.run import run
from validation.studies import compiled_speed
from validation.studies.stability.eigenvalue_check import engine_matrices
from validation.sweeps.axes import Axis, Design
from validation.sweeps.plan import Plan
from validation.sweeps.runner import run_chunk
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep

TIMES = np.linspace(0.0, 2.0, 201)

_SWEPT = 10
"""Cases of a sweep that is timed."""

MODEL_SCENARIOS = tuple(Scenario(constraints=each) for each in MODELS.values())
MODEL_1, MODEL_2, MODEL_3, MODEL_4 = MODEL_SCENARIOS


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One benchmark: how to run it, and the error and time it should stay below."""

    label: str
    scenario: Scenario
    how: dict[str, Any]
    error: float
    milliseconds: float

    def call(self) -> Trajectory:
        """Run it once."""
        return run(self.scenario, TIMES, **self.how)

    def solver_seconds(self) -> float | None:
        """Processor time of the engine's integration alone in s, if it is run with a step."""
        if "step" not in self.how:
            return None
        scene = Scene(self.scenario, self.how["formulation"])
        return run_over(scene, TIMES, Integrator(name="RK67"), self.how["step"]).seconds


def rows() -> list[Row]:
    """The runs with an error and a time to reach."""
    result = [
        Row(
            label=f"engine, contact tree, step {step:g} s",
            scenario=MODEL_1,
            how={"formulation": "contact-tree", "step": step},
            error=error,
            milliseconds=limit,
        )
        for step, error, limit in ((5e-3, 1e-6, 25.0), (2.5e-3, 1e-9, 60.0))
    ]
    result += [
        Row(
            label=f"engine, Euler tree, {scenario.name}, to tolerance",
            scenario=scenario,
            how={"formulation": "euler-tree", "tolerance": 1e-6},
            error=1e-6,
            milliseconds=800.0,
        )
        for scenario in (MODEL_2, MODEL_3, MODEL_4)
    ]
    result += [
        Row(
            label=f"in-house, {scenario.name}, {form}",
            scenario=scenario,
            how={"source": "in-house", "formulation": form, "local_tolerance": local},
            error=1e-9,
            milliseconds=limit,
        )
        for scenario, local, form, limit in (
            (MODEL_1, 1e-10, "index-1", 100.0),
            (MODEL_4, 1e-10, "reduced", 100.0),
            (MODEL_2, 3e-12, "index-1", 150.0),
            (MODEL_3, 1e-11, "index-1", 150.0),
        )
    ]
    return result


def median_milliseconds(
    call: Callable[[], object], repeats: int, clock: Callable[[], float] = time.process_time
) -> float:
    """Median time of a call after a warm-up in ms."""
    call()
    times = []
    for _ in range(repeats):
        begin = clock()
        call()
        times.append(clock() - begin)
    return 1e3 * statistics.median(times)


def targets(repeats: int) -> Table:
    """Error and time of every row beside what it should stay below."""
    truths = {
        scenario.name: analysis.simulate(scenario, TIMES, local_tolerance=1e-13)
        for scenario in MODEL_SCENARIOS
    }
    cells: list[list[Cell]] = []
    for row in rows():
        error = deviation(row.call(), truths[row.scenario.name])
        taken = median_milliseconds(row.call, repeats)
        solver = [each for _ in range(repeats) if (each := row.solver_seconds()) is not None]
        cells.append(
            [
                row.label,
                error,
                row.error,
                round(taken, 1),
                row.milliseconds,
                round(1e3 * statistics.median(solver), 1) if solver else None,
                holds(error, row.error) and holds(taken, row.milliseconds),
            ]
        )
    return Table(
        name="targets",
        title="Single runs",
        columns=(
            "run",
            "error in rad",
            "at most",
            "time in ms",
            "at most",
            "of it the solver's",
            "reached",
        ),
        rows=cells,
        note="Truth: DOP853 with a local tolerance of 1e-13, which differs by less than 1e-12 rad "
        "from Radau.",
    )


def load_laws(repeats: int) -> Table:
    """What it costs that the friction law knows the contact force."""
    cells: list[list[Cell]] = []
    for scenario in MODEL_SCENARIOS:
        taken = []
        for load in analysis.LOADS:
            scene = Scene(replace(scenario, friction=SmoothCoulomb(load=load)), "euler-tree")
            call = partial(mbs_models.simulate, scene, TIMES, step=2.5e-3)
            taken.append(median_milliseconds(call, repeats))
        cells.append([scenario.name, round(taken[0], 1), round(taken[1], 1), taken[1] / taken[0]])
    return Table(
        name="load-laws",
        title="Load of the friction law: weight or contact force (Euler tree, step 2.5 ms)",
        columns=("model", "weight in ms", "contact force in ms", "ratio"),
        rows=cells,
    )


def stability(repeats: int) -> Table:
    """Times of the eigenvalue work beside what they should stay below."""
    many = np.linspace(0.0, 60.0, 10_000)
    calls: list[tuple[str, Callable[[], object], float]] = [
        (
            "10,000 spins of the full system, tracked branches",
            partial(spectra.branches, MODEL_1, many, system="full"),
            1500.0,
        ),
        (
            "stability chart, 200 x 200",
            partial(
                stability_chart,
                MODEL_1,
                np.linspace(0.0, 80.0, 200),
                np.geomspace(0.3, 30.0, 200),
            ),
            10_000.0,
        ),
        (
            "engine, Model 1, 100 spins",
            partial(engine_matrices, MODEL_1, np.linspace(0.0, 60.0, 100)),
            5000.0,
        ),
    ]
    cells: list[list[Cell]] = []
    for label, call, limit in calls:
        taken = median_milliseconds(call, min(repeats, 3))
        cells.append([label, round(taken), limit, holds(taken, limit)])
    return Table(
        name="stability-speed",
        title="Linear stability",
        columns=("task", "time in ms", "at most", "reached"),
        rows=cells,
    )


def engine_sweeps(repeats: int) -> Table:
    """What a sweep of the engine takes beside its runs, made one by one."""
    cells: list[list[Cell]] = []
    ways: tuple[tuple[Scenario, str, dict[str, Any]], ...] = (
        (MODEL_1, "contact-tree", {"step": 5e-3}),
        (MODEL_1, "contact-tree", {"local_tolerance": 1e-6}),
        (MODEL_1, "contact-tree", {"tolerance": 1e-6}),
        (MODEL_2, "euler-tree", {"step": 5e-3}),
    )
    for scenario, form, how in ways:
        plan = Plan(source="engine", formulation=form, end=2.0, spacing=1e-2, **how)
        axis = Axis(field="spin", first=30.0, last=50.0, count=_SWEPT)
        sweep = Sweep(scenario=scenario, design=Design(axes=(axis,)), plan=plan)
        ratios, swept = _sweep_ratios(sweep, repeats)
        ratio = statistics.median(ratios)
        told = ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in how.items())
        label = f"{form}, {scenario.name}, {told}"
        cells.append([label, round(swept, 1), ratio, 1.2, holds(ratio, 1.2)])
    return Table(
        name="engine-sweeps",
        title="Sweeps of the engine",
        columns=("sweep", "time of a case in ms", "over a single run", "at most", "reached"),
        rows=cells,
        note=f"{_SWEPT} cases as a worker runs them, and stored; single runs: `run` of the same "
        "scenarios in the same process, in turns. Starting the processes comes on top, once.",
    )


def _sweep_ratios(sweep: Sweep, repeats: int) -> tuple[list[float], float]:
    """Time of a sweep over that of its runs in several turns, and its median for a case in ms."""
    plan, numbers = sweep.plan, range(sweep.design.size)
    scenarios = [sweep.scenario_of(number) for number in numbers]
    with TemporaryDirectory() as folder, Store(Path(folder) / "a.db", sweep) as store:

        def swept() -> None:
            store.add(run_chunk(sweep.to_text(), numbers, 60.0, 200.0))
            store.commit()

        def single() -> None:
            for scenario in scenarios:
                plan.motion(scenario, time_limit=None)

        pairs = [
            [median_milliseconds(call, 1) for call in (swept, single)] for _ in range(repeats)
        ]
    times, singles = np.array(pairs).T
    return (times / singles).tolist(), float(np.median(times)) / len(scenarios)


def to_rest() -> Table:
    """A long run from Table 3 to rest, and how right its phase times before the fall are."""
    dissipation = Dissipation(rolling_dry=2.5e-4, pivoting=8e-6)
    scene = Scene(Scenario.rest(dissipation=dissipation))
    begin = time.process_time()
    motion = mbs_models.simulate_to_rest(scene, 120.0, step=0.6 * largest_step(scene))
    taken = time.process_time() - begin
    converged = analysis.simulate_to_rest(
        Scenario.rest(
            contact=PenaltyContact.rounded(STEEL_DISK, stiffness=1e7, half_thickness=2e-5),
            dissipation=dissipation,
        ),
        25.0,
    ).phases
    found = motion.phases
    if found.rest is None:
        raise ArithmeticError("the disk did not come to rest")
    limit = 30.0 * found.rest / 60.0
    cells: list[list[Cell]] = [
        ["run time in s", taken, limit, holds(taken, limit)],
    ]
    for name in ("inversion", "inversion_lost"):
        off = abs(getattr(found, name) / getattr(converged, name) - 1.0)
        cells.append([f"{name.replace('_', ' ')}, relative error", off, 0.01, holds(off, 0.01)])
    return Table(
        name="to-rest",
        title=f"Engine from Table 3 to rest after {found.rest:.1f} s",
        columns=("quantity", "value", "at most", "reached"),
        rows=cells,
        note="Run time: at most 30 s for 60 simulated seconds. Converged phase times: in-house on "
        "a contact ten times as stiff with a rim a tenth as thick.",
    )


def start_up() -> Table:
    """Time of a new process until it has imported a package or shown the help."""
    calls = {
        "tippedisk --help": "from validation.cli import main\ntry: main(['--help'])\n"
        "except SystemExit: pass",
        "import analysis": "import analysis",
        "import mbs_models": "import mbs_models",
    }
    cells: list[list[Cell]] = []
    for label, code in calls.items():
        command = [sys.executable, "-c", code]
        taken = median_milliseconds(
            partial(subprocess.check_output, command), 5, time.perf_counter
        )
        cells.append([label, round(taken)])
    return Table(name="start-up", title="Start-up", columns=("call", "time in ms"), rows=cells)


def compiled(repeats: int) -> list[Table]:
    """Compiled runs, if heyoka is installed."""
    if not is_installed():
        return []
    milliseconds = partial(median_milliseconds, repeats=repeats)
    few = partial(median_milliseconds, repeats=min(repeats, 3))
    return [
        compiled_speed.single_runs(milliseconds),
        compiled_speed.ensembles(milliseconds),
        compiled_speed.basin(few),
    ]


def main() -> int:
    """Print all tables; 1 if one of them misses what it should reach."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=7, help="timed calls of each run (7)")
    repeats = parser.parse_args().repeats
    tables = (
        targets(repeats),
        stability(repeats),
        engine_sweeps(min(repeats, 3)),
        to_rest(),
        load_laws(repeats),
        start_up(),
        *compiled(repeats),
    )
    for table in tables:
        print(f"{table.title}\n{table.to_text()}\n")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"Largest memory of this process: {memory:.0f} MB. Machine: {machine()}.")
    return 0 if all(all(table.checks()) for table in tables) else 1


if __name__ == "__main__":
    raise SystemExit(main())
