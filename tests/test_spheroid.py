"""The spheroid's contact point: lowest point, limits, and its velocity along the rim."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis import STEEL_DISK
from analysis.data.checks import Array
from analysis.mechanics.dual import rate
from analysis.mechanics.penalty import lowest_point

RADIUS, HALF = 0.045, 2e-3


def lowest(half: float, upward: Iterable[float]) -> Array:
    """Lowest point seen from the centre."""
    disk = replace(STEEL_DISK, radius=RADIUS)
    return np.array(lowest_point(disk, half, tuple(upward)))


def height(half: float, upward: Array) -> float:
    """Height of the centre over it."""
    return float(-lowest(half, upward) @ upward)


def contour(half: float, upward: Array, angular: Array) -> Array:
    """Velocity of the lowest point over the rim."""
    change = np.cross(upward, angular)
    disk = replace(STEEL_DISK, radius=RADIUS)
    return np.array(rate(lambda up: lowest_point(disk, half, up), upward, change))


@pytest.mark.parametrize("seed", range(5))
def test_contact_point_is_the_lowest_of_many_points_of_the_surface(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upward = Rotation.random(random_state=seed).as_matrix()[2]
    sphere = rng.normal(size=(20000, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    heights = (sphere * (RADIUS, RADIUS, HALF)) @ upward
    point = lowest(HALF, upward)
    assert np.sum((point / (RADIUS, RADIUS, HALF)) ** 2) == pytest.approx(1.0)
    assert point @ upward <= heights.min()


@pytest.mark.parametrize("face", [1.0, -1.0])
def test_flat_disk_has_a_smooth_contact_on_either_face(face: float) -> None:
    assert lowest(HALF, (0.0, 0.0, face)).tolist() == [0.0, 0.0, -face * HALF]
    x, y, _ = lowest(HALF, (1e-9, 0.0, face))
    assert x == pytest.approx(-(RADIUS**2) / HALF * 1e-9)
    assert y == 0.0


@pytest.mark.parametrize("beta", [0.5, 1.0, 1.5])
def test_spheroid_lies_above_the_thin_disk_by_a_second_order_height(beta: float) -> None:
    upward = np.array((np.sin(beta), 0.0, np.cos(beta)))
    halves = np.array((1e-4, 1e-5))
    errors = [height(h, upward) - RADIUS * np.sin(beta) for h in halves]
    expected = halves**2 * np.cos(beta) ** 2 / (2 * RADIUS * np.sin(beta))
    np.testing.assert_allclose(errors, expected, rtol=1e-4, atol=1e-17)
    # A torus, the other candidate, lies higher by a first-order height.
    assert errors[0] < 0.2 * halves[0] * (1 - np.sin(beta))


@pytest.mark.parametrize("seed", range(5))
def test_contour_velocity_is_the_rate_of_the_contact_point(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upward = Rotation.random(random_state=seed).as_matrix()[2]
    angular = rng.normal(size=3)

    def after(time: float) -> Array:
        # In the body frame, the vertical turns backwards.
        turned = Rotation.from_rotvec(-time * angular).apply(upward)
        return lowest(HALF, turned)

    step = 1e-5
    velocity = contour(HALF, upward, angular)
    np.testing.assert_allclose(velocity, (after(step) - after(-step)) / (2 * step), atol=1e-8)
    assert abs(np.dot(velocity, upward)) < 1e-15


def test_contour_speed_of_a_thin_standing_disk_is_radius_times_rolling_rate() -> None:
    beta, rolling = 1.2, 3.0
    upward = np.array((0.0, np.sin(beta), np.cos(beta)))
    velocity = contour(1e-7, upward, np.array((0.0, 0.0, rolling)))
    np.testing.assert_allclose(velocity, (-RADIUS * rolling, 0.0, 0.0), atol=1e-9)
