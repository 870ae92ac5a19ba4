"""A bar on standard error that shows how far a run is."""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from tqdm import tqdm

from analysis import Progress

T = TypeVar("T")

DELAY = 2.0
"""Time in s before it appears, so that short runs stay silent."""


@contextmanager
def progress_bar(reached: str = "t = {n:.4g} of {total:.4g} s") -> Iterator[Progress]:
    """Progress of a run of simulated time, or of what `reached` says, for `simulate` and others.

    A run that begins anew, as tolerance-controlled runs do, takes the bar back. Nothing is shown
    where standard error is not a terminal.
    """
    bar = tqdm(
        total=0.0,
        delay=DELAY,
        disable=not sys.stderr.isatty(),
        leave=False,
        bar_format=f"{{l_bar}}{{bar}}| {reached} [{{elapsed}}]",
    )

    def show(now: float, end: float) -> None:
        bar.total = end
        bar.n = min(bar.n, now)
        bar.update(now - bar.n)

    with bar:
        yield show


def counted(items: Iterable[T], what: str) -> Iterable[T]:
    """The items, with a bar that counts them; nothing is shown where no terminal looks on."""
    counting: Iterable[T] = tqdm(
        items, desc=what, delay=DELAY, disable=not sys.stderr.isatty(), leave=False
    )
    return counting
