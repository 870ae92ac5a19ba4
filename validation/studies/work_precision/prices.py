"""What an option or a formulation costs, measured against its alternative in turns."""

from dataclasses import dataclass, replace
from statistics import median

import mbs_models
from mbs_models import Formulation, Integrator, Newton
from validation.studies.work_precision.methods import EngineMethod, TimedRun
from validation.studies.work_precision.problems import (
    PROBLEMS,
    SPACING,
    ProblemName,
    StandardProblem,
    compare,
    reference,
)
from validation.studies.work_precision.runs import evaluations, words

CONSTRAINED: tuple[Formulation, ...] = ("euler-tree", "floating", "floating-lie")
"""Formulations that keep constraints."""

_QUICK = ("floating-lie",)

PAIRS, QUICK_PAIRS = 11, 5
"""Number of pairs of runs."""

STEP = SPACING / 8
"""Of both runs of a pair, in s."""

GOAL = 1e-3
"""Error in rad to which extrapolation is compared with a single run."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Price:
    """Processor time with something over that without, at the same step or to the same error.

    Parameters
    ----------
    what : str
        In words.
    problem, formulation : str
    ratios : tuple of float
        Of the pairs, in the order in which they were measured.
    work : float
        Ratio of the iterations or evaluations, the same on every machine.
    error : float
        Ratio of the errors.
    """

    what: str
    problem: ProblemName
    formulation: str
    ratios: tuple[float, ...]
    work: float
    error: float

    @property
    def ratio(self) -> float:
        """Median of the ratios."""
        return median(self.ratios)

    @property
    def interval(self) -> tuple[float, float]:
        """Interval that holds the true median, from the order statistics.

        With 5 pairs from the least to the largest (confidence 94 %), from 9 on without the
        outermost two (96 % and more).
        """
        ranked = sorted(self.ratios)
        cut = 1 if len(ranked) >= 9 else 0
        return ranked[cut], ranked[-1 - cut]

    @property
    def told(self) -> bool:
        """Whether the ratio can be told from 1."""
        low, high = self.interval
        return low > 1.0 or high < 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """One of two things to compare: a method on a problem, at one step or extrapolated."""

    problem: StandardProblem
    method: EngineMethod
    steps: tuple[float, ...] = (STEP,)

    def seconds(self) -> float:
        """Processor time of all its runs."""
        return sum(self.method.run(self.problem, step).seconds for step in self.steps)

    def outcome(self) -> tuple[int, float]:
        """Iterations or evaluations of its runs, and the error of its result."""
        extrapolation = self.method.extrapolation(self.problem)
        work, result = 0, None
        for step in self.steps:
            run = self.method.run(self.problem, step)
            work += evaluations(run.counts)
            result = extrapolation.add(run) or run
        return work, _error(self.problem, self.method, result)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A comparison to be measured.

    Parameters
    ----------
    what : str
        In words.
    one, other : Side
        With it, and without.
    goal : float, optional
        Error to which `one` is extrapolated and `other` is a single run, in place of their steps.
    """

    what: str
    one: Side
    other: Side
    goal: float | None = None

    @property
    def label(self) -> str:
        """Name that no other case has."""
        return f"{self.what}, {self.one.method.formulation}, {self.one.problem.name}"


def measure_price(case: Comparison, quick: bool) -> Price:
    """Measure both sides in turns, after a run of each that tells its work and error.

    Raises
    ------
    ArithmeticError
        If a run does not reach its end, or a goal is not met.
    """
    one, other = case.one, case.other
    if case.goal is not None:
        one, other = _to_goal(one, case.goal)
    (work, error), (plain_work, plain_error) = one.outcome(), other.outcome()
    ratios = [one.seconds() / other.seconds() for _ in range(QUICK_PAIRS if quick else PAIRS)]
    return Price(
        what=case.what,
        problem=one.problem.name,
        formulation=one.method.formulation,
        ratios=tuple(ratios),
        work=work / plain_work,
        error=error / plain_error,
    )


def _to_goal(side: Side, goal: float) -> tuple[Side, Side]:
    """Coarsest steps whose extrapolation meets a goal, and coarsest step that does so alone."""
    extrapolation = side.method.extrapolation(side.problem)
    steps: list[float] = []
    joined: Side | None = None
    for step in side.method.ladder(side.problem):
        try:
            run = side.method.run(side.problem, step)
        except ArithmeticError:
            # Too long a step; extrapolation needs unbroken halving.
            extrapolation, steps = side.method.extrapolation(side.problem), []
            continue
        steps.append(step)
        better = extrapolation.add(run)
        met = better is not None and _error(side.problem, side.method, better) <= goal
        if joined is None and met:
            joined = replace(side, steps=tuple(steps))
        if _error(side.problem, side.method, run) <= goal:
            alone = replace(side, steps=(step,))
            return joined or alone, alone
    raise ArithmeticError(f"{side.method.formulation} does not meet {words(goal)} on its ladder")


def _error(problem: StandardProblem, method: EngineMethod, run: TimedRun | None) -> float:
    if run is None:
        raise ValueError("steps must not be empty")
    return compare(method.trajectory(problem, run), reference(problem.name)).error


def cases(quick: bool) -> list[Comparison]:
    """All comparisons; the quick ones are those of two formulations on Model 1."""
    names: tuple[ProblemName, ...] = ("model-1", "model-3")
    found = [case for name in names for case in _options(PROBLEMS[name])] + _loads()
    return [
        case
        for case in found
        if not quick
        or (case.other.problem.name == names[0] and case.one.method.formulation in _QUICK)
    ]


def _options(problem: StandardProblem) -> list[Comparison]:
    trapezoidal = Integrator(name="TrapezoidalIndex2")
    damped = Integrator(name="GeneralizedAlpha")
    full = replace(trapezoidal, newton=Newton(modified=False))
    result: list[Comparison] = []
    for formulation in mbs_models.formulations(problem.scenario):
        if formulation == "contact-tree":
            continue
        plain = EngineMethod(formulation=formulation, integrator=trapezoidal)
        options = {
            "full for modified Newton": replace(plain, integrator=full),
            "generalized-α 0.9 for the trapezoidal rule": replace(plain, integrator=damped),
        }
        result += [
            Comparison(
                what=what,
                one=Side(problem=problem, method=method),
                other=Side(problem=problem, method=plain),
            )
            for what, method in options.items()
        ]
        side = Side(problem=problem, method=plain)
        what = f"extrapolated for a single run, to {words(GOAL)}"
        result.append(Comparison(what=what, one=side, other=side, goal=GOAL))
    return result + _attitudes(problem)


def _attitudes(problem: StandardProblem) -> list[Comparison]:
    """Other formulations for the free body with Euler parameters."""
    trapezoidal = Integrator(name="TrapezoidalIndex2")
    usual = EngineMethod(formulation="floating", integrator=trapezoidal)
    return [
        Comparison(
            what="instead of floating with Euler parameters",
            one=Side(problem=problem, method=replace(usual, formulation=formulation)),
            other=Side(problem=problem, method=usual),
        )
        for formulation in ("euler-tree", "floating-lie")
    ]


def _loads() -> list[Comparison]:
    """Friction that reads the contact force, for friction that takes the weight as its load."""
    trapezoidal = Integrator(name="TrapezoidalIndex2")
    return [
        Comparison(
            what="friction that knows the contact force",
            one=Side(problem=PROBLEMS["contact-load"], method=method),
            other=Side(problem=PROBLEMS["model-1"], method=method),
        )
        for formulation in CONSTRAINED
        for method in [EngineMethod(formulation=formulation, integrator=trapezoidal)]
    ]
