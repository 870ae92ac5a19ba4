"""The way of a disk with a rounded rim to rest: as an initial value problem, and its runs.

A state is a row of 19 numbers: position of G, attitude as a quaternion of any length, velocity of
G, angular velocity in the disk's axes, and the energy taken by each of `CAUSES`.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from math import hypot, sqrt
from typing import Any, Final

import numpy as np

from analysis.data import frames
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.contact import PenaltyContact
from analysis.data.endings import FLATTEST, TIME_LIMIT, Condition
from analysis.data.scenario import Scenario
from analysis.data.spatial_motion import SpatialMotion
from analysis.data.state import State
from analysis.data.trajectory import versions
from analysis.solve.effort import contact_time
from analysis.solve.stepping import InitialValueProblem, Run, integrate
from analysis.solve.until_rest import Advance, RestCall
from mbs_models.endings import dips, until_ending
from mbs_models.floating import FloatingWithLosses, quaternion_rates
from mbs_models.integrators import Integrator
from mbs_models.loads import largest_lever, loads_of
from mbs_models.probe import Probe
from mbs_models.runs import run
from mbs_models.scene import Scene
from mbs_models.solving import stepping

STRETCHES = {"RK44": 0.1, "LSODA": 1.0}
"""Time in s after which a run chooses a fixed step anew and looks for rest."""

SAFETY = 0.6
"""Part of the predicted stability limit that a fixed step may use."""

POSE, TURNING, TAKEN = slice(3, 7), slice(10, 13), slice(13, None)
"""Columns of attitude, angular velocity and energies."""


def largest_step(scene: Scene, leaning: float = 1.0) -> float:
    """Step in s above which explicit Runge-Kutta runs of order 4 are predicted to diverge.

    Parameters
    ----------
    scene : Scene
        With a rounded rim.
    leaning : float
        Sine of the smallest inclination, 0 flat. The lower the disk leans, the more a rolling
        resistance on the fast contour brakes its turning.

    Returns
    -------
    float
        The least of three limits: of the contact's spring and damper, of sliding friction at no
        slip, and of the rolling resistance.

    Raises
    ------
    ValueError
        If the scene has no rounded rim.
    """
    scenario, contact = scene.scenario, rounded_contact(scene)
    disk, loss, weight = scenario.disk, scenario.dissipation, scenario.weight
    frequency = sqrt(contact.stiffness * disk.contact_mobility)
    slope = loss.rolling_viscous + loss.rolling_dry / loss.rolling_smoothing
    reach = largest_lever(disk, leaning, contact.half_thickness)
    decay = max(
        contact.damping * disk.contact_mobility,
        scenario.slip_decay,
        slope * weight * reach**2 / disk.least_moment,
    )
    # Stability limits of the method along the imaginary and the negative real axis.
    return min(2.8 / frequency, 2.7 / decay) if decay else 2.8 / frequency


def rounded_contact(scene: Scene) -> PenaltyContact:
    """Contact of a scene that lasts until the disk lies flat; `ValueError` for another scene."""
    contact = scene.scenario.contact
    if contact is None:
        raise ValueError("scene must have a penalty contact, got contact None")
    if not scene.scenario.is_smooth:
        raise ValueError(
            "half_thickness must be positive, since only then the contact is defined when the "
            "disk lies flat, got 0"
        )
    if scene.has_constraints:
        raise ValueError(
            "scene must be of formulation 'floating-lie', which the explicit integrator of this "
            f"run can take, got {scene.built_as!r}"
        )
    return contact


class RestProblem:
    """The motion of a scene in any attitude, by the engine's own accelerations.

    Parameters
    ----------
    scene : Scene
        With a rounded rim.
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative; they
        are not asked where the disk lies flat.
    """

    method: Final = "LSODA"

    def __init__(self, scene: Scene, conditions: Mapping[str, Condition]) -> None:
        self._scenario = scene.scenario
        self.model = FloatingWithLosses(scene.scenario)
        self.system = self.model.system
        self._probe = Probe(self.model)
        assert self.model.loads is not None
        self._loads = self.model.loads
        self.conditions = {name: _of_pose(condition) for name, condition in conditions.items()}

    def starting_at(self, state: Array) -> InitialValueProblem:
        """The problem from a state on; to be solved within `solving`."""
        return InitialValueProblem(
            self._derivative,
            state,
            None,
            None,
            contact_time(self._scenario),
            lambda states: states[:, POSE],
            self.conditions,
        )

    def _derivative(self, _: float, state: Array) -> list[float]:
        values = state.tolist()
        turn, rates = values[POSE], values[7:13]
        place = np.array((*values[:3], *self.model.rotation_vector(turn))) - self.model.origin
        self._probe.put(place.tolist(), rates)
        # The engine has just asked for the loads in this state.
        second, _unused = self._probe.solved()
        return [
            *rates[:3],
            *quaternion_rates(turn, rates[3:]),
            *second.tolist(),
            *self._loads.last.taken,
        ]

    def samples(self, states: Array) -> Array:
        """States as they are sampled."""
        return states


def _of_pose(condition: Condition) -> Callable[[Array], float]:
    def said(row: Array) -> float:
        place, rotation, velocity, angular = spatial(row[None])
        if hypot(rotation[0, 2, 0], rotation[0, 2, 1]) <= FLATTEST:
            return 1.0
        z, u = frames.from_poses(place, rotation, velocity, angular)
        return condition(State(coordinates=tuple(z[0].tolist()), rates=tuple(u[0].tolist())))

    return said


def spatial(states: Array) -> tuple[Array, Array, Array, Array]:
    """Position, rotation matrix, velocity and angular velocity in inertial components."""
    attitudes = states[:, POSE]
    rotation = frames.rotations(attitudes / np.linalg.norm(attitudes, axis=1)[:, None])
    angular = np.einsum("nij,nj->ni", rotation, states[:, TURNING])
    return states[:, :3], rotation, states[:, 7:10], angular


def kinetic_energy(disk: Body, states: Array) -> Array:
    """Kinetic energy in J, shape (n,)."""
    _, rotation, v, w = spatial(states)
    local = states[:, TURNING]
    about_centre = np.einsum("ni,ij,nj->n", local, disk.tensor, local)
    arm = disk.eccentricity * rotation[:, :, 0]
    coupling = 2.0 * np.sum(v * np.cross(w, arm), axis=1)
    result: Array = 0.5 * (about_centre + disk.mass * (np.sum(v * v, axis=1) + coupling))
    return result


class RestRun:
    """Runs of a scene in stretches, until the disk is at rest or the run ends otherwise.

    Each tells states at its samples, shape (n, 19), and what `RestCall.until_rest` says of them.

    Parameters
    ----------
    scene : Scene
        With a rounded rim.
    call : RestCall
    """

    def __init__(self, scene: Scene, call: RestCall) -> None:
        self._scene, self._call = scene, call
        self._problem = RestProblem(scene, call.conditions)
        self._start = states_of(self._problem.model.record()[None])[0]

    def by_steps(self, step: float) -> SpatialMotion:
        """With fixed steps of the engine's Runge-Kutta method of order 4, of at most so many s.

        They are cut where rolling resistance makes a nearly flat disk stiff.
        """
        model = FloatingWithLosses(self._scene.scenario)
        method = {"integrator": "RK44", "step": step}
        return self._until_rest(partial(self._over_steps, model, step), method)

    def by_accelerations(self, local: float) -> SpatialMotion:
        """With steps of the engine's accelerations, to this relative and absolute error each."""

        def advance(times: Array, state: Array) -> Run:
            problem, watch = self._problem.starting_at(state), self._call.watch
            return integrate(
                problem, times, self._problem.method, local, allow_pulling=True, watch=watch
            )

        with stepping(self._problem.system):
            return self._until_rest(advance, {"integrator": "LSODA", "local_tolerance": local})

    def _until_rest(self, advance: Advance, method: dict[str, Any]) -> SpatialMotion:
        scenario, stretch = self._scene.scenario, STRETCHES[method["integrator"]]
        states, told = self._call.until_rest(
            self._start, advance, stretch, self._problem.conditions, self._still
        )
        return SpatialMotion(
            **(told | readings(scenario, states)),
            scenario=scenario,
            source="engine",
            method=method,
            versions=versions("numpy", "exudyn"),
        )

    def _over_steps(
        self, model: FloatingWithLosses, step: float, times: Array, state: Array
    ) -> Run:
        _, rotation, *_unused = spatial(state[None])
        leaning = float(np.hypot(*rotation[0, 2, :2]))
        step = min(step, SAFETY * largest_step(self._scene, 0.5 * leaning))
        spacing = float(self._call.times[1])
        samples = run(
            model,
            Integrator(name="RK44"),
            spacing=spacing,
            intervals=times.size - 1,
            substeps=int(np.ceil(spacing / step - 1e-9)),
            begin=float(times[0]),
        )
        states, counts = states_of(samples.records), Counter(samples.counts)
        ended, times, states = until_ending(
            times,
            states,
            (
                place
                for reason, says in self._problem.conditions.items()
                for place in dips(np.array([says(each) for each in states]), reason)
            ),
            self._problem,
            period=spacing,
            work=counts,
        )
        last = self._call.times[-1]
        if ended is None and self._call.watch.is_over(times[-1], last) and times[-1] < last:
            ended = TIME_LIMIT
        return Run(times, states, counts["right_hand_sides"], ended, (), counts["steps"])

    def _still(self, states: Array) -> tuple[Array, Array]:
        """Kinetic energies, and how far the centre of gravity is above its height at rest."""
        disk, weight = self._scene.scenario.disk, self._scene.scenario.weight
        _, rotation, *_unused = spatial(states)
        height = states[:, 2] + disk.eccentricity * rotation[:, 2, 0]
        rise = height - rounded_contact(self._scene).resting_height(disk, weight)
        return kinetic_energy(disk, states), rise


