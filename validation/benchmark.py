"""Speed and memory of single runs, sweeps and ensembles: `python -m validation.benchmark`.

Every time is the median processor time of repeats after a warm-up, in one thread; what is
compared is called in turns. Single runs are whole calls of a `simulate` function for Table 3 over
2 s, sampled every 0.01 s; errors are the largest in beta and gamma over all samples, against
DOP853 with a local tolerance of 3e-14, which differs by less than 1e-12 rad from Radau.
"""

import argparse
import resource
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from itertools import product
from math import inf
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

import analysis
import mbs_models
from analysis import (
    MODELS,
    STEEL_DISK,
    Dissipation,
    Ensemble,
    Form,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Trajectory,
    simulate_many,
)
from analysis.compiled.library import is_installed
from analysis.data.checks import Array
from analysis.models.request import COMPILED_TOLERANCES
from analysis.stability import spectra
from analysis.stability.chart import stability_chart
from mbs_models import Scene
from mbs_models.rest_run import largest_step
from validation import by_hand
from validation.kit.limits import holds
from validation.kit.provenance import machine
from validation.kit.references import deviation
from validation.kit.tables import show
from validation.kit.timing import in_turns
from validation.run import run
from validation.studies.stability.eigenvalue_check import engine_matrices
from validation.sweeps.axes import Axis, Design
from validation.sweeps.case import run_chunk
from validation.sweeps.plan import Plan
from validation.sweeps.store import Store
from validation.sweeps.sweep import Sweep

TIMES = np.linspace(0.0, 2.0, 201)
ERRORS = (1e-6, 1e-9, 1e-12)

MODEL_1, MODEL_2, MODEL_3, MODEL_4 = (Scenario(constraints=each) for each in MODELS.values())

How = dict[str, Any]
Timed = Callable[[], object]


class Measured(NamedTuple):
    """A number with its unit, and what it may be at most."""

    name: str
    value: float
    unit: str
    limit: float = inf

    @property
    def reached(self) -> bool:
        """Whether it is as it should be; one without a limit is."""
        return self.limit == inf or holds(self.value, self.limit)

    def text(self) -> str:
        """It in a line."""
        told = f"{self.name:62}{show(self.value, 3):>9} {self.unit:5}"
        bound = f"  at most {self.limit:g}: {show(self.reached)}" if self.limit < inf else ""
        return told + bound


def milliseconds(*calls: Timed, repeats: int) -> list[float]:
    """Median times of calls in turns in ms."""
    return [1e3 * median(times) for times in in_turns(*calls, pairs=repeats)]


def _engine(formulation: str, **how: Any) -> How:
    return {"formulation": formulation, **how}


def _in_house(**how: Any) -> How:
    return {"source": "in-house", **how}


