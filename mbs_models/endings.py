"""Where a run of the engine's own integrators ends: looked for among its records, then located.

It is located by stepping the scene's accelerations from the record before: these have a solution
between any two steps, in which one search finds whatever comes first.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import exudyn as exu
import numpy as np

from analysis.data.checks import Array, ToleranceError
from analysis.data.endings import CONTACT_WOULD_PULL, Condition
from analysis.data.limits import LEAST_TILT
from analysis.data.watch import Watch
from analysis.solve.stepping import SolverError, integrate
from mbs_models import sampled
from mbs_models.accelerations import AccelerationProblem
from mbs_models.effort import stepping_integrator
from mbs_models.probe import SingularError
from mbs_models.sampled import leaning, state_of
from mbs_models.scene import Scene
from mbs_models.solving import solving

LOCAL = 1e-11
"""Error in a step with which endings are located."""

MOST_STEPS_OF_A_SEARCH = 1000
"""Of the accelerations; between two records some ten are usual."""

Says = Callable[[Array], float]
"""From a record to a number; the run ends where that turns negative."""


def of_records(conditions: Mapping[str, Condition]) -> dict[str, Says]:
    """Conditions on a `State` as functions of a record."""

    def of_record(condition: Condition) -> Says:
        return lambda row: condition(state_of(row))

    return {reason: of_record(condition) for reason, condition in conditions.items()}


class Place(NamedTuple):
    """Where a condition is negative, or may be between two records.

    Parameters
    ----------
    row : int
        Record before it, where it is not negative.
    width : float
        Periods after it that hold the place.
    reason : str
        That of the condition if it is known to be negative at the end of them, else empty.
    """

    row: int
    width: float
    reason: str


class Found(NamedTuple):
    """Where a run ends: `moment` s after record `row`, with these `values`, for this reason."""

    reason: str
    row: int
    moment: float
    values: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Records:
    """What a run has recorded, and how it came to its end.

    Parameters
    ----------
    scene : Scene
    values : ndarray, shape (n, 12 + k)
        At even spacing.
    period : float
        Time between records in s.
    broke_off : bool
        Whether the run failed after the last of them.
    stopped_by : str or None
        The reason for which it was stopped after the last of them, if it was.
    beyond : float
        Time in s after the last of them at which it was.
    """

    scene: Scene
    values: Array
    period: float
    broke_off: bool
    stopped_by: str | None
    beyond: float

    def first_ending(
        self, conditions: Mapping[str, Condition], *, must_not_pull: bool, work: Counter[str]
    ) -> Found | None:
        """The first ending, if there is one.

        Parameters
        ----------
        conditions : mapping
            By the reason they give.
        must_not_pull : bool
            Whether a contact that pulls ends the run.
        work : Counter
            To which the steps of the search are added.
        """
        for place in sorted(self._places(conditions, must_not_pull)):
            found = self._located(place, conditions, must_not_pull, work)
            if found is not None:
                return found
        return None

    def _places(self, conditions: Mapping[str, Condition], must_not_pull: bool) -> Iterator[Place]:
        """Places to look at, in no order."""
        lying = np.flatnonzero(leaning(self.values) < LEAST_TILT)
        upright = self.values[: lying[0] if lying.size else len(self.values)]
        last = len(upright) - 1
        if last < 0:
            return
        if lying.size or self.broke_off:
            # It may lie flat.
            yield Place(last, 2.0, "")
        if must_not_pull:
            yield from dips(upright[:, sampled.NORMAL_FORCE], CONTACT_WOULD_PULL)
        for reason, says in of_records(conditions).items():
            yield from dips(np.array([says(row) for row in upright]), reason)
        if self.stopped_by is not None and self.beyond > 1e-9 * self.period:
            yield Place(last, self.beyond / self.period, self.stopped_by)

    def _located(
        self,
        place: Place,
        conditions: Mapping[str, Condition],
        must_not_pull: bool,
        work: Counter[str],
    ) -> Found | None:
        """The first ending behind a record, by the accelerations; None if they show none."""
        values = self.values[place.row]
        scene = self.scene.starting_at(state_of(values))
        motion = AccelerationProblem(scene, conditions)
        problem = motion.initial_value_problem
        # Runs differ by their errors: what one shows to be negative may be so later in another.
        end = self.period * (place.width + bool(place.reason))
        times = np.array([0.0, end])
        # On a stiff contact a search may be endless, and a run that broke off has then no ending.
        watch = Watch(most=MOST_STEPS_OF_A_SEARCH)
        try:
            with solving(motion.model.system):
                force = problem.normal_force
                if must_not_pull and force is not None and force(problem.start) < 0.0:
                    return Found(CONTACT_WOULD_PULL, place.row, 0.0, values)
                found = integrate(
                    problem,
                    times,
                    stepping_integrator(scene, times, LOCAL).method,
                    LOCAL,
                    allow_pulling=not must_not_pull,
                    watch=watch,
                )
                last = motion.samples(found.states[-1:])[0]
        except (SolverError, SingularError, exu.ExudynError):
            return None
        except ToleranceError:
            # Where a condition is known to be negative, an ending must not be passed over.
            if place.reason:
                raise
            return None
        work.update(steps=found.steps, right_hand_sides=found.evaluations)
        if found.ended is not None:
            return Found(found.ended, place.row, float(found.times[-1]), last)
        if place.reason:
            return Found(place.reason, place.row, end, last)
        return None


def dips(values: Array, reason: str) -> Iterator[Place]:
    """Places to look at, in order, up to the first record at which a condition turns negative.

    Parameters
    ----------
    values : ndarray, shape (n,)
        What the condition says at even spacing. Where it is negative from the start on, it waits
        until it has not been.
    reason : str
        The one that it gives.
    """
    armed = int(np.argmax(values >= 0.0)) if values.size else 0
    if not values.size or values[armed] < 0.0:
        return
    first = armed + 1
    negative = np.flatnonzero(values[first:] < 0.0)
    end = first + int(negative[0]) if negative.size else values.size - 1
    before, here, after = (
        values[first - 1 : end - 1],
        values[first:end],
        values[first + 1 : end + 1],
    )
    curvature = before - 2.0 * here + after
    lowest = (np.minimum(before, after) >= here) & (after >= 0.0) & (curvature > 0.0)
    bent = np.where(lowest, curvature, 1.0)
    vertex = here - (after - before) ** 2 / (8.0 * bent)
    near = vertex < 0.1 * (np.maximum(before, after) - here)
    for place in np.flatnonzero(lowest & near).tolist():
        yield Place(armed + place, 2.0, "")
    if negative.size:
        yield Place(end - 1, 1.0, reason)


def pulling_times(
    moments: Sequence[float], forces: Sequence[float]
) -> tuple[tuple[float, float], ...]:
    """Times in s between which a force is negative, by linear interpolation of samples.

    Parameters
    ----------
    moments : sequence of n floats
        Increasing times in s.
    forces : sequence of n floats
        In N.
    """
    times, values = np.asarray(moments), np.asarray(forces)
    negative = values < 0.0
    if not np.any(negative):
        return ()
    edges = np.flatnonzero(negative[1:] != negative[:-1])
    share = values[edges] / (values[edges] - values[edges + 1])
    crossings = (times[edges] + share * np.diff(times)[edges]).tolist()
    if negative[0]:
        crossings.insert(0, float(times[0]))
    if negative[-1]:
        crossings.append(float(times[-1]))
    return tuple(zip(crossings[::2], crossings[1::2], strict=True))
