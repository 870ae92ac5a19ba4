"""The report: every study's jobs, run side by side, and the sections they fill.

A study offers `jobs`, the calls behind it, and `section`, which makes a section of the report from
their results by key; those with a long form are asked for their quick one.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from validation.kit.report import Job, Section, run_jobs, write
from validation.kit.tables import Table
from validation.studies import crosscheck, inversion, lean, modelled, paper_numbers, summary
from validation.studies.claims import section as claims
from validation.studies.rest import section as rest
from validation.studies.robustness import section as robustness
from validation.studies.stability import section as stability
from validation.studies.work_precision import study as work_precision


@dataclass(frozen=True, slots=True)
class Study:
    """What a study offers to the report.

    Parameters
    ----------
    jobs : callable
        Returns the jobs.
    section : callable
        From the results of all jobs by key to the section.
    timed : bool
        Whether the jobs measure run times, and have to run beside their like.
    """

    jobs: Callable[[], Sequence[Job]]
    section: Callable[[dict[Any, Any]], Section]
    timed: bool = False


def _quick(study: Any) -> Study:
    return Study(partial(study.jobs, quick=True), partial(study.section, quick=True), timed=True)


STUDIES = (
    Study(list, modelled.section),
    Study(inversion.jobs, inversion.section),
    Study(claims.jobs, claims.section),
    Study(crosscheck.jobs, crosscheck.section),
    Study(stability.jobs, stability.section),
    Study(rest.jobs, rest.section),
    _quick(work_precision),
    _quick(robustness),
    Study(partial(lean.jobs, quick=True), lean.section, timed=True),
    Study(list, paper_numbers.section),
)
"""In the order of their sections, behind the box that sums them up."""


def make(folder: Path) -> tuple[Path, list[Table]]:
    """Run everything and write the report.

    Parameters
    ----------
    folder : Path
        Where the page, figures and tables go.

    Returns
    -------
    page : Path
    tables : list of Table
        The tables a terminal should show: the first of each section, and all with verdicts.
    """
    begin = time.perf_counter()
    ordered = sorted(STUDIES, key=lambda study: not study.timed)
    results = run_jobs((job for study in ordered for job in study.jobs()), title="report")
    sections = [study.section(results) for study in STUDIES]
    page = write(
        [summary.section(sections), *sections], folder, seconds=time.perf_counter() - begin
    )
    shown = [
        table
        for section in sections
        for table in section.tables
        if table is section.tables[0] or any(isinstance(c, bool) for r in table.rows for c in r)
    ]
    return page, shown
