"""Whether, and when, the disk turns itself upside down and stays so."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from analysis.data.checks import Array, increasing_times
from analysis.data.endings import REACHED

STAYING = 1.0
"""Time in s for which it then stays above the geometric centre.

A disk that rolls without slip reaches 0.90, and falls below the centre within 0.2 s.
"""

DEFINITION = (
    f"The disk is inverted from the first time at which its centre of gravity has risen to "
    f"{REACHED:.0%} of its largest height above the geometric centre and from which it stays "
    f"above that centre for {STAYING:g} s; if the motion ends before, it is not decided."
)

Outcome = Literal["inverted", "lost", "not inverted", "not decided"]
OUTCOMES: tuple[Outcome, ...] = get_args(Outcome)


@dataclass(frozen=True, slots=True, kw_only=True)
class Inversion:
    """What became of the inversion in a motion; see `DEFINITION`.

    Parameters
    ----------
    outcome : {"inverted", "lost", "not inverted", "not decided"}
        "lost": inverted, but the centre of gravity came below the geometric centre again before
        the motion ended. "not decided": it rose, and the motion ended before it had stayed up
        for `STAYING`.
    time : float, optional
        When the disk was inverted in s, to the spacing of the samples; None if it never was.
    lost : float, optional
        When the centre of gravity came below the geometric centre again in s.
    """

    outcome: Outcome
    time: float | None = None
    lost: float | None = None

    @classmethod
    def of_direction(cls, times: Array, cog_direction: Array) -> "Inversion":
        """Judge by where the centre of gravity lies, seen from the geometric centre.

        Parameters
        ----------
        times : ndarray, shape (n,)
            Strictly increasing times in s, dense against the oscillations of the disk.
        cog_direction : ndarray, shape (n,)
            Vertical part of the unit vector from the geometric centre to the centre of gravity.

        Raises
        ------
        ValueError
            If the times do not increase.
        """
        times = increasing_times(times)
        high = times[cog_direction >= REACHED]
        falls = np.append(times[cog_direction < 0.0], np.inf)
        next_fall = falls[np.searchsorted(falls, high)]
        stays = np.minimum(next_fall, times[-1]) - high >= STAYING
        if np.any(stays):
            first = int(np.argmax(stays))
            lost = None if np.isinf(next_fall[first]) else float(next_fall[first])
            outcome: Outcome = "inverted" if lost is None else "lost"
            return cls(outcome=outcome, time=float(high[first]), lost=lost)
        undecided = high.size > 0 and np.isinf(next_fall[-1])
        return cls(outcome="not decided" if undecided else "not inverted")
