"""Where a run of the engine's own integrators ends: looked for among its records, then located.

It is located by stepping the scene's accelerations from the record before: these have a solution
between any two steps, in which one search finds whatever comes first.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from analysis.motion.endings import CONTACT_WOULD_PULL, TIME_LIMIT
from analysis.problem.checks import Array, ToleranceError
from analysis.problem.choices import Method
from analysis.problem.elementary import Rows
from analysis.solve.stepping import (
    InitialValueProblem,
    Run,
    SolverError,
    integrate,
    pulls_at_start,
)
from analysis.solve.watch import StateFunction, Watch, intervals
from mbs_models.solving import EngineError, stepping

LOCAL = 1e-11
"""Error in a step with which endings are located."""

MOST_STEPS_OF_A_SEARCH = 1000
"""Of the accelerations; between two records some ten are usual."""


class Suspect(NamedTuple):
    """An ending that a run may have: a condition is negative, or may be between two records.

    Parameters
    ----------
    row : int
        Record before it, where it is not negative.
    width : float
        Time in s after it within which the ending may lie.
    reason : str
        That of the condition if it is known to be negative at the end of them, else empty.
    """

    row: int
    width: float
    reason: str


def turning_negative(
    conditions: Mapping[str, StateFunction], start: Array
) -> Callable[[Array], str | None]:
    """What tells of one state after the other which condition has turned negative, if one has.

    One that is negative from the start on waits until it has not been.
    """
    armed = {name for name, condition in conditions.items() if condition(start) >= 0.0}

    def turned(state: Array) -> str | None:
        for name, condition in conditions.items():
            if condition(state) >= 0.0:
                armed.add(name)
            elif name in armed:
                return name
        return None

    return turned


def suspects(
    moments: Array, told: Mapping[str, npt.ArrayLike], stopped: tuple[float, str] | None
) -> Iterator[Suspect]:
    """Where a run may end, in no order.

    Parameters
    ----------
    moments : ndarray, shape (n,)
        Times of the records in s.
    told : mapping
        What the conditions say at the records, or at the first ones.
    stopped : tuple of float and str, optional
        Time in s at which the run was stopped, and why, if it was.
    """
    for reason, values in told.items():
        yield from _dips(moments, np.asarray(values), reason)
    if stopped is not None and stopped[1] != TIME_LIMIT:
        # A condition may have been positive between two records alone.
        row = max(0, int(np.searchsorted(moments, stopped[0])) - 1)
        yield Suspect(row, stopped[0] - moments[row], stopped[1])


class Stepped(Protocol):
    """A motion by the accelerations of an engine system, to be stepped from any record on."""

    system: Any

    @property
    def method(self) -> Method:
        """How it is stepped."""

    def starting_at(self, record: Array) -> InitialValueProblem:
        """The motion from a record on."""

    def samples(self, states: Array) -> Array:
        """Records, shape (n, k), from n states of the problem."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Search:
    """How the endings of runs are located.

    Parameters
    ----------
    motion : Stepped
    allow_pulling : bool
        Whether a contact that pulls ends nothing.
    watch : Watch
        Of the call: what its time does not suffice to search ends before that.
    counts : Counter
        To which the work of the search is added.
    """

    motion: Stepped
    allow_pulling: bool = True
    watch: Watch
    counts: Counter[str] = field(default_factory=Counter)

    def until_ending(
        self, moments: Array, records: Array, suspects: Iterable[Suspect], margin: float
    ) -> tuple[str | None, Array, Array]:
        """Why a run ends, if it does, and its records up to there.

        Parameters
        ----------
        moments : ndarray, shape (n,)
            In s.
        records : ndarray, shape (n, k)
        suspects : iterable of Suspect
            In any order.
        margin : float
            Time in s by which a condition may turn negative later than a run shows.

        Returns
        -------
        ended : str or None
        moments : ndarray, shape (m,)
        records : ndarray, shape (m, k)

        Raises
        ------
        EngineError
            If the search fails where a condition is known to be negative.
        """
        for suspect in sorted(suspects):
            # Runs differ by their errors: what is negative in one may be so later in another.
            end, size = suspect.width + margin * bool(suspect.reason), suspect.row + 1
            if self.watch.is_out_of_time:
                return TIME_LIMIT, moments[:size], records[:size]
            try:
                reason, later, last = self._located(records[suspect.row], end)
            except EngineError as error:
                # Where a condition is known to be negative, an ending must not be passed over.
                if suspect.reason:
                    at = f"the ending {suspect.reason!r} after t = {moments[suspect.row]:.6g} s"
                    raise EngineError(f"{at} is not found: {error}") from error
                continue
            if ended := reason or suspect.reason:
                moments, records = moments[:size], records[:size]
                # By the digits of its time, it may be no later.
                if (moment := moments[-1] + later) > moments[-1]:
                    moments = np.append(moments, moment)
                    records = np.vstack((records, last))
                return ended, moments, records
        return None, moments, records

    def _located(self, record: Array, end: float) -> tuple[str | None, float, Array]:
        """Why the motion ends first within `end` s of a record, if it does; when, and record."""
        with stepping(self.motion.system):
            problem = self.motion.starting_at(record)
            if pulls_at_start(problem, allow_pulling=True) and not self.allow_pulling:
                return CONTACT_WOULD_PULL, 0.0, record
            found = self._stepped(problem, np.array([0.0, end]), MOST_STEPS_OF_A_SEARCH)
            last = self.motion.samples(found.states[-1:])[0]
            return found.ended, float(found.times[-1]), last

    def _stepped(self, problem: InitialValueProblem, times: Array, most: int) -> Run:
        """A motion from a record on, in so many steps at most."""
        # On a stiff contact a search may be endless, and a run that broke off has then no ending.
        how: dict[str, Any] = {"allow_pulling": self.allow_pulling, "watch": self.watch.part(most)}
        try:
            found = integrate(problem, times, self.motion.method, LOCAL, **how)
        except ToleranceError as error:
            raise SolverError(f"{most} steps are too few") from error
        self.counts.update(steps=found.steps, right_hand_sides=found.evaluations)
        return found

    def pulling_times(
        self, moments: Array, records: Array, forces: Array
    ) -> tuple[tuple[float, float], ...]:
        """Times in s between which the contact pulls.

        Between two records that differ in that, and where the force comes near to zero, they are
        located by stepping the scene's accelerations; those that no time is left for, as if the
        force ran straight from record to record.

        Parameters
        ----------
        moments : ndarray, shape (n,)
            Increasing times in s.
        records : ndarray, shape (n, k)
        forces : ndarray, shape (n,)
            Normal forces in N.
        """
        pulls, motion = forces < 0.0, self.motion
        searched = pulls[1:] != pulls[:-1]
        for sign in (1.0, -1.0):
            rows = _near_zero(moments, sign * forces)
            searched[rows] = searched[rows + 1] = True
        found = [tuple(moments[rows].tolist()) for rows in _runs_of(pulls[:-1] & ~searched)]
        with stepping(motion.system):
            for first, last in _runs_of(searched).tolist():
                if not self.watch.is_out_of_time:
                    problem, ends = motion.starting_at(records[first]), moments[[first, last]]
                    run = self._stepped(problem, ends, MOST_STEPS_OF_A_SEARCH * (last - first))
                    if run.ended != TIME_LIMIT:
                        found += run.pulling
                        continue
                here = slice(first, last + 1)
                found += _straight(moments[here], forces[here])
        joined: list[tuple[float, float]] = []
        for first, last in sorted(found):
            begin = joined.pop()[0] if joined and joined[-1][1] >= first else first
            joined.append((begin, last))
        return tuple(joined)


