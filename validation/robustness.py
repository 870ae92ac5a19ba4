"""Numerical stability on stiff and extreme cases: the jobs, and the section they fill."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any

from analysis import LOADS
from validation import robustness_drift as long_runs
from validation import robustness_figures as draw
from validation import robustness_steps as steps
from validation.penalty_limit import STIFFNESSES, PenaltyError, penalty_error
from validation.refusals import refusals
from validation.report import Job, Section
from validation.robustness_cases import TOLERANCE, Problem, problems, ways
from validation.robustness_drift import Conserved
from validation.robustness_run import Outcome, Verdict, run_problems
from validation.robustness_steps import StepLimit
from validation.tables import Cell, Table

VERDICTS: tuple[Verdict, ...] = (
    "accurate",
    "inaccurate",
    "diverged",
    "refused",
    "too slow",
    "crashed",
)

_QUICK_BATCHES = 6
_LIMITS = {True: 20.0, False: 60.0}
"""Time limit of a case in s, by whether the version is the quick one."""

_STEP_WAYS: dict[steps.Axis, tuple[tuple[Any, Any], ...]] = {
    "smoothing": (
        ("contact-tree", "RK44"),
        ("contact-tree", "TrapezoidalIndex2"),
        ("euler-tree", "TrapezoidalIndex2"),
        ("floating", "GeneralizedAlpha"),
    ),
    "stiffness": (
        ("euler-tree", "RK44"),
        ("euler-tree", "TrapezoidalIndex2"),
        ("floating-lie", "TrapezoidalIndex2"),
        ("floating", "GeneralizedAlpha"),
    ),
}


def jobs(*, quick: bool) -> list[Job]:
    """Jobs for `run_jobs`; all keys start with "robustness".

    Parameters
    ----------
    quick : bool
        Model 1 alone, default integrators and fewer places on each curve.
    """
    return [
        *_case_jobs(quick=quick),
        *_step_jobs(quick=quick),
        *(
            Job(("robustness", "drift", index), long_runs.drift, (runner, 5.0 if quick else 20.0))
            for index, runner in enumerate(long_runs.RUNNERS)
        ),
        *(
            Job(("robustness", "conserved", way), long_runs.conserved, (*way, 2.0))
            for way in long_runs.CONSERVED
        ),
        *(
            Job(("robustness", "penalty", case), penalty_error, case)
            for case in product(STIFFNESSES, LOADS)
        ),
        Job(("robustness", "refusals"), refusals),
    ]


def _case_jobs(*, quick: bool) -> list[Job]:
    """The grid of cases, in few batches if quick: each needs a process of its own."""
    found = problems(quick=quick)
    count = _QUICK_BATCHES if quick else len(found)
    return [
        Job(
            ("robustness", "cases", batch),
            run_problems,
            ([(each, ways(each, quick=quick)) for each in found[batch::count]], _LIMITS[quick]),
        )
        for batch in range(count)
    ]


def _step_jobs(*, quick: bool) -> list[Job]:
    smoothings = tuple(10.0**-n for n in range(0, 9, 2 if quick else 1))
    stiffnesses = (1e4, 1e5, 1e7, 1e9) if quick else tuple(10.0**n for n in range(4, 10))
    smallest = 3e-4 if quick else 1e-5
    found: list[tuple[Callable[..., list[StepLimit]], tuple[Any, ...]]] = []
    for integrator in ("RK44", "RK67"):
        found += [(steps.stable_over_smoothing, (value, integrator)) for value in smoothings]
        found += [(steps.stable_over_stiffness, (value, integrator)) for value in stiffnesses]
    for axis, ways_of_axis in _STEP_WAYS.items():
        values = smoothings if axis == "smoothing" else stiffnesses
        found += [(steps.accurate_steps, (axis, each, ways_of_axis, smallest)) for each in values]
    return [
        Job(("robustness", "step", index), function, arguments)
        for index, (function, arguments) in enumerate(found)
    ]


def section(results: Mapping[Any, Any], *, quick: bool) -> Section:
    """Section of the report.

    Parameters
    ----------
    results : mapping
        Of `jobs`, by key.
    quick : bool
        As given to `jobs`.
    """
    outcomes = _outcomes(results, quick=quick)
    limits: list[StepLimit] = [each for found in _all(results, "step") for each in found]
    drifts = [results["robustness", "drift", index] for index in range(len(long_runs.RUNNERS))]
    penalty: list[PenaltyError] = [
        results["robustness", "penalty", case] for case in product(STIFFNESSES, LOADS)
    ]
    return Section(
        name="robustness",
        title="Numerical stability",
        paragraphs=_paragraphs(outcomes),
        pictures=[
            draw.outcome_map(outcomes),
            draw.steps(limits, "smoothing"),
            draw.steps(limits, "stiffness"),
            draw.penalty(penalty),
            draw.drifts(drifts),
        ],
        tables=[
            summary(outcomes),
            failures(outcomes),
            results["robustness", "refusals"],
            step_table(limits),
            conserved_table(
                [results["robustness", "conserved", way] for way in long_runs.CONSERVED]
            ),
            drift_table(drifts),
        ],
    )


def wrong(results: Mapping[Any, Any]) -> int:
    """Number of cases that broke a promise or crashed, and of non-refusals.

    A run without an error estimate of its own, such as one with step control, promises nothing.
    """
    outcomes: list[Outcome] = [each for batch in _all(results, "cases") for each in batch]
    bad = sum(
        each.verdict == "crashed"
        or (each.verdict == "inaccurate" and (each.estimate is not None or each.error is None))
        for each in outcomes
    )
    return bad + sum(row[1] is not True for row in results["robustness", "refusals"].rows)


def _all(results: Mapping[Any, Any], kind: str) -> list[Any]:
    keys = [key for key in results if isinstance(key, tuple) and key[:2] == ("robustness", kind)]
    return [results[key] for key in sorted(keys, key=lambda key: key[2])]


def _outcomes(results: Mapping[Any, Any], *, quick: bool) -> list[Outcome]:
    order = {problem: index for index, problem in enumerate(problems(quick=quick))}
    flat = [outcome for batch in _all(results, "cases") for outcome in batch]
    return sorted(flat, key=lambda outcome: order[outcome.problem])


def _paragraphs(outcomes: Sequence[Outcome]) -> list[str]:
    counts = Counter(outcome.verdict for outcome in outcomes)
    counted = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
    return [
        (
            f"Each case asks for {TOLERANCE:g} rad in β and γ, in a process of its own with a "
            "time limit, and is measured against in-house runs by two other methods. Accurate: "
            "the error is within what was asked for and promised. Inaccurate: a result came back "
            "as right and is not. Diverged: the run said itself that it failed. Refused: it did "
            "not start. Too slow: the time limit ended it. "
            f"Of {len(outcomes)} cases: {counted}."
        ),
        (
            "The steps: an explicit integrator stays stable up to the step at which its "
            "stability function, measured on the engine itself, leaves the unit circle at the "
            "fastest eigenvalue. Beyond, friction does not blow up but chatters, since its force "
            "is bounded."
        ),
        (
            "The paper warns that formulations on acceleration level drift. They do, and the "
            "drift accumulates; how far is a matter of the integrator's tolerance. The engine's "
            "rolling joint holds the contact on velocity level with either of its integrators, "
            "and its residual does not accumulate."
        ),
    ]


def summary(outcomes: Sequence[Outcome]) -> Table:
    """One row per problem, one column per way, with verdict and error."""
    names = list(dict.fromkeys(outcome.way.name for outcome in outcomes))
    by_problem: dict[Problem, dict[str, Outcome]] = {}
    for outcome in outcomes:
        by_problem.setdefault(outcome.problem, {})[outcome.way.name] = outcome
    return Table(
        name="robustness",
        title=f"Hard cases at a tolerance of {TOLERANCE:g} rad: verdict and error in rad",
        columns=("model", "what is extreme", "how", *names, "doubt of the reference"),
        rows=[
            [
                problem.level,
                problem.axis,
                problem.label,
                *(_verdict(found.get(name)) for name in names),
                next((each.doubt for each in found.values() if each.doubt is not None), None),
            ]
            for problem, found in by_problem.items()
        ],
        note="Eccentric disks keep the steel disk's mass and its moments about the COG. Disks of "
        "another radius are scaled at the same Froude number.",
    )


def _verdict(outcome: Outcome | None) -> Cell:
    if outcome is None:
        return None
    return outcome.verdict if outcome.error is None else f"{outcome.verdict} {outcome.error:.0e}"


def failures(outcomes: Sequence[Outcome]) -> Table:
    """Every case that is not accurate, with its reason."""
    return Table(
        name="robustness-failures",
        title="Cases that gave no accurate result",
        columns=(
            "model",
            "what is extreme",
            "how",
            "formulation, integrator",
            "verdict",
            "reason",
        ),
        rows=[
            [
                outcome.problem.level,
                outcome.problem.axis,
                outcome.problem.label,
                outcome.way.name,
                outcome.verdict,
                outcome.reason or _error(outcome),
            ]
            for outcome in outcomes
            if outcome.verdict != "accurate"
        ],
    )


def _error(outcome: Outcome) -> str:
    promised = "nothing" if outcome.estimate is None else f"{outcome.estimate:.1e} rad"
    return f"error {outcome.error:.1e} rad, promised {promised}"


def step_table(limits: Sequence[StepLimit]) -> Table:
    """Measured and predicted step limits."""
    units = {"smoothing": "m/s", "stiffness": "N/m"}
    return Table(
        name="step-limits",
        title="Largest stable and largest accurate steps",
        columns=("over", "formulation", "integrator", "limit", "step in s", "predicted in s"),
        rows=[
            [
                f"{limit.axis} {limit.value:g} {units[limit.axis]}",
                limit.formulation,
                limit.integrator,
                limit.kind,
                limit.step,
                limit.predicted,
            ]
            for limit in limits
        ],
        note="Stable: a small disturbance of inverted spinning does not grow. Accurate: within "
        f"{steps.ACCURACY:g} rad over 0.4 s from Table 3. No step: none of those tried works, or "
        "the spinning itself is as unstable as the step could make it.",
    )


def conserved_table(found: Sequence[Conserved]) -> Table:
    """What a frictionless Model 1 conserves."""
    return Table(
        name="conserved",
        title="Model 1 without friction, 2 s from Table 3: largest changes of what is conserved",
        columns=(
            "formulation, integrator",
            "energy / (weight · radius)",
            "horizontal momentum / (mass · rim speed)",
            "vertical angular momentum about the COG, relative",
            "failure",
        ),
        rows=[
            [each.name, each.energy, each.momentum, each.spin, each.failure or None]
            for each in found
        ],
        note="Engine at a step of 1 ms, in-house at a local tolerance of 1e-9. The table's force "
        "is vertical, so that it has no moment about the vertical through the COG.",
    )


def drift_table(found: Sequence[long_runs.Drift]) -> Table:
    """Largest residuals of the long runs."""
    return Table(
        name="drift",
        title="Constraint drift and energy balance of long runs from Table 3",
        columns=(
            "constraints met on",
            "end in s",
            "largest position residual in m",
            "at the end in m",
            "largest velocity residual in m/s",
            "energy residual / (weight · radius)",
            "failure",
        ),
        rows=[
            [each.runner.label, None, None, None, None, None, each.failure]
            if each.failure
            else [
                each.runner.label,
                float(each.times[-1]),
                float(max(abs(each.position))),
                float(each.position[-1]),
                float(max(abs(each.velocity))),
                float(max(abs(each.energy))),
                None,
            ]
            for each in found
        ],
    )
