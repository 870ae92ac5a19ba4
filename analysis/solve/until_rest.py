"""The way to rest on either side: what is asked of it, its stretches until rest, its accuracy."""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import inf, tan
from typing import Any, ClassVar

import numpy as np

from analysis.motion.endings import (
    AT_REST,
    TIME_LIMIT,
    Ending,
    StopWhen,
    named_conditions,
)
from analysis.motion.sampled import Setting
from analysis.motion.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.motion.trajectory import versions
from analysis.problem.bodies import noting
from analysis.problem.checks import (
    Array,
    TimeLimitError,
    ToleranceError,
    function,
    instance,
    optional,
    positive,
)
from analysis.problem.choices import Method, Source
from analysis.problem.contact import RestCriterion
from analysis.problem.friction import check_slipping
from analysis.problem.limits import check_storage
from analysis.problem.scenario import Scenario
from analysis.solve.stepping import InitialValueProblem, Run, integrate
from analysis.solve.to_tolerance import error_at_ending, tighter_and_tighter
from analysis.solve.watch import PaperState, Progress, Watch, of_states

RUNS = 5
"""Runs after which a tolerance counts as out of reach."""

TIGHTEST = 1e-13
"""Local tolerance that no run goes below, because of rounding."""

SENSITIVE = 1e4
"""Difference of two runs over the tolerance of a step, from which on they may agree by chance.

Of such a motion every run ends up somewhere else: from Table 3, two runs over 60 s agreed to 2e-4
where both were off by 2e-3.
"""

LOCAL_PART = 1e-6
"""Part of the tolerance that the first run allows in a step; the sum over a motion is larger."""

STRETCH = 1.0
"""Time in s after which rest is looked for."""

Advance = Callable[[Array, Array], Run]
"""From times of a stretch in s and the state at the first of them to what a run has reached."""


class WayToRest(ABC):
    """What is asked of a call of `simulate_to_rest`, checked, and how a side goes there.

    Its parameters are those of `simulate_to_rest`.

    Attributes
    ----------
    scenario : Scenario
    times : ndarray, shape (n,)
        Of the samples, evenly spaced from 0, in s.
    criterion : RestCriterion
    conditions : dict
        From reasons to functions of a state of the side; the motion ends where one turns negative.
    start : ndarray, shape (m,)
        State at the start.
    energy : float
        At the start in J: kinetic, and of gravity by the height above the table.
    watch : Watch

    Raises
    ------
    ValueError
        If one of them is out of range.
    """

    source: ClassVar[Source]

    package: ClassVar[str]
    """What steps, besides NumPy,"""

    stepper: ClassVar[str]
    """and what its methods are called among the settings."""

    start: Array

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
        if not (scenario.penalty_contact and scenario.is_smooth):
            raise ValueError("half_thickness must be positive for the disk to lie flat, got 0")
        end, spacing = positive("end", end), positive("spacing", spacing)
        if spacing > end:
            raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
        check_storage("end", end / spacing, MOTION_COLUMNS)
        check_slipping(scenario.friction)
        self.scenario = scenario
        self.times = np.arange(int(np.floor(end / spacing + 1e-9)) + 1, dtype=float) * spacing
        criterion = RestCriterion() if criterion is None else criterion
        self.criterion = instance("criterion", criterion, RestCriterion)
        named = named_conditions(stop_when, scenario.initial_state)
        self.conditions = of_states(named, self.to_paper)
        tell = optional(function, "progress", progress)
        # A stretch knows no end but its own.
        self.watch = Watch(time_limit, tell and (lambda reached, _: tell(reached, end)))
        # Its surface is asked in many directions at once.
        with noting(scenario.disk):
            self._low = scenario.penalty_contact.resting_height(scenario.disk, scenario.weight)
        self.build()
        (kinetic,), (height,) = self.still(self.start[None])
        self.energy = float(kinetic + scenario.weight * height)

    @abstractmethod
    def build(self) -> None:
        """Make what is asked for the motion, and the start."""

    @abstractmethod
    def to_paper(self, state: Array) -> PaperState:
        """The paper's coordinates and their rates of a state; None on a flat disk."""

    @abstractmethod
    def still(self, states: Array) -> tuple[Array, Array]:
        """Kinetic energies in J and heights of S in m, each shape (k,), of states, (k, m)."""

    @abstractmethod
    def readings(self, states: Array) -> dict[str, Any]:
        """Arrays of a `SpatialMotion` by their names, from states, shape (n, m)."""

    @abstractmethod
    def starting_at(self, state: Array) -> InitialValueProblem:
        """The motion from a state on."""

    def stepped(self, method: Method, local_tolerance: float) -> SpatialMotion:
        """The motion by a method of SciPy, to this relative tolerance of a step."""

        def advance(times: Array, state: Array) -> Run:
            problem, watch = self.starting_at(state), self.watch
            return integrate(
                problem, times, method, local_tolerance, allow_pulling=True, watch=watch
            )

        return self.motion(advance, {self.stepper: method, "local_tolerance": local_tolerance})

    def motion(
        self, advance: Advance, method: Mapping[str, Setting], stretch: float = STRETCH
    ) -> SpatialMotion:
        """Run in stretches until the disk is at rest, or the run ends otherwise.

        Parameters
        ----------
        advance : callable
            See `Advance`.
        method : mapping
            What steps, and its settings.
        stretch : float
            Time in s after which rest is looked for.

        Raises
        ------
        TimeLimitError
            If the time limit is met before the first sample.
        """
        times, spacing, done = self.times, float(self.times[1]), 0
        count, enough = max(1, round(stretch / spacing)), self.criterion.samples(spacing)
        states, counts = np.empty((times.size, self.start.size)), Counter[str]()
        states[0] = self.start
        rest, ended = None, None
        while done + 1 < times.size and rest is None and ended is None:
            found = advance(times[done : done + count + 1], states[done])
            size, ended = found.times.size - 1, found.ended
            states[done + 1 : done + size + 1] = found.states[1:]
            counts.update(steps=found.steps, right_hand_sides=found.evaluations)
            done += size
            # One that the run has ended with may lie off the grid, and comes after rest.
            even = done if ended is None else done - 1
            first = max(0, done + 1 - size - enough)
            rest = self._rest(states[first : even + 1])
            rest = None if rest is None else first + rest
            if ended is not None:
                times = np.append(times[:done], found.times[-1])
        if rest is not None:
            done, ended = min(done, rest + enough - 1), AT_REST
        if ended == TIME_LIMIT and times[done] < spacing:
            raise TimeLimitError(
                f"time limit met after {self.watch.seconds:.3g} s of processor time, before the "
                "first sample"
            )
        ending = None
        if ended is not None:
            (energy,), _ = self.still(states[done : done + 1])
            values = {AT_REST: float(energy), TIME_LIMIT: self.watch.seconds}
            # Any other condition ends a run where it is zero.
            value = values.get(ended, 0.0)
            ending = Ending(reason=ended, time=float(times[done]), value=value)
        return SpatialMotion(
            times=times[: done + 1],
            **self.readings(states[: done + 1]),
            rest_time=None if rest is None else float(times[rest]),
            scenario=self.scenario,
            source=self.source,
            method=method,
            counts=counts,
            versions=versions("numpy", self.package),
            ending=ending,
        )

    def _rest(self, states: Array) -> int | None:
        """Index of the first of states from which on the disk is at rest for long enough."""
        kinetic, height = self.still(states)
        scenario, disk = self.scenario, self.scenario.disk
        # On a table that leans, a body lies balanced where its centre of gravity is above the
        # contact point, which is higher by less than this.
        leaning = 2.0 * self._low * tan(scenario.table.inclination)
        above = height - self._low
        rise = above - np.clip(above, 0.0, leaning)
        parts = kinetic / (scenario.weight * disk.radius), rise / disk.radius
        return self.criterion.first(*parts, float(self.times[1]))


