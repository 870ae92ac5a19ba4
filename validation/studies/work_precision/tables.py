"""Tables of the work-precision study."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import partial
from statistics import median

import mbs_models
from validation.kit.limits import holds
from validation.kit.plain import rounded
from validation.kit.tables import Cell, Table
from validation.studies.work_precision.figures import NAMES
from validation.studies.work_precision.prices import Price
from validation.studies.work_precision.problems import (
    PROBLEMS,
    SAFETY,
    Agreement,
    Errors,
    ProblemName,
)
from validation.studies.work_precision.runs import (
    ENDS,
    GOALS,
    Run,
    fastest,
    grouped,
    observed_order,
    shortfall,
    words,
)
from validation.studies.work_precision.stored import Study

_COSTS = ("evaluations", "time in ms")


def ways(study: Study) -> Table:
    """Fastest way to each goal, in the engine and in-house."""
    cells: list[list[Cell]] = []
    for name, problem in PROBLEMS.items():
        if not study.of(name):
            cells.append([problem.title, None, "not in this selection", *(None,) * 5])
            continue
        for goal in GOALS:
            row: list[Cell] = [problem.title, words(goal)]
            for side in (_engine(name), ("index-1", "reduced")):
                row += _way(study, name, side, goal)
            cells.append(row)
    return Table(
        name="work-precision-ways",
        title="Fastest way to an error of 1e-3, 1e-6 and 1e-9",
        folded=False,
        columns=(
            "problem",
            "error at most",
            "in the engine",
            "evaluations",
            "time in ms",
            "in-house",
            "evaluations",
            "time in ms",
        ),
        rows=cells,
        note="Among the rungs that were run, without interpolation; which rung is good enough is "
        "known from the reference. The engine is compiled and calls a Python friction function; "
        "the in-house equations are Python altogether. An extrapolated run counts all the runs "
        "it is made of. Evaluations: of the right-hand side, one per Newton iteration.",
    )


def _engine(name: ProblemName) -> Sequence[str]:
    return mbs_models.formulations(PROBLEMS[name].scenario)


def _way(study: Study, name: ProblemName, side: Sequence[str], goal: float) -> list[Cell]:
    curves = study.of(name, *side)
    run = fastest([run for curve in curves for run in curve.runs], goal)
    if run is None:
        return [shortfall(curves), None, None]
    return [run.method, run.work, _milliseconds(run)]


def _milliseconds(run: Run) -> float:
    milliseconds: float = rounded(1e3 * run.seconds, 3)
    return milliseconds


def formulation_ways(study: Study) -> Table:
    """Fastest way of each formulation of the engine to each goal."""
    names = [name for name in NAMES if name not in {"index-1", "reduced"}]
    cells: list[list[Cell]] = []
    for name, problem in PROBLEMS.items():
        if not study.of(name):
            cells.append([problem.title, None, *("not in this selection",) * len(names)])
            continue
        for goal in GOALS:
            row: list[Cell] = [problem.title, words(goal)]
            for formulation in names:
                if formulation not in _engine(name):
                    row.append(None)
                    continue
                curves = study.of(name, formulation)
                best = fastest([run for curve in curves for run in curve.runs], goal)
                row.append(
                    shortfall(curves)
                    if best is None
                    else f"{best.way}: {_milliseconds(best):g} ms"
                )
            cells.append(row)
    return Table(
        name="work-precision-formulations",
        title="Fastest way of each formulation",
        columns=("problem", "error at most", *(NAMES[name] for name in names)),
        rows=cells,
        note="–: the formulation does not apply. Not reached: every ladder of it went to its "
        "end, where finer steps bring no gain or fail. Not tried: stopped at that many steps.",
    )


def every_way(study: Study) -> Table:
    """What each method takes to each goal, with a step, extrapolated and to a tolerance."""
    cells: list[list[Cell]] = []
    for curve in study.curves:
        for kind, runs in grouped(curve.runs, lambda run: run.kind).items():
            row: list[Cell] = [
                PROBLEMS[curve.problem].title,
                curve.formulation,
                curve.scheme,
                kind,
            ]
            for goal in GOALS:
                good = [run for run in runs if run.error <= goal]
                if kind == "tolerance":
                    good = [run for run in good if run.setting == goal]
                best = min(good, key=lambda run: run.work, default=None)
                row += [best.work, _milliseconds(best)] if best else [None, None]
            cells.append([*row, min(run.error for run in runs), ENDS[curve.end]])
    return Table(
        name="work-precision-every-way",
        title="What every way takes to each goal",
        file_only=True,
        columns=(
            "problem",
            "formulation",
            "integrator",
            "asked for",
            *(f"{what} to {words(goal)}" for goal in GOALS for what in _COSTS),
            "smallest error",
            "why the ladder ended",
        ),
        rows=cells,
    )


def tolerances(study: Study) -> Table:
    """What runs to a tolerance deliver and take, per formulation and integrator."""
    asked = [run for run in study.runs if run.kind == "tolerance"]
    cells: list[list[Cell]] = []
    for method, runs in grouped(asked, lambda run: f"{run.formulation}, {run.scheme}").items():
        met = [run for run in runs if run.errors is not None]
        extra = [excess for run in met if (excess := study.excess(run)) is not None]
        margins = [run.angle_error / run.setting for run in met]
        cells.append(
            [
                method,
                len(runs),
                len(runs) - len(met),
                rounded(max(margins), 3) if margins else None,
                rounded(median(margins), 3) if margins else None,
                sum(not holds(run.error, run.setting) for run in met),
                rounded(median(extra), 3) if extra else None,
            ]
        )
    return Table(
        name="work-precision-tolerances",
        title="Runs to a tolerance, for which the library chooses the steps",
        worst="error of β and γ over tolerance, largest",
        columns=(
            "method",
            "runs",
            "refused",
            "error of β and γ over tolerance, largest",
            "median",
            "position worse than that, runs",
            "evaluations over the least that would do, median",
        ),
        rows=cells,
        note="Promised are β and γ; the position of the centre of gravity, over the radius, is "
        "not. Tolerances of 1e-3, 1e-6 and 1e-9 rad where the ladder of the method meets them. "
        "The least that would do is that of the cheapest run of the same method, extrapolated or "
        "not, chosen with the reference at hand.",
    )


def agreement_table(agreements: Mapping[ProblemName, Agreement]) -> Table:
    """What the references agree to, and the smallest error that can be measured with them."""
    return Table(
        name="work-precision-references",
        title="References: in-house DOP853 at its tightest tolerance against other methods",
        columns=("problem", "compared with", "largest difference in rad", "errors count from"),
        rows=[
            [PROBLEMS[name].title, other, difference, agreements[name].floor]
            for name in PROBLEMS
            if name in agreements
            for other, difference in agreements[name].others.items()
        ],
        note=f"Errors below {SAFETY:g} times the smaller difference are not told apart from the "
        "reference's own; that range is shaded in the diagrams.",
    )


def order_table(study: Study) -> Table:
    """Observed orders of all methods on all problems."""
    shown = [run for run in study.runs if run.kind in {"step", "local tolerance"}]
    names = [name for name in PROBLEMS if study.of(name)]
    methods = grouped(shown, lambda run: run.method)
    cells: list[list[Cell]] = []
    for method, group in sorted(methods.items(), key=lambda item: _rank(item[1][0])):
        by_problem = grouped(group, lambda run: run.problem)
        row: list[Cell] = [method]
        for name in names:
            if name not in by_problem:
                row.append("")
                continue
            order = observed_order(by_problem[name], study.agreements[name].floor)
            row.append(f"– {order.reason}" if order.value is None else round(order.value, 2))
        cells.append(row)
    return Table(
        name="work-precision-orders",
        title="Observed orders",
        columns=("method", *(PROBLEMS[name].title for name in names)),
        rows=cells,
        note="Slope of the error against the number of steps, for methods with step control "
        "against the evaluations of the right-hand side, over the last four of at least four "
        "rungs with a useful and measurable error. Few rungs: fewer than that. Unsettled: the "
        "slopes between them differ by more than 0.6. Empty: the method does not apply.",
    )


def _rank(run: Run) -> tuple[int, str]:
    return list(NAMES).index(run.formulation), run.scheme


def price_table(prices: Sequence[Price]) -> Table:
    """What options and formulations cost, from pairs of runs in turns."""
    cells: list[list[Cell]] = []
    for price in sorted(prices, key=lambda price: (price.what, price.formulation)):
        low, high = price.interval
        cells.append(
            [
                price.what,
                price.formulation,
                PROBLEMS[price.problem].title,
                rounded(price.ratio, 3),
                f"{low:.3g} to {high:.3g}",
                "more" if low > 1.0 else "less" if high < 1.0 else "within scatter",
                rounded(price.work, 3),
                rounded(price.error, 3),
            ]
        )
    pairs = min((len(price.ratios) for price in prices), default=0)
    return Table(
        name="work-precision-prices",
        title="Prices, from pairs of runs measured in turns",
        columns=(
            "what",
            "formulation",
            "problem",
            "time, median ratio",
            "interval of the median",
            "so",
            "evaluations, ratio",
            "error, ratio",
        ),
        rows=cells,
        note=f"Processor time with over without, {pairs} pairs each, at the same step unless a "
        "goal is named. Within scatter: the interval, of at least 94 % confidence, holds 1.",
    )


def failures(study: Study) -> Table:
    """Failed runs, one row per method and problem, with the reason of the finest."""
    failed = [run for run in study.runs if run.failure]
    cells: list[list[Cell]] = []
    for gaps in grouped(failed, lambda run: f"{run.problem}, {run.method}").values():
        finest = min(gaps, key=lambda run: run.setting)
        cells.append(
            [
                PROBLEMS[finest.problem].title,
                finest.method,
                len(gaps),
                finest.setting,
                finest.failure,
            ]
        )
    return Table(
        name="work-precision-failures",
        title="Runs that did not reach their end",
        worst="runs",
        columns=("problem", "method", "runs", "finest step or tolerance", "reason of that one"),
        rows=cells,
    )


def all_runs(study: Study) -> Table:
    """Everything, for a file."""
    counts = sorted({name for run in study.runs for name in run.counts})
    return Table.of(
        study.runs,
        {
            "problem": lambda run: run.problem,
            "formulation": lambda run: run.formulation,
            "integrator": lambda run: run.scheme,
            "asked for": lambda run: run.kind,
            "step in s or tolerance": lambda run: run.setting,
            "least processor time in s": lambda run: run.seconds if run.errors else None,
            "slowest round over fastest": lambda run: run.scatter if run.errors else None,
            "repeats of a round": lambda run: run.repeats,
            **{each.name.replace("_", " "): partial(_error, each.name) for each in fields(Errors)},
            **{name.replace("_", " "): partial(_count, name) for name in counts},
            "failure": lambda run: run.failure,
        },
        name="work-precision-all-runs",
        title="All runs of the work-precision study",
        file_only=True,
    )


def _error(name: str, run: Run) -> float | None:
    return getattr(run.errors, name, None)


def _count(name: str, run: Run) -> int | None:
    return run.counts.get(name)
