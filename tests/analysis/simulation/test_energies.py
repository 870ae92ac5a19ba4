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
from analysis.mechanics import paper
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from analysis.problem.constraints import PRESCRIBED, multiplier_names
from analysis.problem.start import COORDINATES
from tests.helpers import (
    all_sets,
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

loads = pytest.mark.parametrize("load", LOADS)
seeds = pytest.mark.parametrize("seed", range(3))


@seeds
def test_energies_are_those_of_the_moving_cog_and_the_turning_body(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, table = random_disk(random), random_table(random)
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
@loads
def test_power_is_the_rate_of_the_energy(constraints: ConstraintSet, load: Load) -> None:
    scenario, z, u = random_scenario(constraints, 0, SmoothCoulomb(load=load))
    a, _ = accelerations(scenario, z, u)
    path = arc(z, u, a)

    def energy(t: float) -> Array:
        return np.concatenate(analysis.energies(scenario, path(t)[None], (u + t * a)[None]))

    run = simulate(scenario, [0.0, 1e-3], local_tolerance=1e-3)
    gain = float(np.sum(derivative(energy)))
    assert analysis.power(run)[0] == pytest.approx(gain, rel=1e-10, abs=1e-10)


@all_sets
def test_friction_takes_energy_and_only_forces_that_keep_a_rate_bring_some(
    constraints: ConstraintSet,
) -> None:
    scenario, z, u = random_scenario(constraints, 1)
    along, across = paper.tangential_directions(scenario.disk, z).T @ u
    force = scenario.friction.force(along, across, scenario.weight)
    taken = force[0] * along + force[1] * across
    assert taken < -1e-3 if scenario.rubs else abs(taken) < 1e-24
    velocities = paper.constraint_directions(constraints, scenario.disk, z) @ u
    for name, velocity in zip(multiplier_names(constraints), velocities, strict=True):
        kept = u[COORDINATES.index(PRESCRIBED[name])] if name in PRESCRIBED else 0.0
        assert velocity == pytest.approx(kept, abs=1e-12)


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
