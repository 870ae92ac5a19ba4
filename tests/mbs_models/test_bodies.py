"""Bodies other than the paper's disk in the engine, against the in-house side."""

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LOADS,
    POSSIBLE_SETS,
    Body,
    ConstraintSet,
    Dissipation,
    Load,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.data.constraint_set import set_name
from analysis.mechanics.recorded import accelerations
from mbs_models import Scene
from tests.bodies import BODIES, COMPOSED, TIPPE_TOP, random_start, spinning_top
from tests.helpers import assert_close, not_none

every_body = pytest.mark.parametrize("body", BODIES.values(), ids=list(BODIES))

TABLE = Table(inclination=0.2, downhill=0.5)
START = Start(beta=1.3, gamma=0.4, spin=12.0, beta_rate=0.5)


def compare(scenario: Scenario) -> None:
    """Accelerations and forces of every formulation with the in-house ones."""
    state = scenario.initial_state
    expected, force = accelerations(scenario, state.coordinates, state.rates)
    built = mbs_models.formulations(scenario)
    assert built
    for formulation in built:
        found, pressing = mbs_models.acceleration(Scene(scenario, formulation))
        assert_close(found, expected, relative=1e-9)
        assert_close(pressing, force, relative=1e-9)


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_composed_disk_has_the_same_accelerations(constraints: ConstraintSet) -> None:
    friction = SmoothCoulomb(load="contact")
    compare(
        Scenario(
            disk=COMPOSED,
            constraints=constraints,
            friction=friction,
            start=Start(beta=1.2, gamma=0.4, spin=12.0),
        )
    )


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("rounded", [False, True])
@every_body
def test_bodies_have_the_same_accelerations_on_a_yielding_table(
    body: Body, rounded: bool, seed: int, load: Load
) -> None:
    contact = PenaltyContact.damped(1e5, body)
    if rounded:
        contact = PenaltyContact.rounded(body, stiffness=1e5)
    losses = Dissipation(rolling_dry=1e-3, rolling_viscous=1e-3, pivoting=1e-4)
    scenario = Scenario(
        disk=body,
        contact=contact,
        dissipation=losses,
        table=TABLE,
        friction=SmoothCoulomb(load=load),
        start=random_start(seed),
    )
    compare(scenario)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("seed", range(3))
def test_sphere_has_the_same_accelerations_on_the_ideal_contact(seed: int, load: Load) -> None:
    friction = SmoothCoulomb(load=load)
    compare(Scenario(disk=TIPPE_TOP, table=TABLE, friction=friction, start=random_start(seed)))


@every_body
def test_bodies_go_the_same_way_through_every_attitude(body: Body) -> None:
    losses = Dissipation(rolling_dry=1e-3, rolling_viscous=1e-3, pivoting=1e-4)
    contact = PenaltyContact.rounded(body, stiffness=2e4)
    scenario = Scenario(disk=body, contact=contact, dissipation=losses, start=START)
    one = analysis.simulate_to_rest(scenario, 0.1, tolerance=1e-7)
    other = mbs_models.simulate_to_rest(scenario, 0.1, tolerance=1e-7)
    assert one.deviation(other) < 1e-7
    np.testing.assert_allclose(other.contact_points, one.contact_points, atol=1e-8)
    np.testing.assert_allclose(other.contour_speeds, one.contour_speeds, atol=1e-5)


@pytest.mark.slow
def test_tippe_top_turns_over_at_the_same_time() -> None:
    scenario = spinning_top()
    one = analysis.simulate_to_rest(scenario, 2.4, tolerance=1e-6)
    other = mbs_models.simulate_to_rest(scenario, 2.4, tolerance=1e-6)
    assert one.deviation(other) < 1e-7
    turned = not_none(one.inversion.time)
    assert not_none(other.inversion.time) == pytest.approx(turned, abs=1e-7)
