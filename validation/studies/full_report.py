"""What goes into the report: the jobs behind it and its sections."""

import time
from pathlib import Path
from typing import Any

from analysis import LEVELS, LOADS, find_inversion
from analysis.models.inversion import DEFINITION
from validation.kit import snapshots
from validation.kit.animation import player as animation
from validation.kit.report import Job, Section, run_jobs, write
from validation.kit.tables import Table
from validation.studies import crosscheck, inversion, lean, paper_numbers
from validation.studies.claims import section as claims
from validation.studies.rest import section as rest
from validation.studies.robustness import section as robustness
from validation.studies.stability import section as stability
from validation.studies.work_precision import study as work_precision


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
        The tables a terminal should show.
    """
    begin = time.perf_counter()
    results = run_jobs(
        [
            # What is timed comes first, so that it runs beside its like.
            *lean.jobs(quick=True),
            *work_precision.jobs(quick=True),
            *robustness.jobs(quick=True),
            *rest.jobs(),
            *_inversion_jobs(),
            *_crosscheck_jobs(),
            *claims.jobs(),
            *stability.jobs(),
        ],
        title="report",
    )
    precision = work_precision.section(results, quick=True)
    hard = robustness.section(results, quick=True)
    sections = [
        _inversion(results),
        claims.section(results),
        _crosscheck(results),
        stability.section(results),
        rest.section(results),
        precision,
        hard,
        lean.section(results),
        _numbers(),
    ]
    page = write(sections, folder, seconds=time.perf_counter() - begin)
    shown = [
        *sections[0].tables,
        *sections[1].tables,
        *sections[2].tables,
        *sections[3].tables[:3],
    ]
    return page, [*shown, precision.tables[0], hard.tables[0]]


def _inversion_jobs() -> list[Job]:
    return [
        Job(("run", *arguments), inversion.run_pair, arguments)
        for arguments in inversion.level_jobs()
    ]


def _inversion(results: dict[Any, Any]) -> Section:
    loads = {load: results["run", 1, load, 2.0] for load in LOADS}
    levels = [results["run", level, "weight", 4.0] for level in LEVELS]
    inverted = find_inversion(loads["weight"][0])
    after = "more than 2 s" if inverted is None else f"{inverted:.2f} s"
    return Section(
        name="inversion",
        title="The inversion",
        paragraphs=[
            (
                "A disk whose centre of gravity lies off its centre is spun about an in-plane "
                "axis with the centre of gravity low (start of Table 3). Friction at the contact "
                f"turns it upside down, in Model 1 after {after}. {DEFINITION}"
            ),
            (
                "The engine's runs and the in-house equations share the description of the disk, "
                "the friction parameters and the start, and nothing of the mechanics."
            ),
        ],
        animations=[
            animation.player(
                loads["weight"][0],
                name="inversion-animation",
                title="The inversion",
                caption="Table 3's start. Drag to turn the view.",
            )
        ],
        pictures=[
            snapshots.strip(loads["weight"][0], (0.0, 0.2, 0.3, 0.38, 0.45, 0.55, 0.8)),
            *inversion.draw(loads, levels),
        ],
        tables=[inversion.agreement(levels)],
    )


def _crosscheck_jobs() -> list[Job]:
    cases = crosscheck.cases()
    return [Job(("trajectory", case), crosscheck.check_trajectory, (case,)) for case in cases] + [
        Job(("acceleration", case), crosscheck.check_accelerations, (case,)) for case in cases
    ]


def _crosscheck(results: dict[Any, Any]) -> Section:
    cases = crosscheck.cases()
    return Section(
        name="crosscheck",
        title="Engine against in-house equations",
        paragraphs=[
            (
                "Accelerations: mass matrix, right-hand side and constraint residual are taken "
                "from the engine, and one linear solve gives its accelerations and constraint "
                "forces; the in-house ones come from the index-1 systems (79), (80) and (92)."
            ),
            (
                "Trajectories: the engine halves its step and extrapolates until its own error "
                "estimate is below the limit; the in-house run is integrated with DOP853 to a "
                "hundredth of the limit. The normal force is the joint's multiplier in the engine."
            ),
        ],
        tables=[
            crosscheck.acceleration_table([results["acceleration", case] for case in cases]),
            crosscheck.trajectory_table([results["trajectory", case] for case in cases]),
        ],
    )


def _numbers() -> Section:
    return Section(
        name="numbers",
        title="The numbers the paper prints",
        tables=[paper_numbers.disk_numbers(), paper_numbers.misprints()],
    )
