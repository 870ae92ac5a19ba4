"""Engine simulation of the disk until it lies still, to a tolerance or to a step size.

A state is a row of 19 numbers: position of G, attitude as a quaternion of any length, velocity of
G, angular velocity in the disk's axes, and the energy taken by each of `CAUSES`.
"""

from collections import Counter
from contextlib import closing
from functools import partial
from math import ceil, hypot, sqrt
from operator import mul
from typing import Any, Final

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np

from analysis.motion import frames
from analysis.motion.endings import TIME_LIMIT, StopWhen
from analysis.motion.frames import Poses
from analysis.motion.spatial_motion import SpatialMotion
from analysis.problem.checks import Array, optional, positive
from analysis.problem.contact import CAUSES, RestCriterion
from analysis.problem.limits import LEAST_TILT, REST_SPACING
from analysis.problem.scenario import Scenario
from analysis.solve.effort import contact_time
from analysis.solve.stepping import InitialValueProblem, Run
from analysis.solve.until_rest import WayToRest, until_agreement
from analysis.solve.watch import PaperState, Progress
from mbs_models.effort import rest_effort
from mbs_models.endings import Search, suspects, turning_negative
from mbs_models.floating import FloatingLie, quaternion_rates, rotation_rows
from mbs_models.integrators import Integrator
from mbs_models.loads import largest_lever
from mbs_models.model import Reading
from mbs_models.probe import Probe
from mbs_models.runs import Recording, Stop, run
from mbs_models.scene import Scene
from mbs_models.solving import EngineError, stepping

COARSEST = 1e-9
"""Error in a step from which on two runs may agree by the longest step that both take."""

STRETCH = 0.1
"""Time in s after which a run chooses a fixed step anew and looks for rest."""

SAFETY = 0.6
"""Part of the predicted stability limit that a fixed step may use."""

BALANCED = 1e-4
"""Part of the energy at the start that may be made or lost over a stretch: limits are predicted
under the weight, and a disk that falls presses on the table many times as hard."""

HALVINGS = 8
"""Of the step, after which a stretch whose energies do not balance is given up."""

POSE, TURNING, TAKEN = slice(3, 7), slice(10, 13), slice(13, None)
"""Columns of attitude, angular velocity and energies."""


