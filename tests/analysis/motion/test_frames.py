"""The way between the co-rotating coordinates and the inertial frame."""

from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.motion import frames
from analysis.problem.checks import Array
from tests.helpers import (
    angular_velocity,
    arc,
    assert_close,
    centre,
    derivative,
    random_state,
    rotation,
)


def states(seed: int, count: int = 20) -> tuple[Array, Array]:
    random = np.random.default_rng(seed)
    rows = [random_state(random) for _ in range(count)]
    return np.array([z for z, _ in rows]), np.array([u for _, u in rows])


def test_poses_are_three_euler_turns_and_the_turned_place_and_lead_back() -> None:
    z, u = states(0)
    z[:10, 4] = pi - 1e-3
    wound = z + 2.0 * pi * np.array([0.0, 0.0, 0.0, 3.0, 0.0, -2.0])
    position, turn = frames.poses(wound)
    assert_close(turn, np.array([rotation(row) for row in z]), relative=1e-14)
    assert_close(position, np.array([centre(row) for row in z]), relative=1e-14)
    back_z, back_u = frames.from_poses(position, turn, *frames.twists(wound, u))
    # Into the principal range; rounding is magnified by 1 / sin(beta), rates by its square.
    for rows, close, rates_close in ((slice(10), 1e-12, 1e-9), (slice(10, 20), 1e-14, 1e-14)):
        assert_close(back_z[rows], z[rows], relative=close)
        assert_close(back_u[rows], u[rows], relative=rates_close)


@pytest.mark.parametrize("seed", range(3))
def test_twists_are_the_change_of_the_pose(seed: int) -> None:
    random = np.random.default_rng(seed)
    (z, u), a = random_state(random), random.uniform(-2.0, 2.0, size=6)
    path = arc(z, u, a)
    velocity, angular = frames.twists(z[np.newaxis], u[np.newaxis])
    assert_close(velocity[0], derivative(lambda t: centre(path(t))))
    assert_close(angular[0], angular_velocity(path))


def test_quaternions_of_a_motion_keep_close_through_many_turns() -> None:
    turns = Rotation.from_rotvec(np.outer(np.linspace(0.0, 30.0, 301), (0.6, 0.0, 0.8)))
    steps = np.diff(frames.quaternions(turns.as_matrix()), axis=0)
    assert np.linalg.norm(steps, axis=1).max() < 0.051


def wobbling(count: int, least: float, face: float) -> tuple[Array, Array, Array, Array]:
    """Times, coordinates whose angles are whole, the same cut to a turn, and rates.

    The axis comes by the vertical at a least distance twice, while the disk spins and rolls.
    """
    times = np.linspace(0.0, 1.0, count)
    x, y = 0.3 * np.cos(2 * pi * times), np.full(count, least)
    x_rate = -0.6 * pi * np.sin(2 * pi * times)
    size = np.hypot(x, y)
    lean, lean_rate = np.arcsin(size), x * x_rate / size / np.sqrt(1.0 - size**2)
    whole, rates = np.zeros((2, count, 6))
    # The disk turns about its own axis by 20 rad in all, seen from above.
    whole[:, 3] = np.unwrap(np.arctan2(y, x))
    whole[:, 4] = np.where(face > 0.0, lean, pi - lean)
    whole[:, 5] = face * (20.0 * times - whole[:, 3])
    rates[:, 3] = -y * x_rate / size**2
    rates[:, 4], rates[:, 5] = face * lean_rate, face * (20.0 - rates[:, 3])
    cut = whole.copy()
    cut[1:, [3, 5]] = np.angle(np.exp(1j * whole[1:, [3, 5]]))
    return times, whole, cut, rates


@pytest.mark.parametrize("face", [1.0, -1.0])
@pytest.mark.parametrize("least", [0.1, 0.01, 1e-3])
def test_turns_are_followed_by_a_nearly_flat_disk_or_said_to_be_unseen(
    face: float, least: float
) -> None:
    for count in (20, 40, 80, 160, 10_000):
        times, whole, cut, rates = wobbling(count, least, face)
        unseen = frames.follow_turns(times, cut, rates, 0.0)
        # What is known to be right goes on from a place that may be wrong.
        apart = np.abs(np.diff(cut - whole, axis=0))[:, [3, 5]].max(axis=1)
        assert np.max(apart[~unseen], initial=0.0) < 1e-9
    assert not np.any(unseen)
    times, _, cut, rates = wobbling(20, 1e-3, face)
    assert np.any(frames.follow_turns(times, cut, rates, 0.0))


def test_a_fast_spin_is_followed_from_coarse_samples_by_its_rates() -> None:
    times = np.linspace(0.0, 1.0, 6)
    whole, rates = np.zeros((2, 6, 6))
    rates[:, 3], rates[:, 5] = 40.0, -3.0
    whole[:, 4] = 1.5
    whole += np.outer(times, rates[0])
    cut = whole.copy()
    cut[1:, [3, 5]] = np.angle(np.exp(1j * whole[1:, [3, 5]]))
    assert not np.any(frames.follow_turns(times, cut, rates, 10.0))
    np.testing.assert_allclose(cut, whole, atol=1e-12)
    # Two radians are nearer to what the rates say than any whole turn more or less, and too far.
    for angle in (3, 5):
        other = cut.copy()
        other[3:, angle] += 2.0
        unseen = frames.follow_turns(times, other, rates, 10.0)
        assert np.flatnonzero(unseen).tolist() == [2]
    # In the time between two samples it may as well fall and rise again.
    assert np.all(frames.follow_turns(times, cut, rates, 200.0))
