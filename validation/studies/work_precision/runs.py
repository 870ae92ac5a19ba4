"""What the work-precision study has measured: runs, ladders of them, and what they reach."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from hashlib import sha256
from itertools import pairwise
from math import inf, log, nan
from statistics import median
from typing import Literal

from validation.studies.work_precision.problems import TIMES, Errors, ProblemName

GOALS = (1e-3, 1e-6, 1e-9)
"""Errors to be reached."""

USEFUL = 0.1
"""Error from which on a run says nothing about the motion any more."""

LEAST_RATIO = 1.4
"""Of steps or evaluations between two rungs from which an order can be told."""

LEAST_RUNGS = 4
"""Rungs in the asymptotic range from which an order can be told."""

SETTLED = 0.6
"""Largest spread of the slopes between those rungs."""

Kind = Literal["step", "extrapolated", "local tolerance", "tolerance"]
"""What is asked for: a step; the steps down to one, extrapolated; a tolerance of each step; a
tolerance of the whole run, for which `mbs_models.simulate` chooses the steps."""

End = Literal["goal", "rounding", "failure", "finest", "work"]
"""Why a ladder has no finer rungs: it met the finest goal; two finer rungs brought nothing, or
failed; there is no finer setting; the next would take more work than is spent on one."""

ENDS: dict[End, str] = {
    "goal": "met the finest goal",
    "rounding": "two finer rungs brought no gain",
    "failure": "two finer rungs failed",
    "finest": "there is no finer tolerance",
    "work": "stopped at the limit of work",
}


def words(goal: float) -> str:
    """Short text of a power of ten, as 1e-3."""
    return f"{goal:.0e}".replace("e-0", "e-")


def evaluations(counts: Mapping[str, int]) -> int:
    """Evaluations of the right-hand side; of implicit rules in the engine, iterations.

    A Newton iteration evaluates it once. Does not depend on the machine.
    """
    return counts.get("right_hand_sides") or counts.get("newton_iterations", 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One rung of the ladder of a method on a problem.

    Parameters
    ----------
    problem, formulation, scheme : str
    kind : str
    setting : float
        Step in s or tolerance.
    rounds : tuple of float
        Least processor time in s over the repeats of each round; empty if it failed. That of the
        integration alone, but for kind "tolerance" that of the whole call.
    repeats : int
        Of each round.
    counts : dict
        Work, of an extrapolated run that of all runs it is made of.
    errors : Errors, optional
        None if it failed.
    failure : str
        Why it failed.
    """

    problem: ProblemName
    formulation: str
    scheme: str
    kind: Kind
    setting: float
    rounds: tuple[float, ...] = ()
    repeats: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    errors: Errors | None = None
    failure: str = ""

    @property
    def seconds(self) -> float:
        """Least processor time in s; nan if it failed."""
        return min(self.rounds, default=nan)

    @property
    def scatter(self) -> float:
        """Largest time of a round over the smallest; nan if it failed."""
        return max(self.rounds, default=nan) / self.seconds

    @property
    def error(self) -> float:
        """`Errors.error`, infinite for a failed run."""
        return inf if self.errors is None else self.errors.error

    @property
    def angle_error(self) -> float:
        """Error of beta and gamma alone, infinite for a failed run."""
        return inf if self.errors is None else max(self.errors.beta, self.errors.gamma)

    @property
    def work(self) -> int:
        """See `evaluations`."""
        return evaluations(self.counts)

    @property
    def method(self) -> str:
        """Formulation, integrator and what was asked for."""
        return f"{self.formulation}, {self.way}"

    @property
    def way(self) -> str:
        """Integrator and what was asked for."""
        words = {"extrapolated": "extrapolated", "tolerance": "to a tolerance"}.get(self.kind)
        return f"{self.scheme}, {words}" if words else self.scheme

    @property
    def in_house(self) -> bool:
        """Whether the in-house equations made it."""
        return self.formulation in {"index-1", "reduced"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Times:
    """What a further round of a curve brings.

    Parameters
    ----------
    curve : tuple of str
        Its name.
    rounds : tuple of tuple of float
        `Run.rounds` of its runs.
    rest : str
        Hash of all else, which has to be the same.
    """

    curve: tuple[ProblemName, str, str]
    rounds: tuple[tuple[float, ...], ...]
    rest: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """All runs of a formulation with an integrator on a problem, and why there are no more.

    Parameters
    ----------
    problem, formulation, scheme : str
    runs : tuple of Run
        In the order in which they were made; at least one.
    end : str
    """

    problem: ProblemName
    formulation: str
    scheme: str
    runs: tuple[Run, ...]
    end: End

    @property
    def name(self) -> tuple[ProblemName, str, str]:
        """Problem, formulation and scheme."""
        return self.problem, self.formulation, self.scheme

    @property
    def times(self) -> "Times":
        """Its times alone."""
        untimed = [replace(run, rounds=()) for run in self.runs]
        return Times(
            curve=self.name,
            rounds=tuple(run.rounds for run in self.runs),
            rest=sha256(repr(untimed).encode()).hexdigest()[:12],
        )

    def joined(self, later: "Times") -> "Curve":
        """With the times of a later round.

        Raises
        ------
        ValueError
            If that differs in more than times.
        """
        if self.times.rest != later.rest:
            raise ValueError(f"{', '.join(self.name)}: rounds differ in more than their times")
        pairs = zip(self.runs, later.rounds, strict=True)
        runs = (replace(run, rounds=run.rounds + again) for run, again in pairs)
        return replace(self, runs=tuple(runs))

    @property
    def best(self) -> float:
        """Smallest error of any of its runs."""
        return min(run.error for run in self.runs)


def by_hindsight(runs: Iterable[Run]) -> list[Run]:
    """Runs of a given step, extrapolated or not, or local tolerance.

    They are not chosen by themselves to meet an error, as those of kind "tolerance" are.
    """
    return [run for run in runs if run.kind != "tolerance"]


def fastest(runs: Iterable[Run], goal: float) -> Run | None:
    """Run with an error of at most `goal` that took the least time, if there is one."""
    good = [run for run in by_hindsight(runs) if run.error <= goal]
    return min(good, key=lambda run: run.seconds, default=None)


def shortfall(curves: Sequence[Curve]) -> str:
    """Why none of the curves meets a goal, in words a table can hold.

    "not reached" only where every ladder went to its end.
    """
    if not curves:
        return "not in this selection"
    best = min(curve.best for curve in curves)
    found = "" if best > USEFUL else f", best {best:.0e}"
    open_ended = [curve for curve in curves if curve.end in {"work", "goal"}]
    if not open_ended:
        return f"not reached{found}"
    if all(curve.end == "goal" for curve in open_ended):
        return "not in this selection"
    finest = min(run.setting for curve in open_ended for run in curve.runs if run.kind == "step")
    steps = round(TIMES[-1] / finest)
    if best == inf:
        return f"fails up to {steps} steps"
    return f"not tried beyond {steps} steps{found}"


def front(
    runs: Iterable[Run], cost: Callable[[Run], float] = lambda run: run.seconds
) -> list[Run]:
    """Runs that no other beats in both cost and error, the cheapest first."""
    result: list[Run] = []
    finished = [run for run in by_hindsight(runs) if run.errors is not None]
    for run in sorted(finished, key=lambda run: (cost(run), run.error)):
        if run.error < (result[-1].error if result else USEFUL):
            result.append(run)
    return result


def grouped(runs: Iterable[Run], key: Callable[[Run], str]) -> dict[str, list[Run]]:
    """Runs by a key, in the order in which they come."""
    result: dict[str, list[Run]] = {}
    for run in runs:
        result.setdefault(key(run), []).append(run)
    return result


@dataclass(frozen=True, slots=True)
class Order:
    """Observed order of convergence, or why there is none.

    Parameters
    ----------
    value : float, optional
    reason : str
        Why there is no value.
    """

    value: float | None
    reason: str = ""


def observed_order(runs: Sequence[Run], floor: float) -> Order:
    """Median slope of the error against the number of steps, with its sign turned.

    Evaluations of the right-hand side stand for the steps of methods that control them. Counted
    are the finest consecutive rungs whose errors lie between what can be measured and what is
    useful and fall from each to the next; there must be `LEAST_RUNGS` of them, and the slopes
    between the last ones must agree to `SETTLED`.

    Parameters
    ----------
    runs : sequence of Run
        Of one method on one problem, from coarse to fine.
    floor : float
        Smallest error that can be measured.
    """
    stretches: list[list[float]] = [[]]
    for coarse, fine in pairwise(runs):
        falling = floor < fine.error < coarse.error < USEFUL
        ratio = _refinement(coarse, fine) if falling else 0.0
        if ratio > LEAST_RATIO:
            stretches[-1].append(log(coarse.error / fine.error) / log(ratio))
        elif stretches[-1]:
            stretches.append([])
    slopes = max(stretches, key=len)[1 - LEAST_RUNGS :]
    if len(slopes) < LEAST_RUNGS - 1:
        return Order(None, "few rungs")
    if max(slopes) - min(slopes) > SETTLED:
        return Order(None, f"unsettled, {min(slopes):.1f} to {max(slopes):.1f}")
    return Order(median(slopes))


def _refinement(coarse: Run, fine: Run) -> float:
    if coarse.kind == "step":
        return coarse.setting / fine.setting
    return fine.work / coarse.work
