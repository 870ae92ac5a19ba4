"""Speed and memory of single runs, sweeps and ensembles: `python -m validation.benchmark`.

Every time is the median processor time of repeats after a warm-up, in one thread; what is
compared is called in turns. Single runs are whole calls of a `simulate` function for Table 3 over
2 s, sampled every 0.01 s; errors are the largest in beta and gamma over all samples, against
DOP853 with a local tolerance of 1e-13, which differs by less than 1e-12 rad from Radau.
"""

import argparse
import resource
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
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
    Method,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Trajectory,
    simulate_many,
)
from analysis.compiled.library import is_installed
from analysis.compiled.stack import deeper
from analysis.models.request import COMPILED_TOLERANCES
from analysis.stability import spectra
from analysis.stability.chart import stability_chart
from mbs_models import Integrator, Scene
from mbs_models.own_runs import run_over
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

_SWEPT = 10
"""Cases of a sweep that is timed."""

MODEL_SCENARIOS = tuple(Scenario(constraints=each) for each in MODELS.values())
MODEL_1, MODEL_2, MODEL_3, MODEL_4 = MODEL_SCENARIOS


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


def milliseconds(*calls: Callable[[], object], repeats: int) -> list[float]:
    """Median times of calls in turns in ms."""
    return [1e3 * median(times) for times in in_turns(*calls, pairs=repeats)]


# --- Single runs, sweeps and eigenvalues ---------------------------------------------------------


def _targets() -> Iterator[tuple[str, Scenario, dict[str, Any], float, float]]:
    """Label of a run, its scenario, how it is run, and most of its error in rad and time in ms."""
    for step, error, limit in ((5e-3, 1e-6, 25.0), (2.5e-3, 1e-9, 60.0)):
        how = {"formulation": "contact-tree", "step": step}
        yield f"engine, contact tree, step {step:g} s", MODEL_1, how, error, limit
    for scenario in (MODEL_2, MODEL_3, MODEL_4):
        how = {"formulation": "euler-tree", "tolerance": 1e-6}
        yield f"engine, Euler tree, {scenario.name}, to 1e-6 rad", scenario, how, 1e-6, 800.0
    for scenario, local, form, limit in (
        (MODEL_1, 1e-10, "index-1", 100.0),
        (MODEL_4, 1e-10, "reduced", 100.0),
        (MODEL_2, 3e-12, "index-1", 150.0),
        (MODEL_3, 1e-11, "index-1", 150.0),
    ):
        how = {"source": "in-house", "formulation": form, "local_tolerance": local}
        yield f"in-house, {scenario.name}, {form}", scenario, how, 1e-9, limit


@cache
def _truth(scenario: Scenario) -> Trajectory:
    return analysis.simulate(scenario, TIMES, local_tolerance=1e-13)


def single_runs(repeats: int) -> Iterator[Measured]:
    """Error and time of runs, and what of it is the solver's."""
    for label, scenario, how, error, limit in _targets():
        call = partial(run, scenario, TIMES, **how)
        yield Measured(f"{label}: error", deviation(call(), _truth(scenario)), "rad", error)
        yield Measured(label, milliseconds(call, repeats=repeats)[0], "ms", limit)
        if "step" in how:
            scene = Scene(scenario, how["formulation"])
            solver = partial(run_over, scene, TIMES, Integrator(name="RK67"), how["step"])
            taken = 1e3 * median(solver().seconds for _ in range(repeats))
            yield Measured(f"{label}: of it the solver's", taken, "ms")


def load_laws(repeats: int) -> Iterator[Measured]:
    """What it costs that the friction law knows the contact force (Euler tree, step 2.5 ms)."""
    for scenario in MODEL_SCENARIOS:
        calls = [
            partial(mbs_models.simulate, Scene(laden, "euler-tree"), TIMES, step=2.5e-3)
            for load in analysis.LOADS
            for laden in [replace(scenario, friction=SmoothCoulomb(load=load))]
        ]
        weight, contact = milliseconds(*calls, repeats=repeats)
        yield Measured(f"{scenario.name}: contact force over weight as load", contact / weight, "")


def stability(repeats: int) -> Iterator[Measured]:
    """Times of the eigenvalue work."""
    many, gradients = np.linspace(0.0, 60.0, 10_000), np.geomspace(0.3, 30.0, 200)
    calls: list[tuple[str, Callable[[], object], float]] = [
        (
            "10,000 spins of the full system, tracked branches",
            partial(spectra.branches, MODEL_1, many, system="full"),
            1500.0,
        ),
        (
            "stability chart, 200 x 200",
            partial(stability_chart, MODEL_1, np.linspace(0.0, 80.0, 200), gradients),
            10_000.0,
        ),
        (
            "engine, Model 1, 100 spins",
            partial(engine_matrices, MODEL_1, np.linspace(0.0, 60.0, 100)),
            5000.0,
        ),
    ]
    for label, call, limit in calls:
        yield Measured(label, milliseconds(call, repeats=min(repeats, 3))[0], "ms", limit)


