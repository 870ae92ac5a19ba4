"""Runs on the engine's own accelerations, stepped by SciPy's solvers.

What is integrated are the coordinates and rates that the constraints leave free, with alpha and
the spin, in the paper's coordinates: the others follow from these, so that no constraint drifts.
The accelerations are those of the scene's own formulation.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import cos, sin

import numpy as np

from analysis.motion.endings import Condition
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import Array
from analysis.problem.constraints import demanded, independent_coordinates
from analysis.problem.start import COORDINATES, State
from analysis.solve.effort import contact_time, longest_step
from analysis.solve.stepping import InitialValueProblem, Method, Run, integrate
from analysis.solve.to_tolerance import run_to, tighter_and_tighter
from mbs_models.effort import LOCAL, stepping_integrator
from mbs_models.friction import slip_velocity
from mbs_models.integrators import FINEST_LOCAL, Integrator
from mbs_models.probe import Probe
from mbs_models.sampled import Call
from mbs_models.scene import Scene, build
from mbs_models.solving import stepping

_NAMES = (*COORDINATES, *(f"{name}_rate" for name in COORDINATES))
"""What tells a whole state: coordinates, and then rates."""

_LOW = 0.05
"""Sine of the inclination below which accelerations are taken with more care: rounding in those of
alpha and gamma grows with one over its square."""


BENDING = 1e-4
"""Part of the finest speed of friction over which its slope hardly changes,"""

DIFFERENCES = (1e-12, 1e-8)
"""and bounds of the differences that Jacobians are taken from."""

QUICK = 3e-12
"""Error in a step from which on accelerations may be noisier."""

FINE = 3e-9
"""Tolerance in rad from which on a first run allows a step less of it."""

_Solved = tuple[list[float], list[float], Array, Array]
"""Coordinates, rates, and the engine's accelerations and multipliers."""