def states_of(records: Array) -> Array:
    """States, shape (n, 19), from records of the engine, shape (n, 24)."""
    rotation = records[:, 3:12].reshape(-1, 3, 3)
    angular = np.einsum("nji,nj->ni", rotation, records[:, 15:18])
    attitude = frames.quaternions(rotation)
    return np.column_stack((records[:, :3], attitude, records[:, 12:15], angular, records[:, 18:]))


def readings(scenario: Scenario, states: Array) -> dict[str, Any]:
    """Arrays of a `SpatialMotion` from states."""
    disk = scenario.disk
    place, rotation, velocity, angular = spatial(states)
    values = np.array(
        [
            (*load.point, load.slip, contour, load.normal, load.elastic)
            for load, contour in loads_of(scenario).over(place, rotation, velocity, angular)
        ]
    )
    cog = place + disk.eccentricity * rotation[:, :, 0]
    potential = -disk.mass * cog @ np.array(scenario.table.vector)
    return {
        "positions": place,
        "quaternions": frames.quaternions(rotation),
        "velocities": velocity,
        "angular_velocities": angular,
        "contact_points": place + values[:, :3],
        "slip_speeds": values[:, 3],
        "contour_speeds": values[:, 4],
        "normal_force": values[:, 5],
        "energies": np.column_stack((kinetic_energy(disk, states), potential, values[:, 6])),
        "dissipated": states[:, TAKEN],
    }
