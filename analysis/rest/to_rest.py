"""In-house simulation of the disk until it lies still, in any attitude."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import atan2, cos, hypot, sin
from typing import Any, Literal, get_args

import numpy as np

from analysis.data import frames
from analysis.data.agreement import TIGHTEST, until_agreement
from analysis.data.body import Body
from analysis.data.checks import Array, TimeLimitError, choice, instance, positive
from analysis.data.checks import local_tolerance as one_step
from analysis.data.dissipation import CAUSES, RestCriterion
from analysis.data.endings import (
    AT_REST,
    FLATTEST,
    TIME_LIMIT,
    Condition,
    Ending,
    StopWhen,
    named_conditions,
)
from analysis.data.friction import check_slipping
from analysis.data.limits import check_storage
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import MOTION_COLUMNS, SpatialMotion
from analysis.data.state import State
from analysis.data.trajectory import versions
from analysis.data.watch import Progress, Watch
from analysis.mechanics.attitude import EulerTurning, Quaternion
from analysis.mechanics.free_body import FreeBody
from analysis.mechanics.states import paper_of
from analysis.solve.effort import contact_time, rest_effort
from analysis.solve.stepping import InitialValueProblem, Run, integrate

RestMethod = Literal["LSODA", "DOP853", "RK45"]
REST_METHODS: tuple[RestMethod, ...] = get_args(RestMethod)
"""SciPy's Radau and BDF overflow: their numerical Jacobian meets states nothing depends on."""

LOCAL_PART = 1e-6
"""Part of the tolerance that the first run allows in a step; the sum over a motion is larger."""

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
        negative there. They are not asked where the disk lies flat.
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
    criterion = RestCriterion() if criterion is None else criterion
    way = _Way(
        scenario=scenario,
        model=FreeBody(scenario),
        times=np.arange(int(np.floor(end / spacing + 1e-9)) + 1, dtype=float) * spacing,
        criterion=instance("criterion", criterion, RestCriterion),
        method=method,
        conditions=named_conditions(stop_when, scenario.initial_state),
        watch=Watch(time_limit, progress),
    )
    if local_tolerance is not None:
        return way.run(one_step("local_tolerance", local_tolerance, TIGHTEST))
    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    return until_agreement(way.run, LOCAL_PART * tolerance, tolerance)


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Way:
    """What is to be integrated, and who watches."""

    scenario: Scenario
    model: FreeBody
    times: Array
    criterion: RestCriterion
    method: RestMethod
    conditions: Mapping[str, Condition]
    watch: Watch

    def run(self, local_tolerance: float) -> SpatialMotion:
        """Motion to this relative tolerance of a step, up to rest or as far as it comes."""
        times, stretch = self.times, max(1, round(STRETCH / self.times[1]))
        blocks = [start_vector(self.scenario.disk, self.scenario.initial_state)[None]]
        evaluations, rest, ending = 0, None, None
        for begin in range(0, self.times.size - 1, stretch):
            span = self.times[begin : begin + stretch + 1]
            found = self._stretch(span, blocks[-1][-1], local_tolerance)
            evaluations += found.evaluations
            if found.ended == TIME_LIMIT:
                ending = self._out_of_time(float(span[0]))
                break
            blocks.append(_with_unit_quaternions(found.states[1:]))
            if found.ended is not None:
                times = np.append(times[:begin], found.times)
                value = self._says(self.conditions[found.ended])(blocks[-1][-1])
                ending = Ending(reason=found.ended, time=float(times[-1]), value=value)
                break
            rest = self._rest(blocks)
            if rest is not None:
                break
        states = np.concatenate(blocks)
        if rest is not None:
            states = states[: rest + self.criterion.samples(times[1])]
            kinetic = self.model.energies(states[-1].tolist())[0]
            ending = Ending(reason=AT_REST, time=float(times[len(states) - 1]), value=kinetic)
        return SpatialMotion(
            **sampled(self.model, times[: len(states)], states),
            scenario=self.scenario,
            source="in-house",
            rest_time=None if rest is None else float(times[rest]),
            ending=ending,
            method={"method": self.method, "local_tolerance": local_tolerance},
            counts={"right_hand_sides": evaluations},
            versions=versions("numpy", "scipy"),
        )

    def _stretch(self, span: Array, start: Array, local_tolerance: float) -> Run:
        """Motion from the first to the last of these times."""
        problem = InitialValueProblem(
            self.model.derivative,
            start,
            leaning=None,
            normal_force=None,
            longest_step=contact_time(self.scenario),
            attitudes=lambda states: states[..., 3:7],
            conditions={name: self._says(each) for name, each in self.conditions.items()},
            absolute=0.01,
        )
        return integrate(
            problem, span, self.method, local_tolerance, allow_pulling=False, watch=self.watch
        )

    def _says(self, condition: Condition) -> Callable[[Array], float]:
        """A condition as a function of what is integrated; it is not negative on a flat disk."""

        def says(vector: Array) -> float:
            state = paper_state(self.scenario.disk, vector)
            return 1.0 if state is None else condition(state)

        return says

    def _rest(self, blocks: list[Array]) -> int | None:
        """Number of the first sample at rest, seen from the last two stretches."""
        recent = np.concatenate(blocks[-2:])
        kinetic = np.array([self.model.energies(state)[0] for state in recent.tolist()])
        disk, weight = self.scenario.disk, self.scenario.weight
        rise = recent[:, 2] - self.model.contact.resting_height(disk, weight)
        found = self.criterion.first(kinetic, rise, self.times[1])
        return None if found is None else sum(map(len, blocks[:-2])) + found

    def _out_of_time(self, moment: float) -> Ending:
        seconds = self.watch.seconds
        if moment == 0.0:
            raise TimeLimitError(
                f"time limit met after {seconds:.3g} s of processor time, in the first stretch "
                "of the motion"
            )
        return Ending(reason=TIME_LIMIT, time=moment, value=seconds)


def paper_state(disk: Body, vector: Array) -> State | None:
    """The paper's coordinates and their rates of a state of `FreeBody`; None on a flat disk."""
    moving = Quaternion.moving(vector[:13].tolist())
    ahead, across, up = moving.frame
    leaning = hypot(up[0], up[1])
    if leaning <= FLATTEST:
        return None
    alpha = atan2(ahead[2], -across[2])
    sa, ca = sin(alpha), cos(alpha)
    (x, y, z), (u, v, w) = moving.position, moving.velocity
    position = (ca * x + sa * y, ca * y - sa * x, z)
    velocity = (ca * u + sa * v, ca * v - sa * u, w)
    angles = (alpha, atan2(leaning, up[2]), atan2(up[0], up[1]))
    turning = (*position, *angles, *velocity, *moving.angular)
    coordinates, rates = paper_of(disk, turning, EulerTurning)
    return State(coordinates=coordinates, rates=rates)


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
