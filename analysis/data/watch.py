"""How long a run takes, in seconds and in steps, and who wants to know."""

import time
from collections.abc import Callable
from math import inf

from analysis.data.checks import ToleranceError, function, positive
from analysis.data.limits import MOST_STEPS

Progress = Callable[[float, float], None]
"""Called now and then with the time reached in a run and with its end, both in s."""


class Watch:
    """Processor time and steps of one call, however many runs it makes.

    Parameters
    ----------
    time_limit : float, optional
        In s of processor time of this process.
    progress : callable, optional
        See `Progress`.
    most : float
        Steps after which the call is given up if it has no time limit; see `Effort.most`.

    Attributes
    ----------
    steps : int
        Taken so far.
    flattest : tuple of floats
        Where the last run came nearest to flat, as far as it is known: time in s, and angle
        between disk and table in rad.

    Raises
    ------
    ValueError
        If the time limit is not positive, or `progress` is no function.
    """

    def __init__(
        self,
        time_limit: float | None = None,
        progress: Progress | None = None,
        most: float = MOST_STEPS,
    ) -> None:
        self._limit = inf if time_limit is None else positive("time_limit", time_limit)
        self._most = int(most if time_limit is None else MOST_STEPS)
        self.steps = 0
        self.flattest = (0.0, inf)
        self._progress = None if progress is None else function("progress", progress)
        # With many threads it takes long to read.
        self._begin = time.process_time() if self._limit < inf else 0.0

    @property
    def is_idle(self) -> bool:
        """Whether it has neither a limit to look at nor anybody to tell."""
        return self._progress is None and self._limit == inf

    @property
    def seconds(self) -> float:
        """Processor time taken so far in s, of a call that has a limit."""
        return time.process_time() - self._begin

    @property
    def steps_left(self) -> int:
        """Steps after which the call is given up."""
        return max(0, self._most - self.steps)

    def given_up(self, who: str) -> ToleranceError:
        """The error of a call that is out of steps; `who` is what has run."""
        moment, leaning = self.flattest
        place = f" at t = {moment:.9g} s, where the disk leans by {leaning:.2g} rad"
        return ToleranceError(
            f"{who} was given up{place if leaning < inf else ''}, since its runs have taken "
            f"{self.steps:.1e} steps, far more than expected; ask for a larger tolerance or an "
            "earlier end, or give a time limit, up to which it goes on"
        )

    def is_over(self, reached: float, end: float) -> bool:
        """Tell how far a run is; returns whether it has to stop."""
        if self._progress is not None:
            self._progress(reached, end)
        return self._limit < inf and self.seconds > self._limit
