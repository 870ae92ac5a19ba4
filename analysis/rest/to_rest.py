"""In-house simulation of the disk until it lies still, in any attitude."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, get_args

import numpy as np
from scipy.integrate import solve_ivp

from analysis.data import frames
from analysis.data.agreement import TIGHTEST, until_agreement
from analysis.data.body import Body
from analysis.data.checks import Array, TimeLimitError, choice, instance, positive
from analysis.data.checks import local_tolerance as one_step
from analysis.data.dissipation import CAUSES, RestCriterion
from analysis.data.endings import (
    AT_REST,
    TIME_LIMIT,
    Condition,
    Ending,
    Poses,
    StopWhen,
    ending_met,
    first_met,
    named_conditions,
)
from analysis.data.friction import check_slipping
from analysis.data.limits import check_storage
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.data.state import State
from analysis.data.trajectory import versions
from analysis.data.watch import Progress, Watch
from analysis.mechanics.free_body import FreeBody
from analysis.solve.effort import contact_time, rest_effort

RestMethod = Literal["LSODA", "DOP853", "RK45"]
REST_METHODS: tuple[RestMethod, ...] = get_args(RestMethod)
"""SciPy's Radau and BDF overflow: their numerical Jacobian meets states nothing depends on."""

LOCAL_PART = 1e-6
"""Part of the tolerance that the first run allows in a step; the sum over a motion is larger."""

LOOK = 1000
"""Right-hand sides after which a run looks at the time."""

STRETCH = 1.0
"""Time in s after which the quaternion is normalised and rest is looked for."""


