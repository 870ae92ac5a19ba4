"""Measuring one method on one problem: its ladder, its repeats, and what is derived from them.

Nothing here looks at a clock to decide anything: ladders end by errors and by counted work, so
that every machine makes the same runs.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from math import inf

import numpy as np

from analysis import Trajectory
from validation.kit.plain import rounded
from validation.studies.work_precision.methods import EngineMethod, Extrapolation, Method, TimedRun
from validation.studies.work_precision.problems import (
    PROBLEMS,
    Errors,
    ProblemName,
    StandardProblem,
    compare,
    reference,
)
from validation.studies.work_precision.runs import (
    GOALS,
    USEFUL,
    Curve,
    End,
    Run,
    Times,
    evaluations,
)

LONG, VERY_LONG = 30_000, 100_000
"""Evaluations or iterations from which on a run is repeated less often, and not at all.

It then takes so long that a disturbance of the machine matters little.
"""

DIGITS = 4
"""Significant digits of times and errors, which mean no more."""

NEAR = 1e3
"""Estimated error over a tolerance from which the library takes two rungs or so to get there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effort:
    """How thoroughly to measure.

    Parameters
    ----------
    goal : float
        Error at which ladders end.
    repeats, long_repeats : int
        Timed runs of each rung, and of a rung of more than `LONG` evaluations.
    """

    goal: float
    repeats: int
    long_repeats: int

    def runs(self, work: int) -> int:
        """Timed runs of a rung of so many evaluations."""
        if work > VERY_LONG:
            return 1
        return self.long_repeats if work > LONG else self.repeats


QUICK = Effort(goal=1e-6, repeats=2, long_repeats=1)
FULL = Effort(goal=GOALS[-1], repeats=2, long_repeats=1)


@dataclass(slots=True)
class _Rung:
    """What a rung has given so far; filled over the sweeps."""

    setting: float
    errors: Errors | None = None
    counts: dict[str, int] = field(default_factory=dict)
    failure: str = ""
    seconds: list[float] = field(default_factory=list)
    parts: "list[_Rung]" = field(default_factory=list)
    """Of an extrapolated run: the rungs it is made of, whose times it adds up."""


def measure(name: ProblemName, method: Method, quick: bool) -> Curve:
    """Run a method on a problem along its ladder, extrapolated and to tolerances beside it.

    The whole ladder is repeated, not each rung by itself, so that a disturbance of the machine
    does not hit all repeats of a rung.

    Parameters
    ----------
    name : str
        Name of the problem.
    method : Method
    quick : bool
        Ladders end earlier, with fewer repeats.

    Returns
    -------
    Curve
        A failed run in it holds the reason.
    """
    problem, effort = PROBLEMS[name], QUICK if quick else FULL
    # The timed run of the same rung tells of a failure.
    with suppress(ArithmeticError):
        method.run(problem, method.ladder(problem)[0])
    rungs, joined, end, estimate = _first_sweep(problem, method, effort.goal)
    for sweep in range(1, effort.repeats):
        for rung in rungs:
            if rung.errors is not None and sweep < effort.runs(evaluations(rung.counts)):
                rung.seconds.append(method.run(problem, rung.setting).seconds)
    runs = [_run(problem, method, rung) for rung in rungs]
    runs += [replace(_run(problem, method, rung), kind="extrapolated") for rung in joined]
    if isinstance(method, EngineMethod) and method.fixed_step:
        best = min(run.error for run in runs)
        # Nothing is to run on without end: the library needs an estimate that is small, too.
        known = estimate / NEAR if method.judged_extrapolated else best
        goals = [goal for goal in GOALS if max(effort.goal, best, known) <= goal]
        runs += [_to_tolerance(problem, method, goal, effort) for goal in goals]
    return Curve(
        problem=name,
        formulation=method.formulation,
        scheme=method.scheme,
        runs=tuple(runs),
        end=end,
    )


def measure_again(name: ProblemName, method: Method, quick: bool) -> Times:
    """Times of a further round of `measure`."""
    return measure(name, method, quick).times


