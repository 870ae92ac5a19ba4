"""One hard case, run to its end and classified from measured error, drift and energy."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Literal

import numpy as np

import analysis
from analysis import Level, Trajectory
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT
from validation.kit.limits import holds, largest
from validation.studies.robustness.cases import TOLERANCE, EndedProblem, HardProblem, Way
from validation.studies.robustness.isolated import Failure, run_isolated
from validation.studies.robustness.reference import (
    NoReference,
    Reference,
    deviation,
    ending_error,
    energy_error,
    limited,
    reference_or_reason,
)
from validation.studies.robustness.work import StepCount

Verdict = Literal[
    "accurate",
    "ends: contact would pull",
    "ends: condition met",
    "ends: lies flat",
    "inaccurate",
    "reference in doubt",
    "diverged",
    "refused",
    "not finished in the limit",
    "time limit",
    "crashed",
]

STEPS = {"engine": 50_000, "in-house": 20_000}
"""Most steps of a case of up to a second, all its passes together, by source; of longer ones per
second."""

TIME_LIMIT = 240.0
"""Time in s after which a process is ended from outside, many times what its steps take."""

DOUBT = 0.1
"""Largest doubt of a reference, in parts of the tolerance, that leaves a verdict possible."""

SLACK = 10.0
"""Times the angles' allowed error in rad that drift over radius and relative energy error may be.

