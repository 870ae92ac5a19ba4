"""The motion of a scene as an initial value problem, from the engine's own accelerations.

What is integrated are the coordinates and rates that the constraints leave free, with alpha and
the spin, in the paper's coordinates: the others follow from these, so that no constraint drifts.
The accelerations are those of the scene's own formulation.
"""

from collections.abc import Callable, Mapping, Sequence
from math import cos, sin

import numpy as np

from analysis.data.admissible import demanded, independent_coordinates
from analysis.data.checks import Array
from analysis.data.endings import Condition
from analysis.data.scenario import Scenario
from analysis.data.state import COORDINATES, State
from analysis.solve.effort import contact_time, longest_step
from analysis.solve.stepping import InitialValueProblem
from mbs_models.friction import slip_velocity
from mbs_models.probe import Probe
from mbs_models.scene import Scene, build

_NAMES = (*COORDINATES, *(f"{name}_rate" for name in COORDINATES))
"""What tells a whole state: coordinates, and then rates."""

_LOW = 0.05
"""Sine of the inclination below which accelerations are taken with more care: rounding in those of
alpha and gamma grows with one over its square."""


BENDING = 1e-4
"""Part of the finest speed of friction over which its slope hardly changes,"""

DIFFERENCES = (1e-12, 1e-8)
"""and bounds of the differences that Jacobians are taken from."""

_Solved = tuple[list[float], list[float], Array, Array]
"""Coordinates, rates, and the engine's accelerations and multipliers."""


class FreeVariables:
    """The coordinates and rates of a scenario that determine all others.

    Parameters
    ----------
    scenario : Scenario

    Attributes
    ----------
    places : list of int
        Where they stand among the six coordinates and the six rates.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._disk, self._constraints = scenario.disk, scenario.constraints
        self._follows = scenario.contact is None
        self._start = scenario.initial_state.vector.tolist()
        names: tuple[str, ...] = _NAMES
        if self._follows:
            names = ("alpha", *independent_coordinates(self._constraints))
            if "constant-spin" not in self._constraints:
                names += ("alpha_rate",)
        self.places = [_NAMES.index(name) for name in names]

    def whole(self, values: Array) -> tuple[list[float], list[float]]:
        """Coordinates and rates, six floats each, from the free ones."""
        found = self._start.copy()
        for place, value in zip(self.places, values.tolist()):  # noqa: B905 - called so often
            found[place] = value
        if self._follows:
            x, y, _, alpha, beta, gamma, xd, yd, _, spin, bd, gd = found
            x, y, xd, yd, bd, gd = demanded(
                self._constraints, self._disk, (beta, gamma, spin), (x, y, xd, yd, bd, gd)
            )
            if self._disk.is_round_disk:
                r = self._disk.radius
                z, zd = r * sin(beta), r * cos(beta) * bd
            else:
                z, per_beta, per_gamma = self._disk.clearance(beta, gamma)
                zd = per_beta * bd + per_gamma * gd
            found = [x, y, z, alpha, beta, gamma, xd, yd, zd, spin, bd, gd]
        return found[:6], found[6:]


class AccelerationProblem:
    """The motion of a scene as an initial value problem, and the way back from its states.

    Parameters
    ----------
    scene : Scene
    conditions : mapping
        From reasons to functions of a `State` that end the motion where they turn negative.

    Attributes
    ----------
    quick : bool
        Whether accelerations may be noisier for the sake of speed; see `Probe.solved`.
    """

    def __init__(self, scene: Scene, conditions: Mapping[str, Condition]) -> None:
        self.quick = True
        self.scenario = scene.scenario
        self.model = build(scene)
        self._probe = Probe(self.model)
        self._free = FreeVariables(self.scenario)
        places = self._free.places
        self._tilt = places.index(_NAMES.index("beta"))
        self._angles = [self._tilt, places.index(_NAMES.index("gamma"))]
        self._conditions = conditions
        self._last: tuple[Array | None, _Solved]
        self._last = (None, ([], [], np.zeros(0), np.zeros(0)))

    def check_start(self) -> None:
        """Raise `ValueError` if the start breaks a constraint."""
        self._probe.check_start()

    @property
    def initial_value_problem(self) -> InitialValueProblem:
        """The problem to be stepped; to be solved within `solving`."""
        scenario = self.scenario
        longest = longest_step(scenario)
        if scenario.contact is not None:
            longest = min(longest, contact_time(scenario))
        return InitialValueProblem(
            self._derivative,
            scenario.initial_state.vector[self._free.places],
            lambda state: sin(state[self._tilt]),
            self._normal_force if self.model.may_pull else lambda _: 1.0,
            longest,
            lambda states: states[:, self._angles],
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
        records = [np.concatenate((*self.model.encode(z, u), a)) for z, u, a, _ in found]
        coordinates, rates, algebraic = (
            np.array([each[part] for each in found]) for part in (0, 1, 3)
        )
        return self.model.multipliers(np.array(records), algebraic, coordinates, rates)

    def _solved(self, state: Array) -> _Solved:
        """Coordinates, rates, the engine's accelerations and its multipliers in a state."""
        last, found = self._last
        if state is not last:
            z, u = self._free.whole(state)
            self._probe.move_to(z, u)
            second, multipliers = self._probe.solved(quick=self.quick and abs(sin(z[4])) > _LOW)
            found = (z, u, second, multipliers)
            self._last = (state, found)
        return found

    def _derivative(self, _: float, state: Array) -> list[float]:
        z, u, second, _unused = self._solved(state)
        rates = (*u, *self.model.decode_accelerations(second, z, u).tolist())
        return [rates[place] for place in self._free.places]

    def _normal_force(self, state: Array) -> float:
        z, u, second, multipliers = self._solved(state)
        equation = self.model.contact_equation
        if equation is not None:
            # The engine's constraint forces act with a minus sign on the second body.
            return -float(multipliers[equation])
        return float(self._forces([(z, u, second, multipliers)])[0, 0])

    def _of_state(self, condition: Condition) -> Callable[[Array], float]:
        def said(state: Array) -> float:
            z, u = self._free.whole(state)
            return condition(State(coordinates=tuple(z), rates=tuple(u)))

        return said

    def _slip_of_one_direction(self) -> Callable[[Array], float] | None:
        held = [f"no-slip-{way}" in self.scenario.constraints for way in ("along", "across")]
        if not self.scenario.rubs or sum(held) != 1:
            return None
        radius, direction = self.scenario.disk.radius, int(held[0])
        return lambda state: slip_velocity(radius, *self._free.whole(state))[direction]
