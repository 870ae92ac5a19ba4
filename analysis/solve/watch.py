"""What ends a run: limits of time and steps, and conditions wherever within a step."""

import time
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from functools import cached_property, partial
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import minimize_scalar, toms748

from analysis.motion.endings import CONTACT_WOULD_PULL, Condition
from analysis.problem.checks import Array, ToleranceError, function, optional, positive
from analysis.problem.limits import MOST_STEPS
from analysis.problem.start import State

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
        self._progress = optional(function, "progress", progress)
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

    def part(self, most: int) -> "Watch":
        """A watch over what may take so many steps of its own within the same time limit."""
        found = copy(self)
        vars(found).update(steps=0, _most=most, _progress=None)
        return found

    def is_over(self, reached: float, end: float) -> bool:
        """Tell how far a run is; returns whether it has to stop."""
        if self._progress is not None:
            self._progress(reached, end)
        return self.is_out_of_time

    @property
    def is_out_of_time(self) -> bool:
        """Whether the call has met its time limit."""
        return self._limit < inf and self.seconds > self._limit


StateFunction = Callable[[Array], float]
"""From a state to a number; the motion ends where that turns negative."""


PaperState = tuple[Sequence[float], Sequence[float]] | None
"""The paper's coordinates and their rates, 6 floats each; None on a flat disk."""


def of_states(
    conditions: Mapping[str, Condition], to_paper: Callable[[Array], PaperState]
) -> dict[str, StateFunction]:
    """Conditions as functions of what is integrated.

    Parameters
    ----------
    conditions : mapping
        From reasons to functions of a `State`.
    to_paper : callable
        From what is integrated; on a flat disk, no condition is negative.
    """

    def said(condition: Condition, state: Array) -> float:
        found = to_paper(state)
        if found is None:
            return 1.0
        coordinates, rates = map(tuple, found)
        return condition(State(coordinates=coordinates, rates=rates))

    return {reason: partial(said, condition) for reason, condition in conditions.items()}


PARTS = 8
"""Parts of a step in which a condition is looked at closely, each between two of its extremes."""

NEAR = 0.1
"""How near to zero the extreme of a parabola through three values must come to be looked for,
over their spread."""


class Step:
    """The last step of a solver of SciPy, and the motion within it.

    Parameters
    ----------
    solver : OdeSolver
        After a step that has succeeded.

    Attributes
    ----------
    begin, end : float
        Times in s.
    last : ndarray, shape (m,)
        State at the end.
    """

    def __init__(self, solver: Any) -> None:
        self._solver = solver
        self.begin, self.end = float(solver.t_old), float(solver.t)
        self.last: Array = solver.y

    @cached_property
    def path(self) -> Callable[[Any], Array]:
        """From a time to the state, or from n times to states of shape (m, n)."""
        return self._solver.dense_output()

    def cut(self, end: float) -> None:
        """Leave out what comes after a time."""
        self.end, self.last = end, self.path(end)

    def states(self, times: Array) -> list[Array]:
        """States at some times within the step, the last of which may be its end."""
        inside = times[times < self.end]
        found = list(self.path(inside).T) if inside.size else []
        return found + [self.last] * (times.size - inside.size)

    @property
    def middle(self) -> Array:
        """State halfway, nearly."""
        solver = self._solver
        if "path" in self.__dict__ or not isinstance(solver, DOP853):
            return self.path(0.5 * (self.begin + self.end))
        # The path takes three more evaluations; a cubic through both ends takes none.
        bend = (0.125 * (self.end - self.begin)) * (solver.K[0] - solver.f)
        return 0.5 * (solver.y_old + self.last) + bend


