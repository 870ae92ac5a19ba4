"""The paper's printed equations against Lagrange's equations of the rigid body."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import sympy

from analysis import MODELS, STEEL_DISK, ConstraintSet, Disk, Scenario, Table
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.mechanics import paper
from tests.helpers import (
    all_sets,
    assert_close,
    cog,
    derivative,
    jacobian,
    parameter_values,
    random_disk,
    random_state,
    rigid_body,
    rotation,
    slip,
    turn_z,
)

PREFIXES = {"co-rotating": "", "inertial": "inertial_"}

ROLLING: ConstraintSet = ("contact", "no-slip-along", "no-slip-across")

seeds = pytest.mark.parametrize("seed", range(5))


LEVEL = Table()


class Derived(NamedTuple):
    mass_matrix: Array
    gyroscopic_forces: Array
    gravity_forces: Array
    normal_direction: Array
    tangential_directions: Array


@cache
def _numeric(frame: str) -> Callable[..., list[Array]]:
    body = rigid_body(rotating=frame == "co-rotating")
    terms = [
        body.mass_matrix,
        body.gyroscopic_forces,
        body.gravity_forces,
        body.normal_direction,
        body.tangential_directions,
    ]
    arguments = [body.parameters, body.coordinates, body.rates]
    function: Callable[..., list[Array]] = sympy.lambdify(arguments, terms, cse=True)
    return function


@pytest.fixture(scope="module", params=list(PREFIXES))
def frame(request: pytest.FixtureRequest) -> str:
    """Name of the coordinates, whose equations are derived before the tests."""
    name: str = request.param
    _numeric(name)
    return name


def derived(frame: str, disk: Body, z: Array, u: Array, table: Table = LEVEL) -> Derived:
    M, h, f, w_N, W_T = _numeric(frame)(parameter_values(disk, table), z, u)
    return Derived(M, h[:, 0], f[:, 0], w_N[:, 0], W_T)


def printed(frame: str, name: str) -> Callable[..., Array]:
    """One of the printed formulas in the coordinates of a frame."""
    function: Callable[..., Array] = getattr(paper, PREFIXES[frame] + name)
    return function


def sample(seed: int) -> tuple[Disk, Array, Array]:
    random = np.random.default_rng(seed)
    return random_disk(random), *random_state(random)


@seeds
def test_gyroscopic_forces_are_those_of_lagrange(frame: str, seed: int) -> None:
    disk, z, u = sample(seed)
    found = printed(frame, "gyroscopic_forces")(disk, z, u)
    assert_close(found, derived(frame, disk, z, u).gyroscopic_forces)


@seeds
def test_gravity_is_the_falling_gradient_of_the_cog_height(frame: str, seed: int) -> None:
    disk, z, u = sample(seed)
    forces = paper.gravity_forces(Scenario(disk=disk), z)
    assert_close(forces, derived(frame, disk, z, u).gravity_forces)


@seeds
@pytest.mark.parametrize(
    "name",
    [
        pytest.param("mass_matrix", id="mass matrix belongs to the kinetic energy"),
        pytest.param("normal_direction", id="is the gradient of the contact height"),
        pytest.param("tangential_directions", id="give the contact point's velocity"),
    ],
)
def test_matrices_and_directions_are_those_derived(name: str, frame: str, seed: int) -> None:
    disk, z, u = sample(seed)
    # The normal direction is the same in both.
    of = paper.normal_direction if name == "normal_direction" else printed(frame, name)
    assert_close(of(disk, z), getattr(derived(frame, disk, z, u), name))


@seeds
def test_gyroscopic_forces_are_quadratic_in_the_rates(seed: int) -> None:
    disk, z, u = sample(seed)
    once = paper.gyroscopic_forces(disk, z, u)
    assert_close(paper.gyroscopic_forces(disk, z, -3.0 * u), 9.0 * once)


def _inertial_coordinates(z: Array) -> Array:
    """Inertial coordinates q(z) of Eq. (10)."""
    c, s = np.cos(z[3]), np.sin(z[3])
    return np.array([c * z[0] - s * z[1], s * z[0] + c * z[1], *z[2:]])


@seeds
def test_rate_matrix_is_the_derivative_of_the_inertial_coordinates(seed: int) -> None:
    _, z, u = sample(seed)
    rates = derivative(lambda t: _inertial_coordinates(z + t * u))
    assert_close(paper.rate_matrix(z) @ u, rates)


@seeds
def test_contact_distance_is_the_height_of_the_lowest_point_of_the_rim(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    around = np.linspace(-np.pi, np.pi, 200_001)
    rim = disk.radius * np.array([np.cos(around), np.sin(around), np.zeros_like(around)])
    lowest = np.min(z[2] + rotation(z)[2] @ rim)
    # The lowest of the sampled points lies at most radius * step² / 8 above the lowest of all.
    assert paper.constraint_positions(MODELS[1], disk, z)[0] == pytest.approx(lowest, abs=1e-9)


@seeds
def test_cog_constraint_holds_the_cog_above_the_origin(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    in_frame = turn_z(-z[3]) @ cog(disk, z)
    assert_close(paper.constraint_positions(MODELS[2], disk, z)[1:], in_frame[:2])


@all_sets
@seeds
def test_directions_are_the_gradient_of_the_positions(
    constraints: ConstraintSet, seed: int
) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    gradient = jacobian(lambda place: paper.constraint_positions(constraints, disk, place), z)
    assert_close(paper.constraint_directions(constraints, disk, z)[: len(gradient)], gradient)


@all_sets
@seeds
def test_acceleration_terms_are_the_change_of_the_directions(
    constraints: ConstraintSet, seed: int
) -> None:
    random = np.random.default_rng(seed)
    disk, (z, u) = random_disk(random), random_state(random)
    change = derivative(lambda t: paper.constraint_directions(constraints, disk, z + t * u))
    terms = paper.constraint_changes(constraints, disk, z, u)
    np.testing.assert_allclose(terms, change @ u, rtol=0.0, atol=1e-11)


@seeds
def test_slip_rows_give_the_contact_points_velocity(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, u) = random_disk(random), random_state(random)
    velocity = slip(disk, lambda t: z + t * u)
    np.testing.assert_allclose(
        paper.constraint_directions(ROLLING, disk, z)[1:] @ u, velocity, rtol=1e-11
    )


@seeds
def test_contact_forces_have_the_directions_of_the_equations(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    found = paper.constraint_directions(ROLLING, disk, z)
    np.testing.assert_array_equal(found[0], paper.normal_direction(disk, z))
    np.testing.assert_array_equal(found[1:].T, paper.tangential_directions(disk, z))


def test_spin_row_is_the_rate_of_alpha_alone() -> None:
    z, _ = random_state(np.random.default_rng(0))
    row = paper.constraint_directions(MODELS[4], STEEL_DISK, z)[4]
    np.testing.assert_array_equal(row, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
