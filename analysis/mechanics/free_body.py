"""The equations of a disk on a penalty contact as code, recorded for one scenario each."""

from collections.abc import Callable
from functools import partial
from math import hypot
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.mechanics.attitude import EulerAngles, Quaternion
from analysis.mechanics.newton_euler import Friction
from analysis.mechanics.penalty import YieldingTable
from analysis.mechanics.recorder import Recorder, Symbol, call, pair

Solver = Callable[..., tuple[float, ...]]
"""From the floats of a state to its time derivative and what else follows from it."""


def free_solver(scenario: Scenario, chart: type[EulerAngles] = EulerAngles) -> Solver:
    """Function from a state in Euler angles, 12 floats, to its derivative and the normal force.

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.
    chart : EulerAngles or EulerTurning
        What a state holds.
    """

    def results(table: YieldingTable, state: list[Symbol]) -> list[Any]:
        derivative, touch, _ = table.derivative(chart, state)
        return [*derivative, touch.force]

    return _recorded(scenario, 12, results)


class FreeBody:
    """A disk on a table that yields, in a chart that is regular in every attitude.

    Its state holds that of `Quaternion`, 13 numbers, and the energy taken so far by each of
    `dissipation.CAUSES` (6).

    Parameters
    ----------
    scenario : Scenario
        With a penalty contact.

    Raises
    ------
    ValueError
        If the contact is the ideal one.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.contact, self.disk = scenario.penalty_contact, scenario.disk

        def derivative(table: YieldingTable, state: list[Symbol]) -> list[Any]:
            found, _, powers = table.derivative(Quaternion, state)
            return [*found, *powers]

        self._derivative = _recorded(scenario, 13, derivative)
        forces = _forces(scenario)
        spring, normal_force = (
            np.vectorize(forces[name], otypes=[float]) for name in ("spring", "normal_force")
        )
        self._table = YieldingTable(scenario, spring, normal_force, scenario.friction.force)

    def derivative(self, _: float, state: Array) -> tuple[float, ...]:
        """Time derivative of the state, 19 numbers."""
        return self._derivative(*state[:13].tolist())

    def readings(self, states: Array) -> dict[str, Array]:
        """Arrays of a `SpatialMotion` by their names, from states, shape (n, 19)."""
        return self._table.readings(states[:, :13])


def _recorded(
    scenario: Scenario,
    size: int,
    results: Callable[[YieldingTable, list[Symbol]], list[Any]],
) -> Solver:
    """Code of results from a state of this size, with the numbers of a scenario in it."""
    is_simple = scenario.friction.is_simple
    force = friction_of(is_simple=is_simple)

    def friction(along: Symbol, across: Symbol, normal_force: Symbol) -> tuple[Any, Any]:
        return force(along, across, call("load", normal_force) if is_simple else normal_force)

    recorder = Recorder((), [f"s{number}" for number in range(size)])
    spring, normal_force = (partial(call, name) for name in ("spring", "normal_force"))
    table = YieldingTable(scenario, spring, normal_force, friction)
    code = recorder.code(results(table, recorder.variables))
    solver: Solver = code(speed=hypot, per_speed=scenario.friction.per_speed, **_forces(scenario))
    return solver


def friction_of(*, is_simple: bool) -> Friction:
    """Symbols of friction; a law that is not isotropic and in proportion is called as it is."""

    def simple(along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        factor = -(call("per_speed", call("speed", along, across)) * load)
        return factor * along, factor * across

    return simple if is_simple else partial(pair, "force")


def _forces(scenario: Scenario) -> dict[str, Callable[..., Any]]:
    """What of a contact may open: spring, spring and damper, and friction with its load."""
    contact, weight, law = scenario.penalty_contact, scenario.weight, scenario.friction
    by_weight = law.load == "weight"

    def spring(gap: float) -> float:
        return 0.0 if gap > 0.0 and not contact.bilateral else -contact.stiffness * gap

    def normal_force(gap: float, gap_rate: float) -> float:
        force = -contact.stiffness * gap - contact.damping * gap_rate
        lifted = not contact.bilateral and (gap > 0.0 or force < 0.0)
        return 0.0 if lifted else force

    def load(force: float) -> float:
        if by_weight and (force > 0.0 or contact.bilateral):
            return weight
        return max(0.0, force)

    def force(along: float, across: float, normal: float) -> tuple[float, float]:
        touches = normal > 0.0 or contact.bilateral
        return law.force(along, across, load(normal)) if touches else (0.0, 0.0)

    return {"spring": spring, "normal_force": normal_force, "load": load, "force": force}
