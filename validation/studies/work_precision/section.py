"""The section of the report on error against run time."""

from collections.abc import Mapping
from typing import Any

from validation.kit.provenance import Provenance
from validation.kit.report import Section
from validation.kit.samples import age
from validation.studies.work_precision import confirm, figures, lesson, tables
from validation.studies.work_precision.jobs import PREFIX, jobs
from validation.studies.work_precision.methods import QUICK_PROBLEMS
from validation.studies.work_precision.problems import PROBLEMS, SPACING, TIMES
from validation.studies.work_precision.stored import Study, gathered, shipped


def collect(
    results: Mapping[Any, Any], *, quick: bool, provenance: Provenance | None = None
) -> Study:
    """Study from the results of `jobs`, by default made here and now.

    Raises
    ------
    KeyError
        If a result is missing; others beside them do not matter.
    """
    found = [results[job.key] for job in jobs(quick=quick)]
    return gathered(found, provenance=provenance or Provenance.here(), quick=quick)


def section(
    results: Mapping[Any, Any], *, quick: bool, provenance: Provenance | None = None
) -> Section:
    """Section of the report from the results of `jobs`; arguments as of `collect`."""
    return make_section(collect(results, quick=quick, provenance=provenance))


def make_section(measured: Study) -> Section:
    """Section with the lesson, the diagrams and the tables.

    Parameters
    ----------
    measured : Study
        What was measured on the spot. A full study speaks for itself; a quick one confirms by
        sample what the shipped full study says.
    """
    full = shipped()
    here = measured if measured.quick and full is not None else None
    shown = full if here is not None and full is not None else measured
    # A selection has too few cases for a lesson.
    said = [] if shown.quick else lesson.paragraphs(shown)
    confirmed = [] if here is None else [confirm.sentence(here, shown)]
    return Section(
        name="work-precision",
        title="Error against run time",
        paragraphs=[_how(shown), _origin(shown, here), _ways(shown), *confirmed, *said],
        pictures=[figures.fronts(shown, here), figures.orders(shown)],
        tables=[
            tables.ways(shown),
            tables.formulation_ways(shown),
            tables.tolerances(shown),
            tables.price_table(shown.prices),
            *([] if here is None else [confirm.table(here, shown)]),
            tables.agreement_table(shown.agreements),
            tables.order_table(shown),
            tables.failures(shown),
            tables.every_way(shown),
            tables.all_runs(shown),
        ],
    )


def _how(study: Study) -> str:
    repeats = max((run.repeats for run in study.runs), default=0)
    rounds = max((len(run.rounds) for run in study.runs), default=0)
    times = f"least of up to {repeats} repeats of the whole ladder after a warm-up"
    if rounds > 1:
        times += f", in each of {rounds} rounds minutes apart"
    return (
        f"Every method runs {TIMES[-1]:g} s from Table 3 on a ladder of steps or tolerances and "
        f"is sampled every {SPACING:g} s: the engine is made to have a step there, SciPy uses its "
        "own interpolation. Error: largest deviation over the motion of β and γ in rad (whole "
        "turns taken out) and of the centre of gravity's position over the radius. Work: "
        "evaluations of the right-hand side, one per Newton iteration; it is the same on every "
        "machine, and so is where a ladder ends. Time: processor time of the integration alone, "
        f"{times}; building the scene and the normal force of the contact tree, which is computed "
        "from the result, do not count, but for runs to a tolerance, whose time is that of the "
        "whole call. Engine and in-house runs solve the same equations: the contact is ideal, in "
        "none of the problems would it have to pull, and friction in the engine reads the "
        "contact force of the same iteration. So these are errors of integration alone. Each run "
        f"has one thread of one process, and two run side by side. {lesson.repeatability(study)}"
    )


def _ways(study: Study) -> str:
    """Formulations, integrators and what is asked of them, by name."""
    schemes: dict[str, dict[str, None]] = {name: {} for name in figures.NAMES}
    for curve in study.curves:
        schemes[curve.formulation][curve.scheme] = None
    named = "; ".join(
        f"{figures.NAMES[formulation]}: {', '.join(found)}"
        for formulation, found in schemes.items()
        if found
    )
    return (
        f"The ways, {len(study.runs)} runs in all: {named}. In the engine, rules with a fixed "
        "step are run with a step, extrapolated from halved steps, and to a tolerance of the "
        "whole run, for which the library chooses the steps; DOPRI5 and the methods of SciPy to a "
        "tolerance of each step. What every one of them takes to each goal is in the file "
        "work-precision-every-way.csv, all runs in work-precision-all-runs.csv."
    )


def _origin(shown: Study, here: Study | None) -> str:
    if not shown.quick:
        kind = "Shipped with the package" if here is not None else "Measured on the spot"
        since = f" {age(PREFIX, jobs(quick=False))}" if here is not None else ""
        return f"The full study. {kind}: {shown.provenance.text()}.{since}"
    titles = ", ".join(PROBLEMS[name].title for name in QUICK_PROBLEMS)
    return (
        f"This is the quick selection ({titles}; few integrators; to an error of 1e-6), from "
        "which no lesson is drawn; `tippedisk work-precision` runs all. "
        f"{shown.provenance.text()}."
    )
