"""How long a run takes, and who wants to know."""

import time
from collections.abc import Callable
from math import inf

from analysis.data.checks import positive

Progress = Callable[[float, float], None]
"""Called now and then with the time reached in a run and with its end, both in s."""


class Watch:
    """Processor time of one call, however many runs it makes.

    Parameters
    ----------
    time_limit : float, optional
        In s of processor time of this process.
    progress : callable, optional
        See `Progress`.

    Raises
    ------
    ValueError
        If the time limit is not positive.
    """

    def __init__(self, time_limit: float | None = None, progress: Progress | None = None) -> None:
        self._limit = inf if time_limit is None else positive("time_limit", time_limit)
        self._progress = progress
        self._begin = time.process_time()

    @property
    def is_idle(self) -> bool:
        """Whether it has neither a limit to look at nor anybody to tell."""
        return self._progress is None and self._limit == inf

    @property
    def seconds(self) -> float:
        """Processor time taken so far in s."""
        return time.process_time() - self._begin

    def is_over(self, reached: float, end: float) -> bool:
        """Tell how far a run is; returns whether it has to stop."""
        if self._progress is not None:
            self._progress(reached, end)
        return self._limit < inf and self.seconds > self._limit
