"""In-house simulation of the disk until it lies still, in any attitude."""

from dataclasses import replace
from functools import partial
from math import atan2, cos, hypot, sin
from typing import Literal, get_args

import numpy as np

from analysis.data import frames
from analysis.data.agreement import TIGHTEST, until_agreement
from analysis.data.body import Body
from analysis.data.checks import Array, choice, instance, positive
from analysis.data.checks import local_tolerance as one_step
from analysis.data.dissipation import CAUSES, RestCriterion
from analysis.data.endings import FLATTEST, Condition, StopWhen
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.state import State
from analysis.data.trajectory import versions
from analysis.data.watch import Progress
from analysis.mechanics.attitude import EulerTurning, Quaternion
from analysis.mechanics.free_body import FreeBody
from analysis.mechanics.newton_euler import kinetic_energy
from analysis.mechanics.states import paper_of
from analysis.solve.effort import contact_time, rest_effort
from analysis.solve.stepping import InitialValueProblem, Run, integrate
from analysis.solve.until_rest import RestCall

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
        If the time limit is met before the first sample.
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
    choice("method", method, REST_METHODS)
    if tolerance is not None and local_tolerance is not None:
        raise ValueError("give either tolerance or local_tolerance, not both")
    if not (scenario.penalty_contact and scenario.is_smooth):
        raise ValueError("half_thickness must be positive for the disk to lie flat, got 0")
    call = RestCall(
        scenario,
        end,
        spacing=spacing,
        criterion=criterion,
        stop_when=stop_when,
        time_limit=time_limit,
        progress=progress,
    )
    rest_effort(scenario, end).check()
    run = partial(_motion, call, FreeBody(scenario), method)
    if local_tolerance is not None:
        return run(one_step("local_tolerance", local_tolerance, TIGHTEST))
    tolerance = positive("tolerance", 1e-3 if tolerance is None else tolerance)
    return until_agreement(run, LOCAL_PART * tolerance, tolerance)


def _motion(
    call: RestCall, model: FreeBody, method: RestMethod, local_tolerance: float
) -> SpatialMotion:
    """Motion to this relative tolerance of a step, up to rest or as far as it comes."""
    scenario, disk = call.scenario, call.scenario.disk
    low = model.contact.resting_height(disk, scenario.weight)
    problem = InitialValueProblem(
        model.derivative,
        start_vector(disk, scenario.initial_state),
        leaning=None,
        normal_force=None,
        longest_step=contact_time(scenario),
        attitudes=lambda states: states[..., 3:7],
        conditions={name: partial(_says, disk, each) for name, each in call.conditions.items()},
        absolute=0.01,
    )

    def advance(times: Array, start: Array) -> Run:
        found = integrate(
            replace(problem, start=start),
            times,
            method,
            local_tolerance,
            allow_pulling=False,
            watch=call.watch,
        )
        found.states[:, 3:7] /= np.linalg.norm(found.states[:, 3:7], axis=1)[:, None]
        return found

    def still(states: Array) -> tuple[Array, Array]:
        velocity, angular = tuple(states[:, 7:10].T), tuple(states[:, 10:13].T)
        return kinetic_energy(disk, velocity, angular), states[:, 2] - low

    states, told = call.until_rest(problem.start, advance, STRETCH, problem.conditions, still)
    return SpatialMotion(
        **(told | model.readings(states)),
        quaternions=states[:, 3:7],
        dissipated=states[:, 13:],
        scenario=scenario,
        source="in-house",
        method={"method": method, "local_tolerance": local_tolerance},
        versions=versions("numpy", "scipy"),
    )


def _says(disk: Body, condition: Condition, vector: Array) -> float:
    """A condition of what is integrated; it is not negative on a flat disk."""
    state = paper_state(disk, vector)
    return 1.0 if state is None else condition(state)


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
