"""The rim on a yielding table: its motion in both charts, and the energy it loses."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from analysis import STEEL_DISK, Body, Dissipation, PenaltyContact, Scenario, Start, Table
from analysis.mechanics.attitude import EulerAngles, Quaternion, state_of
from analysis.mechanics.dual import of_floats, rate
from analysis.mechanics.penalty import YieldingTable, free_solver
from analysis.mechanics.recorded import solver
from analysis.problem.checks import Array
from analysis.problem.contact import CAUSES
from analysis.problem.elementary import cos, sin
from analysis.simulation.to_rest import start_vector
from tests.bodies import EGG, ELLIPSE
from tests.helpers import assert_close, derivative

HALF = 2e-3


def changes_of(scenario: Scenario, state: Array) -> Array:
    """Time derivative of a state that holds a quaternion."""
    solve = free_solver(scenario, Quaternion, of_floats(scenario.friction))
    return np.array(solve(*state[:13].tolist()))


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("half", [0.0, HALF])
def test_both_charts_of_the_attitude_give_the_same_motion(half: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    contact = PenaltyContact.damped(1e5, STEEL_DISK, half_thickness=half)
    losses = Dissipation(rolling_dry=1e-3, rolling_viscous=1e-3, pivoting=1e-4, air_drag=1.2)
    table = Table(inclination=0.2, downhill=rng.uniform(-3.0, 3.0))
    names = ("x_rate", "y_rate", "beta_rate", "gamma_rate")
    rates = dict(zip(names, rng.normal(size=4), strict=True))
    start = Start(beta=rng.uniform(0.3, 2.8), gamma=rng.uniform(-3.0, 3.0), spin=4.0, **rates)
    scenario = Scenario(contact=contact, table=table, dissipation=losses, start=start)
    state, disk = scenario.initial_state, scenario.disk

    def velocities(moving: Sequence[Any]) -> list[Any]:
        """Of S in inertial axes, and angular ones in those of the body."""
        c, s, (x, y, z) = cos(moving[3]), sin(moving[3]), moving[6:9]
        turning = EulerAngles.angular_velocity(moving[3:6], moving[9:])
        return [c * x - s * y, s * x + c * y, z, *turning]

    here = state_of(disk, state.coordinates, state.rates)
    *changes, force = solver(scenario)(*here)
    body = start_vector(disk, state)
    found = changes_of(scenario, body)[7:13]
    assert_close(found, rate(velocities, here, changes), relative=1e-12)
    readings = YieldingTable.of(scenario).readings(body[None])
    assert readings["normal_force"][0] == pytest.approx(force, rel=1e-12)


SURFACES = ((STEEL_DISK, 0.0), (STEEL_DISK, HALF), (ELLIPSE, HALF), (EGG, 0.0))
# Air presses on the faces of a round disk alone; its drag is the last cause.
TAKEN = [(*each, cause) for each in SURFACES for cause in CAUSES[2 : 5 + each[0].is_round_disk]]


@pytest.mark.parametrize(("body", "half", "cause"), TAKEN)
def test_energy_falls_by_what_is_taken(body: Body, half: float, cause: str) -> None:
    # A contact that may open has a kink where it does.
    contact = PenaltyContact(stiffness=1e5, damping=50.0, half_thickness=half, bilateral=True)
    start = Start(beta=1.1, gamma=0.3, spin=9.0, x_rate=0.2, y_rate=0.4, beta_rate=2.0)
    losses = Dissipation(**{cause: 1e-2})
    scenario = Scenario(disk=body, contact=contact, dissipation=losses, start=start)
    table, state = YieldingTable.of(scenario), start_vector(body, scenario.initial_state)
    state[9] -= 0.1
    change = changes_of(scenario, state)
    powers = change[13:]
    # The contact's damper and sliding are always there.
    np.testing.assert_array_equal(powers > 0.0, [each in (*CAUSES[:2], cause) for each in CAUSES])

    def energy(time: float) -> Array:
        return table.readings((state + time * change)[None])["energies"].sum(axis=1)

    assert derivative(energy, 1e-4) == pytest.approx(-powers.sum(), rel=1e-9)
