"""How far long work is, on standard error: a bar on a terminal, now and then a line elsewhere."""

import io
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import Any, TypeVar

from tqdm import tqdm

from analysis import Progress
from analysis.problem.limits import duration

T = TypeVar("T")

DELAY = 2.0
"""Time in s before a bar appears, so that short runs stay silent."""

EVERY = 10.0
"""Time in s between lines at first; each comes no sooner than after a tenth of what passed."""

_LOOK = 0.1
"""Time in s between looks at how far a run is."""

_TELLING = 0.01
"""Part that has to be done before the rest is reckoned from it; the first may be a compilation."""


def bar(what: str = "", *, reached: str = "", unit: str = "", **how: Any) -> "tqdm[Any]":
    """A bar that is to be updated and closed.

    Parameters
    ----------
    what : str
        In front of it.
    reached : str
        How far it is, as a format of `n` and `total`; by default a count.
    unit : str
        Of that count.
    **how
        `iterable`, `total` and `initial` as `tqdm` takes them.
    """
    how |= {"desc": what, "unit": unit, "delay": DELAY, "leave": False}
    if not sys.stderr.isatty():
        return _Lines(reached, **how)
    if reached:
        how["bar_format"] = f"{{l_bar}}{{bar}}| {reached} [{{elapsed}}]"
    return tqdm(**how)


class _Lines(tqdm):  # type: ignore[misc] # it brings no types
    """A bar as lines for a file or a pipe, which are no place to draw over."""

    def __init__(self, reached: str, **how: Any) -> None:
        self._reached, self._told = reached, 0.0
        super().__init__(**how, file=io.StringIO(), mininterval=EVERY, miniters=0)

    def __iter__(self) -> Iterator[Any]:
        """Its items, counted one by one: tqdm counts wrong where the interval of lines grows."""
        with self:
            for each in self.iterable:
                yield each
                self.update()

    def display(self, msg: str | None = None, pos: int | None = None) -> bool:  # noqa: ARG002
        """Write a line; an empty one would only clear a bar."""
        if msg == "":
            return True
        state = self.format_dict
        n, total, passed = state["n"], state["total"], state["elapsed"]
        count = f"{n:g} of {total:g} {self.unit}" if total else f"{n:g} {self.unit}"
        line = self._reached.format(n=n, total=total) if self._reached else count.rstrip()
        parts = [f"{self.desc}: {line}" if self.desc else line, self.postfix]
        parts.append(f"after {duration(passed)}")
        done = n - self.initial
        # A total that grows with what is done tells nothing, nor what has not moved.
        if total and done > _TELLING * (total - self.initial) and self._told < n < total:
            parts.append(f"some {duration(passed * (total - n) / done)} to go")
        self._told = n
        say(", ".join(part for part in parts if part))
        self.mininterval = max(EVERY, 0.1 * passed)
        return True


def say(text: str) -> None:
    """Write a line to standard error, if there is one; a bar goes on below it."""
    with suppress(OSError, ValueError):
        tqdm.write(text, file=sys.stderr)


@contextmanager
def progress_bar(reached: str = "t = {n:.4g} of {total:.4g} s") -> Iterator[Progress]:
    """Progress of a run of simulated time, or of what `reached` says, for `simulate` and others.

    A run that begins anew, as tolerance-controlled runs do, takes the bar back.
    """
    due = 0.0
    with bar(reached=reached, total=0.0) as shown:

        def show(now: float, end: float) -> None:
            nonlocal due
            # Runs tell at every step, of which the shortest take no longer than the bar does.
            if (passed := monotonic()) < due:
                return
            due = passed + _LOOK
            shown.total = end
            shown.n = min(shown.n, now)
            shown.update(now - shown.n)

        yield show


def counted(items: Iterable[T], what: str) -> Iterable[T]:
    """The items, with a bar that counts them."""
    return bar(what, iterable=items)
