"""What runs of many members have reached, as arrays; one run is the case of one member."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.data.checks import Array
from analysis.data.files import AnyArray
from analysis.data.members import Rows
from analysis.solve.stepping import Run

RUNNING = -1
"""In place of the number of an ending, of a motion that has none."""


@dataclass(frozen=True, slots=True, eq=False)
class Runs:
    """What runs of m members have reached.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Asked for, in s.
    names : sequence of str
        Of the endings that there may be.
    states : ndarray, shape (m, n, d)
        At these times; behind the end of a motion they mean nothing.
    last : ndarray, shape (m, d)
        At the end.
    ends : ndarray, shape (m,)
        Time of the end in s.
    reasons : ndarray of int, shape (m,)
        Numbers of names, or `RUNNING`.
    steps : ndarray of int, shape (m,)
        Or evaluations of the right-hand side, by solvers that count these.
    pulling : ndarray of object, shape (m,)
        Times in s between which the contact has pulled, or None.
    """

    times: Array
    names: Sequence[str]
    states: Array
    last: Array
    ends: Array
    reasons: Rows
    steps: Rows
    pulling: AnyArray

    @classmethod
    def empty(cls, members: int, times: Array, size: int, names: Sequence[str]) -> "Runs":
        """Room for the runs of so many members, of a state of this size."""
        return cls(
            times,
            names,
            np.empty((members, times.size, size)),
            np.empty((members, size)),
            np.full(members, times[-1]),
            np.full(members, RUNNING),
            np.zeros(members, dtype=int),
            np.full(members, None),
        )

    @property
    def counts(self) -> Rows:
        """Number of samples up to each end, shape (m,)."""
        return np.searchsorted(self.times, self.ends, side="right")

    def ended(self, name: str) -> AnyArray:
        """Whether each run ended for this reason, shape (m,)."""
        found: AnyArray = self.reasons == (self.names.index(name) if name in self.names else -2)
        return found

    def part(self, rows: AnyArray) -> "Runs":
        """Those of some members."""
        return Runs(self.times, self.names, *(each[rows] for each in self.arrays))

    def put(self, rows: AnyArray, other: "Runs") -> None:
        """Put in those of some members."""
        for each, new in zip(self.arrays, other.arrays, strict=True):
            each[rows] = new

    @property
    def arrays(self) -> tuple[AnyArray, ...]:
        """All of it, one row for each member."""
        return self.states, self.last, self.ends, self.reasons, self.steps, self.pulling

    def cut_to_samples(self, rows: AnyArray) -> None:
        """Let these runs, shape (m,), end at the last of the times asked for that they reached."""
        for row in np.flatnonzero(rows).tolist():
            last = self.counts[row] - 1
            self.ends[row], self.last[row] = self.times[last], self.states[row, last]

    def put_run(self, row: int, run: Run) -> None:
        """Put in the run of one member."""
        count = int(np.searchsorted(self.times, run.times[-1], side="right"))
        self.states[row, :count] = run.states[:count]
        self.states[row, count:] = self.last[row] = run.states[-1]
        self.ends[row], self.steps[row] = run.times[-1], run.evaluations
        self.reasons[row] = RUNNING if run.ended is None else self.names.index(run.ended)
        self.pulling[row] = run.pulling

    def run(self, row: int) -> Run:
        """Run of one member."""
        count = int(self.counts[row])
        times, states = self.times[:count], self.states[row, :count]
        if self.ends[row] > times[-1]:
            times = np.append(times, self.ends[row])
            states = np.vstack((states, self.last[row]))
        ended = None if self.reasons[row] == RUNNING else self.names[self.reasons[row]]
        return Run(times, states, int(self.steps[row]), ended, self.pulling[row] or ())
