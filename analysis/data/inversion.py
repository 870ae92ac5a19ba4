"""Whether, and when, the disk turns itself upside down and stays so."""

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, increasing_times
from analysis.data.endings import REACHED

STAYING = 1.0
"""Time in s for which it then stays above the geometric centre.

A disk that rolls without slip reaches 0.90, and falls below the centre within 0.2 s.
"""

_LAST_DIGITS = 1e-12
"""By which a motion that ends at `REACHED`, because it does, may miss it."""

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
        found = inversions(times[None], np.asarray(cog_direction)[None], times[-1:])
        time, lost = found.times[0], found.lost[0]
        return cls(
            outcome=found.outcomes[0],
            time=None if np.isnan(time) else float(time),
            lost=None if np.isnan(lost) else float(lost),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inversions:
    """What became of the inversion in many motions; see `Inversion`.

    Parameters
    ----------
    outcomes : ndarray of str, shape (m,)
    times, lost : ndarray, shape (m,)
        In s; nan where there is none.
    """

    outcomes: npt.NDArray[Any]
    times: Array
    lost: Array


def inversions(times: Array, cog_directions: Array, ends: Array) -> Inversions:
    """Judge many motions as `Inversion.of_direction` does one.

    Parameters
    ----------
    times, cog_directions : ndarray, shape (m, n) or one that broadcasts
        See `Inversion.of_direction`; a direction is nan where a motion has ended.
    ends : ndarray, shape (m,)
        Time of the last sample of each in s.
    """
    high = cog_directions >= REACHED - _LAST_DIGITS
    outcomes = np.full(len(high), "not inverted", dtype=object)
    inverted, lost = np.full(len(high), np.nan), np.full(len(high), np.nan)
    found = Inversions(outcomes=outcomes, times=inverted, lost=lost)
    rose = np.flatnonzero(high.any(axis=1))
    if not rose.size:
        return found
    high, each = high[rose], np.arange(rose.size)
    times = np.broadcast_to(times, cog_directions.shape)[rose]
    falls = np.where(cog_directions[rose] < 0.0, times, np.inf)
    next_fall = np.minimum.accumulate(falls[:, ::-1], axis=1)[:, ::-1]
    stays = high & (np.minimum(next_fall, ends[rose, None]) - times >= STAYING)
    first, last = np.argmax(stays, axis=1), high.shape[1] - 1 - np.argmax(high[:, ::-1], axis=1)
    is_inverted = stays.any(axis=1)
    outcomes[rose[np.isinf(next_fall[each, last])]] = "not decided"
    fall = next_fall[each, first]
    outcomes[rose[is_inverted]] = np.where(np.isinf(fall), "inverted", "lost")[is_inverted]
    inverted[rose] = np.where(is_inverted, times[each, first], np.nan)
    lost[rose] = np.where(is_inverted & np.isfinite(fall), fall, np.nan)
    return found
