"""What the subcommands that make a long study by itself do; each returns the exit code."""

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from validation.commands.options import output_folder
from validation.kit.clock import Clock
from validation.kit.parts import Job
from validation.kit.provenance import Provenance
from validation.kit.report import Section, run_kept, write
from validation.kit.tables import Table

Results = dict[Any, Any]


def work_precision(options: argparse.Namespace) -> int:
    """Measure error against run time; options are out, quick and fresh."""
    from validation.studies.work_precision import section as study
    from validation.studies.work_precision.jobs import WORKERS, jobs

    # The commit may move on while the study runs.
    section = partial(study.section, quick=options.quick, provenance=Provenance.here())
    page, made, _ = make(options, jobs(quick=options.quick), section, workers=WORKERS)
    _print([table for table in made.tables if not table.file_only])
    print(f"\nOpen {page}")
    return 0


def robustness(options: argparse.Namespace) -> int:
    """Run the hard cases; options as of `work_precision`.

    Returns 1 if a result came back as right and is not, or if a run took the interpreter down.
    """
    from validation.studies.robustness import section as study

    section = partial(study.section, quick=options.quick)
    page, made, results = make(options, study.jobs(quick=options.quick), section)
    _print(made.tables[:2])
    wrong = study.wrong(results)
    verdict = "No case crashed or broke its promise" if not wrong else f"{wrong} cases FAIL"
    print(f"\n{verdict}. Open {page}")
    return 1 if wrong else 0


def make(
    options: argparse.Namespace,
    jobs: Sequence[Job],
    section: Callable[[Results], Section],
    *,
    workers: int | None = None,
) -> tuple[Path, Section, Results]:
    """Run what is not kept of the jobs, and write the page of their section."""
    from validation.studies.full_report import STUDIES

    folder, clock = output_folder("out", options.out), Clock()
    name = options.command.replace("_", "-")
    (study,) = (each for each in STUDIES if each.name == name)
    seconds = study.expected_seconds(quick=options.quick)
    how: dict[str, Any] = {"workers": workers, "fresh": options.fresh, "seconds": seconds}
    parts = run_kept(jobs, folder, title=name, **how)
    results = {key: part.result for key, part in parts.items()}
    made = section(results)
    return write([made], folder, made=clock.sentence()), made, results


def _print(tables: Sequence[Table]) -> None:
    for table in tables:
        print(f"\n{table.title}\n{table.to_text()}")