def simulate_to_rest(
    scenario: Scenario,
    end: float,
    *,
    spacing: float = 2e-3,
    criterion: RestCriterion | None = None,
    method: RestMethod = "LSODA",
    tolerance: float | None = None,
    local_tolerance: float | None = None,
    stop_when: StopWhen = (),
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> SpatialMotion:
    """Simulate the disk on a compliant table until it rests, or until `end`.

    With `tolerance`, the tolerance of a step is tightened tenfold until two runs agree. With
    `local_tolerance`, there is a single run, and nobody looks at its error.

    Parameters
    ----------
    scenario : Scenario
        With a rounded rim, such as `Scenario.rest` makes.
    end : float
        Longest time in s.
    spacing : float
        Time between samples in s.
    criterion : RestCriterion, optional
    method : {"LSODA", "DOP853", "RK45"}
        SciPy method. LSODA is fastest; the explicit ones slow down on a flat disk.
    tolerance : float, optional
        Largest error, see `SpatialMotion.deviation`, and by `error_at_ending` where a condition
        ends the run; 1e-3 if neither tolerance is given.
    local_tolerance : float, optional
        Relative tolerance of a single step; the absolute one is a hundredth of the number.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there. They are asked at the samples, but not where the disk lies flat, and
        located by integrating anew from the sample before.
    time_limit : float, optional
        Processor time in s after which the motion is returned as far as it has come, with its
        `ending`.
    progress : callable, optional
        Called now and then with the time reached and `end`, anew for each run.

    Returns
    -------
    SpatialMotion
        With `error_estimate` if two runs could be compared: their whole difference.

    Raises
    ------
    ValueError
        If an argument is out of range, or the run would take more than `MOST_STEPS` or samples
        than can be held.
    ToleranceError
        If runs of ever tighter steps do not agree, as after impacts that a small change turns
        into another motion.
    TimeLimitError
        If the time limit is met in the first stretch.
    ArithmeticError
        If the integration fails on the way.

    Examples
    --------
    >>> from analysis import Dissipation, Scenario, Start, simulate_to_rest
    >>> loss = Dissipation(rolling_viscous=5e-3, pivoting=1e-3)
    >>> motion = simulate_to_rest(
    ...     Scenario.rest(dissipation=loss, start=Start(beta=0.1, spin=0.0)), 5.0
    ... )
    >>> motion.phases.rest == motion.rest_time
    True
    """
    scenario = instance("scenario", scenario, Scenario)
    end, spacing = positive("end", end), positive("spacing", spacing)
    if spacing > end:
        raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
    choice("method", method, REST_METHODS)
    if tolerance is not None and local_tolerance is not None:
        raise ValueError("give either tolerance or local_tolerance, not both")
    if not (scenario.penalty_contact and scenario.is_smooth):
        raise ValueError("half_thickness must be positive for the disk to lie flat, got 0")
    check_storage("end", end / spacing, MOTION_COLUMNS)
    rest_effort(scenario, end).check()
    check_slipping(scenario.friction)
    task = _Task(
        scenario=scenario,
        model=FreeBody(scenario),
        start=start_vector(scenario.disk, scenario.initial_state),
        times=np.arange(int(np.floor(end / spacing + 1e-9)) + 1, dtype=float) * spacing,
        criterion=RestCriterion()
        if criterion is None
        else instance("criterion", criterion, RestCriterion),
        method=method,
        conditions=named_conditions(stop_when, scenario.initial_state),
        watch=Watch(time_limit, progress),
    )
    if local_tolerance is not None:
        return task.run(one_step("local_tolerance", local_tolerance, TIGHTEST))
    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    return until_agreement(task.run, LOCAL_PART * tolerance, tolerance)


def start_vector(disk: Body, start: State) -> Array:
    """State of `FreeBody` for a start in the paper's coordinates, shape (19,)."""
    position, rotation = frames.poses(np.array([start.coordinates]))
    velocity, angular = frames.twists(np.array([start.coordinates]), np.array([start.rates]))
    A = rotation[0]
    offset = disk.eccentricity * A[:, 0]
    cog = position[0] + offset
    cog_velocity = velocity[0] + np.cross(angular[0], offset)
    return np.concatenate(
        (
            cog,
            frames.quaternions(rotation)[0],
            cog_velocity,
            A.T @ angular[0],
            np.zeros(len(CAUSES)),
        )
    )


class _OverError(Exception):
    """The watch ends the run."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Task:
    """What is to be integrated, and who watches."""

    scenario: Scenario
    model: FreeBody
    start: Array
    times: Array
    criterion: RestCriterion
    method: RestMethod
    conditions: Mapping[str, Condition]
    watch: Watch

    def run(self, local_tolerance: float) -> SpatialMotion:
        """Motion to this relative tolerance of a step, up to rest or as far as it comes."""
        model, times = self.model, self.times
        blocks, counts, rest, ending = [self.start[None]], {"right_hand_sides": 0}, None, None
        solved = partial(self._solved, local_tolerance, counts)
        stretch = max(1, round(STRETCH / times[1]))
        for begin in range(0, times.size - 1, stretch):
            span = times[begin : begin + stretch + 1]
            try:
                block = _with_unit_quaternions(solved(span, blocks[-1][-1], t_eval=span[1:]).y.T)
                met = self._met(span, np.concatenate((blocks[-1][-1:], block)), solved)
            except _OverError:
                ending = self._ending(float(span[0]))
                break
            blocks.append(block)
            if met is not None:
                ending, last = met
                before = times[: sum(map(len, blocks))] < ending.time
                blocks = [np.concatenate(blocks)[before], last[None]]
                times = np.append(times[: before.size][before], ending.time)
                break
            rest = self._rest(blocks)
            if rest is not None:
                break
        states = np.concatenate(blocks)
        if rest is not None:
            states = states[: rest + self.criterion.samples(times[1])]
            kinetic = model.energies(states[-1].tolist())[0]
            ending = Ending(reason=AT_REST, time=float(times[len(states) - 1]), value=kinetic)
        return SpatialMotion(
            **sampled(model, times[: len(states)], states),
            scenario=self.scenario,
            source="in-house",
            rest_time=None if rest is None else float(times[rest]),
            ending=ending,
            method={"method": self.method, "local_tolerance": local_tolerance},
            counts=counts,
            versions=versions("numpy", "scipy"),
        )

    def _solved(
        self,
        local_tolerance: float,
        counts: dict[str, int],
        span: Array,
        first: Array,
        **wanted: Any,
    ) -> Any:
        """Result of SciPy from the first to the last of these times."""

        def derivative(time: float, state: Array) -> tuple[float, ...]:
            counts["right_hand_sides"] += 1
            if counts["right_hand_sides"] % LOOK == 0 and self.watch.is_over(time, self.times[-1]):
                raise _OverError
            return self.model.derivative(time, state)

        result = solve_ivp(
            derivative,
            (span[0], span[-1]),
            first,
            method=self.method,
            rtol=local_tolerance,
            atol=0.01 * local_tolerance,
            max_step=contact_time(self.scenario),
            **wanted,
        )
        if not result.success:
            raise ArithmeticError(f"{self.method} stopped at t = {span[0]:g} s: {result.message}")
        return result

    def _met(
        self, span: Array, states: Array, solved: Callable[..., Any]
    ) -> tuple[Ending, Array] | None:
        """Ending in a stretch by a condition, and the state there.

        From the last sample before, it is integrated anew: the solver knows the motion within
        each of its steps, which end where the contact opens and closes.
        """
        met = first_met(self.conditions, *self._poses(states)) if self.conditions else None
        if met is None:
            return None
        around = span[[met.before, met.row]]
        anew = solved(around, states[met.before], dense_output=True)
        steps = first_met(self.conditions, *self._poses(_with_unit_quaternions(anew.y.T)))
        begin, end = around if steps is None else anew.t[[steps.before, steps.row]]

        def state_at(time: float) -> Array:
            return _with_unit_quaternions(anew.sol(time)[None])

        ending = ending_met(
            self.conditions, lambda time: self._poses(state_at(time)), float(begin), float(end)
        )
        return ending, state_at(ending.time)[0]

    def _poses(self, states: Array) -> Poses:
        found = sampled(self.model, np.zeros(len(states)), states)
        return Poses(
            found["positions"],
            frames.rotations(found["quaternions"]),
            found["velocities"],
            found["angular_velocities"],
        )

    def _rest(self, blocks: list[Array]) -> int | None:
        """Number of the first sample at rest, seen from the last two stretches."""
        recent = np.concatenate(blocks[-2:])
        kinetic = np.array([self.model.energies(state)[0] for state in recent.tolist()])
        rise = recent[:, 2] - self.model.contact.resting_height(
            self.scenario.disk, self.scenario.weight
        )
        found = self.criterion.first(kinetic, rise, self.times[1])
        return None if found is None else sum(map(len, blocks[:-2])) + found

    def _ending(self, time: float) -> Ending:
        seconds = self.watch.seconds
        if time == 0.0:
            raise TimeLimitError(
                f"time limit met after {seconds:.3g} s of processor time, in the first stretch "
                "of the motion"
            )
        return Ending(reason=TIME_LIMIT, time=time, value=seconds)


def _with_unit_quaternions(states: Array) -> Array:
    states = states.copy()
    states[:, 3:7] /= np.linalg.norm(states[:, 3:7], axis=1)[:, None]
    return states


def sampled(model: FreeBody, times: Array, states: Array) -> dict[str, Any]:
    """Arrays of a `SpatialMotion` from states of `FreeBody`."""
    return {
        "times": times,
        "quaternions": states[:, 3:7],
        "dissipated": states[:, 13:],
        **model.readings(states),
    }
