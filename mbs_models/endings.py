"""Where a run of the engine's own integrators ends: looked for among its records, then located.

It is located by stepping the scene's accelerations from the record before: these have a solution
between any two steps, in which one search finds whatever comes first.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import exudyn as exu
import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, ToleranceError
from analysis.data.endings import CONTACT_WOULD_PULL
from analysis.data.watch import Watch
from analysis.solve.stepping import InitialValueProblem, Method, SolverError, integrate
from mbs_models.solving import SingularError, solving

LOCAL = 1e-11
"""Error in a step with which endings are located."""

MOST_STEPS_OF_A_SEARCH = 1000
"""Of the accelerations; between two records some ten are usual."""


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
    """Where a run ends: `moment` s after record `row`, with these values, for this reason."""

    reason: str
    row: int
    moment: float
    values: Array


class Motion(NamedTuple):
    """A motion from a record on.

    Parameters
    ----------
    system : exudyn.MainSystem
        Whose accelerations are stepped.
    problem : InitialValueProblem
    method : str
    values_of : callable
        From a state of the problem to the values of a record.
    """

    system: Any
    problem: InitialValueProblem
    method: Method
    values_of: Callable[[Array], Array]


def first_ending(
    places: Iterable[Place],
    period: float,
    motion_from: Callable[[int], Motion],
    *,
    allow_pulling: bool,
    work: Counter[str],
) -> Found | None:
    """The first ending of a run, if there is one.

    Parameters
    ----------
    places : iterable of Place
        In any order.
    period : float
        Time between records in s.
    motion_from : callable
        From the number of a record to the motion that begins there.
    allow_pulling : bool
        Whether a contact that pulls ends nothing.
    work : Counter
        To which the steps of the search are added.
    """
    for place in sorted(places):
        # Runs differ by their errors: what one shows to be negative may be so later in another.
        end = period * (place.width + bool(place.reason))
        found = _located(place, end, motion_from(place.row), allow_pulling, work)
        if found is not None:
            return found
    return None


def _located(
    place: Place, end: float, motion: Motion, allow_pulling: bool, work: Counter[str]
) -> Found | None:
    """The first ending within `end` s of a record; None if the accelerations show none."""
    problem = motion.problem
    # On a stiff contact a search may be endless, and a run that broke off has then no ending.
    watch, times = Watch(most=MOST_STEPS_OF_A_SEARCH), np.array([0.0, end])
    try:
        with solving(motion.system):
            force = problem.normal_force
            if not allow_pulling and force is not None and force(problem.start) < 0.0:
                first = motion.values_of(problem.start)
                return Found(CONTACT_WOULD_PULL, place.row, 0.0, first)
            found = integrate(
                problem, times, motion.method, LOCAL, allow_pulling=allow_pulling, watch=watch
            )
            last = motion.values_of(found.states[-1])
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
    return Found(place.reason, place.row, end, last) if place.reason else None


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
    moments: npt.ArrayLike, forces: npt.ArrayLike
) -> tuple[tuple[float, float], ...]:
    """Times in s between which a force is negative, by linear interpolation of samples.

    Parameters
    ----------
    moments : array_like, shape (n,)
        Increasing times in s.
    forces : array_like, shape (n,)
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