Speeds and forces are not what a tolerance promises, and converge more slowly in some methods.
"""

_ENDINGS: dict[str, Verdict] = {
    CONTACT_WOULD_PULL: "ends: contact would pull",
    FLAT: "ends: lies flat",
}
"""Verdict on a run that ends rightly for a reason; that of a condition for any other."""

FEW = 3
"""Samples up to which a run is repeated, to see whether it gives the same bits; but for those
of which the ending is looked at, which are many."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of a case.

    Parameters
    ----------
    axis, label : str
        See `HardProblem`.
    level : {1, 2, 3, 4}, optional
        Number of the paper's model; None for another set of constraints.
    way : Way
    verdict : str
        `accurate`: the error is within what was asked for and the doubt of the reference, that
        doubt is at most `DOUBT` of the former, and drift and energy are within `SLACK` times that.
        `ends: …`: so it is, up to where it ends, and the reference ends there for the same
        reason. `inaccurate`: a result came back, and is beyond that. `reference in
        doubt`: a result came back, and no reference is good enough. `diverged`: the run said
        itself that it failed. `refused`: it did not start. `not finished in the limit`: it took
        `STEPS`. `time limit` and `crashed`: the process had to be ended, or ended itself, or the
        run raised a `ValueError` on its way.
    tolerance : float
        Asked for in rad, and of the time of an ending in s.
    error : float, optional
        Largest deviation of beta and gamma from the reference in rad; see `deviation`.
    ending_error : float, optional
        Deviation in s of the time at which it ends; infinite if the reasons differ.
    doubt : float, optional
        Deviation of two references by different methods from each other, in rad or in s.
    estimate : float, optional
        The run's own error estimate in rad.
    drift : float, optional
        Largest residual of the position-level constraints as a part of the radius; None on a
        penalty contact.
    energy : float, optional
        Largest deviation of the energy from the reference as a part of its largest value.
    repeatable : bool, optional
        Whether a second run gives the same bits; None if there was none.
    steps : int
        Of all passes of the run.
    seconds : float
    reason : str
        Why it diverged, was refused, was not finished or is in doubt.
    """

    axis: str
    label: str
    level: Level | None
    way: Way
    verdict: Verdict
    tolerance: float = TOLERANCE
    error: float | None = None
    ending_error: float | None = None
    doubt: float | None = None
    estimate: float | None = None
    drift: float | None = None
    energy: float | None = None
    repeatable: bool | None = None
    steps: int = 0
    seconds: float = field(default=0.0, compare=False)
    reason: str = ""

    @property
    def allowed(self) -> float:
        """Error in rad that is asked for, and what the references leave open beside it."""
        # What they leave open cannot be held against the run.
        return self.tolerance + (self.doubt or 0.0)

    @property
    def worst(self) -> float:
        """Larger of both errors, in rad or in s; infinite if one is no number."""
        return largest((self.error, self.ending_error or 0.0))

    @property
    def broken(self) -> bool:
        """Whether it crashed, broke its promise or, run again, gave other bits.

        The promise is about the angles, and about where and why the run ends. A run without an
        error estimate, such as one with step control, promises nothing.
        """
        if self.verdict == "crashed" or self.repeatable is False:
            return True
        if self.verdict == "reference in doubt" or self.error is None or self.estimate is None:
            return False
        return not holds(self.worst, self.allowed)


def run_problems(batch: Sequence[tuple[HardProblem, Sequence[Way]]]) -> list[Outcome]:
    """Run problems in several ways each, in a process that may hang or crash."""
    problems = [problem for problem, _ in batch]
    found = run_isolated(
        reference_or_reason, [(problem,) for problem in problems], limit=TIME_LIMIT
    )
    references = [
        NoReference(reason=each.reason) if isinstance(each, Failure) else each for each in found
    ]
    cases = [
        (problem, way, known)
        for (problem, ways), known in zip(batch, references, strict=True)
        for way in ways
    ]
    results = run_isolated(run_case, cases, limit=TIME_LIMIT)
    return [
        replace(
            _blank(problem, way),
            verdict="crashed" if result.kind == "crashed" else "time limit",
            reason=result.reason,
        )
        if isinstance(result, Failure)
        else result
        for (problem, way, _), result in zip(cases, results, strict=True)
    ]


def run_case(problem: HardProblem, way: Way, known: Reference | NoReference) -> Outcome:
    """Run one case and classify it."""
    count = StepCount(limited(STEPS[way.source], problem))
    begin = time.perf_counter()
    blank = _blank(problem, way)
    try:
        run = simulate(problem, way, count)
    except Exception as error:
        verdict = _verdict_of(error, count)
        if verdict is None:
            raise
        reason = " ".join(str(error).split())
        if verdict == "not finished in the limit":
            reason = f"{count.limit} steps taken, the last pass at t = {count.reached:.3g} s"
        return replace(
            blank,
            verdict=verdict,
            reason=reason,
            steps=min(count.steps, count.limit),
            seconds=time.perf_counter() - begin,
        )
    blank = replace(
        blank,
        estimate=run.error_estimate,
        steps=count.steps,
        seconds=time.perf_counter() - begin,
    )
    if problem.samples <= FEW and not isinstance(problem, EndedProblem):
        again = simulate(problem, way, StepCount(count.limit))
        blank = replace(blank, repeatable=_same(run, again))
    if isinstance(known, NoReference):
        if known.refused:
            reason = f"runs, and the reference cannot start: {known.reason}"
            return replace(blank, verdict="inaccurate", reason=reason)
        reason = f"the reference fails: {known.reason}"
        return replace(blank, verdict="reference in doubt", reason=reason)
    return _judge(blank, run, known)


def _blank(problem: HardProblem, way: Way) -> Outcome:
    return Outcome(
        axis=problem.axis,
        label=problem.label,
        level=problem.scenario.model,
        way=way,
        verdict="crashed",
        tolerance=problem.tolerance,
    )


def _verdict_of(error: Exception, count: StepCount) -> Verdict | None:
    """Verdict on a run that raised, None if nothing explains it.

    The engine wraps the end of the steps in errors of its own, and goes on to the next pass.
    """
    if count.is_used_up:
        return "not finished in the limit"
    if isinstance(error, ValueError):
        # What is refused is so before anything is computed.
        return "crashed" if count.steps else "refused"
    return "diverged" if isinstance(error, ArithmeticError) else None


def _judge(blank: Outcome, run: Trajectory, known: Reference) -> Outcome:
    """Classify a result by its deviation from the reference."""
    truth, doubt = known.for_way(blank.way), known.doubt
    ending = ending_error(run, truth)
    drift = None
    if run.scenario.contact is None:
        drift = float(np.max(analysis.constraint_drift(run)[0])) / run.scenario.disk.radius
    outcome = replace(
        blank,
        error=deviation(run, truth),
        ending_error=ending if run.ending or truth.ending else None,
        doubt=doubt,
        drift=drift,
        energy=energy_error(run, truth),
    )
    return replace(outcome, verdict=_verdict(outcome, run), reason=_reason(outcome, run, truth))


def _verdict(outcome: Outcome, run: Trajectory) -> Verdict:
    right = holds(outcome.worst, outcome.allowed)
    if not holds(outcome.doubt, DOUBT * outcome.tolerance) and (
        right or not isfinite(outcome.allowed)
    ):
        return "reference in doubt"
    silent = outcome.drift is not None and not np.all(run.normal_force[:-1] >= 0.0)
    kept = largest((outcome.drift or 0.0, outcome.energy))
    if silent or not right or not holds(kept, SLACK * outcome.allowed):
        return "inaccurate"
    if run.ending is None:
        return "accurate"
    return _ENDINGS.get(run.ending.reason, "ends: condition met")


def _reason(outcome: Outcome, run: Trajectory, truth: Trajectory) -> str:
    if outcome.ending_error is None:
        return ""
    one, other = (each.ending or "does not end early" for each in (run, truth))
    same = holds(outcome.ending_error, outcome.tolerance)
    return str(one) if same else f"{one}; reference: {other}"


def simulate(problem: HardProblem, way: Way, count: StepCount) -> Trajectory:
    """Simulate a problem to its tolerance, with the steps that `count` allows."""
    # Step control has a local tolerance of its own and promises nothing more.
    tolerance = None if way.integrator == "DOPRI5" else problem.tolerance
    return way.run(
        problem.scenario,
        problem.times,
        tolerance=tolerance,
        stop_when=problem.stop_when,
        progress=count,
    )


def _same(run: Trajectory, other: Trajectory) -> bool:
    return bool(
        np.array_equal(run.coordinates, other.coordinates)
        and np.array_equal(run.rates, other.rates)
        and np.array_equal(run.multipliers, other.multipliers)
    )
