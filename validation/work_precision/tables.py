"""Tables of the work-precision study."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from math import exp, log
from statistics import mean

from validation.tables import Cell, Table
from validation.work_precision.figures import GOALS, NAMES
from validation.work_precision.problems import PROBLEMS, SAFETY, Agreement, Errors, ProblemName
from validation.work_precision.runs import Run, curves, fastest, observed_order


def ways(runs: Sequence[Run]) -> Table:
    """Fastest way to each goal, in the engine and in-house."""
    by_problem = curves(runs, lambda run: run.problem)
    cells: list[list[Cell]] = []
    for name, problem in PROBLEMS.items():
        for goal in GOALS:
            row: list[Cell] = [problem.title, goal]
            for in_house in (False, True):
                side = [run for run in by_problem.get(name, []) if run.in_house is in_house]
                row += _way(fastest(side, goal))
            cells.append(row)
    return Table(
        name="work-precision-ways",
        title="Fastest way to an error of 1e-3, 1e-6 and 1e-9",
        columns=(
            "problem",
            "error at most",
            "in the engine",
            "step or tolerance",
            "time in ms",
            "in-house",
            "tolerance",
            "time in ms",
        ),
        rows=cells,
        note="Among the rungs that were run, without interpolation. The engine is compiled and "
        "calls a Python friction function; the in-house equations are Python altogether. An "
        "extrapolated run counts the time of all the runs it is made of.",
    )


def formulation_ways(runs: Sequence[Run]) -> Table:
    """Fastest way of each formulation of the engine to each goal."""
    names = [name for name in NAMES if name not in {"index-1", "reduced"}]
    cells: list[list[Cell]] = []
    for problem in PROBLEMS.values():
        for goal in GOALS[:2]:
            row: list[Cell] = [problem.title, goal]
            for name in names:
                own = [
                    run for run in runs if run.problem == problem.name and run.formulation == name
                ]
                best = fastest(own, goal)
                row.append(None if best is None else f"{best.way}: {_milliseconds(best)}")
            cells.append(row)
    return Table(
        name="work-precision-formulations",
        title="Fastest way of each formulation",
        columns=("problem", "error at most", *(NAMES[name] for name in names)),
        rows=cells,
        note="No entry: not reached on the ladder, or the formulation does not apply.",
    )


def _milliseconds(run: Run) -> str:
    return f"{1e3 * run.seconds:.3g} ms"


def _way(run: Run | None) -> list[Cell]:
    if run is None:
        return ["not reached", None, None]
    return [run.method, run.setting, round(1e3 * run.seconds, 2)]


def agreement_table(agreements: Mapping[ProblemName, Agreement]) -> Table:
    """What the references agree to, and the smallest error that can be measured with them."""
    return Table(
        name="work-precision-references",
        title="References: in-house DOP853 at its tightest tolerance against other methods",
        columns=("problem", "compared with", "largest difference in rad", "errors count from"),
        rows=[
            [PROBLEMS[name].title, other, difference, agreements[name].floor]
            for name in PROBLEMS
            for other, difference in agreements[name].others.items()
        ],
        note=f"Errors below {SAFETY:g} times the smaller difference are not told apart from the "
        "reference's own; that range is shaded in the diagrams.",
    )


def order_table(runs: Sequence[Run], agreements: Mapping[ProblemName, Agreement]) -> Table:
    """Observed orders of all plain methods on all problems."""
    plain = [run for run in runs if not run.variant and not run.extrapolated]
    cells: list[list[Cell]] = []
    for method, group in sorted(curves(plain).items(), key=lambda item: _rank(item[1][0])):
        by_problem = curves(group, lambda run: run.problem)
        row: list[Cell] = [method]
        for name in PROBLEMS:
            order = observed_order(by_problem.get(name, []), agreements[name].floor)
            row.append(None if order is None else round(order, 2))
        cells.append(row)
    return Table(
        name="work-precision-orders",
        title="Observed orders",
        columns=("method", *(problem.title for problem in PROBLEMS.values())),
        rows=cells,
        note="Slope of the error against the number of steps, for methods with step control "
        "against the evaluations of the right-hand side; no entry where fewer than two "
        "neighbouring runs have a useful and measurable error, or the method does not apply.",
    )


def _rank(run: Run) -> tuple[int, str]:
    return list(NAMES).index(run.formulation), run.scheme


def failures(runs: Sequence[Run]) -> Table:
    """Failed runs, one row per method and problem, with the reason of the finest."""
    failed = [run for run in runs if run.failure]
    cells: list[list[Cell]] = []
    for name, group in curves(failed, lambda run: run.problem).items():
        for method, gaps in curves(group).items():
            finest = min(gaps, key=lambda run: run.setting)
            cells.append(
                [
                    PROBLEMS[gaps[0].problem].title if name in PROBLEMS else name,
                    method,
                    len(gaps),
                    finest.setting,
                    finest.failure,
                ]
            )
    return Table(
        name="work-precision-failures",
        title="Runs that did not reach their end",
        columns=("problem", "method", "runs", "finest step or tolerance", "reason of that one"),
        rows=cells,
    )


def options(runs: Sequence[Run]) -> Table:
    """What each option costs and changes, against the plain method at the same step."""
    by_method: dict[str, list[tuple[Run, Run]]] = {}
    for pair in option_pairs(runs):
        by_method.setdefault(pair[0].method, []).append(pair)
    cells: list[list[Cell]] = [
        [
            method,
            len(pairs),
            geometric_mean([one.seconds / other.seconds for one, other in pairs]),
            max(one.error / other.error for one, other in pairs),
        ]
        for method, pairs in by_method.items()
    ]
    return Table(
        name="work-precision-options",
        title="Options against the plain method at the same step",
        columns=("method", "pairs of runs", "time, mean ratio", "error, largest ratio"),
        rows=sorted(cells, key=lambda row: str(row[0])),
        note="Plain: modified Newton to 1e-12, friction as a Python function. Means are "
        "geometric, over all problems and steps at which both ran.",
    )


def option_pairs(runs: Sequence[Run]) -> list[tuple[Run, Run]]:
    """Runs with an option, each with the plain run of the same method at the same step."""
    plain = {
        (run.problem, run.formulation, run.scheme, run.setting): run
        for run in runs
        if not run.variant and not run.extrapolated and run.errors is not None
    }
    return [
        (run, plain[key])
        for run in runs
        if run.variant
        and run.errors is not None
        and (key := (run.problem, run.formulation, run.scheme, run.setting)) in plain
    ]


def geometric_mean(values: Sequence[float]) -> float:
    """Geometric mean of positive numbers."""
    return exp(mean(log(value) for value in values))


def all_runs(runs: Sequence[Run]) -> Table:
    """Everything, for a file."""
    counts = sorted({name for run in runs for name in run.counts})
    errors = [field.name for field in fields(Errors)]
    return Table(
        name="work-precision-all-runs",
        title="All runs of the work-precision study",
        file_only=True,
        columns=(
            "problem",
            "method",
            "step in s",
            "local tolerance",
            "least processor time in s",
            "median processor time in s",
            "set-up time in s",
            "repeats",
            *(name.replace("_", " ") for name in errors),
            *(name.replace("_", " ") for name in counts),
            "failure",
        ),
        rows=[
            [
                run.problem,
                run.method,
                run.setting if run.fixed_step else None,
                None if run.fixed_step else run.setting,
                *(
                    (run.seconds, run.median_seconds, run.setup_seconds)
                    if run.errors
                    else (None,) * 3
                ),
                run.repeats,
                *(run.errors.row() if run.errors else [None] * len(errors)),
                *(run.counts.get(name) for name in counts),
                run.failure,
            ]
            for run in runs
        ],
    )
