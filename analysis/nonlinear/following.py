"""Periodic motions followed from one value to the next, and what happens on the way."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq

from analysis.nonlinear.collocation import NoCycleError, solve
from analysis.nonlinear.motions import Event, PeriodicMotion
from analysis.problem.checks import instance
from analysis.solve.watch import Progress

_HALVINGS = 5
"""How often a step that fails is halved before a family ends there."""

_SLOW = 1e-2
"""Part of the largest speed below which all is equally slow."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Family:
    """Periodic motions of one kind, each reached from its neighbour.

    Parameters
    ----------
    motions : tuple of PeriodicMotion
        All of them converged: by rising amplitude or tilt, or one for each of a sequence of
        scenarios.
    begins : float
        Spin in rad/s where it begins: of the Hopf point, the heteroclinic connection, or the
        symmetric cycle at which cycles without symmetry branch off.
    reason : str or None
        Why it ends early, if it does; it names the last good one.
    born : Event or None
        That symmetric cycle.
    """

    motions: tuple[PeriodicMotion, ...]
    begins: float
    reason: str | None = None
    born: Event | None = None

    @classmethod
    def of(
        cls,
        begins: float,
        *ways: Iterable[PeriodicMotion],
        progress: Progress | None = None,
        wanted: int = 0,
    ) -> "Family":
        """All motions of each way up to the first not found; `NoCycleError` if there is none.

        After each `progress` is called with how many there are and how many are wanted.
        """
        found: list[PeriodicMotion] = []
        reason = None
        for way in ways:
            try:
                for each in way:
                    found.append(each)
                    if progress is not None:
                        progress(float(len(found)), float(wanted))
            except NoCycleError as error:
                reason = str(error)
        if not found:
            raise NoCycleError(reason)
        return cls(motions=tuple(found), begins=begins, reason=reason)


def continue_to(
    start: PeriodicMotion, value: float, gained: float = 0.0, halvings: int = _HALVINGS
) -> PeriodicMotion:
    """Motion of a value, on the way over others if it is too far from `start`.

    `gained` is by how much longer it is expected to take, in s.

    Raises
    ------
    NoCycleError
        That of the first motion for which halving does not help.
    """
    try:
        return solve(start.scenario, value, _lingering(start, gained))
    except NoCycleError:
        if not halvings:
            raise
    between = continue_to(start, (start.value + value) / 2.0, gained / 2.0, halvings - 1)
    return continue_to(between, value, _gain(start, between), halvings - 1)


def onward(start: PeriodicMotion, values: Iterable[float]) -> Iterator[PeriodicMotion]:
    """Motions of values, each continued from the one before, the first one from `start`."""
    before = last = start
    for value in values:
        before, last = last, continue_to(last, value, _gain(before, last))
        yield last


def _gain(first: PeriodicMotion, last: PeriodicMotion) -> float:
    return max(0.0, float(last.times[-1] - first.times[-1]))


def _lingering(motion: PeriodicMotion, gained: float) -> PeriodicMotion:
    """A motion to begin with that takes so much longer in s where it is slowest.

    Towards a connection each step adds as much time, all of it beside the saddle. If the whole
    motion took longer by it, the iteration would often diverge.
    """
    rates = np.gradient(motion.states, motion.times, axis=0)
    speeds = np.linalg.norm(rates / np.max(np.abs(rates), axis=0), axis=1)
    slow = 1.0 / (speeds + _SLOW) ** 2
    spent = cumulative_trapezoid(slow, motion.times, initial=0.0)
    return replace(motion, times=motion.times + gained * spent / spent[-1])


def events(family: Family) -> tuple[Event, ...]:
    """Where a family is born and its stability changes, between neighbours.

    Symmetric cycles fold, or lose their symmetry ("symmetry-breaking"), which is where those
    without symmetry are born; the others fold, or their period doubles ("period-doubling").

    Raises
    ------
    NoCycleError
        If an iteration between two neighbours fails.
    """
    changes = instance("family", family, Family).motions[0].ends.changes.items()
    found = (
        Event(name, _between(first, last, multiplier))
        for first, last in pairwise(family.motions)
        for name, multiplier in changes
        if first.characteristic(multiplier) * last.characteristic(multiplier) < 0.0
    )
    return (*found,) if family.born is None else (family.born, *found)


def _between(first: PeriodicMotion, last: PeriodicMotion, multiplier: float) -> PeriodicMotion:
    """Motion between two neighbours that has a multiplier."""
    known = {each.value: each for each in (first, last)}
    at = cache(lambda value: known.get(value) or continue_to(first, value))
    return at(brentq(lambda value: at(value).characteristic(multiplier), *known, xtol=1e-9))
