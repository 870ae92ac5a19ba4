"""The way between the co-rotating coordinates and the inertial frame."""

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.data import frames
from analysis.data.checks import Array
from tests.helpers import (
    OUTER_STEP,
    angular_velocity,
    arc,
    assert_close,
    centre,
    derivative,
    random_state,
    rotation,
    second_derivative,
)

seeds = pytest.mark.parametrize("seed", range(5))


def states(seed: int, count: int = 20) -> tuple[Array, Array]:
    random = np.random.default_rng(seed)
    rows = [random_state(random) for _ in range(count)]
    return np.array([z for z, _ in rows]), np.array([u for _, u in rows])


def motion(seed: int) -> tuple[Callable[[float], Array], Array, Array, Array]:
    """Path through one random state with its coordinates, rates and accelerations there."""
    random = np.random.default_rng(seed)
    z, u = random_state(random)
    a = random.uniform(-2.0, 2.0, size=6)
    return arc(z, u, a), z, u, a


@seeds
def test_poses_are_three_euler_turns_and_the_turned_place(seed: int) -> None:
    z, _ = states(seed)
    position, turn = frames.poses(z)
    assert_close(turn, np.array([rotation(row) for row in z]), relative=1e-14)
    assert_close(position, np.array([centre(row) for row in z]), relative=1e-14)


@seeds
def test_coordinates_come_back_from_poses_and_twists(seed: int) -> None:
    z, u = states(seed)
    back_z, back_u = frames.from_poses(*frames.poses(z), *frames.twists(z, u))
    assert_close(back_z, z, relative=1e-14)
    assert_close(back_u, u, relative=1e-14)


def test_angles_from_poses_lie_in_the_principal_range() -> None:
    z, u = states(0)
    wound = z + 2.0 * pi * np.array([0.0, 0.0, 0.0, 3.0, 0.0, -2.0])
    back, _ = frames.from_poses(*frames.poses(wound), *frames.twists(wound, u))
    assert_close(back, z, relative=1e-13)


@pytest.mark.parametrize("beta", [1e-3, pi - 1e-3])
def test_coordinates_come_back_near_the_singular_tilts(beta: float) -> None:
    z, u = states(1)
    z[:, 4] = beta
    back_z, back_u = frames.from_poses(*frames.poses(z), *frames.twists(z, u))
    # Rounding is magnified by 1 / sin(beta), and for the rates by its square.
    assert_close(back_z, z, relative=1e-12)
    assert_close(back_u, u, relative=1e-9)


@seeds
def test_twists_are_the_change_of_the_pose(seed: int) -> None:
    path, z, u, _ = motion(seed)
    velocity, angular = frames.twists(z[np.newaxis], u[np.newaxis])
    assert_close(velocity[0], derivative(lambda t: centre(path(t))))
    assert_close(angular[0], angular_velocity(path))


@seeds
def test_accelerations_come_back_from_the_inertial_ones(seed: int) -> None:
    path, z, u, a = motion(seed)
    acceleration = second_derivative(lambda t: centre(path(t)))
    angular = derivative(lambda t: angular_velocity(path, t), OUTER_STEP)
    back = frames.accelerations_from_inertial(
        z[np.newaxis], u[np.newaxis], acceleration[np.newaxis], angular[np.newaxis]
    )
    assert_close(back[0], a, relative=1e-10)


def test_quaternions_and_rotations_are_those_of_scipy_and_each_others_inverse() -> None:
    known = Rotation.random(200, random_state=4)
    x, y, z, w = known.as_quat().T
    found = frames.rotations(np.column_stack((w, x, y, z)))
    np.testing.assert_allclose(found, known.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(frames.rotations(frames.quaternions(found)), found, atol=1e-14)
    np.testing.assert_allclose(np.cos(frames.tilts(found)), found[:, 2, 2], atol=1e-14)