def sweeps(repeats: int) -> Iterator[Measured]:
    """What a sweep takes beside its runs: cases as a worker runs them, and stored.

    Without the commits, of which there is one a second.
    """
    ways: tuple[tuple[str, Scenario, dict[str, Any]], ...] = (
        ("engine, contact tree, step 5 ms", MODEL_1, {"step": 5e-3}),
        ("engine, contact tree, local 1e-6", MODEL_1, {"local_tolerance": 1e-6}),
        ("engine, contact tree, to 1e-6 rad", MODEL_1, {"tolerance": 1e-6}),
        ("engine, Euler tree, Model 2, step 5 ms", MODEL_2, {"step": 5e-3}),
        (
            "in-house, Model 4, local 1e-6",
            MODEL_4,
            {"source": "in-house", "local_tolerance": 1e-6},
        ),
    )
    for label, scenario, how in ways:
        axis = Axis(field="spin", first=30.0, last=50.0, count=_SWEPT)
        plan = Plan(end=2.0, spacing=1e-2, **({"source": "engine"} | how))
        sweep = Sweep(scenario=scenario, design=Design(axes=(axis,)), plan=plan)
        swept, runs = sweep_times(sweep, repeats)
        yield Measured(f"{label}: over single runs", swept / runs, "", 1.2)
        yield Measured(f"{label}: beside each run", (swept - runs) / _SWEPT, "ms")


def sweep_times(sweep: Sweep, repeats: int) -> tuple[float, float]:
    """Time in ms of a sweep in this process, and of its runs made one by one."""
    numbers = range(sweep.design.size)
    scenarios = [sweep.scenario_of(number) for number in numbers]
    with TemporaryDirectory() as folder, Store(Path(folder) / "a.db", sweep) as store:

        def swept() -> None:
            store.add(run_chunk(sweep.to_text(), numbers, 60.0, 200.0))

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


# --- Compiled runs -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Compiled:
    """A system that is compiled, from Table 3."""

    scenario: Scenario
    form: Form
    members: int

    def simulate(self, method: Method, local_tolerance: float) -> Trajectory:
        """Run it once to a local tolerance."""
        how: Any = {"form": self.form, "method": method, "local_tolerance": local_tolerance}
        return analysis.simulate(self.scenario, TIMES, **how)

    def ensemble(self) -> Ensemble:
        """Spins at which the disk is inverted."""
        base = replace(self.scenario, start=Start(beta=1.5))
        return Ensemble(scenario=base, fields={"spin": np.linspace(34.0, 50.0, self.members)})

    def many(self, members: Sequence[Scenario] | None = None, **how: Any) -> object:
        """Run its ensemble, made and checked anew, or some members."""
        how |= {"form": self.form, "workers": 1}
        return simulate_many(self.ensemble() if members is None else members, TIMES, **how)


COMPILED = (
    Compiled(scenario=MODEL_1, form="index-1", members=64),
    Compiled(scenario=MODEL_4, form="reduced", members=512),
)


def compiled_runs(repeats: int) -> Iterator[Measured]:
    """Single runs to an error: pure, compiled, and heyoka driven by hand.

    One run of each, without the second one that a tolerance takes. Compiled code is warm.
    """
    for case in COMPILED if is_installed() else ():
        truth = case.simulate("DOP853", 3e-14)
        for error in ERRORS:
            label = f"{case.scenario.name}, {case.form}, to {error:g} rad"
            ladder = [10.0**-power for power in range(6, 14)]
            if (local := _loosest(case, "DOP853", ladder, error, truth)) is not None:
                pure = partial(case.simulate, "DOP853", local)
                yield Measured(f"{label}: pure", milliseconds(pure, repeats=repeats)[0], "ms")
            local = _loosest(case, "taylor", COMPILED_TOLERANCES, error, truth)
            if local is not None:
                ours = partial(case.simulate, "taylor", local)
                hand = by_hand.single(case.scenario, case.form, local, TIMES)
                taken, by = from_all_places(ours, hand, repeats=repeats, calls=10)
                yield Measured(f"{label}: compiled", taken, "ms")
                yield Measured(f"{label}: by hand", by, "ms")


def _loosest(
    case: Compiled, method: Method, ladder: Sequence[float], error: float, truth: Trajectory
) -> float | None:
    """The loosest local tolerance of a ladder with which the error is kept."""
    for local in ladder:
        if local <= 10.0 * error and deviation(case.simulate(method, local), truth) <= error:
            return local
    return None


def ensembles(repeats: int) -> Iterator[Measured]:
    """Runs per second: pure, compiled in batches, and batches by hand.

    Compiled: an `Ensemble`, made and checked anew each time, and the arrays that come out; from a
    list: a Scenario and a Trajectory for each. To 1e-6 rad: with the second run that checks it.
    One run each: local tolerance 1e-9. By hand, nothing is made of the sampled states.
    """
    for case in COMPILED if is_installed() else ():
        name, size = f"{case.scenario.name}, {case.form}", case.members
        few, members = list(case.ensemble().part(slice(4))), list(case.ensemble())
        once: Any = {"method": "taylor", "local_tolerance": 1e-9}
        calls: dict[str, tuple[Callable[[], object], int]] = {
            "pure to 1e-6 rad": (partial(case.many, few, method="DOP853", tolerance=1e-6), 4),
            "compiled to 1e-6 rad": (partial(case.many, method="taylor", tolerance=1e-6), size),
            "one run each, from a list": (partial(case.many, members, **once), size),
        }
        for label, (call, count) in calls.items():
            (taken,) = milliseconds(call, repeats=repeats)
            yield Measured(f"{name}: {label}", 1e3 * count / taken, "1/s")
        taken, by = from_all_places(
            partial(case.many, **once),
            by_hand.batches(members, case.form, 1e-9, TIMES),
            repeats=repeats,
        )
        yield Measured(f"{name}: one run each", 1e3 * size / taken, "1/s")
        yield Measured(f"{name}: one run each, by hand", 1e3 * size / by, "1/s")


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