def until_agreement(
    run: Callable[[float], SpatialMotion], tolerance: float | None, coarsest: float = inf
) -> SpatialMotion:
    """Tighten the local tolerance tenfold until two runs agree, of a sensitive motion three.

    Parameters
    ----------
    run : callable
        From a local tolerance to a motion.
    tolerance : float, optional
        Largest `SpatialMotion.deviation` of the last two runs, and `error_at_ending` where a
        condition ends them; 1e-3 by default.
    coarsest : float
        Largest local tolerance.

    Returns
    -------
    SpatialMotion
        The last run, with its deviation from the one before as its error estimate; of a sensitive
        motion it is at least a tenth of the deviation before. A run that met a time limit is
        returned as it is, with an estimate over what it reached if there is another run to
        compare with.

    Raises
    ------
    ValueError
        If the tolerance is not positive.
    ToleranceError
        If no two runs agree.
    """
    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    rungs = tighter_and_tighter(min(LOCAL_PART * tolerance, coarsest), TIGHTEST)[:RUNS]

    def asked(local: float) -> SpatialMotion:
        motion = run(local)
        return replace(motion, method={**motion.method, "tolerance": tolerance})

    coarse = asked(rungs[0])
    if _event(coarse) == TIME_LIMIT:
        return coarse
    differences = [inf]
    for local in rungs[1:]:
        fine = asked(local)
        if _event(fine) == TIME_LIMIT:
            return replace(fine, error_estimate=fine.deviation(coarse))
        difference = _apart(fine, coarse)
        grown = difference / local
        # There is no run beyond the tightest to ask.
        sensitive = grown > SENSITIVE and local > 10.0 * TIGHTEST
        # The difference before leaves a tenth, as the tolerance of a step does.
        estimate = max(difference, 0.1 * differences[-1]) if sensitive else difference
        if estimate <= tolerance:
            return replace(fine, error_estimate=estimate)
        differences.append(difference)
        coarse = fine
    listed = ", ".join(f"{difference:.1e}" for difference in differences[1:])
    raise ToleranceError(
        f"tolerance {tolerance:g} cannot be reached: runs of which each allows a tenth of the "
        f"error in a step differ by {listed}, the last two by {grown:.0e} times what a step "
        "allows; inf stands for two that do not end alike"
    )


def _apart(fine: SpatialMotion, coarse: SpatialMotion) -> float:
    """How far two runs are apart, in what `SpatialMotion.deviation` is told in."""
    difference = fine.deviation(coarse)
    events = {_event(motion) for motion in (fine, coarse)}
    if events == {None}:
        return difference
    if len(events) > 1:
        return inf
    up, other_up = (motion.rotations[-1, 2] for motion in (fine, coarse))
    left, other_left = (
        np.append(motion.energies[-1].sum(), motion.dissipated[-1]) for motion in (fine, coarse)
    )
    energy = np.max(np.abs(left - other_left)) / fine.starting_energy
    ended = error_at_ending(
        [np.linalg.norm(up - other_up), energy],
        fine.times[-1] - coarse.times[-1],
        [np.hypot(*fine.angular_velocities[-1, :2]), 0.0],
    )
    return max(difference, float(ended))


def _event(motion: SpatialMotion) -> str | None:
    """Why a motion ended in the middle, if it did."""
    reason = None if motion.ending is None else motion.ending.reason
    return None if reason == AT_REST else reason
