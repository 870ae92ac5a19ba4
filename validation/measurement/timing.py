"""One way to time one thing against another: calls in turns, after a warm-up each."""

from collections.abc import Callable, Sequence
from statistics import median
from typing import TypeVar

from scipy.stats import binom

T = TypeVar("T")

CONFIDENCE = 0.99
"""With which an interval holds the median of ratios."""


def in_turns(*calls: Callable[[], T], pairs: int) -> list[list[T]]:
    """Results of some calls, such as their times, made one after the other so many times.

    Parameters
    ----------
    *calls : callable
        Each is called once more before, to warm up.
    pairs : int

    Returns
    -------
    list of list
        For each call its results, in the order of the turns.
    """
    for call in calls:
        call()
    rounds = [[call() for call in calls] for _ in range(pairs)]
    return [list(results) for results in zip(*rounds, strict=True)]


def interval(ratios: Sequence[float]) -> tuple[float, float, float]:
    """Median ratio of pairs of times, and an interval that holds it with `CONFIDENCE`.

    Of 31 pairs, that is the one between the ninth and the last but eight.
    """
    ranked = sorted(ratios)
    first = int(binom.ppf((1.0 - CONFIDENCE) / 2.0, len(ranked), 0.5))
    return median(ranked), ranked[first], ranked[-1 - first]
