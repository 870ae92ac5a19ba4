"""The section of the report on error against run time."""

from collections.abc import Mapping, Sequence

from validation.report import Section
from validation.work_precision import figures, lesson, tables
from validation.work_precision.problems import SPACING, TIMES, Agreement, ProblemName
from validation.work_precision.runs import Run


def make_section(
    runs: Sequence[Run], agreements: Mapping[ProblemName, Agreement], *, quick: bool
) -> Section:
    """Section with the lesson, the diagrams and the tables."""
    return Section(
        name="work-precision",
        title="Error against run time",
        paragraphs=[_how(runs, quick), *lesson.paragraphs(runs)],
        pictures=[figures.fronts(runs, agreements), figures.orders(runs, agreements)],
        tables=[
            tables.ways(runs),
            tables.formulation_ways(runs),
            tables.agreement_table(agreements),
            tables.order_table(runs, agreements),
            tables.options(runs),
            tables.failures(runs),
            tables.all_runs(runs),
        ],
    )


def _how(runs: Sequence[Run], quick: bool) -> str:
    repeats = max((run.repeats for run in runs), default=0)
    selection = (
        "This is the quick selection of methods and rungs; `tippedisk work-precision` runs all. "
        if quick
        else ""
    )
    return (
        f"Every method runs {TIMES[-1]:g} s from Table 3 on a ladder of steps or tolerances and "
        f"is sampled every {SPACING:g} s: the engine is made to have a step there, SciPy uses its "
        "own interpolation. Error: largest deviation over the motion of β and γ in rad (whole "
        "turns taken out) and of the centre of gravity's position over the radius. Time: "
        f"processor time of the integration alone, least of {repeats} repeats after a warm-up; "
        "building the scene and the normal force of the contact tree, which is computed from the "
        "result, do not count. "
        "Engine and in-house runs solve the same equations: the contact is ideal, and friction in "
        "the engine reads the contact force of the same iteration. So these are errors of "
        "integration alone; what a penalty contact changes is found under numerical stability. "
        "Each run has one thread of one process, and two run side by side. "
        f"{selection}The file work-precision-all-runs.csv holds the errors of each quantity, "
        "energy, normal force, constraint drift and the work done."
    )