def _first_sweep(
    problem: StandardProblem, method: Method, goal: float
) -> tuple[list[_Rung], list[_Rung], End, float]:
    """Rungs, extrapolated runs, why there are no more, and the smallest estimated error."""
    rungs: list[_Rung] = []
    joined: list[_Rung] = []
    judged: list[float] = []
    estimate = inf
    extrapolation, parts = _extrapolation(problem, method), list[_Rung]()
    for setting in method.ladder(problem):
        rung = _Rung(setting)
        rungs.append(rung)
        try:
            result = method.run(problem, setting)
            rung.errors = _errors(problem, method.trajectory(problem, result))
        except ArithmeticError as error:
            # A rung that cannot be run is a result: a gap in the curve, with its reason.
            rung.failure = " ".join(str(error).split())
            # Extrapolation needs unbroken halving.
            extrapolation, parts = _extrapolation(problem, method), []
            judged.append(inf)
        else:
            rung.counts, rung.seconds = result.counts, [result.seconds]
            judged.append(rung.errors.error)
            parts.append(rung)
            better = None if extrapolation is None else extrapolation.add(result)
            if better is not None and extrapolation is not None:
                estimate = extrapolation.estimate
                errors = _errors(problem, method.trajectory(problem, better))
                joined.append(_Rung(setting, errors, better.counts, parts=list(parts)))
                if method.judged_extrapolated:
                    judged[-1] = min(judged[-1], errors.error)
        end = ladder_end(judged, goal, fixed_step=method.fixed_step)
        if end is not None:
            return rungs, joined, end, estimate
    return rungs, joined, "work" if method.fixed_step else "finest", estimate


def ladder_end(errors: Sequence[float], goal: float, *, fixed_step: bool) -> End | None:
    """Why a ladder with these errors needs no finer rung, or None if it does.

    Parameters
    ----------
    errors : sequence of float
        Of its rungs, from coarse to fine; infinite for failed ones.
    goal : float
        Error that is enough.
    fixed_step : bool
        Whether each rung halves the step. Tolerances may change nothing until they take over
        from the longest step.
    """
    if errors[-1] <= goal:
        return "goal"
    best, last = min(errors[:-2], default=inf), errors[-2:]
    if best < USEFUL and min(last) == inf:
        return "failure"
    # Above the coarsest goal, an error may rise and fall again.
    if fixed_step and best < GOALS[0] and min(last) > 0.5 * best:
        return "rounding"
    return None


def _extrapolation(problem: StandardProblem, method: Method) -> Extrapolation | None:
    if isinstance(method, EngineMethod) and method.fixed_step:
        return method.extrapolation(problem)
    return None


def _errors(problem: StandardProblem, run: Trajectory) -> Errors:
    truth = reference(problem.name)
    if run.ending is not None:
        raise ArithmeticError(f"{run.ending.reason} at t = {run.ending.time:.6g} s")
    errors = compare(run, truth)
    if not np.all(np.isfinite(errors.row())):
        raise ArithmeticError("the result is not finite")
    return errors


def _run(problem: StandardProblem, method: Method, rung: _Rung) -> Run:
    run = Run(
        problem=problem.name,
        formulation=method.formulation,
        scheme=method.scheme,
        kind="step" if method.fixed_step else "local tolerance",
        setting=rung.setting,
    )
    if rung.errors is None:
        return replace(run, failure=rung.failure)
    parts = rung.parts or [rung]
    return replace(
        run,
        rounds=(rounded(sum(min(part.seconds) for part in parts), DIGITS),),
        repeats=min(len(part.seconds) for part in parts),
        counts=rung.counts,
        errors=Errors(**rounded(asdict(rung.errors), DIGITS)),
    )


def _to_tolerance(
    problem: StandardProblem, method: EngineMethod, goal: float, effort: Effort
) -> Run:
    rung = _Rung(goal)
    try:
        trajectory, result = method.run_to(problem, goal)
        rung.errors, rung.counts = _errors(problem, trajectory), result.counts
    except ArithmeticError as error:
        rung.failure = " ".join(str(error).split())
    else:
        results: list[TimedRun] = [result]
        while len(results) < effort.runs(evaluations(rung.counts)):
            results.append(method.run_to(problem, goal)[1])
        rung.seconds = [each.seconds for each in results]
    return replace(_run(problem, method, rung), kind="tolerance")