def _dips(moments: Array, values: Array, reason: str) -> Iterator[Suspect]:
    """Places up to the first record at which a condition turns negative.

    Where it is negative from the start on, it waits until it has not been.
    """
    armed = int(np.argmin(np.append(values < 0.0, False)))
    # Between two records it may have been positive.
    for row in _near_zero(moments[:armed], -values[:armed]).tolist():
        yield Suspect(row, float(moments[row + 2] - moments[row]), "")
    if armed == values.size:
        return
    negative = armed + np.flatnonzero(values[armed:] < 0.0)
    end = int(negative[0]) if negative.size else values.size - 1
    for row in (armed + _near_zero(moments[armed : end + 1], values[armed : end + 1])).tolist():
        yield Suspect(row, float(moments[row + 2] - moments[row]), "")
    if negative.size:
        yield Suspect(end - 1, float(moments[end] - moments[end - 1]), reason)


def _straight(moments: Array, forces: Array) -> tuple[tuple[float, float], ...]:
    """Times between which forces are negative that run straight from record to record."""
    pulls = forces < 0.0
    rows = np.flatnonzero(pulls[1:] != pulls[:-1])
    parts = forces[rows] / (forces[rows] - forces[rows + 1])
    edges = moments[rows] + parts * (moments[rows + 1] - moments[rows])
    return intervals([*moments[:1][pulls[:1]], *edges.tolist()], float(moments[-1]))


def _near_zero(moments: Array, values: Array) -> Rows:
    """First of three samples that are not negative, between which a function may yet be so."""
    before, here, after = (values[shift : max(0, values.size - 2) + shift] for shift in range(3))
    first, second = np.diff(moments)[: here.size], np.diff(moments)[1:]
    fall, rise = (here - before) / first, (after - here) / second
    lowest = (np.minimum(np.minimum(before, here), after) >= 0.0) & (fall <= 0.0) & (rise >= 0.0)
    lowest &= rise > fall
    # Of the parabola through all three.
    slope, bend = fall * second + rise * first, np.where(lowest, rise - fall, 1.0)
    vertex = here - slope**2 / (4.0 * bend * (first + second))
    return np.flatnonzero(lowest & (vertex < 0.1 * (np.maximum(before, after) - here)))


def _runs_of(intervals: npt.NDArray[np.bool_]) -> Rows:
    """First and last sample of each row of intervals between samples, shape (m, 2)."""
    changes = np.diff(np.concatenate(([0], intervals.astype(int), [0])))
    return np.flatnonzero(changes).reshape(-1, 2)
