"""Whether, and when, the disk turns itself upside down and stays so."""

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from analysis.motion.endings import REACHED
from analysis.motion.interpolation import CAUTION, Numbers, Sampled
from analysis.motion.quantities import Quantities
from analysis.problem.checks import Array

STAYING = 1.0
"""Time in s for which it then stays above the geometric centre.

A disk that rolls without slip reaches 0.90, and falls below the centre within 0.22 s.
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
    """What became of the inversion in a motion.

    The disk is inverted from the first time at which its centre of gravity has risen to 90 % of
    its largest height above the geometric centre and from which it stays above that for 1 s.

    Parameters
    ----------
    outcome : {"inverted", "lost", "not inverted", "not decided"}
        "lost": inverted, but the centre of gravity came below the geometric centre again before
        the motion ended. "not decided": it rose, and the motion ended before it had stayed up
        for 1 s.
    time : float, optional
        When the disk was inverted in s, between two samples; None if it never was.
    lost : float, optional
        When the centre of gravity came below the geometric centre again in s.
    time_error, lost_error : float, optional
        How far off the samples may leave these times in s, as estimated: at most their spacing,
        and the first of them more where they are so far apart that the disk may have been up or
        down between two of them unseen. The error of the motion itself comes beside it.
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


def inversions(sampled: Quantities) -> Inversions:
    """Judge motions by where the centre of gravity lies, seen from the geometric centre.

    Parameters
    ----------
    sampled : Quantities
        Of a motion, or of m of them, dense against the oscillations of the disk; behind the end of
        one its last sample is repeated. A disk without eccentricity is never inverted.
    """
    courses = sampled.times, sampled.cog_direction, sampled.cog_direction_rate
    motions = _Motions(*map(np.atleast_2d, courses))
    eccentricities = np.ravel(sampled.scenario.disk.eccentricity)
    outcomes, numbers = motions.judged(eccentricities)
    # What comes up or down between two samples counts as well.
    rows, *both = motions.with_extremes(0.0, REACHED)
    if rows.size:
        (words, again), (_, other) = (each.judged(eccentricities[rows]) for each in both)
        # Where the other polynomials tell of none, it may have been at any time between two.
        spacing = np.diff(motions.times[rows]).max(axis=1)
        apart = np.where(np.isnan(other[:2]), spacing, CAUTION * np.abs(again[:2] - other[:2]))
        again[2:] = np.maximum(again[2:], apart)
        outcomes[rows], numbers[:, rows] = words, again
    return Inversions(outcomes, *numbers)


class _Motions(Sampled):
    """Samples of where the centre of gravity lies in k motions."""

    def judged(self, eccentricities: Array) -> tuple[npt.NDArray[Any], Array]:
        """What becomes of `Inversions`, by samples alone: outcomes, and its numbers, (4, k)."""
        outcomes = np.full(len(self.values), "not inverted", dtype=object)
        numbers = np.full((4, len(self.values)), np.nan)
        is_high = (self.values >= REACHED - _LAST_DIGITS).any(axis=1)
        rose = np.flatnonzero(is_high & (eccentricities > 0.0))
        if rose.size:
            motions = self.part(rose)
            rises = motions.rises()
            outcomes[rose[rises[0, rises[2] == self.times.shape[1]]]] = "not decided"
            rows, found = motions.first_lasting(rises)
            outcomes[rose[rows]] = np.where(np.isnan(found[1]), "inverted", "lost")
            numbers[:, rose[rows]] = found
        return outcomes, numbers

    def rises(self) -> Numbers:
        """The first rise of each motion and the first one after each fall, in order.

        Returns
        -------
        ndarray of int, shape (3, j)
            Row of the motion, first column at which it is up, and next one at which it is down, n
            if it is so at none.
        """
        size = self.times.shape[1]
        is_up = self.values >= REACHED - _LAST_DIGITS
        is_up[:, 1:] &= ~is_up[:, :-1]
        up = np.flatnonzero(is_up)
        down = np.append(np.flatnonzero(self.values < _LAST_DIGITS), self.times.size)
        rows = up // size
        falls = np.minimum(down[np.searchsorted(down, up)], (rows + 1) * size)
        is_new = np.append(True, falls[1:] > falls[:-1])
        return np.array((rows, up - rows * size, falls - rows * size))[:, is_new]

    def first_lasting(self, rises: Numbers) -> tuple[Numbers, Array]:
        """Rows that are inverted, and when, when that was lost, and both errors, shape (4, j)."""
        rows, columns, falls = rises
        last = self.times.shape[1] - 1
        # What has risen between two samples may have stayed since the earlier one.
        since = self.times[rows, np.maximum(columns - 1, 0)]
        until = self.times[rows, np.minimum(falls, last)]
        rows, columns, falls = rises[:, until - since >= STAYING]
        found = np.full((4, rows.size), np.nan)
        found[0], found[2] = self._passed(rows, columns, REACHED)
        lost = np.flatnonzero(falls <= last)
        found[1, lost], found[3, lost] = self._passed(rows[lost], falls[lost], 0.0)
        stays = np.flatnonzero(np.fmin(found[1], self.times[rows, -1]) - found[0] >= STAYING)
        rows, first = np.unique(rows[stays], return_index=True)
        found = found[:, stays[first]]
        found[2] = np.maximum(found[2], self._unseen(rows, found[0]))
        return rows, found

    def _unseen(self, rows: Numbers, risen: Array) -> Array:
        """How far off a rise or a fall that no sample shows may put the times of some rows.

        Only samples that are far apart are looked between: by cubic polynomials, with a margin.
        """
        errors = np.zeros(rows.size)
        widths, speeds = np.diff(self.times[rows], axis=1), np.abs(self.rates[rows])
        # Between two samples that are alike it may have been elsewhere, at this speed.
        moved = np.abs(np.diff(self.values[rows], axis=1))
        moved = np.maximum(moved, widths * np.maximum(speeds[:, :-1], speeds[:, 1:]))
        coarse = np.max(moved, axis=1) > _COARSE
        if not coarse.any():
            return errors
        chosen, risen = self.part(rows[coarse]), risen[coarse, None]
        times, directions, _ = chosen
        lowest, highest = chosen.extremes()
        begins, ends = times[:, :-1], times[:, 1:]
        # Up before, and not down since; or down within the time for which it has to stay up.
        is_down = (directions < _LAST_DIGITS) & (times <= risen)
        sunk = np.max(times, axis=1, keepdims=True, where=is_down, initial=-np.inf)
        before = (highest >= REACHED) & (ends <= risen) & (ends > sunk)
        after = (lowest < 0.0) & (begins >= risen) & (begins < risen + STAYING)
        earliest = np.min(np.where(before, begins, risen), axis=1)
        latest = np.max(np.where(after, np.minimum(ends + STAYING, times[:, -1:]), risen), axis=1)
        errors[coarse] = np.maximum(risen[:, 0] - earliest, latest - risen[:, 0])
        return errors

    def _passed(self, rows: Numbers, columns: Numbers, level: float) -> tuple[Array, Array]:
        """Times at which a level was passed before these samples, and their errors."""
        found, errors = self.times[rows, columns], np.zeros(rows.size)
        apart = np.abs(self.values[rows, columns] - level) > _LAST_DIGITS
        some = np.flatnonzero((columns > 0) & apart)
        if some.size:
            found[some], errors[some] = self.part(rows[some]).crossings(level, columns[some])
        return found, errors
