"""What a run is compared with: two runs by other methods, and how far they are apart.

Where they end is found apart from the solvers' own search for endings. A run that knows of no
ending is sampled so finely that none lies unseen between two samples. Where one may lie, the run
is made again from the sample before, with finer and finer samples.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from analysis import Method, Scenario, Trajectory, formulations
from analysis.motion.endings import (
    CONTACT_WOULD_PULL,
    Condition,
    Ending,
    StopWhen,
    named_conditions,
)
from analysis.problem.checks import Array
from analysis.simulation.request import TIGHTEST_LOCAL_TOLERANCE
from validation.comparison.differences import deviation, ending_error
from validation.comparison.ways import StepLimit, Way

STIFF = 1e-3
"""Finest speed of friction in m/s below which explicit in-house methods are not tried."""

LONG = 5.0
"""Time in s beyond which small errors grow by some thousands."""

SPACINGS = (2e-4, 1.37e-4)
"""Times in s between the samples of both runs, among which endings are located."""

STEPS = 200_000
"""Most steps of a reference per second; see `StepLimit`."""

PARTS = 16
"""Parts of an interval that is looked at again."""

FINEST = 1e-12
"""Time in s to which an ending is located."""

Plain = Callable[[Scenario, Array], Trajectory]
"""Runs a scenario over some times, whatever pulls or is met on the way."""


_SAMPLED = ("times", "coordinates", "rates", "multipliers")


class Reference(NamedTuple):
    """Two runs of a motion by two methods.

    Parameters
    ----------
    first, second : Trajectory
    """

    first: Trajectory
    second: Trajectory

    @property
    def doubt(self) -> float:
        """Their deviation in rad, or that of the times at which they end in s if it is larger."""
        return max(deviation(self.first, self.second), ending_error(self.first, self.second))

    def beside(self, run: Trajectory) -> Trajectory:
        """The first one, or the second for a run by the method of the first."""
        return self.second if _method(run) == _method(self.first) else self.first


def _method(run: Trajectory) -> tuple[object, ...]:
    """What runs by one method have in common."""
    names = ("formulation", "integrator") if run.source == "engine" else ("method",)
    return run.source, *(run.method[name] for name in names)


def reference(scenario: Scenario, times: Array, *, stop_when: StopWhen | None = None) -> Reference:
    """Two in-house runs of a motion.

    Parameters
    ----------
    scenario : Scenario
    times : ndarray, shape (n,)
        Strictly increasing, in s.
    stop_when : str, callable or iterable of them, optional
        What ends the motion besides a contact that would have to pull. If it is given, even an
        empty one, endings are located apart from the solvers' own search for them.

    Raises
    ------
    ArithmeticError
        If one of the two fails, or takes more than `STEPS`.
    ValueError
        If the motion cannot start.
    """

    def run(way: Way, spacing: float, **how: Any) -> Trajectory:
        with StepLimit(STEPS, times[-1]) as count:
            if stop_when is None:
                return way.run(scenario, times, progress=count, **how)

            def plain(scenario: Scenario, times: Array) -> Trajectory:
                return way.run(scenario, times, progress=count, allow_pulling=True, **how)

            return up_to_ending(plain, scenario, times, stop_when, spacing)

    tight = 1e-12 if times[-1] <= LONG else TIGHTEST_LOCAL_TOLERANCE
    stiff = scenario.friction.finest_speed < STIFF
    method: Method = "Radau" if stiff else "DOP853"
    tolerance = 1e-10 if stiff else tight
    formulation = formulations(scenario)[0]
    first = run(Way("in-house", formulation, method), SPACINGS[0], local_tolerance=tolerance)
    second = run(Way("in-house", formulation, "LSODA"), SPACINGS[1], local_tolerance=tight)
    return Reference(first=first, second=second)


# --- Where a motion ends -------------------------------------------------------------------------


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
) -> tuple[Ending, dict[str, Array]] | None:
    """The first ending of a run, and what is sampled there; None if it has none."""
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
