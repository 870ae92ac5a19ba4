"""The index-1 systems against Newton's and Euler's laws and their constraints."""

from collections.abc import Callable
from dataclasses import replace
from math import hypot

import numpy as np
import pytest

from analysis import (
    GRAVITY,
    LEVELS,
    LOADS,
    STEEL_DISK,
    Disk,
    Level,
    Load,
    SmoothCoulomb,
    consistent_start,
    multiplier_names,
)
from analysis.data.checks import Array
from analysis.models import equations, index1
from tests.helpers import (
    OUTER_STEP,
    arc,
    assert_close,
    centre,
    cog,
    contact_arm,
    derivative,
    random_disk,
    random_sample,
    random_state,
    second_derivative,
    slip,
    spin_momentum,
    turn_z,
)

levels = pytest.mark.parametrize("level", LEVELS)
loads = pytest.mark.parametrize("load", LOADS)
seeds = pytest.mark.parametrize("seed", range(3))


def solved(
    level: Level, disk: Disk, friction: SmoothCoulomb, z: Array, u: Array
) -> tuple[Callable[[float], Array], dict[str, float]]:
    """Path of the disk around time 0 and all multipliers, those that are missing as zeros."""
    a, forces = index1.accelerations(level, disk, friction, z, u)
    multipliers = dict.fromkeys(multiplier_names(4), 0.0)
    multipliers.update(zip(multiplier_names(level), forces.tolist(), strict=True))
    return arc(z, u, a), multipliers


def friction_in_frame(
    level: Level, friction: SmoothCoulomb, load: float, slip_x: float, slip_y: float
) -> Array:
    """Eq. (3), in R-frame axes; Models 3 and 4 slide along e_y alone."""
    if level >= 3:
        slip_x = 0.0
    scale = friction.coefficient * load / (hypot(slip_x, slip_y) + friction.smoothing)
    force: Array = -scale * np.array([slip_x, slip_y, 0.0])
    return force


def contact_force(
    level: Level,
    disk: Disk,
    friction: SmoothCoulomb,
    path: Callable[[float], Array],
    multipliers: dict[str, float],
) -> Array:
    """Force of the table on the disk in R-frame axes."""
    normal = multipliers["normal_force"]
    load = normal if friction.load == "contact" else disk.mass * GRAVITY
    rubbing = friction_in_frame(level, friction, load, *slip(disk, path).tolist())
    force: Array = rubbing + np.array([multipliers["tangential_force"], 0.0, normal])
    return force


