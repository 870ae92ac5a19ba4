"""In-house simulation of the disk until it lies still, in any attitude."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any, Literal, get_args

import numpy as np
from scipy.integrate import solve_ivp

from analysis.data import frames
from analysis.data.agreement import TIGHTEST, located, until_agreement
from analysis.data.checks import Array, TimeLimitError, choice, positive
from analysis.data.disk import Disk
from analysis.data.dissipation import CAUSES, RestCriterion
from analysis.data.endings import (
    AT_REST,
    TIME_LIMIT,
    Condition,
    Ending,
    StopWhen,
    first_met,
    named_conditions,
)
from analysis.data.limits import check_storage
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.data.state import State
from analysis.data.trajectory import versions
from analysis.data.watch import Progress, Watch
from analysis.mechanics.free_body import FreeBody
from analysis.models.effort import rest_effort

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
        Largest error, see `SpatialMotion.deviation`; 1e-3 if neither tolerance is given.
    local_tolerance : float, optional
        Relative tolerance of a single step; the absolute one is a hundredth of the number.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there. They are asked at the samples, but not where the disk lies flat; see
        `located`.
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
    end, spacing = positive("end", end), positive("spacing", spacing)
    if spacing > end:
        raise ValueError(f"spacing must not exceed end = {end:g}, got {spacing:g}")
    choice("method", method, REST_METHODS)
    if tolerance is not None and local_tolerance is not None:
        raise ValueError("give either tolerance or local_tolerance, not both")
    if not scenario.penalty_contact.is_rounded:
        raise ValueError("half_thickness must be positive for the disk to lie flat, got 0")
    check_storage("end", end / spacing, MOTION_COLUMNS)
    rest_effort(scenario, end).check()
    task = _Task(
        scenario=scenario,
        model=FreeBody(scenario),
        start=start_vector(scenario.disk, scenario.initial_state),
        times=np.arange(int(np.floor(end / spacing + 1e-9)) + 1, dtype=float) * spacing,
        criterion=criterion if criterion is not None else RestCriterion(),
        method=method,
        conditions=named_conditions(stop_when),
        watch=Watch(time_limit, progress),
    )
    if local_tolerance is not None:
        local_tolerance = positive("local_tolerance", local_tolerance)
        if local_tolerance < TIGHTEST:
            raise ValueError(
                f"local_tolerance must not be below {TIGHTEST:g}, got {local_tolerance:g}"
            )
        return located(task.run(local_tolerance), task.conditions)
    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    agreed = until_agreement(task.run, LOCAL_PART * tolerance, tolerance)
    return located(agreed, task.conditions, tolerance)


def start_vector(disk: Disk, start: State) -> Array:
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
        stretch = max(1, round(STRETCH / times[1]))
        for begin in range(0, times.size - 1, stretch):
            span = times[begin : begin + stretch + 1]
            try:
                blocks.append(self._stretch(span, blocks[-1][-1], local_tolerance, counts))
            except _OverError:
                ending = self._ending(float(span[0]))
                break
            ending, rest = self._met(begin, blocks), self._rest(blocks)
            if ending is not None or rest is not None:
                break
        states = np.concatenate(blocks)
        if ending is not None:
            states, rest = states[times[: len(states)] <= ending.time], None
        if rest is not None:
            states = states[: rest + self.criterion.samples(times[1])]
            last = float(times[len(states) - 1])
            kinetic = model.energies(states[-1].tolist())[0]
            ending = Ending(reason=AT_REST, time=last, value=kinetic)
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

    def _stretch(
        self, span: Array, first: Array, local_tolerance: float, counts: dict[str, int]
    ) -> Array:
        """States at all but the first of these times."""

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
            t_eval=span[1:],
            rtol=local_tolerance,
            atol=0.01 * local_tolerance,
            max_step=contact_time(self.scenario),
        )
        if not result.success:
            raise ArithmeticError(f"{self.method} stopped at t = {span[0]:g} s: {result.message}")
        block: Array = result.y.T
        block[:, 3:7] /= np.linalg.norm(block[:, 3:7], axis=1)[:, None]
        return block

    def _met(self, begin: int, blocks: list[Array]) -> Ending | None:
        """Ending in the last stretch, which begins with this sample, by a condition."""
        if not self.conditions:
            return None
        states = np.concatenate((blocks[-2][-1:], blocks[-1]))
        pose = sampled(self.model, self.times[: len(states)], states)
        found = first_met(
            self.conditions,
            pose["positions"],
            frames.rotations(pose["quaternions"]),
            pose["velocities"],
            pose["angular_velocities"],
        )
        if found is None:
            return None
        row, reason, value = found
        return Ending(reason=reason, time=float(self.times[begin + row]), value=value)

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


def contact_time(scenario: Scenario) -> float:
    """Half a period in s of the disk on its contact: steps no longer find every impact."""
    return pi / sqrt(scenario.penalty_contact.stiffness * scenario.disk.contact_mobility)


def sampled(model: FreeBody, times: Array, states: Array) -> dict[str, Any]:
    """Arrays of a `SpatialMotion` from states of `FreeBody`."""
    return {
        "times": times,
        "quaternions": states[:, 3:7],
        "dissipated": states[:, 13:],
        **model.readings(states),
    }
