"""Error against work and run time of every formulation and integrator.

Every method runs every problem on a ladder of steps or tolerances. What a run costs is counted
in evaluations and measured in processor time; what it is worth is its largest deviation from a
reference that two different methods agree on.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from validation.kit.clock import Clock
from validation.kit.provenance import Provenance
from validation.kit.report import Section, run_kept, write
from validation.kit.tables import Table
from validation.studies.work_precision.jobs import jobs
from validation.studies.work_precision.section import make_section
from validation.studies.work_precision.stored import Study, gathered

WORKERS = 2
"""Runs at the same time, each in one thread of a process of its own."""


def collect(results: Mapping[Any, Any], *, quick: bool) -> Study:
    """Study from the results of `jobs`; other results beside them do not matter.

    Raises
    ------
    KeyError
        If a result is missing.
    """
    found = [results[job.key] for job in jobs(quick=quick)]
    return gathered(found, provenance=Provenance.here(), quick=quick)


def section(results: Mapping[Any, Any], *, quick: bool) -> Section:
    """Section of the report from the results of `jobs`."""
    return make_section(collect(results, quick=quick))


def make(folder: Path, *, quick: bool = False, fresh: bool = False) -> tuple[Path, list[Table]]:
    """Run the study, write its page, figures and tables, and keep every finished result.

    Parameters
    ----------
    folder : Path
        Made if it does not exist. What is finished is kept there, also for
        `validation.studies.ship`.
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
    """
    clock = Clock()
    # The commit may move on while the study runs.
    provenance = Provenance.here()
    parts = run_kept(
        jobs(quick=quick), folder, workers=WORKERS, title="work-precision", fresh=fresh
    )
    results = {key: part.result for key, part in parts.items()}
    study = replace(collect(results, quick=quick), provenance=provenance)
    made = make_section(study)
    page = write([made], folder, made=clock.sentence())
    return page, [table for table in made.tables if not table.file_only]
