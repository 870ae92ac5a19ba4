"""What ends a run of the engine: looked for after its steps, and found among its samples."""

from collections.abc import Callable, Iterator, Mapping
from math import ceil, sin
from typing import NamedTuple

import numpy as np

from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.data.limits import LEAST_TILT
from analysis.data.state import State
from analysis.data.watch import Watch
from mbs_models.model import Model
from mbs_models.pulling import Dip, dips, zero
from mbs_models.runs import EngineError

_HALVINGS = 40
_FLAT_ENOUGH = 1e-4
"""Sine of the inclination up to which runs that fail beyond it are said to fail for it."""

Says = Callable[[Array], float]
"""From coordinates, rates and constraint forces in one row to a number; negative ends the run."""


def state_of(row: Array) -> State:
    """State of a row of coordinates, rates and whatever follows."""
    values = row.tolist()
    return State(coordinates=tuple(values[:6]), rates=tuple(values[6:12]))


def conditions_of(
    model: Model, named: Mapping[str, Condition], *, allow_pulling: bool
) -> dict[str, Says]:
    """All that ends a run, by its reason.

    Parameters
    ----------
    model : Model
    named : mapping
        Conditions of the user's.
    allow_pulling : bool
    """
    found: dict[str, Says] = {}
    if model.may_pull and not allow_pulling:
        found[CONTACT_WOULD_PULL] = lambda row: float(row[12])
    if model.has_euler_angles or model.scenario.contact is None:
        found[FLAT] = lambda row: sin(row[4]) - LEAST_TILT

    def in_rows(condition: Condition) -> Says:
        return lambda row: condition(state_of(row))

    return found | {reason: in_rows(condition) for reason, condition in named.items()}


class Stop:
    """Ends a run early where a condition turns negative, or when the watch calls time.

    Parameters
    ----------
    model : Model
    conditions : mapping
        As `conditions_of` makes them.
    watch : Watch
    begin, end : float
        Time at which the run starts, and at which the last one is to end, in s.

    Attributes
    ----------
    reason : str
        The condition that has ended it; empty if none has.
    """

    def __init__(
        self, model: Model, conditions: Mapping[str, Says], watch: Watch, begin: float, end: float
    ) -> None:
        self._model, self._watch = model, watch
        self._begin, self._end = begin, end
        self._pulls = CONTACT_WOULD_PULL in conditions and model.contact_equation is not None
        # Angles that are known up to whole turns would mislead conditions between samples, and
        # without any of the user's nobody pays for decoding each step.
        named = {
            reason: says for reason, says in conditions.items() if reason != CONTACT_WOULD_PULL
        }
        self._says = named if model.has_euler_angles and set(named) != {FLAT} else {}
        self._before = dict.fromkeys(self._says, -1.0)
        self.reason = ""
        if self._says:
            self._look()

    @property
    def is_idle(self) -> bool:
        """Whether it never ends a run."""
        return not self._pulls and not self._says and self._watch.is_idle

    def __call__(self, moment: float) -> bool:
        """Look after a step, at the time in the run in s; returns whether the run ends there."""
        if self._pulls and self._model.pulls():
            self.reason = CONTACT_WOULD_PULL
        elif self._says:
            self._look()
        return bool(self.reason) or self._watch.is_over(self._begin + moment, self._end)

    def _look(self) -> None:
        row = np.hstack(self._model.decode(self._model.record()[None]))[0]
        for reason, says in self._says.items():
            if reason != FLAT and sin(row[4]) < LEAST_TILT:
                continue
            here = says(row)
            if here < 0.0 <= self._before[reason]:
                self.reason = reason
            self._before[reason] = here


class Records(NamedTuple):
    """Rows of coordinates, rates and constraint forces, shape (n, k), at even spacing in s."""

    values: Array
    moments: Array
    period: float


class Found(NamedTuple):
    """Why a motion ends, its records up to there, and what the condition says there."""

    reason: str
    moments: Array
    values: Array
    value: float


After = Callable[[State, float, int], Array]
"""Row that a short run ends with: from a state, over a time in s, in steps of so many records."""


def first_ending(
    conditions: Mapping[str, Says], records: Records, stopped: tuple[str, float], after: After
) -> Found | None:
    """Where the first of the conditions ends a motion, if one does.

    Parameters
    ----------
    conditions : mapping
    records : Records
    stopped : tuple of str and float
        Condition that has stopped the run, and the time in s after the last record at which it
        has; "" and 0 if none has.
    after : callable
    """
    values, moments = records.values, records.moments
    upright = len(values)
    if FLAT in conditions:
        flat = np.sin(values[:, 4]) < LEAST_TILT
        upright = int(np.argmax(flat)) if np.any(flat) else upright
    endings: list[tuple[float, int, str, Array]] = []
    for reason, says in conditions.items():
        # The other conditions have no meaning beyond where the disk lies flat.
        seen = records._replace(values=values[: upright + (reason == FLAT)])
        beyond = stopped[1] if reason == stopped[0] else 0.0
        for spot in _spots(reason, says, seen, beyond):
            locate = _flat_place if reason == FLAT else _located
            located = locate(says, seen, spot, after)
            if located is not None:
                endings.append(
                    (float(moments[spot.row]) + located[0], spot.row, reason, located[1])
                )
                break
    if not endings:
        return None
    moment, row, reason, last = min(endings, key=lambda ending: ending[0])
    return Found(
        reason,
        np.append(moments[: row + 1], moment),
        np.vstack((values[: row + 1], last)),
        conditions[reason](last),
    )


def _spots(reason: str, says: Says, records: Records, beyond: float) -> Iterator[Dip]:
    """Where a condition turns negative among records, or may between two of them."""
    values = records.values
    if reason == CONTACT_WOULD_PULL:
        yield from dips(values[:, 12])
    else:
        before = -1.0
        for number, row in enumerate(values):
            here = says(row)
            if here < 0.0 <= before:
                yield Dip(number - 1, 1.0, sure=True)
                return
            before = here
    if beyond > 1e-9 * records.period:
        yield Dip(len(values) - 1, beyond / records.period, sure=True)


def _located(says: Says, records: Records, spot: Dip, after: After) -> tuple[float, Array] | None:
    """Time after a record at which a condition turns negative, and the row there."""
    reached = _short_runs(records, spot, after)
    begin, width = says(records.values[spot.row]), spot.width * records.period
    moment = zero(lambda time: says(reached(time)), begin, width, sure=spot.sure)
    return None if moment is None else (moment, reached(moment))


def _flat_place(
    says: Says, records: Records, spot: Dip, after: After
) -> tuple[float, Array] | None:
    """The same for a disk that comes to lie flat, where runs may fail: a failed one is beyond."""
    reached = _short_runs(records, spot, after)
    upright, beyond = 0.0, spot.width * records.period
    row = records.values[spot.row]
    for halving in range(_HALVINGS):
        middle = beyond if halving == 0 else 0.5 * (upright + beyond)
        try:
            found = reached(middle)
        except EngineError:
            found = None
        if found is not None and says(found) >= 0.0:
            if halving == 0:
                return None
            upright, row = middle, found
        else:
            beyond = middle
    return (upright, row) if says(row) < _FLAT_ENOUGH and upright > 0.0 else None


def _short_runs(records: Records, spot: Dip, after: After) -> Callable[[float], Array]:
    """From a time after a record to the row there, by a run of its own."""
    # From one record earlier: very short steps would make the forces noisy.
    first = max(0, spot.row - 1)
    start, lead = state_of(records.values[first]), records.period * (spot.row - first)
    count = ceil(spot.width) + spot.row - first
    return lambda moment: after(start, lead + moment, count)