class Lookout:
    """Looks out for the first of some conditions to turn negative, wherever within a step.

    Samples count for nothing: where a motion ends does not depend on the times asked for.

    Parameters
    ----------
    conditions : mapping
        Functions of a state by the reason that they give.
    start : ndarray, shape (n,)
        At time 0.
    allow_pulling : bool
        Whether a contact that pulls ends nothing; when it does is then noted.
    """

    def __init__(
        self, conditions: Mapping[str, StateFunction], start: Array, allow_pulling: bool
    ) -> None:
        self._conditions, self._allow = conditions, allow_pulling
        self._values = {reason: condition(start) for reason, condition in conditions.items()}
        pulls = allow_pulling and self._values.get(CONTACT_WOULD_PULL, 0.0) < 0.0
        self._edges = [0.0] if pulls else []

    def ending(self, step: Step) -> str | None:
        """Why the motion ends within a step, if it does; the step then goes up to there."""
        if not self._conditions:
            return None
        ended, middle = None, step.middle
        for reason, condition in self._conditions.items():
            first, last = self._values[reason], condition(step.last)
            passed = int(first < 0.0)
            self._values[reason] = last
            if _keeps_sign(first, condition(middle), last):
                continue
            changes = _sign_changes(condition, step, first, last)
            if self._allow and reason == CONTACT_WOULD_PULL:
                self._edges += changes
            # Where it is negative from the start on, it waits until it has not been.
            elif len(changes) > passed:
                step.cut(changes[passed])
                ended = reason
            # What comes later counts for nothing, and there may be no motion after some endings.
            middle = step.middle
        return ended

    def pulling(self, last: float) -> tuple[tuple[float, float], ...]:
        """Times between which the contact has pulled, up to `last`."""
        return intervals([edge for edge in self._edges if edge < last], last)


def intervals(edges: list[float], last: float) -> tuple[tuple[float, float], ...]:
    """Intervals between edges in turns, the last one open up to `last`."""
    closed = [*edges, last] if len(edges) % 2 else edges
    return tuple(zip(closed[::2], closed[1::2], strict=True))


def _keeps_sign(*values: float) -> bool:
    """Whether a function can have no zero between values in a row: none is as near as they spread.

    A sine that is seen three times in less than two thirds of a turn goes beyond the values by
    a third of their spread at most.
    """
    low, high = min(values), max(values)
    return low >= high - low or -high > high - low


def _sign_changes(condition: StateFunction, step: Step, first: float, last: float) -> list[float]:
    """Times within a step at which a condition becomes negative or ceases to be, in order."""
    times = np.linspace(step.begin, step.end, PARTS + 1).tolist()
    inside = [condition(state) for state in step.path(np.array(times[1:-1])).T]
    seen = dict(zip(times, (first, *inside, last), strict=True))

    def at(time: float) -> float:
        return seen[time] if time in seen else condition(step.path(time))

    for left in range(PARTS - 1):
        extreme = _beyond_zero(at, times[left : left + 3])
        if extreme is not None:
            seen[extreme] = at(extreme)
    points = sorted(seen)
    # Friction by a power of the load flattens a contact force on one side of its zero, where other
    # ways than this one may take the square of bisection's steps.
    return [
        float(toms748(at, before, after, xtol=1e-14, rtol=1e-14))
        for before, after in pairwise(points)
        if (seen[before] < 0.0) != (seen[after] < 0.0)
    ]


def _beyond_zero(at: Callable[[float], float], times: list[float]) -> float | None:
    """A time between three at which a function of one sign there has the other one, if any."""
    values = [at(time) for time in times]
    negative = values[0] < 0.0
    if any((value < 0.0) != negative for value in values):
        return None
    sign = -1.0 if negative else 1.0
    before, here, after = (sign * value for value in values)
    slope, bend = 0.5 * (after - before), before - 2.0 * here + after
    if bend <= 0.0 or abs(slope) > 1.25 * bend:
        return None
    spread = max(before, here, after) - min(before, here, after)
    if here - 0.5 * slope * slope / bend >= NEAR * spread:
        return None
    least = minimize_scalar(
        lambda time: sign * at(time),
        bounds=(times[0], times[2]),
        method="bounded",
        options={"xatol": 1e-5 * (times[2] - times[0])},
    )
    found = float(least.x)
    return found if (at(found) < 0.0) != negative else None
