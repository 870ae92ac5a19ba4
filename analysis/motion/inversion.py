"""Whether, and when, the disk turns itself upside down and stays so."""

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from analysis.motion.endings import REACHED
from analysis.motion.interpolation import Numbers, crossings, extremes
from analysis.problem.checks import Array

STAYING = 1.0
"""Time in s for which it then stays above the geometric centre.

A disk that rolls without slip reaches 0.90, and falls below the centre within 0.2 s.
"""

_LAST_DIGITS = 1e-12
"""By which a motion that ends at `REACHED` or at zero, because it does, may miss it."""

_COARSE = 0.25
"""Change between two samples from which on more may happen between them than they show."""

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
        When the disk was inverted in s, between two samples; None if it never was.
    lost : float, optional
        When the centre of gravity came below the geometric centre again in s.
    time_error, lost_error : float, optional
        How far off the samples may leave these times in s, as estimated: at most their spacing,
        and the first of them more where the disk may have been up or down between two samples
        unseen. The error of the motion itself comes beside it.
    """

    outcome: Outcome
    time: float | None = None
    lost: float | None = None
    time_error: float | None = None
    lost_error: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Inversions:
    """What became of the inversion in many motions; `inversions[member]` is an `Inversion`.

    Parameters
    ----------
    outcomes : ndarray of str, shape (m,)
    times, lost, time_errors, lost_errors : ndarray, shape (m,)
        In s; nan where there is none.
    """

    outcomes: npt.NDArray[Any]
    times: Array
    lost: Array
    time_errors: Array
    lost_errors: Array

    @property
    def numbers(self) -> tuple[Array, Array, Array, Array]:
        """All but the outcomes."""
        return self.times, self.lost, self.time_errors, self.lost_errors

    def __getitem__(self, member: int) -> Inversion:
        names = ("time", "lost", "time_error", "lost_error")
        numbers = zip(names, (float(each[member]) for each in self.numbers), strict=True)
        known = {name: value for name, value in numbers if value == value}  # noqa: PLR0124
        return Inversion(outcome=self.outcomes[member], **known)


def inversions(
    times: Array, cog_directions: Array, rates: Array, eccentricities: Array
) -> Inversions:
    """Judge motions by where the centre of gravity lies, seen from the geometric centre.

    Parameters
    ----------
    times : ndarray, shape (m, n)
        Strictly increasing times in s, dense against the oscillations of the disk; behind the end
        of a motion its last sample is repeated.
    cog_directions : ndarray, shape (m, n)
        Vertical part of the unit vector from the geometric centre to the centre of gravity.
    rates : ndarray, shape (m, n)
        Its rate in 1/s.
    eccentricities : ndarray, shape (m,)
        Of the disks in m; one without is never inverted.
    """
    size = len(cog_directions)
    outcomes = np.full(size, "not inverted", dtype=object)
    numbers = np.full((4, size), np.nan)
    is_high = (cog_directions >= REACHED - _LAST_DIGITS).any(axis=1)
    rose = np.flatnonzero(is_high & (eccentricities > 0.0))
    if rose.size:
        risen = _Risen(times[rose], cog_directions[rose], rates[rose])
        outcomes[rose[risen.is_up_at_end]] = "not decided"
        rows, found = risen.inversions()
        outcomes[rose[rows]] = np.where(np.isnan(found[1]), "inverted", "lost")
        numbers[:, rose[rows]] = found
    return Inversions(outcomes, *numbers)


class _Risen:
    """Motions whose centre of gravity rises to `REACHED` at some sample, shape (k, n)."""

    def __init__(self, times: Array, directions: Array, rates: Array) -> None:
        self._times, self._directions, self._rates = times, directions, rates
        self._ends, high = times[:, -1], directions >= REACHED - _LAST_DIGITS
        falls = np.where(directions < _LAST_DIGITS, times, np.inf)
        self._next_fall = np.minimum.accumulate(falls[:, ::-1], axis=1)[:, ::-1]
        last = high.shape[1] - 1 - np.argmax(high[:, ::-1], axis=1)
        self.is_up_at_end = np.isinf(self._next_fall[np.arange(len(high)), last])
        # What has risen between two samples may have stayed since the earlier one.
        since = np.append(times[:, :1], times[:, :-1], axis=1)
        until = np.minimum(self._next_fall, self._ends[:, None])
        self._may_stay = high & (until - since >= STAYING)

    def inversions(self) -> tuple[Numbers, Array]:
        """Rows that are inverted, and when, when that was lost, and both errors, shape (4, j)."""
        settled = np.full((4, len(self._times)), np.nan)
        rows = np.flatnonzero(self._may_stay.any(axis=1))
        while rows.size:
            first = np.argmax(self._may_stay[rows], axis=1)
            found = np.full((4, rows.size), np.nan)
            found[0], found[2] = self._passed(rows, first, REACHED)
            fall = self._next_fall[rows, first]
            if (lost := np.flatnonzero(np.isfinite(fall))).size:
                columns = np.argmax(self._times[rows[lost]] >= fall[lost, None], axis=1)
                found[1, lost], found[3, lost] = self._passed(rows[lost], columns, 0.0)
            stays = np.fmin(found[1], self._ends[rows]) - found[0] >= STAYING
            settled[:, rows[stays]] = found[:, stays]
            rows, fall = rows[~stays], fall[~stays]
            self._may_stay[rows] &= self._times[rows] > fall[:, None]
            rows = rows[self._may_stay[rows].any(axis=1)]
        rows = np.flatnonzero(~np.isnan(settled[0]))
        settled[2, rows] = np.maximum(settled[2, rows], self._unseen(rows, settled[0, rows]))
        return rows, settled[:, rows]

    def _unseen(self, rows: Numbers, risen: Array) -> Array:
        """How far off a rise or a fall that no sample shows may put the times of some rows.

        Only samples that are far apart are looked between: by cubic polynomials, with a margin.
        """
        errors = np.zeros(rows.size)
        coarse = np.max(np.abs(np.diff(self._directions[rows], axis=1)), axis=1) > _COARSE
        if not coarse.any():
            return errors
        rows, risen = rows[coarse], risen[coarse, None]
        times = self._times[rows]
        lowest, highest = extremes(times, self._directions[rows], self._rates[rows])
        begins, ends, falls = times[:, :-1], times[:, 1:], self._next_fall[rows]
        # Up before, and not down since; or down within the time for which it has to stay up.
        before = (highest >= REACHED) & (ends <= risen) & (falls[:, 1:] > risen)
        after = (lowest < 0.0) & (begins >= risen) & (begins < risen + STAYING)
        earliest = np.min(np.where(before, begins, risen), axis=1)
        latest = np.max(np.where(after, np.minimum(ends + STAYING, times[:, -1:]), risen), axis=1)
        errors[coarse] = np.maximum(risen[:, 0] - earliest, latest - risen[:, 0])
        return errors

    def _passed(self, rows: Numbers, columns: Numbers, level: float) -> tuple[Array, Array]:
        """Times at which a level was passed before these samples, and their errors."""
        found, errors = self._times[rows, columns], np.zeros(rows.size)
        apart = np.abs(self._directions[rows, columns] - level) > _LAST_DIGITS
        some = np.flatnonzero((columns > 0) & apart)
        chosen = rows[some]
        found[some], errors[some] = crossings(
            self._times[chosen],
            self._directions[chosen],
            self._rates[chosen],
            level,
            columns[some],
        )
        return found, errors
