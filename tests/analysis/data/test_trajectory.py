"""What a trajectory accepts and how its columns are found."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis import COORDINATES, MODELS, Scenario, State, Trajectory, multiplier_names
from tests.helpers import random_trajectory

ARRAYS = ("times", "coordinates", "rates", "multipliers")


def changed(**changes: Any) -> Trajectory:
    return replace(random_trajectory(), **changes)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("coordinates", (5, 5)),
        ("rates", (4, 6)),
        ("multipliers", (5, 3)),
        ("multipliers", (5,)),
    ],
)
def test_wrong_shape_is_named(name: str, shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=rf"^{name} must have shape \(.*\), got \({shape[0]},"):
        changed(**{name: np.ones(shape)})


@pytest.mark.parametrize("name", ARRAYS)
def test_number_that_is_not_finite_is_named(name: str) -> None:
    values = getattr(random_trajectory(), name).copy()
    values[-1] = np.nan
    with pytest.raises(ValueError, match=f"^{name} must be finite$"):
        changed(**{name: values})


@pytest.mark.parametrize("times", [[0.0, 1.0, 1.0, 2.0, 3.0], [0.0, 1.0, 0.5, 2.0, 3.0]])
def test_times_must_increase(times: list[float]) -> None:
    with pytest.raises(ValueError, match=r"^times must increase strictly, got 1 before (1|0\.5)$"):
        changed(times=times)


@pytest.mark.parametrize("times", [[0.0], 0.0, [[0.0, 1.0]]])
def test_times_must_be_a_row_of_at_least_two(times: Any) -> None:
    with pytest.raises(
        ValueError, match=r"^times must be one-dimensional with at least 2 entries"
    ):
        changed(times=times)


def test_multipliers_must_be_those_of_the_scenarios_constraints() -> None:
    with pytest.raises(ValueError, match=r"^multipliers must have shape \(5, 1\), got \(5, 4\)$"):
        changed(scenario=Scenario())


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_are_the_trajectorys_own_and_cannot_be_changed(name: str) -> None:
    given = getattr(random_trajectory(), name).copy()
    kept = getattr(changed(**{name: given}), name)
    before = kept.copy()
    given += 1.0
    np.testing.assert_array_equal(kept, before)
    with pytest.raises(ValueError, match=r"read-only"):
        kept[0] = 0.0


def test_columns_are_found_by_name() -> None:
    motion = random_trajectory(4)
    for column, name in enumerate(COORDINATES):
        np.testing.assert_array_equal(motion.coordinate(name), motion.coordinates[:, column])
        np.testing.assert_array_equal(motion.rate(name), motion.rates[:, column])
    for column, name in enumerate(multiplier_names(MODELS[4])):
        np.testing.assert_array_equal(motion.multiplier(name), motion.multipliers[:, column])
    np.testing.assert_array_equal(motion.normal_force, motion.multipliers[:, 0])


def test_unknown_columns_are_refused() -> None:
    motion = random_trajectory(2)
    with pytest.raises(ValueError, match=r"^coordinate must be one of x, y, .*, got 'delta'$"):
        motion.coordinate("delta")
    with pytest.raises(ValueError, match=r"^multiplier must be one of .*, got 'spin_torque'$"):
        motion.multiplier("spin_torque")


def test_state_is_one_sample() -> None:
    motion = random_trajectory()
    expected = State(
        coordinates=tuple(motion.coordinates[2].tolist()), rates=tuple(motion.rates[2].tolist())
    )
    assert motion.state(2) == expected


def test_trajectory_is_equal_to_itself_alone() -> None:
    motion = random_trajectory()
    assert {motion: "kept"}[motion] == "kept"
    assert motion != replace(motion)
