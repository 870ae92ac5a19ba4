"""Curves followed by pseudo-arclength."""

import numpy as np
import pytest

from analysis.problem.checks import Array
from analysis.solve.continuation import Curve

ANYWHERE = np.full(2, -np.inf), np.full(2, np.inf)


def circle(points: Array) -> Array:
    return np.sum(points**2, axis=1, keepdims=True) - 1.0


def line(points: Array) -> Array:
    return points[:, 1:] - 0.5 * points[:, :1]


def hairpin(points: Array) -> Array:
    x, y = points.T
    return np.column_stack((y * y - 1e-4 * (x + 1e-4),))


def test_a_closed_curve_begins_and_ends_where_it_was_begun() -> None:
    start = np.array((1.0, 0.0))
    points = np.array(Curve(circle, ANYWHERE, 0.1).through(start))
    np.testing.assert_array_equal(points[[0, -1]], [start, start])
    np.testing.assert_allclose(np.hypot(*points.T), 1.0, atol=1e-12)
    turns = np.unwrap(np.arctan2(*points.T[::-1]))
    assert abs(turns[-1]) == pytest.approx(2.0 * np.pi)
    assert np.max(np.abs(np.diff(turns))) < 0.11


def test_a_curve_that_comes_back_beside_its_start_is_not_closed() -> None:
    x = 0.3
    start = np.array((x, 1e-2 * np.sqrt(x + 1e-4)))
    bounds = np.full(2, -1.0), np.full(2, 1.0)
    points = np.array(Curve(hairpin, bounds, 0.05).through(start))
    np.testing.assert_allclose(points[[0, -1], 0], 1.0, atol=1e-12)
    assert points[0, 1] * points[-1, 1] < 0.0
    # It goes round the fold, and not across.
    assert np.min(points[:, 0]) == pytest.approx(-1e-4, abs=1e-5)
    chords = np.diff(points, axis=0)
    chords /= np.linalg.norm(chords, axis=1, keepdims=True)
    assert np.min(np.sum(chords[1:] * chords[:-1], axis=1)) > 0.95


@pytest.mark.parametrize("unknown", [0, 1])
def test_a_curve_ends_at_the_bound_that_it_meets_first(unknown: int) -> None:
    bounds = np.full(2, -1.0), np.full(2, np.inf)
    bounds[1][unknown] = 0.3
    points = Curve(line, bounds, 0.07).through(np.zeros(2))
    np.testing.assert_allclose(points[0], (-1.0, -0.5), atol=1e-12)
    np.testing.assert_allclose(points[-1], ((0.3, 0.15), (0.6, 0.3))[unknown], atol=1e-12)


def test_a_curve_that_begins_at_a_bound_goes_one_way() -> None:
    points = Curve(line, (np.zeros(2), np.ones(2)), 0.3).through(np.zeros(2))
    np.testing.assert_allclose([points[0], points[-1]], [(0.0, 0.0), (1.0, 0.5)], atol=1e-12)


def test_a_curve_that_goes_on_without_end_says_so() -> None:
    with pytest.raises(ArithmeticError, match="has more than 2000 points one way, and goes on"):
        Curve(line, ANYWHERE, 0.1).through(np.zeros(2))
