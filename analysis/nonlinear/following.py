"""Periodic motions followed from one value to the next, and what happens on the way.

Where amplitude or tilt has a fold, a family is followed by pseudo-arclength: in the place along
the direction from the motion before the last to the last one.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from operator import attrgetter, methodcaller

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq

from analysis.nonlinear.collocation import VALUE, NoCycleError, solve
from analysis.nonlinear.motions import Event, PeriodicMotion
from analysis.problem.checks import Array, instance
from analysis.solve.watch import Progress

Measure = Callable[[PeriodicMotion], float]

_HALVINGS = 5
"""How often a step that fails is halved before a family ends there."""

_LONGEST, _SHORTEST = 0.05, 5e-6
"""Step of pseudo-arclength at most and at least, in parts of value, spin and duration."""

_BEND = 2.0
"""Steps by which a motion may lie beside where it was looked for: the family may turn sharply."""

_STRAY = 5e-3
"""Part of its spin by which a motion may lie beside where the two before it point: beyond a fold,
there may be another part of the family."""

_MOST = 100
"""Motions of a family that are followed through folds, at most."""

_ARRIVED = 1e-7
"""Part of value and spin by which neighbours differ at a connection, where the period alone grows;
a family may wind into it, with folds without end."""

_SLOW = 1e-2
"""Part of the largest speed below which all is equally slow."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Family:
    """Periodic motions of one kind, each reached from its neighbour.

    Parameters
    ----------
    motions : tuple of PeriodicMotion
        All of them converged, in their order along the family; or one for each of a sequence of
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

        Of two ways, the first goes backwards. After each motion `progress` is called with how many
        there are and how many are wanted.
        """
        found: list[PeriodicMotion] = []
        reason = None
        for way in ways:
            found.reverse()
            try:
                for each in way:
                    found.append(each)
                    if progress is not None:
                        progress(float(len(found)), float(max(wanted, len(found))))
            except NoCycleError as error:
                reason = str(error)
        if not found:
            raise NoCycleError(reason)
        return cls(motions=tuple(found), begins=begins, reason=reason)


def continue_to(
    start: PeriodicMotion,
    place: Array,
    held: Array = VALUE,
    *,
    gained: float = 0.0,
    stray: float = np.inf,
    halvings: int = _HALVINGS,
) -> PeriodicMotion:
    """Motion at a place, on the way over others if it is too far from `start`.

    What is held there is said in `solve`; `gained` is by how much longer the motion is expected to
    take, in s, and `stray` the part by which its spin may be another one than that of the place.

    Raises
    ------
    NoCycleError
        That of the first motion for which halving does not help.
    """
    try:
        found = solve(_lingering(start, gained), place, held)
    except NoCycleError:
        if not halvings:
            raise
    else:
        # A family may bend much, but not turn round.
        beside = abs(found.spin - place[1])
        if beside <= max(stray * place[1], abs(found.spin - start.spin) / 2.0):
            return found
        if not halvings:
            raise NoCycleError(
                f"beyond {start.value:.9g} rad and {start.spin:.9g} rad/s the family turns: the "
                f"next motion found, of {found.value:.9g} rad and {found.spin:.9g} rad/s, is none "
                "of its neighbours"
            )
    middle, onto = (start.place + place) / 2.0, partial(continue_to, held=held, stray=stray)
    between = onto(start, middle, gained=gained / 2.0, halvings=halvings - 1)
    gained = float(between.times[-1] - start.times[-1])
    if stray < np.inf:
        place = np.array((place[0], 2.0 * between.spin - start.spin, place[2]))
    return onto(between, place, gained=gained, halvings=halvings - 1)


def onward(
    start: PeriodicMotion, values: Iterable[float], *, through_folds: bool = False
) -> Iterator[PeriodicMotion]:
    """Motions of values, each continued from the one before, the first one from `start`.

    With `through_folds` those further along the family follow where that ends early.

    Raises
    ------
    NoCycleError
        Where nothing further is found, or the period alone grows.
    """
    before = last = start
    try:
        for value in values:
            gained = float(last.times[-1] - before.times[-1])
            # Where it stands, nobody knows which way it goes on.
            way = last.value - before.value
            way, stray = (way, _STRAY) if way else (1.0, np.inf)
            spin = last.spin + (last.spin - before.spin) / way * (value - last.value)
            place = last.place_with(value=value, spin=spin)
            before, last = last, continue_to(last, place, gained=gained, stray=stray)
            yield last
    except NoCycleError:
        if before is last or not through_folds:
            raise
    else:
        return
    for _ in range(_MOST):
        before, last = last, _ahead(before, last)
        yield last
        if np.max(np.abs(last.place / before.place - 1.0)[:2]) < _ARRIVED:
            state = last.states[np.argmin(_speeds(last))]
            saddle = "inverted" if np.sin(state[1]) > 0.0 else "noninverted"
            why = f"its period alone grows, towards a connection of {saddle} spinning with itself"
            break
    else:
        why = f"it goes on, {_MOST} motions further"
    raise NoCycleError(f"at {last.value:.9g} rad and {last.spin:.9g} rad/s {why}")


