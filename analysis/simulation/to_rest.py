"""In-house simulation of the disk until it lies still, in any attitude."""

from functools import partial
from math import hypot
from typing import Literal, get_args

import numpy as np

from analysis.mechanics.attitude import Quaternion
from analysis.mechanics.dual import of_floats
from analysis.mechanics.linear_algebra import add
from analysis.mechanics.newton_euler import kinetic_energy
from analysis.mechanics.penalty import YieldingTable, free_solver
from analysis.motion import frames
from analysis.motion.endings import StopWhen
from analysis.motion.spatial_motion import SpatialMotion
from analysis.problem.body import Body
from analysis.problem.checks import Array, choice, instance
from analysis.problem.checks import local_tolerance as one_step
from analysis.problem.contact import CAUSES, RestCriterion
from analysis.problem.limits import LEAST_TILT, REST_SPACING
from analysis.problem.scenario import Scenario
from analysis.problem.start import State
from analysis.solve.effort import contact_time, rest_effort
from analysis.solve.stepping import InitialValueProblem
from analysis.solve.until_rest import TIGHTEST, WayToRest, until_agreement
from analysis.solve.watch import PaperState, Progress

RestMethod = Literal["LSODA", "DOP853", "RK45"]
REST_METHODS: tuple[RestMethod, ...] = get_args(RestMethod)
"""SciPy's Radau and BDF overflow: their numerical Jacobian meets states nothing depends on."""


def simulate_to_rest(
    scenario: Scenario,
    end: float,
    *,
    spacing: float = REST_SPACING,
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
        Relative tolerance of a single step; the absolute one is a hundredth of the number, of the
        energies in parts of that at the start.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there. They are not asked where the disk lies flat, and see alpha and gamma
        between -pi and pi: one that changes sign as these jump ends the run there.
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
        If an argument is out of range, or the run would take more than 1e8 steps or samples
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
    way = InHouseWay(
        scenario,
        end,
        spacing=spacing,
        criterion=criterion,
        stop_when=stop_when,
        time_limit=time_limit,
        progress=progress,
    )
    rest_effort(scenario, end).check()
    run = partial(way.stepped, method)
    if local_tolerance is not None:
        return run(one_step("local_tolerance", local_tolerance, TIGHTEST))
    return until_agreement(run, tolerance, scenario.finest_slip)


class InHouseWay(WayToRest):
    """By the in-house equations.

    A state holds that of `Quaternion`, 13 numbers, and the energy taken by each of `CAUSES`.
    """

    source, package, stepper = "in-house", "scipy", "method"

    def build(self) -> None:
        """Record the equations."""
        self._table = YieldingTable.of(self.scenario)
        self._solve = free_solver(self.scenario, Quaternion, of_floats(self.scenario.friction))
        self.start = start_vector(self.scenario.disk, self.scenario.initial_state)

    def starting_at(self, state: Array) -> InitialValueProblem:
        """The motion from a state on."""
        return InitialValueProblem(
            lambda _, state: self._solve(*state[:13].tolist()),
            _of_unit_length(state),
            contact_time(self.scenario),
            self.conditions,
            absolute=0.01 * np.append(np.ones(13), np.full(len(CAUSES), self.energy)),
        )

    def still(self, states: Array) -> tuple[Array, Array]:
        """Kinetic energies in J and heights of the centre of gravity in m."""
        velocity, angular = tuple(states[:, 7:10].T), tuple(states[:, 10:13].T)
        return kinetic_energy(self.scenario.disk, velocity, angular), states[:, 2]

    def readings(self, states: Array) -> dict[str, Array]:
        """Arrays of a `SpatialMotion` by their names."""
        states = _of_unit_length(states)
        attitudes = {"quaternions": states[:, 3:7], "dissipated": states[:, 13:]}
        return attitudes | self._table.readings(states)

    def to_paper(self, state: Array) -> PaperState:
        """The paper's coordinates and their rates of a state; None on a flat disk."""
        moving, back = Quaternion.moving(state[:13].tolist()), -self.scenario.disk.eccentricity
        axes, (_, q, r) = moving.frame, moving.angular
        if hypot(*axes.up[:2]) <= LEAST_TILT:
            return None
        place = add(moving.position, axes.seen((back, 0.0, 0.0)))
        velocity = add(moving.velocity, axes.seen((0.0, back * r, -back * q)))
        return frames.from_pose(place, axes, velocity, axes.seen(moving.angular))


def _of_unit_length(states: Array) -> Array:
    """The same states, shape (..., 19), with quaternions of unit length."""
    found = states.copy()
    found[..., 3:7] /= np.linalg.norm(states[..., 3:7], axis=-1, keepdims=True)
    return found


def start_vector(disk: Body, start: State) -> Array:
    """State of `InHouseWay` for a start in the paper's coordinates, shape (19,)."""
    coordinates, rates = np.array([start.coordinates]), np.array([start.rates])
    (position,), rotation = frames.poses(coordinates)
    (velocity,), (angular,) = frames.twists(coordinates, rates)
    offset = disk.eccentricity * rotation[0, :, 0]
    (quaternion,) = frames.quaternions(rotation)
    velocity, angular = velocity + np.cross(angular, offset), rotation[0].T @ angular
    return np.concatenate(
        (position + offset, quaternion, velocity, angular, np.zeros(len(CAUSES)))
    )
