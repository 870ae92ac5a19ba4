"""Where a motion ends, found apart from the solvers' own search for endings.

A run that knows of no ending is sampled so finely that none lies unseen between two samples. Where
one may lie, the run is made again from the sample before, with finer and finer samples.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from analysis import Scenario, Trajectory
from analysis.motion.endings import (
    CONTACT_WOULD_PULL,
    Condition,
    Ending,
    StopWhen,
    named_conditions,
)
from analysis.problem.checks import Array

PARTS = 16
"""Parts of an interval that is looked at again."""

FINEST = 1e-12
"""Time in s to which an ending is located."""

Plain = Callable[[Scenario, Array], Trajectory]
"""Runs a scenario over some times, whatever pulls or is met on the way."""

Met = tuple[Ending, dict[str, Array]]
"""An ending, and what is sampled of a run there."""

_SAMPLED = ("times", "coordinates", "rates", "multipliers")


def up_to_ending(
    plain: Plain, scenario: Scenario, times: Array, stop_when: StopWhen, spacing: float
) -> Trajectory:
    """Motion up to where it ends first, or through all times.

    Parameters
    ----------
    plain : callable
        See `Plain`.
    scenario : Scenario
        With an ideal contact.
    times : ndarray, shape (n,)
        Strictly increasing, in s.
    stop_when : str, callable or iterable of them
        What ends the motion besides a contact that would have to pull.
    spacing : float
        Largest time between two samples in s among which an ending is looked for.
    """
    parts = int(np.ceil(np.max(np.diff(times)) / spacing))
    inner = times[:-1, None] + np.diff(times)[:, None] * np.arange(parts) / parts
    run = plain(scenario, np.append(inner.ravel(), times[-1]))
    # Where the disk lies flat, the run has its last sample there.
    kept = np.isin(run.times, (*times, run.times[-1]))
    ending, last = _first_ending(plain, run, named_conditions(stop_when)) or (run.ending, {})
    if last:
        kept &= run.times < last["times"]
    rows = {name: getattr(run, name)[kept] for name in _SAMPLED}
    rows |= {name: np.append(rows[name], [value], axis=0) for name, value in last.items()}
    return replace(run, **rows, pulling=(), ending=ending)


def _first_ending(
    plain: Plain, run: Trajectory, conditions: Mapping[str, Condition]
) -> Met | None:
    """The first ending of a run; None if it has none."""
    values = _values(run, conditions)
    places = {place for found in values.values() for place in _suspects(found)}
    for begin, end in sorted(places):
        met = None
        if run.times[end] - run.times[begin] > FINEST:
            again = replace(run.scenario, start=run.state(begin))
            times = np.linspace(run.times[begin], run.times[end], PARTS + 1)
            met = _first_ending(plain, plain(again, times), conditions)
        negative = [name for name, found in values.items() if found[end] < 0.0]
        if met is None and negative:
            row = {name: getattr(run, name)[end] for name in _SAMPLED}
            met = Ending(reason=negative[0], time=float(row["times"]), value=0.0), row
        if met is not None:
            return met
    return None


def _values(run: Trajectory, conditions: Mapping[str, Condition]) -> dict[str, Array]:
    """What turns negative at an ending, by the reason it gives, each shape (n,)."""
    states = [run.state(row) for row in range(run.times.size)]
    values = {
        name: np.array([condition(each) for each in states])
        for name, condition in conditions.items()
    }
    return {CONTACT_WOULD_PULL: run.normal_force, **values}


def _suspects(values: Array) -> Iterator[tuple[int, int]]:
    """First and last row of where values turn negative, or may do so about a minimum."""
    for row in np.flatnonzero((values[:-1] >= 0.0) & (values[1:] < 0.0)).tolist():
        yield row, row + 1
    before, middle, after = values[:-2], values[1:-1], values[2:]
    lowest = (middle >= 0.0) & (before >= middle) & (after >= middle)
    near = middle < (before - middle) + (after - middle)
    for row in np.flatnonzero(lowest & near).tolist():
        yield row, row + 2