def _ahead(before: PeriodicMotion, last: PeriodicMotion) -> PeriodicMotion:
    """The next motion in the direction from one to another, as far as it does not bend away."""
    chord = last.place / before.place - 1.0
    length = float(np.linalg.norm(chord))
    step = min(1.5 * length, _LONGEST)
    why = f"the family bends away at {last.value:.9g} rad and {last.spin:.9g} rad/s"
    while step > _SHORTEST:
        place = last.place * (1.0 + step / length * chord)
        try:
            found = solve(_lingering(last, place[2] - last.times[-1]), place, chord / length)
            beside = np.abs(found.place / place - 1.0)
            if np.linalg.norm(beside) < _BEND * step and beside[1] <= _STRAY:
                return found
        except NoCycleError as error:
            why = str(error)
        step /= 4.0
    raise NoCycleError(why)


def _lingering(motion: PeriodicMotion, gained: float) -> PeriodicMotion:
    """A motion to begin with that takes so much longer in s, if at all, where it is slowest.

    Towards a connection each step adds as much time, all of it beside the saddle. If the whole
    motion took longer by it, the iteration would often diverge.
    """
    slow = 1.0 / (_speeds(motion) + _SLOW) ** 2
    spent = cumulative_trapezoid(slow, motion.times, initial=0.0)
    return replace(motion, times=motion.times + max(0.0, gained) * spent / spent[-1])


def _speeds(motion: PeriodicMotion) -> Array:
    """Speed in each state, shape (n,), of numbers over the largest speed of each."""
    rates = np.gradient(motion.states, motion.times, axis=0)
    return np.linalg.norm(rates / np.max(np.abs(rates), axis=0), axis=1)


def events(family: Family) -> tuple[Event, ...]:
    """Where a family is born and its stability changes, between neighbours.

    Symmetric cycles fold, or lose their symmetry ("symmetry-breaking"), which is where those
    without symmetry are born; the others fold, their period doubles ("period-doubling"), or a
    complex pair of multipliers passes the unit circle ("torus").

    Raises
    ------
    NoCycleError
        If an iteration between two neighbours fails.
    """
    changes = instance("family", family, Family).motions[0].ends.changes
    measures = {name: methodcaller("characteristic", at) for name, at in changes.items()}
    found = [
        Event(name, motion, number + part)
        for number, (first, last) in enumerate(pairwise(family.motions))
        for name, measure in (measures | {"torus": attrgetter("log_product")}).items()
        for part, motion in having(measure, first, last)
        # Two real ones of product 1 lie on either side of the circle.
        if name != "torus" or motion.imaginary
    ]
    found.sort(key=attrgetter("place"))
    return (*found,) if family.born is None else (family.born, *found)


def having(
    measure: Measure, first: PeriodicMotion, last: PeriodicMotion
) -> Iterator[tuple[float, PeriodicMotion]]:
    """Where a measure changes its sign between neighbours, if it does; see `between`."""
    if measure(first) * measure(last) < 0.0:
        yield between(first, last, measure)


def between(
    first: PeriodicMotion, last: PeriodicMotion, measure: Measure
) -> tuple[float, PeriodicMotion]:
    """Where on the way between neighbours a measure vanishes, and the motion there.

    Raises
    ------
    NoCycleError
        If an iteration fails.
    """
    known, chord = {0.0: first, 1.0: last}, last.place - first.place

    def at(part: float) -> PeriodicMotion:
        """Where the family meets the plane across the chord, this part of it from the first."""
        if part not in known:
            place = first.place + part * chord
            nearest = known[min(known, key=lambda each: abs(each - part))]
            held = chord / place
            known[part] = continue_to(nearest, place, held / np.linalg.norm(held))
        return known[part]

    part = brentq(lambda part: measure(at(part)), 0.0, 1.0, xtol=1e-9)
    return part, at(part)