class AccelerationProblem:
    """The motion of a scene as an initial value problem, and the way back from its states.

    Parameters
    ----------
    scene : Scene
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative.

    Attributes
    ----------
    names : tuple of str
        The coordinates and rates that determine all others, in the order of a state.
    quick : bool
        Whether accelerations may be noisier for the sake of speed; see `Probe.solved`.
    model : Model
    system : exudyn.MainSystem
    probe : Probe
    """

    def __init__(self, scene: Scene, conditions: Mapping[str, Condition]) -> None:
        self.quick = True
        self.scenario = scenario = scene.scenario
        self._scene, self.model = scene, build(scene)
        self.system = self.model.system
        self.probe = Probe(self.model)
        names: tuple[str, ...] = _NAMES
        if scenario.contact is None:
            free = ("alpha", *independent_coordinates(scenario.constraints), "alpha_rate")
            kept = [f"{name}_rate" for name in self.model.held_rates]
            names = tuple(name for name in free if name not in kept)
        self.names = names
        # Where they stand among the six coordinates and the six rates.
        self._free = [_NAMES.index(name) for name in names]
        self._tilt = names.index("beta")
        self._angles = [self._tilt, names.index("gamma")]
        self._conditions = conditions
        self._last: tuple[Array | None, _Solved]
        self._last = (None, ([], [], np.zeros(0), np.zeros(0)))

    @property
    def method(self) -> Method:
        """With which an ending is located."""
        return stepping_integrator(self._scene, np.array([0.0, 1.0]), LOCAL).method

    def starting_at(self, record: Array) -> InitialValueProblem:
        """The problem from coordinates and rates on; to be solved within `solving`."""
        scenario = self.scenario
        self._start = record[:12].tolist()
        longest = longest_step(scenario)
        if scenario.contact is not None:
            longest = min(longest, contact_time(scenario))
        return InitialValueProblem(
            self._derivative,
            record[self._free],
            lambda state: sin(state[self._tilt]),
            self._normal_force if self.model.may_pull else None,
            longest,
            lambda states: states[..., self._angles],
            {reason: self._of_state(each) for reason, each in self._conditions.items()},
            self._slip_of_one_direction(),
            float(np.clip(BENDING * scenario.friction.finest_speed, *DIFFERENCES)),
        )

    def samples(self, states: Array) -> Array:
        """Coordinates, rates and constraint forces, shape (n, 12 + k), from n states."""
        found = [self._solved(state) for state in states]
        values = np.array([(*z, *u) for z, u, _, _ in found])
        return np.column_stack((values, self._forces(found)))

    def _forces(self, found: Sequence[_Solved]) -> Array:
        """Constraint forces, shape (n, k)."""
        z, u, second, algebraic = (np.array(each) for each in zip(*found, strict=True))
        return self.model.multipliers(second, algebraic, z, u)

    def _whole(self, values: Array) -> tuple[list[float], list[float]]:
        """Coordinates and rates, six floats each, from the free ones."""
        found = self._start.copy()
        for place, value in zip(self._free, values.tolist()):  # noqa: B905 - called so often
            found[place] = value
        if self.scenario.contact is None:
            x, y, _, alpha, beta, gamma, xd, yd, _, spin, bd, gd = found
            disk, constraints = self.scenario.disk, self.scenario.constraints
            x, y, xd, yd, bd, gd = demanded(
                constraints, disk, (beta, gamma, spin), (x, y, xd, yd, bd, gd)
            )
            if disk.is_round_disk:
                r = disk.radius
                z, zd = r * sin(beta), r * cos(beta) * bd
            else:
                z, per_beta, per_gamma = disk.clearance(beta, gamma)
                zd = per_beta * bd + per_gamma * gd
            found = [x, y, z, alpha, beta, gamma, xd, yd, zd, spin, bd, gd]
        return found[:6], found[6:]

    def _solved(self, state: Array) -> _Solved:
        """Coordinates, rates, the engine's accelerations and its multipliers in a state."""
        last, found = self._last
        if state is not last:
            z, u = self._whole(state)
            self.probe.move_to(z, u)
            second, multipliers = self.probe.solved(quick=self.quick and abs(sin(z[4])) > _LOW)
            found = (z, u, second, multipliers)
            self._last = (state, found)
        return found

    def _derivative(self, _: float, state: Array) -> list[float]:
        z, u, second, _unused = self._solved(state)
        rates = (*u, *self.model.decode_accelerations(second, z, u).tolist())
        return [rates[place] for place in self._free]

    def _normal_force(self, state: Array) -> float:
        found = self._solved(state)
        equation = self.model.contact_equation
        if equation is not None:
            # The engine's constraint forces act with a minus sign on the second body.
            return -float(found[3][equation])
        return float(self._forces([found])[0, 0])

    def _of_state(self, condition: Condition) -> Callable[[Array], float]:
        def said(state: Array) -> float:
            z, u = self._whole(state)
            return condition(State(coordinates=tuple(z), rates=tuple(u)))

        return said

    def _slip_of_one_direction(self) -> Callable[[Array], float] | None:
        held = [f"no-slip-{way}" in self.scenario.constraints for way in ("along", "across")]
        if not self.scenario.rubs or sum(held) != 1:
            return None
        radius, direction = self.scenario.disk.radius, int(held[0])
        return lambda state: slip_velocity(radius, *self._whole(state))[direction]


def stepped(call: Call, integrator: Integrator) -> Trajectory:
    """Step a scene's accelerations over all times, to a tolerance if there is one.

    Parameters
    ----------
    call : Call
    integrator : Integrator
        One that steps accelerations. Its local tolerance holds where the call has no tolerance;
        that of what is returned has led there.
    """
    times, tolerance = call.times, call.tolerance
    motion = AccelerationProblem(call.scene, call.conditions)
    motion.probe.check_start()
    start = call.scene.scenario.initial_state.vector
    problem = motion.starting_at(start)
    problem = replace(problem, longest_step=min(call.longest, problem.longest_step))
    begin = time.process_time()

    def run(local: float, part: float) -> Run:
        motion.quick = local >= QUICK
        found = integrate(
            problem.with_steps_up_to(part),
            times,
            integrator.method,
            local,
            allow_pulling=call.allow_pulling,
            watch=call.watch,
        )
        call.counts.update(steps=found.steps, right_hand_sides=found.evaluations)
        return found

    rungs = [integrator.local_tolerance or FINEST_LOCAL]
    if tolerance is not None:
        # The error of a motion falls more slowly than that of a step.
        first = tolerance / (3.0 if tolerance > FINE else 20.0)
        rungs = tighter_and_tighter(first, FINEST_LOCAL)
    with stepping(motion.system):
        found = run_to(run, problem, times, tolerance or np.inf, rungs, method=integrator.name)
        values = motion.samples(found.states)
    # The first sample is the start itself, without the rounding on the way there.
    values[0, :12] = start
    call.seconds = time.process_time() - begin
    used = replace(integrator, local_tolerance=found.local_tolerance)
    estimate = None if tolerance is None else found.estimate
    return call.trajectory(replace(found, states=values), used, call.longest, estimate)