@levels
@loads
@seeds
def test_forces_change_the_momentum(level: Level, load: Load, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    path, multipliers = solved(level, disk, SmoothCoulomb(load=load), z, u)
    in_frame = contact_force(level, disk, SmoothCoulomb(load=load), path, multipliers)
    in_frame += np.array([multipliers["cog_force_x"], multipliers["cog_force_y"], 0.0])
    force = turn_z(z[3]) @ in_frame - np.array([0.0, 0.0, disk.mass * GRAVITY])
    momentum_rate = disk.mass * second_derivative(lambda t: cog(disk, path(t)))
    assert_close(momentum_rate, force, relative=1e-10)


@levels
@loads
@seeds
def test_moments_change_the_angular_momentum(level: Level, load: Load, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    path, multipliers = solved(level, disk, SmoothCoulomb(load=load), z, u)
    force = turn_z(z[3]) @ contact_force(level, disk, SmoothCoulomb(load=load), path, multipliers)
    arm = centre(z) + contact_arm(disk, z) - cog(disk, z)
    # The couple works on alpha alone: it has no part along e_x^R nor along the disk's axis, so it
    # acts along the line through G and the contact, with spin_torque as its vertical part.
    line = contact_arm(disk, z) / contact_arm(disk, z)[2]
    moment = np.cross(arm, force) + multipliers["spin_torque"] * line
    momentum_rate = derivative(lambda t: spin_momentum(disk, path, t), OUTER_STEP)
    assert_close(momentum_rate, moment, relative=1e-10)


@levels
@loads
@seeds
def test_contact_stays_closed(level: Level, load: Load, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    path, _ = solved(level, disk, SmoothCoulomb(load=load), z, u)

    def distance(t: float) -> Array:
        return centre(path(t))[2:] + contact_arm(disk, path(t))[2:]

    np.testing.assert_allclose(second_derivative(distance), 0.0, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("level", [2, 3, 4])
@loads
@seeds
def test_cog_stays_above_the_origin(level: Level, load: Load, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    path, _ = solved(level, disk, SmoothCoulomb(load=load), z, u)
    drift = second_derivative(lambda t: cog(disk, path(t))[:2])
    np.testing.assert_allclose(drift, 0.0, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("level", [3, 4])
@loads
@seeds
def test_rolling_models_gain_no_slip_along_the_track(level: Level, load: Load, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    path, _ = solved(level, disk, SmoothCoulomb(load=load), z, u)
    gain = derivative(lambda t: slip(disk, path, t)[:1], OUTER_STEP)
    np.testing.assert_allclose(gain, 0.0, rtol=0.0, atol=1e-10)


@loads
@seeds
def test_model_4_keeps_its_spin(load: Load, seed: int) -> None:
    disk, z, u = random_sample(4, seed)
    acceleration, _ = index1.accelerations(4, disk, SmoothCoulomb(load=load), z, u)
    assert acceleration[3] == pytest.approx(0.0, abs=1e-12)


@levels
@seeds
def test_contact_load_is_the_weight_load_with_its_coefficient_scaled(
    level: Level, seed: int
) -> None:
    disk, z, u = random_sample(level, seed)
    accelerations, forces = index1.accelerations(level, disk, SmoothCoulomb(load="contact"), z, u)
    scaled = SmoothCoulomb(coefficient=0.3 * forces[0] / disk.weight)
    expected = index1.accelerations(level, disk, scaled, z, u)
    assert_close(accelerations, expected[0])
    assert_close(forces, expected[1])


@pytest.mark.parametrize("level", [3, 4])
@seeds
def test_rolling_models_rub_across_the_track_alone(level: Level, seed: int) -> None:
    # A state that slips along the track, as numerical drift leaves it.
    random = np.random.default_rng(seed)
    disk, (z, u) = random_disk(random), random_state(random)
    force = index1.friction_per_load(level, disk, SmoothCoulomb(), z, u)
    across = slip(disk, arc(z, u, np.zeros(6)))[1]
    expected = friction_in_frame(level, SmoothCoulomb(), 1.0, 0.0, across)
    assert_close(force[:3], expected, relative=1e-11)
    assert force[5] == 0.0


@levels
@seeds
def test_motion_does_not_depend_on_the_direction_it_is_seen_from(level: Level, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    turned = z + np.array([0.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    seen = index1.accelerations(level, disk, SmoothCoulomb(load="contact"), z, u)
    elsewhere = index1.accelerations(level, disk, SmoothCoulomb(load="contact"), turned, u)
    np.testing.assert_array_equal(seen[0], elsewhere[0])
    np.testing.assert_array_equal(seen[1], elsewhere[1])


@loads
@seeds
def test_motion_does_not_depend_on_the_place_on_the_table(load: Load, seed: int) -> None:
    disk, z, u = random_sample(1, seed)
    shift = turn_z(-z[3]) @ np.array([0.7, -0.4, 0.0])
    moved, faster = z.copy(), u.copy()
    moved[:3] += shift
    # The same inertial velocity, seen in the turning frame from another place.
    faster[:3] -= u[3] * np.array([-shift[1], shift[0], 0.0])
    here, here_forces = solved(1, disk, SmoothCoulomb(load=load), z, u)
    there, there_forces = solved(1, disk, SmoothCoulomb(load=load), moved, faster)
    assert there_forces["normal_force"] == pytest.approx(here_forces["normal_force"], rel=1e-12)
    assert_close(
        second_derivative(lambda t: centre(there(t))),
        second_derivative(lambda t: centre(here(t))),
        relative=1e-9,
    )
    assert_close(
        second_derivative(lambda t: there(t)[3:]),
        second_derivative(lambda t: here(t)[3:]),
        relative=1e-9,
    )


def test_a_still_standing_disk_rests_on_its_weight() -> None:
    start = consistent_start(1, STEEL_DISK, gamma=np.pi / 2, spin=0.0)
    acceleration, forces = index1.accelerations(
        1, STEEL_DISK, SmoothCoulomb(), start.coordinates, start.rates
    )
    np.testing.assert_allclose(acceleration, 0.0, rtol=0.0, atol=1e-11)
    assert forces[0] == pytest.approx(STEEL_DISK.weight, rel=1e-12)


def test_a_flat_disk_is_called_singular() -> None:
    centred = replace(STEEL_DISK, eccentricity=0.0)
    flat = np.zeros(6)
    with pytest.raises(ArithmeticError, match="singular index-1 system of Model 1"):
        index1.accelerations(1, centred, SmoothCoulomb(), flat, np.ones(6))


@levels
@seeds
def test_friction_acts_along_the_papers_directions(level: Level, seed: int) -> None:
    disk, z, u = random_sample(level, seed)
    friction = SmoothCoulomb(coefficient=0.4, smoothing=0.02)
    W = equations.tangential_directions(disk, z)
    velocity = W.T @ u
    if level >= 3:
        velocity[0] = 0.0
    expected = -0.4 * W @ velocity / (np.linalg.norm(velocity) + 0.02)
    assert_close(index1.friction_per_load(level, disk, friction, z, u), expected)
