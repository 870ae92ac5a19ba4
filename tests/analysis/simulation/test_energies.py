"""Energy, power and the work of the constraints."""

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LOADS,
    ConstraintSet,
    Dissipation,
    Load,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    simulate,
    simulate_to_rest,
)
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from tests.helpers import (
    angular_velocity,
    arc,
    cog,
    derivative,
    more_sets,
    random_disk,
    random_scenario,
    random_state,
    random_table,
    spin_momentum,
)


@pytest.mark.parametrize("seed", range(3))
def test_energies_are_those_of_the_moving_cog_and_the_turning_body(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, table = random_disk(random, products=0.1), random_table(random)
    z, u = random_state(random)
    scenario = Scenario(disk=disk, table=table)
    path = arc(z, u, np.zeros(6))
    speed = derivative(lambda t: cog(disk, path(t)))
    turning = angular_velocity(path) @ spin_momentum(disk, path, 0.0)
    kinetic, potential = analysis.energies(scenario, z[np.newaxis], u[np.newaxis])
    assert kinetic[0] == pytest.approx((disk.mass * speed @ speed + turning) / 2, rel=1e-11)
    expected = -disk.mass * np.array(table.vector) @ cog(disk, z)
    assert potential[0] == pytest.approx(expected, rel=1e-12)


@more_sets
@pytest.mark.parametrize("load", LOADS)
def test_power_is_the_rate_of_the_energy(constraints: ConstraintSet, load: Load) -> None:
    scenario, z, u = random_scenario(constraints, 0, SmoothCoulomb(load=load))
    a, _ = accelerations(scenario, z, u)
    path = arc(z, u, a)

    def energy(t: float) -> Array:
        return np.concatenate(analysis.energies(scenario, path(t)[None], (u + t * a)[None]))

    run = simulate(scenario, [0.0, 1e-3], local_tolerance=1e-3)
    gain = float(np.sum(derivative(energy)))
    assert analysis.power(run)[0] == pytest.approx(gain, rel=1e-10, abs=1e-10)


def test_balance_refuses_a_motion_whose_losses_it_does_not_know() -> None:
    rolling = Dissipation(rolling_viscous=1e-3, pivoting=5e-5)
    yielding = Scenario(contact=PenaltyContact(stiffness=1e5))
    runs = (
        simulate_to_rest(Scenario.rest(dissipation=rolling), 0.1).to_trajectory(),
        simulate(yielding, [0.0, 0.01], local_tolerance=1e-6),
        mbs_models.simulate(yielding, [0.0, 0.01], step=1e-3),
    )
    for each in runs:
        with pytest.raises(ValueError, match=r"must hold all .* a penalty contact does"):
            analysis.energy_residual(each)