def simulate_to_rest(
    scene: Scene | Scenario,
    end: float,
    *,
    step: float | None = None,
    tolerance: float | None = None,
    spacing: float = REST_SPACING,
    criterion: RestCriterion | None = None,
    stop_when: StopWhen = (),
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> SpatialMotion:
    """Simulate a scene in the engine until the disk rests, or until `end`.

    Accuracy is asked for in one of two ways. With `tolerance`, the engine's accelerations are
    stepped by LSODA, whose steps grow short where the contact opens and closes, and the tolerance
    of a step is tightened tenfold until two runs agree. With `step`, there is a single run of
    fixed steps of the engine's RK44, and nobody looks at its error: it is of order 4 in the step
    while the contact stays closed, but each touch-down, where the damper's force sets in at once,
    leaves an error of the first order.

    Parameters
    ----------
    scene : Scene or Scenario
        Of formulation "floating-lie" and with a rounded rim, such as `Scene(Scenario.rest())`.
    end : float
        Longest time in s.
    step : float, optional
        Largest step in s. It is cut where rolling resistance makes a nearly flat disk stiff, and
        halved wherever energy would be made or lost.
    tolerance : float, optional
        Largest error, see `SpatialMotion.deviation`, and by `error_at_ending` where a condition
        ends the run; 1e-3 if neither is given.
    spacing : float
        Time between samples in s.
    criterion : RestCriterion, optional
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
        If an argument is out of range, the scene does not last until the disk lies flat, the
        step is too large for the contact's stiffness, or the run would take more than
        1e8 steps or samples than can be held.
    ToleranceError
        If runs of ever shorter steps do not agree, as after impacts that a small change turns
        into another motion.
    TimeLimitError
        If the time limit is met before the first sample.
    EngineError
        If the engine does not reach the end, or energies do not balance however short the steps.

    Examples
    --------
    >>> from analysis import Scenario, Start
    >>> from mbs_models import Scene, simulate_to_rest
    >>> motion = simulate_to_rest(Scene(Scenario.rest(start=Start(spin=5.0))), 0.02)
    >>> motion.error_estimate < 1e-3
    True
    """
    if step is not None and tolerance is not None:
        raise ValueError("give either step or tolerance, not both")
    step = optional(positive, "step", step)
    scene = Scene.of(scene)
    scenario = scene.scenario
    way = EngineWay(
        scenario,
        end,
        spacing=spacing,
        criterion=criterion,
        stop_when=stop_when,
        time_limit=time_limit,
        progress=progress,
    )
    with closing(way.model):
        if scene.has_constraints:
            raise ValueError(
                "scene must be of formulation 'floating-lie', which the explicit integrator of "
                f"this run can take, got {scene.built_as!r}"
            )
        rest_effort(scene, end, step).check()
        if step is None:
            coarsest = min(COARSEST, scenario.finest_slip)
            return until_agreement(way.by_accelerations, tolerance, coarsest)
        if step > (largest := largest_step(scenario)):
            contact, gradient = scenario.penalty_contact, scenario.friction_gradient
            raise ValueError(
                f"step must not exceed {largest:.3g} s, the predicted stability limit at "
                f"stiffness {contact.stiffness:g}, damping {contact.damping:g} and friction "
                f"gradient {gradient:g}, got {step:g}"
            )
        return way.by_steps(step)


def largest_step(scenario: Scenario, leaning: float = 1.0) -> float:
    """Step in s above which explicit Runge-Kutta runs of order 4 are predicted to diverge.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.
    leaning : float
        Sine of the smallest inclination, 0 flat. The lower the disk leans, the more a rolling
        resistance on the fast contour brakes its turning.

    Returns
    -------
    float
        The least of four limits: of the contact's spring and damper, of sliding friction at no
        slip, of the rolling resistance, and of pivoting friction.

    Raises
    ------
    ValueError
        If the contact is the ideal one.
    """
    disk, contact, loss = scenario.disk, scenario.penalty_contact, scenario.dissipation
    frequency = sqrt(contact.stiffness * disk.contact_mobility)
    slope = loss.rolling_viscous + loss.rolling_dry / loss.rolling_smoothing
    reach = largest_lever(disk, leaning, contact.half_thickness)
    turning = max(slope * reach**2, loss.pivoting / loss.pivoting_smoothing)
    decay = max(
        contact.damping * disk.contact_mobility,
        scenario.slip_decay,
        turning * scenario.weight / disk.principal_moments[0],
    )
    # Stability limits of the method along the imaginary and the negative real axis.
    return min(2.8 / frequency, 2.7 / decay) if decay else 2.8 / frequency


def spatial(states: Array) -> Poses:
    """Poses and how they move, in inertial components."""
    rotation = frames.rotations(states[:, POSE])
    angular = np.einsum("nij,nj->ni", rotation, states[:, TURNING])
    return Poses(states[:, :3], rotation, states[:, 7:10], angular)


def states_of(records: Array) -> Array:
    """States, shape (n, 19), from records of the engine, shape (n, 24)."""
    rotation = records[:, 3:12].reshape(-1, 3, 3)
    angular = np.einsum("nji,nj->ni", rotation, records[:, 15:18])
    attitude = frames.quaternions(rotation)
    return np.column_stack((records[:, :3], attitude, records[:, 12:15], angular, records[:, 18:]))


class FloatingWithLosses(FloatingLie):
    """A free disk on a penalty contact, and what each of `CAUSES` has taken from it in J.

    The energies are variables of order 1 with the powers as their rates: they go through the same
    stages of the integrator as the motion.
    """

    def _build(self) -> None:
        super()._build()
        zeros = [0.0] * len(CAUSES)
        energies = self.assembly.add(
            items.NodeGenericODE1(
                referenceCoordinates=zeros,
                initialCoordinates=zeros,
                numberOfODE1Coordinates=len(CAUSES),
            ),
            "energy taken by each cause",
        )
        self.assembly.add(
            items.ObjectGenericODE1(
                nodeNumbers=[energies], rhsUserFunction=lambda *_unused: self.powers()
            ),
            "power of each cause, by a user function",
        )

    def powers(self) -> list[float]:
        """What each cause takes in W in the engine's current state, six floats."""
        (_, _, height), matrix, v, w = [tuple(read().tolist()) for read in self._readings[:4]]
        return self.loads.at(height, matrix, v, w).taken

    def pose_readings(self) -> list[Reading]:
        """What `states_of` takes."""
        return [*super().pose_readings(), self.system.systemData.GetODE1Coordinates]


class EngineWay(WayToRest):
    """By the engine: its Runge-Kutta method, or its own accelerations stepped by LSODA."""

    source, package, stepper = "engine", "exudyn", "integrator"
    method: Final = "LSODA"

    def build(self) -> None:
        """Build the model that is run, and asked for accelerations."""
        self.model = FloatingWithLosses(self.scenario)
        self.system = self.model.system
        self._probe = Probe(self.model)
        self.start = states_of(self.model.record()[None])[0]

    def by_steps(self, step: float) -> SpatialMotion:
        """With fixed steps of the engine's Runge-Kutta method of order 4, of at most so many s.

        They are cut where rolling resistance makes a nearly flat disk stiff.
        """
        advance = partial(self._over_steps, step)
        return self.motion(advance, {self.stepper: "RK44", "step": step}, STRETCH)

    def by_accelerations(self, local: float) -> SpatialMotion:
        """With steps of the engine's accelerations, to this relative and absolute error each."""
        with stepping(self.system):
            return self.stepped(self.method, local)

    def starting_at(self, state: Array) -> InitialValueProblem:
        """The problem from a state on; to be solved within `solving`."""
        absolute = np.ones(state.size)
        absolute[TAKEN] = self.energy
        return InitialValueProblem(
            self._derivative,
            state,
            contact_time(self.scenario),
            self.conditions,
            absolute=absolute,
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
            *self.model.loads.last.taken,
        ]

    def samples(self, states: Array) -> Array:
        """States as they are sampled."""
        return states

    def to_paper(self, state: Array) -> PaperState:
        """The paper's coordinates and their rates of a state; None on a flat disk."""
        values = state.tolist()
        rows = rotation_rows(values[POSE])
        if hypot(*rows[2][:2]) <= LEAST_TILT:
            return None
        angular = [sum(map(mul, row, values[TURNING])) for row in rows]
        return frames.from_pose(values[:3], rows, values[7:10], angular)

    def _over_steps(self, step: float, times: Array, state: Array) -> Run:
        leaning = float(np.hypot(*spatial(state[None]).rotations[0, 2, :2]))
        step = min(step, SAFETY * largest_step(self.scenario, 0.5 * leaning))
        spacing, counts = float(self.times[1]), Counter[str]()
        last = self.times[-1]
        for halvings in range(HALVINGS + 1):
            steps = ceil(spacing / step - 1e-9) << halvings
            recording, is_balanced = self._run(times, steps, state)
            counts.update(recording.counts)
            if is_balanced:
                break
            if self.watch.is_out_of_time:
                taken = counts["right_hand_sides"], TIME_LIMIT, (), counts["steps"]
                return Run(times[:1], state[None], *taken)
        else:
            shortest = f"even steps of {step / 2**HALVINGS:.3g} s are too long"
            text = f"the energy explodes after t = {times[0]:.6g} s: {shortest}"
            raise recording.failure or EngineError(text)
        # The next run goes on from there.
        data = self.system.systemData
        data.SetSystemState(data.GetSystemState(), exu.ConfigurationType.Initial)
        states = states_of(recording.records)
        times = times[: len(states)]
        told = {why: [each(state) for state in states] for why, each in self.conditions.items()}
        found = suspects(times, told, recording.stopped)
        search = Search(motion=self, watch=self.watch, counts=counts)
        ended, times, states = search.until_ending(times, states, found, spacing)
        if ended is None and self.watch.is_over(times[-1], last) and times[-1] < last:
            ended = TIME_LIMIT
        return Run(times, states, counts["right_hand_sides"], ended, (), counts["steps"])

    @np.errstate(over="ignore", invalid="ignore")
    def _run(self, times: Array, steps: int, state: Array) -> tuple[Recording, bool]:
        """A run of so many steps for each record, and whether its energies balance.

        Where it explodes, conditions and energies are asked of numbers that are none.
        """
        substeps, stop = np.full(times.size - 1, steps), self._stop(state)
        recording = run(self.model, Integrator(name="RK44"), times, substeps, stop=stop)
        # Where a condition has stopped it, it may have exploded after the last record.
        ends = np.vstack((recording.records[0], self.model.record()))
        return recording, recording.failure is None and self._is_balanced(states_of(ends))

    def _stop(self, state: Array) -> Stop | None:
        """What ends a run from a state on that meets a condition or is out of time, if any may."""
        conditions, watch = self.conditions, self.watch
        turned = turning_negative(conditions, state)

        def stop(_: float) -> str | None:
            name = turned(states_of(self.model.record()[None])[0]) if conditions else None
            return TIME_LIMIT if name is None and watch.is_out_of_time else name

        return stop if conditions or not watch.is_idle else None

    def _is_balanced(self, states: Array) -> bool:
        """Whether two states have as much energy, with what has been taken on the way."""
        found = self.readings(states)
        first, last = np.sum(np.hstack((found["energies"], found["dissipated"])), axis=1)
        return bool(abs(last - first) <= BALANCED * self.energy)

    def still(self, states: Array) -> tuple[Array, Array]:
        """Kinetic energies in J and heights of the centre of gravity in m."""
        kinetic, cog = self._moving(states)
        return kinetic, cog[:, 2]

    def _moving(self, states: Array) -> tuple[Array, Array]:
        """Kinetic energies in J, shape (n,), and places of the centre of gravity, shape (n, 3)."""
        disk, local = self.scenario.disk, states[:, TURNING]
        place, rotation, velocity, angular = spatial(states)
        arm = disk.eccentricity * rotation[:, :, 0]
        speed = np.linalg.norm(velocity + np.cross(angular, arm), axis=1)
        turning = np.einsum("ni,ij,nj->n", local, disk.tensor_about_cog, local)
        return 0.5 * (disk.mass * speed**2 + turning), place + arm

    def readings(self, states: Array) -> dict[str, Any]:
        """Arrays of a `SpatialMotion` by their names."""
        place, rotation, velocity, angular = poses = spatial(states)
        values = np.array(
            [
                (*load.point, load.slip, contour, load.normal, load.elastic)
                for load, contour in self.model.loads.along(*poses)
            ]
        )
        kinetic, cog = self._moving(states)
        potential = -self.scenario.disk.mass * cog @ np.array(self.scenario.table.vector)
        return {
            "positions": place,
            "quaternions": frames.quaternions(rotation),
            "velocities": velocity,
            "angular_velocities": angular,
            "contact_points": place + values[:, :3],
            "slip_speeds": values[:, 3],
            "contour_speeds": values[:, 4],
            "normal_force": values[:, 5],
            "energies": np.column_stack((kinetic, potential, values[:, 6])),
            "dissipated": states[:, TAKEN],
        }
