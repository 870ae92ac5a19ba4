"""Error against run time of every formulation, integrator and solver option.

Every method runs every problem on a ladder of steps or tolerances. What a run costs is the time
of its integration alone; what it is worth is its largest deviation from a reference that two
different methods agree on.
"""

import hashlib
import json
import statistics
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from analysis.files import whole_file
from analysis.trajectory import versions
from validation.report import Job, Section, machine, run_jobs, write
from validation.tables import Table
from validation.work_precision.methods import EngineMethod, Measured, Method, label, methods
from validation.work_precision.problems import (
    PROBLEMS,
    Agreement,
    ProblemName,
    agreement,
    compare,
    reference,
)
from validation.work_precision.runs import Run
from validation.work_precision.section import make_section

WORKERS = 2
"""Runs at the same time, each in one thread of a process of its own."""

STORE = "work-precision-runs"
"""Folder of the stored runs inside the folder of the results."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effort:
    """How thoroughly to measure.

    Parameters
    ----------
    repeats : int
        Timed runs of each rung, besides a warm-up per method.
    seconds : float
        Processor time that a rung may take with its repeats; the ladder ends before the next
        would take longer.
    """

    repeats: int
    seconds: float


QUICK = Effort(repeats=2, seconds=0.35)
FULL = Effort(repeats=3, seconds=5.0)


def measure(name: ProblemName, method: Method, quick: bool) -> list[Run]:
    """Run a method on a problem along its ladder, and its extrapolation beside it.

    Parameters
    ----------
    name : str
        Name of the problem.
    method : Method
    quick : bool
        Fewer rungs and repeats.

    Returns
    -------
    list of Run
        One for every rung; a failed one holds the reason.
    """
    problem, effort = PROBLEMS[name], QUICK if quick else FULL
    ladder = method.ladder(quick)
    # The timed run of the same rung tells of a failure.
    with suppress(ArithmeticError):
        method.run(problem, ladder[0])
    runs: list[Run] = []
    extrapolation = _extrapolation(method)
    for setting in ladder:
        blank = _blank(name, method, setting)
        try:
            best, run = _timed(blank, method, effort.repeats)
        except ArithmeticError as error:
            # A rung that cannot be run is a result: a gap in the curve, with its reason.
            runs.append(replace(blank, failure=" ".join(str(error).split())))
            # Extrapolation needs unbroken halving.
            extrapolation = _extrapolation(method)
            continue
        runs.append(run)
        joined = None if extrapolation is None else extrapolation.add(best)
        if joined is not None:
            runs.append(_filled(blank, method, joined, extrapolated=True))
        if 2.0 * run.median_seconds * effort.repeats > effort.seconds:
            break
    return runs


def _extrapolation(method: Method) -> Any:
    if isinstance(method, EngineMethod) and method.fixed_step and not method.variant:
        return method.extrapolation()
    return None


def _blank(name: ProblemName, method: Method, setting: float) -> Run:
    return Run(
        problem=name,
        formulation=method.formulation,
        scheme=method.scheme,
        variant=method.variant,
        setting=setting,
        fixed_step=method.fixed_step,
    )


def _timed(blank: Run, method: Method, repeats: int) -> tuple[Measured, Run]:
    """Fastest of the repeats, and all of them summed up."""
    problem = PROBLEMS[blank.problem]
    measured = [method.run(problem, blank.setting) for _ in range(repeats)]
    best = min(measured, key=lambda run: run.seconds)
    run = _filled(blank, method, best)
    return best, replace(
        run,
        median_seconds=statistics.median(each.seconds for each in measured),
        setup_seconds=min(each.setup_seconds for each in measured),
        repeats=repeats,
    )


def _filled(blank: Run, method: Method, measured: Measured, *, extrapolated: bool = False) -> Run:
    errors = compare(
        method.trajectory(PROBLEMS[blank.problem], measured), reference(blank.problem)
    )
    return replace(
        blank,
        extrapolated=extrapolated,
        seconds=measured.seconds,
        median_seconds=measured.seconds,
        setup_seconds=measured.setup_seconds,
        repeats=1,
        counts=measured.counts,
        errors=errors,
    )


def stored_measure(
    store: Path | None, conditions: dict[str, Any], name: ProblemName, method: Method
) -> list[Run]:
    """`measure`, or what it has left in `store` under the same conditions.

    Raises
    ------
    ValueError
        If a stored file cannot be read.
    """
    plain = label(method).replace("α", "alpha").replace(", ", "-").replace(" ", "-")
    path = None if store is None else store / f"{name}--{plain}.json"
    kept = _kept(path, conditions)
    if kept is not None:
        return [Run.from_dict(run) for run in kept]
    runs = measure(name, method, bool(conditions["quick"]))
    _keep(path, conditions, [run.to_dict() for run in runs])
    return runs


def stored_agreement(
    store: Path | None, conditions: dict[str, Any], name: ProblemName
) -> Agreement:
    """`agreement`, or what it has left in `store`, as in `stored_measure`."""
    path = None if store is None else store / f"{name}--agreement.json"
    kept = _kept(path, conditions)
    if kept is not None:
        return Agreement(**kept)
    found = agreement(name, bool(conditions["quick"]))
    _keep(path, conditions, asdict(found))
    return found


def _kept(path: Path | None, conditions: dict[str, Any]) -> Any:
    """What the file holds, None if there is no file or it was made under other conditions."""
    if path is None or not path.exists():
        return None
    try:
        stored = json.loads(path.read_text())
        return stored["result"] if stored["conditions"] == conditions else None
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is not readable: {error}; run with --fresh") from error


def _keep(path: Path | None, conditions: dict[str, Any], result: Any) -> None:
    if path is not None:
        with whole_file(path) as stream:
            stream.write(json.dumps({"conditions": conditions, "result": result}).encode())


def measuring_conditions(quick: bool) -> dict[str, Any]:
    """What stored runs depend on: versions, machine, the code, and how much was measured."""
    code = hashlib.sha256()
    for folder in ("analysis", "mbs_models"):
        for path in sorted((Path(__file__).parents[2] / folder).glob("*.py")):
            code.update(path.read_bytes())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if path.stem not in {"figures", "lesson", "section", "tables"}:
            code.update(path.read_bytes())
    return {
        "versions": versions("exudyn", "numpy", "scipy"),
        "machine": machine(),
        "code": code.hexdigest(),
        "quick": quick,
    }


def jobs(quick: bool, store: Path | None = None) -> list[Job]:
    """Everything that is to be computed, under keys that start with "work-precision".

    Parameters
    ----------
    quick : bool
        A selection that takes less than a minute on two cores.
    store : Path, optional
        Existing folder in which finished runs are kept, and looked up under the same conditions.
    """
    conditions = measuring_conditions(quick)
    result = [
        Job(("work-precision", "agreement", name), stored_agreement, (store, conditions, name))
        for name in PROBLEMS
    ]
    for problem in PROBLEMS.values():
        result += [
            Job(
                ("work-precision", problem.name, label(method)),
                stored_measure,
                (store, conditions, problem.name, method),
            )
            for method in methods(problem, quick)
        ]
    return result


def collect(results: Mapping[Any, Any]) -> tuple[list[Run], dict[ProblemName, Agreement]]:
    """Runs, in the order of problems and methods, and agreements from the results of `jobs`."""
    agreements = {name: results["work-precision", "agreement", name] for name in PROBLEMS}
    keys = [key for key in results if key[:1] == ("work-precision",) and key[1] != "agreement"]
    order = list(PROBLEMS)
    runs = [
        run
        for key in sorted(keys, key=lambda key: (order.index(key[1]), key[2]))
        for run in results[key]
    ]
    return runs, agreements


def section(results: Mapping[Any, Any], quick: bool) -> Section:
    """Section of the report from the results of `jobs(quick)`."""
    return make_section(*collect(results), quick=quick)


def main(folder: Path, *, quick: bool = False, fresh: bool = False) -> tuple[Path, list[Table]]:
    """Run the study, write its page, figures and tables, and keep every finished run.

    Parameters
    ----------
    folder : Path
        Made if it does not exist.
    quick : bool
        A selection that takes less than a minute on two cores.
    fresh : bool
        Measure again what is kept from an earlier call.

    Returns
    -------
    page : Path
    tables : list of Table
        The tables a terminal should show.

    Raises
    ------
    OSError
        If the folder cannot be written.
    ValueError
        If a kept file cannot be read.
    """
    begin = time.perf_counter()
    store = folder / STORE
    store.mkdir(parents=True, exist_ok=True)
    if fresh:
        for path in store.glob("*.json"):
            path.unlink()
    results = run_jobs(jobs(quick, store), workers=WORKERS, title="work-precision")
    made = section(results, quick)
    page = write([made], folder, seconds=time.perf_counter() - begin)
    return page, [table for table in made.tables if not table.file_only]
