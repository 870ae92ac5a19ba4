"""Numerical stability on stiff and extreme cases: the jobs, and the section they fill."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any

from analysis import LOADS
from analysis.data.agreement import LEAST_RATE
from validation.kit.report import Job, Section
from validation.kit.samples import age
from validation.studies.robustness import causes, ended, steps, stored, tables
from validation.studies.robustness import drift as long_runs
from validation.studies.robustness import figures as draw
from validation.studies.robustness.axes import problems
from validation.studies.robustness.cases import TOLERANCE, EndedProblem, ways
from validation.studies.robustness.located import STRAIGHT
from validation.studies.robustness.penalty_limit import STIFFNESSES, PenaltyError, penalty_error
from validation.studies.robustness.reference import SPACINGS
from validation.studies.robustness.refusals import refusals
from validation.studies.robustness.run import DOUBT, SLACK, STEPS, Outcome, run_problems
from validation.studies.robustness.steps import StepLimit

_QUICK_BATCHES = 2
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
        *case_jobs(quick=quick),
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


def case_jobs(*, quick: bool) -> list[Job]:
    """The grid of cases, in few batches if quick: each needs a process of its own."""
    found = problems(quick=quick)
    count = _QUICK_BATCHES if quick else len(found)
    if not quick:
        # What takes longest comes first, so that nothing is waited for at the end.
        found.sort(
            key=lambda each: (
                isinstance(each, EndedProblem),
                -each.end,
                each.scenario.friction.finest_speed,
            )
        )
    batches = [found[index::count] for index in range(count)]
    return [
        Job(
            ("robustness", "cases", index),
            run_problems,
            ([(each, ways(each, quick=quick)) for each in batch],),
        )
        for index, batch in enumerate(batches)
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
        # Below 1e-4 m/s a run at each step of the ladder takes long.
        stiffest = 1e-4 if quick else 0.0
        values = [each for each in smoothings if each >= stiffest]
        if axis == "stiffness":
            values = list(stiffnesses)
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
    here = cases(results, quick=quick)
    full = stored.shipped() if quick else None
    outcomes = here if full is None else full.outcomes
    confirmed = [] if full is None else [tables.confirmation(stored.beside(here, full))]
    limits: list[StepLimit] = [each for found in _all(results, "step") for each in found]
    drifts = [results["robustness", "drift", index] for index in range(len(long_runs.RUNNERS))]
    penalty: list[PenaltyError] = [
        results["robustness", "penalty", case] for case in product(STIFFNESSES, LOADS)
    ]
    return Section(
        name="robustness",
        title="Numerical stability",
        paragraphs=[*_paragraphs(outcomes), *_source(full)],
        pictures=[
            *draw.verdicts(outcomes),
            draw.steps(limits, "smoothing"),
            draw.steps(limits, "stiffness"),
            draw.penalty(penalty),
            draw.drifts(drifts),
        ],
        tables=[
            tables.verdicts(outcomes, results["robustness", "refusals"]),
            causes.table(outcomes),
            *confirmed,
            tables.failures(outcomes),
            results["robustness", "refusals"],
            tables.step_limits(limits),
            tables.conserved(
                [results["robustness", "conserved", way] for way in long_runs.CONSERVED]
            ),
            tables.drift(drifts),
            tables.all_cases(outcomes),
        ],
    )


def wrong(results: Mapping[Any, Any]) -> int:
    """Number of cases that crashed or broke a promise, and of non-refusals."""
    outcomes: list[Outcome] = [each for batch in _all(results, "cases") for each in batch]
    refused = [row[1] is True for row in results["robustness", "refusals"].rows]
    return sum(each.broken for each in outcomes) + refused.count(False)


def _all(results: Mapping[Any, Any], kind: str) -> list[Any]:
    keys = [key for key in results if isinstance(key, tuple) and key[:2] == ("robustness", kind)]
    return [results[key] for key in sorted(keys, key=lambda key: key[2])]


def cases(results: Mapping[Any, Any], *, quick: bool) -> list[Outcome]:
    """What became of all cases, in their order; arguments as of `section`."""
    flat = (outcome for batch in _all(results, "cases") for outcome in batch)
    return stored.in_order(flat, problems(quick=quick))


def _source(full: stored.Study | None) -> list[str]:
    if full is None:
        return []
    return [
        (
            "Counts, causes and figures of the cases are those of the last full study "
            f"({full.provenance.text()}); this run has repeated a sample of it. "
            f"{age('robustness', case_jobs(quick=False))}"
        )
    ]


def _paragraphs(outcomes: Sequence[Outcome]) -> list[str]:
    counts = Counter(outcome.verdict for outcome in outcomes)
    broken = sum(outcome.broken for outcome in outcomes)
    counted = ", ".join(f"{counts[each]} {each}" for each in tables.VERDICTS if counts[each])
    return [
        (
            f"Each case asks for {TOLERANCE:g} rad in β and γ, unless its label says another "
            "accuracy, in a process of its own, and is measured against a run by another method; "
            "two such runs by two methods, in-house, on a penalty contact of the engine, are "
            "compared with each other, and their "
            "deviation is the doubt of the reference. Accurate: the error is within what was "
            f"asked for and that doubt, the doubt is at most {DOUBT:g} of the former, and the "
            "constraint drift over the radius and the relative error of the energy are within "
            f"{SLACK:g} times that. Ends: so it is up to where an ideal contact would have to "
            "pull, a condition is met or the disk lies flat, and the reference ends for the same "
            "reason, at a time within the same number in s. Inaccurate: a result "
            "came back and is beyond one of them. Diverged: the run said itself that it failed. "
            f"Refused: it did not start. Not finished: it took {STEPS['engine']} steps of the "
            f"engine or {STEPS['in-house']} in-house, all its passes together, per second if the "
            "motion is longer than one; that is no failure of the method, and the same on every "
            "machine. "
            f"Of {len(outcomes)} cases: {counted}. Of these cases {broken or 'none'} crashed or "
            "broke a promise."
        ),
        *_ended(outcomes),
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


def _ended(outcomes: Sequence[Outcome]) -> list[str]:
    """How motions that end by themselves are judged, if there are any."""
    found = [outcome for outcome in outcomes if outcome.axis == ended.AXIS]
    if not found:
        return []
    least, most = (f(each.tolerance for each in found) for f in (min, max))
    spacings = " and ".join(f"{1e3 * each:g}" for each in SPACINGS)
    return [
        (
            f"{len(found)} cases end by themselves and ask for {least:g} to {most:g} rad, as "
            "their labels say; those not called sampled have two samples alone. A condition fixes "
            "the state at an ending, so that the states of two endings agree however far apart "
            "their times are. What is promised there is the reason, the time, and the state at "
            "one time: the angles' difference at the endings and that of their times multiplied "
            f"by the rates, or {LEAST_RATE:g} rad/s. "
            "The references know of no ending. The two are sampled every "
            f"{spacings} ms, and where the normal force or a condition turns negative, or comes "
            f"close to it, they are run again finer and finer, to {STRAIGHT:g} s."
        )
    ]
