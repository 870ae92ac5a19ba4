"""What the work-precision study has measured: single runs, and selections of them."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from math import log
from statistics import median
from typing import Any

from validation.work_precision.problems import Errors, ProblemName

USEFUL = 0.1
"""Error from which on a run says nothing about the motion any more."""

LEAST_RATIO = 1.4
"""Of steps or evaluations between two rungs from which an order can be told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One rung of the ladder of a method on a problem.

    Parameters
    ----------
    problem, formulation, scheme, variant : str
    extrapolated : bool
        Whether it is extrapolated from all rungs down to this one, whose work it holds.
    setting : float
        Step in s or local tolerance.
    fixed_step : bool
        Which of them.
    seconds, median_seconds : float
        Least and median processor time of the integration over the repeats; nan if it failed.
    setup_seconds : float
        Least processor time of building the scene.
    repeats : int
    counts : dict
        Work of one run.
    errors : Errors, optional
        None if it failed.
    failure : str
        Why it failed.
    """

    problem: ProblemName
    formulation: str
    scheme: str
    variant: str = ""
    extrapolated: bool = False
    setting: float
    fixed_step: bool
    seconds: float = float("nan")
    median_seconds: float = float("nan")
    setup_seconds: float = float("nan")
    repeats: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    errors: Errors | None = None
    failure: str = ""

    @property
    def error(self) -> float:
        """`Errors.error`, infinite for a failed run."""
        return float("inf") if self.errors is None else self.errors.error

    @property
    def method(self) -> str:
        """Formulation, integrator and what was done to them."""
        return f"{self.formulation}, {self.way}"

    @property
    def way(self) -> str:
        """Integrator and what was done to it."""
        parts = [self.scheme, self.variant, "extrapolated" if self.extrapolated else ""]
        return ", ".join(part for part in parts if part)

    @property
    def in_house(self) -> bool:
        """Whether the in-house equations made it."""
        return self.formulation in {"index-1", "reduced"}

    @classmethod
    def from_dict(cls, stored: dict[str, Any]) -> "Run":
        """Run from what `asdict` made of it."""
        errors = stored["errors"]
        return cls(**(stored | {"errors": None if errors is None else Errors(**errors)}))

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and text."""
        return asdict(self)


def fastest(runs: Iterable[Run], goal: float) -> Run | None:
    """Run with an error of at most `goal` that took the least time, if there is one."""
    good = [run for run in runs if run.error <= goal]
    return min(good, key=lambda run: run.seconds, default=None)


def front(runs: Iterable[Run]) -> list[Run]:
    """Runs that no other beats in both time and error, the fastest first."""
    result: list[Run] = []
    finished = [run for run in runs if run.errors is not None]
    for run in sorted(finished, key=lambda run: (run.seconds, run.error)):
        if run.error < (result[-1].error if result else USEFUL):
            result.append(run)
    return result


def curves(
    runs: Iterable[Run], key: Callable[[Run], str] = lambda run: run.method
) -> dict[str, list[Run]]:
    """Runs by method, or another key, in the order in which they come."""
    result: dict[str, list[Run]] = {}
    for run in runs:
        result.setdefault(key(run), []).append(run)
    return result


def observed_order(runs: Sequence[Run], floor: float) -> float | None:
    """Median slope of the error against the number of steps, with its sign turned.

    Evaluations of the right-hand side stand for the steps of methods that control them. Only
    neighbouring rungs count that both lie between what can be measured and what is useful, and
    the last three pairs of them; None without any.

    Parameters
    ----------
    runs : sequence of Run
        Of one method on one problem, from coarse to fine.
    floor : float
        Smallest error that can be measured.
    """
    slopes = []
    for coarse, fine in pairwise(runs):
        if not floor < fine.error < coarse.error < USEFUL:
            continue
        ratio = coarse.setting / fine.setting
        if not coarse.fixed_step:
            ratio = fine.counts["right_hand_sides"] / coarse.counts["right_hand_sides"]
        if ratio > LEAST_RATIO:
            slopes.append(log(coarse.error / fine.error) / log(ratio))
    return median(slopes[-3:]) if slopes else None
