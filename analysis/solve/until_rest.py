"""The way to rest on either side: what is asked of it, checked, and its stretches until rest."""

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from analysis.data.checks import Array, TimeLimitError, function, instance, positive
from analysis.data.dissipation import RestCriterion
from analysis.data.endings import AT_REST, TIME_LIMIT, Ending, StopWhen, named_conditions
from analysis.data.friction import check_slipping
from analysis.data.limits import check_storage
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import MOTION_COLUMNS
from analysis.data.watch import Progress, Watch
from analysis.solve.stepping import Run

Advance = Callable[[Array, Array], Run]
"""From times of a stretch in s and the state at the first of them to what a run has reached."""


class RestCall:
    """What is asked of a call of `simulate_to_rest`, of either side; its parameters are theirs.

    Attributes
    ----------
    scenario : Scenario
    times : ndarray, shape (n,)
        Of the samples, evenly spaced from 0, in s.
    criterion : RestCriterion
    conditions : dict
        From reasons to functions of a `State` that end the motion where they turn negative.
    watch : Watch

    Raises
    ------
    ValueError
        If one of them is out of range.
    """

    def __init__(
        self,
        scenario: Scenario,
        end: float,
        *,
        spacing: float,
        criterion: RestCriterion | None,
        stop_when: StopWhen,
        time_limit: float | None,
        progress: Progress | None,
    ) -> None:
        end, spacing = positive("end", end), positive("spacing", spacing)
        if spacing > end:
            raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
        check_storage("end", end / spacing, MOTION_COLUMNS)
        check_slipping(scenario.friction)
        self.scenario = scenario
        self.times = np.arange(int(np.floor(end / spacing + 1e-9)) + 1, dtype=float) * spacing
        criterion = RestCriterion() if criterion is None else criterion
        self.criterion = instance("criterion", criterion, RestCriterion)
        self.conditions = named_conditions(stop_when, scenario.initial_state)
        tell = None if progress is None else function("progress", progress)
        # A stretch knows no end but its own.
        self.watch = Watch(time_limit, tell and (lambda reached, _: tell(reached, end)))

    def until_rest(
        self,
        start: Array,
        advance: Advance,
        stretch: float,
        conditions: Mapping[str, Callable[[Array], float]],
        still: Callable[[Array], tuple[Array, Array]],
    ) -> tuple[Array, dict[str, Any]]:
        """Run in stretches until the disk is at rest, or the run ends otherwise.

        Parameters
        ----------
        start : ndarray, shape (m,)
        advance : callable
            See `Advance`.
        stretch : float
            Time in s after which rest is looked for.
        conditions : mapping
            The conditions as functions of a state that is integrated.
        still : callable
            From states, shape (k, m), to what `RestCriterion.first` judges, each shape (k,).

        Returns
        -------
        ndarray, shape (n, m)
            States at the samples.
        dict
            What a `SpatialMotion` tells of them: times, rest_time, ending and counts.

        Raises
        ------
        TimeLimitError
            If the time limit is met before the first sample.
        """
        times, spacing, done = self.times, float(self.times[1]), 0
        count, enough = max(1, round(stretch / spacing)), self.criterion.samples(spacing)
        states, counts = np.empty((times.size, start.size)), Counter[str]()
        states[0] = start
        rest, ended = None, None
        while done + 1 < times.size and rest is None and ended is None:
            found = advance(times[done : done + count + 1], states[done])
            size, ended = found.times.size - 1, found.ended
            states[done + 1 : done + size + 1] = found.states[1:]
            counts.update(steps=found.steps, right_hand_sides=found.evaluations)
            done += size
            if ended is None:
                first = max(0, done + 1 - size - enough)
                rest = self.criterion.first(*still(states[first : done + 1]), spacing)
                rest = None if rest is None else first + rest
            else:
                times = np.append(times[:done], found.times[-1])
        if rest is not None:
            done, ended = min(done, rest + enough - 1), AT_REST
        last, value = states[done], self.watch.seconds
        if ended == TIME_LIMIT and times[done] < spacing:
            raise TimeLimitError(
                f"time limit met after {value:.3g} s of processor time, before the first sample"
            )
        if ended != TIME_LIMIT and ended is not None:
            value = float(still(last[None])[0][0]) if ended == AT_REST else conditions[ended](last)
        return states[: done + 1], {
            "times": times[: done + 1],
            "rest_time": None if rest is None else float(times[rest]),
            "ending": ended and Ending(reason=ended, time=float(times[done]), value=value),
            "counts": dict(counts),
        }
