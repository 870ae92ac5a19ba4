"""Energy, power and the work of the constraints."""

from pathlib import Path

import numpy as np
import pytest

import mbs_models
from analysis import (
    GRAVITY,
    LEVELS,
    LOADS,
    STEEL_DISK,
    Disk,
    Dissipation,
    Level,
    Load,
    PenaltyContact,
    SmoothCoulomb,
    State,
    Trajectory,
    consistent_start,
    simulate_to_rest,
)
from analysis.data.checks import Array
from analysis.models import balance, equations, index1
from tests.helpers import (
    angular_velocity,
    arc,
    cog,
    derivative,
    random_disk,
    random_sample,
    random_state,
    spin_momentum,
)

levels = pytest.mark.parametrize("level", LEVELS)
loads = pytest.mark.parametrize("load", LOADS)
seeds = pytest.mark.parametrize("seed", range(3))


@levels
@loads
@seeds
def test_multipliers_do_no_work(level: Level, load: Load, seed: int) -> None:
    random = np.random.default_rng(seed)
    disk = random_disk(random)
    first, second = _two_motions(level, disk, random)
    z, u = np.array(first.coordinates), np.array(first.rates)
    a, forces = index1.accelerations(level, disk, SmoothCoulomb(load=load), z, u)
    weight = disk.weight if load == "weight" else forces[0]
    constraint_force = (
        equations.mass_matrix(disk, z) @ a
        - equations.gyroscopic_forces(disk, z, u)
        - equations.gravity_forces(disk, z)
        - weight * index1.friction_per_load(level, disk, SmoothCoulomb(load=load), z, u)
    )
    virtual = np.array(second.rates) - u
    assert np.max(np.abs(virtual)) > 0.1
    work = constraint_force @ virtual
    assert work == pytest.approx(0.0, abs=1e-12 * float(np.max(np.abs(constraint_force))))


def _two_motions(level: Level, disk: Disk, random: np.random.Generator) -> tuple[State, State]:
    """Two admissible velocities at one place; with the same spin, which Model 4 prescribes."""
    beta, gamma, spin = random.uniform(0.4, 2.7), random.uniform(-3, 3), random.uniform(-1.5, 1.5)
    first, second = (
        consistent_start(
            level,
            disk,
            beta=beta,
            gamma=gamma,
            spin=spin if level == 4 else random.uniform(-1.5, 1.5),
            beta_rate=random.uniform(-1.5, 1.5),
            gamma_rate=random.uniform(-1.5, 1.5) if level < 3 else None,
        )
        for _ in range(2)
    )
    return first, second


@seeds
def test_energies_are_those_of_the_moving_cog_and_the_turning_body(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, u) = random_disk(random), random_state(random)
    path = arc(z, u, np.zeros(6))
    speed = derivative(lambda t: cog(disk, path(t)))
    turning = angular_velocity(path) @ spin_momentum(disk, path, 0.0)
    kinetic, potential = balance.energies(disk, z[np.newaxis], u[np.newaxis])
    assert kinetic[0] == pytest.approx((disk.mass * speed @ speed + turning) / 2, rel=1e-11)
    assert potential[0] == pytest.approx(disk.mass * GRAVITY * cog(disk, z)[2], rel=1e-12)


@levels
@loads
@seeds
def test_power_is_the_rate_of_the_energy(level: Level, load: Load, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    a, forces = index1.accelerations(level, disk, SmoothCoulomb(load=load), z, u)
    path = arc(z, u, a)

    def energy(t: float) -> Array:
        return np.concatenate(balance.energies(disk, path(t)[None], (u + t * a)[None]))

    still = Trajectory(
        times=np.array([0.0, 1.0]),
        coordinates=np.array([z, z]),
        rates=np.array([u, u]),
        multipliers=np.array([forces, forces]),
        level=level,
        disk=disk,
        friction=SmoothCoulomb(load=load),
        source="in-house",
        method={},
    )
    gain = float(np.sum(derivative(energy)))
    assert balance.power(still)[0] == pytest.approx(gain, rel=1e-10)


@levels
@seeds
def test_friction_takes_energy(level: Level, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    assert index1.friction_per_load(level, disk, SmoothCoulomb(), z, u) @ u < 0.0


def test_balance_refuses_a_motion_whose_losses_it_does_not_know(tmp_path: Path) -> None:
    rolling = Dissipation(rolling_viscous=1e-3, pivoting=5e-5)
    run = simulate_to_rest(0.1, dissipation=rolling).to_trajectory()
    run.save(tmp_path / "run.npz")
    for known in (run, Trajectory.load(tmp_path / "run.npz")):
        with pytest.raises(ValueError, match="stiffness, damping, rolling_viscous, pivoting;"):
            balance.energy_residual(known)


def test_balance_refuses_a_penalty_contact_whose_spring_it_does_not_know() -> None:
    scene = mbs_models.Scene(contact=PenaltyContact(stiffness=1e5), disk=STEEL_DISK)
    run = mbs_models.simulate(scene, [0.0, 0.01], step=1e-3)
    with pytest.raises(ValueError, match="holds nothing of its stiffness;"):
        balance.energy_residual(run)