RUNS: tuple[tuple[str, Scenario, How, float, float], ...] = (
    ("engine, contact tree, step 5 ms", MODEL_1, _engine("contact-tree", step=5e-3), 1e-6, 25.0),
    ("engine, contact tree, 2.5 ms", MODEL_1, _engine("contact-tree", step=2.5e-3), 1e-9, 60.0),
    *(
        (f"engine, Euler tree, {each.name}, to 1e-6 rad", each,
         _engine("euler-tree", tolerance=1e-6), 1e-6, 800.0)
        for each in (MODEL_2, MODEL_3, MODEL_4)
    ),
    ("in-house, Model 1", MODEL_1, _in_house(local_tolerance=1e-10), 1e-9, 100.0),
    ("in-house, Model 4, reduced", MODEL_4,
     _in_house(formulation="reduced", local_tolerance=1e-10), 1e-9, 100.0),
    ("in-house, Model 2", MODEL_2, _in_house(local_tolerance=3e-12), 1e-9, 150.0),
    ("in-house, Model 3", MODEL_3, _in_house(local_tolerance=1e-11), 1e-9, 150.0),
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

COMPILED: tuple[tuple[Scenario, Form, int], ...] = (
    (MODEL_1, "index-1", 64),
    (MODEL_4, "reduced", 512),
)
"""Scenario and form of a system that is compiled, and members of its ensemble."""


@cache
def _truth(scenario: Scenario) -> Trajectory:
    return analysis.simulate(scenario, TIMES, local_tolerance=3e-14)


def single_runs(repeats: int) -> Iterator[Measured]:
    """Error and time of runs, and what of it is the solver's."""
    for label, scenario, how, error, limit in RUNS:
        call = partial(run, scenario, TIMES, **how)
        yield Measured(f"{label}: error", deviation(call(), _truth(scenario)), "rad", error)
        yield Measured(label, milliseconds(call, repeats=repeats)[0], "ms", limit)
        if "step" in how:
            scene = Scene(scenario, how["formulation"])
            solver = partial(mbs_models.simulate, scene, TIMES, step=how["step"])
            taken = 1e3 * median(solver().solver_seconds or inf for _ in range(repeats))
            yield Measured(f"{label}: of it the solver's", taken, "ms")


def load_laws(repeats: int) -> Iterator[Measured]:
    """What it costs that the friction law knows the contact force (Euler tree, step 2.5 ms)."""
    for scenario in (MODEL_1, MODEL_2, MODEL_3, MODEL_4):
        laws = [SmoothCoulomb(load=load) for load in analysis.LOADS]
        scenes = [Scene(replace(scenario, friction=law), "euler-tree") for law in laws]
        calls = [partial(mbs_models.simulate, scene, TIMES, step=2.5e-3) for scene in scenes]
        weight, contact = milliseconds(*calls, repeats=repeats)
        yield Measured(f"{scenario.name}: contact force over weight as load", contact / weight, "")


def stability(repeats: int) -> Iterator[Measured]:
    """Times of the eigenvalue work."""
    many, some = np.linspace(0.0, 60.0, 10_000), np.linspace(0.0, 80.0, 200)
    full = partial(spectra.branches, MODEL_1, many, system="full")
    chart = partial(stability_chart, MODEL_1, some, np.geomspace(0.3, 30.0, 200))
    engine = partial(engine_matrices, MODEL_1, np.linspace(0.0, 60.0, 100))
    calls: tuple[tuple[str, Timed, float], ...] = (
        ("10,000 spins of the full system, tracked branches", full, 1500.0),
        ("stability chart, 200 x 200", chart, 10_000.0),
        ("engine, Model 1, 100 spins", engine, 5000.0),
    )
    for label, call, limit in calls:
        yield Measured(label, milliseconds(call, repeats=min(repeats, 3))[0], "ms", limit)


def sweeps(repeats: int) -> Iterator[Measured]:
    """What a sweep takes beside its runs: cases as a worker runs them, and stored.

    Without the commits, of which there is one a second.
    """
    for label, scenario, how in SWEPT:
        axis = Axis(field="spin", first=30.0, last=50.0, count=CASES)
        plan = Plan(end=2.0, spacing=1e-2, **how)
        sweep = Sweep(scenario=scenario, design=Design(axes=(axis,)), plan=plan)
        swept, runs = sweep_times(sweep, repeats)
        yield Measured(f"{label}: over single runs", swept / runs, "", 1.2)
        yield Measured(f"{label}: beside each run", (swept - runs) / CASES, "ms")


def sweep_times(sweep: Sweep, repeats: int) -> tuple[float, float]:
    """Time in ms of a sweep in this process, and of its runs made one by one."""
    numbers = range(sweep.design.size)
    scenarios = [sweep.scenario_of(number) for number in numbers]
    with TemporaryDirectory() as folder, Store(Path(folder) / "a.db", sweep) as store:

        def swept() -> None:
            store.add(run_chunk(sweep, numbers, 60.0, 200.0))

        def single() -> None:
            for scenario in scenarios:
                sweep.plan.motion(scenario, time_limit=None)

        taken, alone = milliseconds(swept, single, repeats=repeats)
    return taken, alone


def to_rest(_: int) -> Iterator[Measured]:
    """The engine's long run to rest, and its phase times before the fall.

    These are compared with in-house ones on a contact ten times as stiff with a rim a tenth as
    thick. A minute of motion may take half a minute.
    """
    dissipation = Dissipation(rolling_dry=2.5e-4, pivoting=8e-6)
    scene = Scene(Scenario.rest(dissipation=dissipation))
    begin = time.process_time()
    motion = mbs_models.simulate_to_rest(scene, 120.0, step=0.6 * largest_step(scene))
    taken = time.process_time() - begin
    found = motion.phases
    if found.rest is None:
        raise ArithmeticError("the disk did not come to rest")
    yield Measured(f"engine from Table 3 to rest after {found.rest:.1f} s", taken, "s",
                   0.5 * found.rest)  # fmt: skip
    contact = PenaltyContact.rounded(STEEL_DISK, stiffness=1e7, half_thickness=2e-5)
    stiff = Scenario.rest(contact=contact, dissipation=dissipation)
    converged = analysis.simulate_to_rest(stiff, 25.0).phases
    for name in ("inversion", "inversion_lost"):
        off = abs(getattr(found, name) / getattr(converged, name) - 1.0)
        yield Measured(f"{name.replace('_', ' ')}, relative error", off, "", 0.01)


def compiled_runs(repeats: int) -> Iterator[Measured]:
    """Single runs to an error: pure, compiled, and heyoka driven by hand.

    One run of each, without the second one that a tolerance takes. Compiled code is warm.
    """
    ladders = {"DOP853": [10.0**-power for power in range(6, 14)], "taylor": COMPILED_TOLERANCES}
    for (scenario, form, _), error in product(COMPILED if is_installed() else (), ERRORS):
        label = f"{scenario.name}, {form}, to {error:g} rad"
        found: dict[str, tuple[float, Timed]] = {}
        for (method, ladder), local in product(ladders.items(), range(8)):
            # The loosest local tolerance with which the error is kept.
            if method in found or local >= len(ladder) or ladder[local] > 10.0 * error:
                continue
            how: How = {"form": form, "method": method, "local_tolerance": ladder[local]}
            call = partial(analysis.simulate, scenario, TIMES, **how)
            if deviation(call(), _truth(scenario)) <= error:
                found[method] = ladder[local], call
        if "DOP853" in found:
            (taken,) = milliseconds(found["DOP853"][1], repeats=repeats)
            yield Measured(f"{label}: pure", taken, "ms")
        if "taylor" in found:
            local_tolerance, ours = found["taylor"]
            hand = by_hand.single(scenario, form, local_tolerance, TIMES)
            taken, by = from_all_places(ours, hand, repeats=repeats, calls=10)
            yield Measured(f"{label}: compiled", taken, "ms")
            yield Measured(f"{label}: by hand", by, "ms")


def ensembles(repeats: int) -> Iterator[Measured]:
    """Runs per second: pure, compiled in batches, and batches by hand.

    Compiled: an `Ensemble`, made and checked anew each time, and the arrays that come out; from a
    list: a Scenario and a Trajectory for each. To 1e-6 rad: with the second run that checks it.
    One run each: local tolerance 1e-9. By hand, nothing is made of the sampled states.
    """
    for scenario, form, size in COMPILED if is_installed() else ():
        base, spins = replace(scenario, start=Start(beta=1.5)), np.linspace(34.0, 50.0, size)

        def made(base: Scenario = base, spins: Array = spins) -> Ensemble:
            return Ensemble(scenario=base, fields={"spin": spins})

        def many(members: Any = None, form: Form = form, **how: Any) -> object:
            found: object = simulate_many(members or made(), TIMES, form=form, workers=1, **how)
            return found

        members = list(made())
        once: How = {"method": "taylor", "local_tolerance": 1e-9}
        few = partial(many, members[:4], method="DOP853", tolerance=1e-6)
        calls: tuple[tuple[str, Timed, int], ...] = (
            ("pure to 1e-6 rad", few, 4),
            ("compiled to 1e-6 rad", partial(many, method="taylor", tolerance=1e-6), size),
            ("one run each, from a list", partial(many, members, **once), size),
        )
        for label, call, count in calls:
            (taken,) = milliseconds(call, repeats=repeats)
            yield Measured(f"{scenario.name}: {label}", 1e3 * count / taken, "1/s")
        hand = by_hand.batches(members, form, 1e-9, TIMES)
        both = from_all_places(partial(many, **once), hand, repeats=repeats)
        for label, taken in zip(("one run each", "one run each, by hand"), both, strict=True):
            yield Measured(f"{scenario.name}: {label}", 1e3 * size / taken, "1/s")


def from_all_places(
    ours: Callable[[], object], hand: Callable[[], object], *, repeats: int, calls: int = 1
) -> tuple[float, float]:
    """Times of a call and of one by hand in ms, in turns, so that both find the machine alike.

    Each from four places on the stack: batches keep most numbers there, as wide as registers, and
    where it happens to lie decides how many of them straddle two lines of the cache, which takes
    up to a third of the time. The means are told.
    """

    def repeated(call: Callable[[], object]) -> None:
        for _ in range(calls):
            call()

    both: list[Callable[[], object]] = [partial(repeated, call) for call in (ours, hand)]
    places = list(both)
    for _ in range(3):
        both = [partial(deeper, call) for call in both]
        places += both
    times = np.reshape(milliseconds(*places, repeats=repeats), (4, 2)) / calls
    mean = times.mean(axis=0)
    return float(mean[0]), float(mean[1])


def deeper(function: Callable[[], object]) -> object:
    """What a function returns, called from another place on the stack."""
    # Frames of Python alone lie on the heap. `map` comes back to Python by way of C.
    return next(map(_called, (function,)))


def _called(function: Callable[[], object]) -> object:
    return function()


def basin(repeats: int) -> Iterator[Measured]:
    """A map of 100 by 100 starts of the reduced system, 4 s to 1e-6 rad, to its outcomes."""
    gamma, beta = np.meshgrid(
        np.linspace(-np.pi / 2, np.pi / 2, 100), np.linspace(0.87, 2.27, 100)
    )
    scenario = Scenario(constraints=MODELS[4], start=Start(spin=30.0))
    fields = {"gamma": gamma.ravel(), "beta": beta.ravel()}
    times = np.linspace(0.0, 4.0, 801)

    def judge() -> None:
        starts = Ensemble(scenario=scenario, fields=fields)
        how: Any = {"form": "reduced", "tolerance": 1e-6, "workers": 1}
        _ = simulate_many(starts, times, **how).inversions.outcomes

    if is_installed():
        (taken,) = milliseconds(judge, repeats=min(repeats, 3))
        yield Measured("10,000 starts of the reduced system", 1e-3 * taken, "s", 10.0)


# --- All of it -----------------------------------------------------------------------------------

PARTS: tuple[Callable[[int], Iterator[Measured]], ...] = (
    single_runs, stability, sweeps, to_rest, load_laws, compiled_runs, ensembles, basin,
)  # fmt: skip


def main() -> int:
    """Print what is measured; 1 if something misses what it should reach."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=7, help="timed calls of each run (7)")
    repeats = parser.parse_args().repeats
    missed = 0
    for part in PARTS:
        print(f"\n{str(part.__doc__).splitlines()[0]}")
        for found in part(repeats):
            print(found.text(), flush=True)
            missed += not found.reached
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"\nLargest memory of this process: {memory:.0f} MB. Machine: {machine()}.")
    if missed:
        print(f"{missed} of these miss what they should reach.")
    return 1 if missed else 0


if __name__ == "__main__":
    raise SystemExit(main())
