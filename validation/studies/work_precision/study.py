"""Error against work and run time of every formulation and integrator.

Every method runs every problem on a ladder of steps or tolerances. What a run costs is counted
in evaluations and measured in processor time; what it is worth is its largest deviation from a
reference that two different methods agree on.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from analysis.data.trajectory import versions
from validation.kit.clock import Clock
from validation.kit.full_study import FULL_STUDY
from validation.kit.provenance import Provenance, machine
from validation.kit.report import Job, Section, run_jobs, write
from validation.kit.tables import Table
from validation.studies.work_precision import measure, prices
from validation.studies.work_precision.methods import Method, label, methods
from validation.studies.work_precision.prices import Comparison, Price
from validation.studies.work_precision.problems import PROBLEMS, Agreement, ProblemName, agreement
from validation.studies.work_precision.runs import Curve
from validation.studies.work_precision.section import make_section
from validation.studies.work_precision.stored import FILE, Study

WORKERS = 2
"""Runs at the same time, each in one thread of a process of its own."""

STORE = "work-precision-runs"
"""Folder of the kept results inside the folder of the study."""

PREFIX = "work-precision"


def curve_job(
    store: Path | None, conditions: dict[str, Any], name: ProblemName, method: Method
) -> Curve:
    """`measure.measure`, or what it has left in `store` under the same conditions."""
    found = _kept_or_made(
        store,
        conditions,
        f"{name}, {label(method)}",
        lambda: measure.measure(name, method, bool(conditions["quick"])).to_dict(),
    )
    return Curve.from_dict(found)


def agreement_job(store: Path | None, conditions: dict[str, Any], name: ProblemName) -> Agreement:
    """`agreement`, or what it has left in `store`."""
    others = _kept_or_made(
        store,
        conditions,
        f"{name}, agreement",
        lambda: agreement(name, bool(conditions["quick"])).others,
    )
    return Agreement(problem=name, others=others)


def price_job(store: Path | None, conditions: dict[str, Any], case: Comparison) -> Price:
    """`prices.measure_price`, or what it has left in `store`."""
    found = _kept_or_made(
        store,
        conditions,
        f"price, {case.label}",
        lambda: prices.measure_price(case, bool(conditions["quick"])).to_dict(),
    )
    return Price.from_dict(found)


def _kept_or_made(
    store: Path | None, conditions: dict[str, Any], name: str, make: Callable[[], Any]
) -> Any:
    """Result from the store if it was made under the same conditions, else made and kept.

    Raises
    ------
    ValueError
        If a kept file cannot be read.
    """
    if store is None:
        return make()
    path = store / f"{''.join(c if c.isalnum() else '-' for c in name)}.json"
    if path.exists():
        try:
            kept = json.loads(path.read_text(encoding="utf-8"))
            if kept["conditions"] == conditions:
                return kept["result"]
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(f"{path} is not readable: {error}; run with --fresh") from error
    result = make()
    with whole_file(path) as stream:
        stream.write(json.dumps({"conditions": conditions, "result": result}).encode())
    return result


_SAYING = {"confirm", "figures", "lesson", "section", "ship", "stored", "tables"}
"""Modules that say what was measured, and do not change it."""


def measuring_conditions(quick: bool) -> dict[str, Any]:
    """What kept results depend on: versions, machine, the code, and how much was measured."""
    code = hashlib.sha256()
    root = Path(__file__).parents[3]
    for folder in ("analysis", "mbs_models", "validation/studies/work_precision"):
        for path in sorted((root / folder).rglob("*.py")):
            if path.parent != Path(__file__).parent or path.stem not in _SAYING:
                code.update(path.read_bytes())
    return {
        "versions": versions("exudyn", "numpy", "scipy"),
        "machine": machine(),
        "code": code.hexdigest(),
        "quick": quick,
    }


def jobs(*, quick: bool, store: Path | None = None) -> list[Job]:
    """Everything that is to be computed, under keys that start with "work-precision".

    Parameters
    ----------
    quick : bool
        A selection that takes some 40 s of processor time.
    store : Path, optional
        Existing folder in which finished results are kept, and looked up under the same
        conditions.
    """
    conditions = {"quick": quick} if store is None else measuring_conditions(quick)
    first: list[Job] = []
    curves: list[Job] = []
    for problem in PROBLEMS.values():
        chosen = methods(problem, quick)
        if chosen:
            key = (PREFIX, "agreement", problem.name)
            first.append(Job(key, agreement_job, (store, conditions, problem.name)))
        curves += [
            Job(
                (PREFIX, problem.name, label(method)),
                curve_job,
                (store, conditions, problem.name, method),
            )
            for method in chosen
        ]
    compared = [
        Job((PREFIX, "price", case.label), price_job, (store, conditions, case))
        for case in prices.cases(quick)
    ]
    return first + curves + compared


def collect(results: Mapping[Any, Any], *, quick: bool) -> Study:
    """Study from the results of `jobs`; other results beside them do not matter.

    Raises
    ------
    KeyError
        If a result is missing.
    """
    keys = [job.key for job in jobs(quick=quick)]
    agreements = {key[2]: results[key] for key in keys if key[1] == "agreement"}
    return Study(
        provenance=Provenance.here(),
        quick=quick,
        curves=tuple(results[key] for key in keys if key[1] in PROBLEMS),
        agreements=agreements,
        prices=tuple(results[key] for key in keys if key[1] == "price"),
    )


def section(results: Mapping[Any, Any], *, quick: bool) -> Section:
    """Section of the report from the results of `jobs`."""
    return make_section(collect(results, quick=quick))


def make(folder: Path, *, quick: bool = False, fresh: bool = False) -> tuple[Path, list[Table]]:
    """Run the study, write its page, figures and tables, and keep every finished result.

    Parameters
    ----------
    folder : Path
        Made if it does not exist. A full study leaves its results there for
        `validation.studies.work_precision.ship`.
    quick : bool
        A selection that takes some 40 s of processor time.
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
    clock = Clock()
    store = folder / STORE
    store.mkdir(parents=True, exist_ok=True)
    if fresh:
        for path in store.glob("*.json"):
            path.unlink()
    # The commit may move on while the study runs.
    provenance = Provenance.here()
    results = run_jobs(jobs(quick=quick, store=store), workers=WORKERS, title="work-precision")
    study = replace(collect(results, quick=quick), provenance=provenance)
    if not quick:
        FILE.write(study, folder / FULL_STUDY)
    made = make_section(study)
    page = write([made], folder, made=clock.sentence())
    return page, [table for table in made.tables if not table.file_only]
