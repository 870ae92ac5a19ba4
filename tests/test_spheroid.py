"""The spheroid's contact point: lowest point, limits, and its velocity along the rim."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.data.checks import Array
from analysis.rest.free_disk import cross
from analysis.rest.spheroid import Vector3, contact_point, contour_velocity, support_height

RADIUS, HALF = 0.045, 2e-3


def vector(values: Array) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z


@pytest.mark.parametrize("seed", range(5))
def test_contact_point_is_the_lowest_of_many_points_of_the_surface(seed: int) -> None:
    rng = np.random.default_rng(seed)
    upward = Rotation.random(random_state=seed).as_matrix()[2]
    sphere = rng.normal(size=(20000, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    heights = (sphere * (RADIUS, RADIUS, HALF)) @ upward
    point = np.array(contact_point(RADIUS, HALF, vector(upward)))
    assert np.sum((point / (RADIUS, RADIUS, HALF)) ** 2) == pytest.approx(1.0)
    assert point @ upward <= heights.min()
    assert point @ upward == pytest.approx(-support_height(RADIUS, HALF, vector(upward)))


@pytest.mark.parametrize("face", [1.0, -1.0])
def test_flat_disk_has_a_smooth_contact_on_either_face(face: float) -> None:
    assert contact_point(RADIUS, HALF, (0.0, 0.0, face)) == (0.0, 0.0, -face * HALF)
    x, y, _ = contact_point(RADIUS, HALF, (1e-9, 0.0, face))
    assert x == pytest.approx(-(RADIUS**2) / HALF * 1e-9)
    assert y == 0.0


@pytest.mark.parametrize("beta", [0.5, 1.0, 1.5])
def test_spheroid_lies_above_the_thin_disk_by_a_second_order_height(beta: float) -> None:
    upward = (np.sin(beta), 0.0, np.cos(beta))
    halves = np.array((1e-4, 1e-5))
    errors = [support_height(RADIUS, h, upward) - RADIUS * np.sin(beta) for h in halves]
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
        return np.array(contact_point(RADIUS, HALF, vector(turned)))

    step = 1e-5
    velocity = contour_velocity(
        RADIUS, HALF, vector(upward), cross(vector(upward), vector(angular))
    )
    np.testing.assert_allclose(velocity, (after(step) - after(-step)) / (2 * step), atol=1e-8)
    assert abs(np.dot(velocity, upward)) < 1e-15


def test_contour_speed_of_a_thin_standing_disk_is_radius_times_rolling_rate() -> None:
    beta, rolling = 1.2, 3.0
    upward = (0.0, np.sin(beta), np.cos(beta))
    velocity = contour_velocity(RADIUS, 1e-7, upward, cross(upward, (0.0, 0.0, rolling)))
    np.testing.assert_allclose(velocity, (-RADIUS * rolling, 0.0, 0.0), atol=1e-9)
