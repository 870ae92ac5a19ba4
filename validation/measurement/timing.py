"""One way to time one thing against another: calls in turns, after a warm-up each."""

from collections.abc import Callable, Sequence
from statistics import median
from typing import TypeVar

from scipy.stats import binom

T = TypeVar("T")

CONFIDENCE = 0.99
"""With which, at least, an interval holds the median of ratios."""


def in_turns(*calls: Callable[[], T], pairs: int) -> list[list[T]]:
    """Results of some calls, such as their times, made one after the other so many times.

    Every other time they are made in the opposite order, so that none is always the first.

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
    results: list[list[T]] = [[] for _ in calls]
    for number in range(pairs):
        for turn in range(len(calls))[:: 1 if number % 2 else -1]:
            results[turn].append(calls[turn]())
    return results


def interval(ratios: Sequence[float]) -> tuple[float, float, float]:
    """Median ratio of pairs of times, and an interval that holds it with `CONFIDENCE`.

    Of 31 pairs, that is the one between the eighth and the last but seven; of less than 8, the
    widest there is, which holds it with less.
    """
    ranked = sorted(ratios)
    # No more than half of what is left may lie below the first.
    first = max(0, int(binom.ppf((1.0 - CONFIDENCE) / 2.0, len(ranked), 0.5)) - 1)
    return median(ranked), ranked[first], ranked[-1 - first]
