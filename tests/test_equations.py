"""The printed equations of motion against Lagrange's equations of the rigid body."""

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import NamedTuple

import numpy as np
import pytest
import sympy

from analysis import Disk, Table
from analysis.data.checks import Array
from analysis.models import equations, inertial
from tests.helpers import (
    assert_close,
    derivative,
    parameter_values,
    random_disk,
    random_state,
    random_table,
    rigid_body,
)

MODULES: dict[str, ModuleType] = {"co-rotating": equations, "inertial": inertial}

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


@pytest.fixture(scope="module", params=list(MODULES))
def frame(request: pytest.FixtureRequest) -> str:
    """Name of the coordinates, whose equations are derived before the tests."""
    name: str = request.param
    _numeric(name)
    return name


def derived(frame: str, disk: Disk, z: Array, u: Array, table: Table = LEVEL) -> Derived:
    M, h, f, w_N, W_T = _numeric(frame)(parameter_values(disk, table), z, u)
    return Derived(M, h[:, 0], f[:, 0], w_N[:, 0], W_T)


def sample(seed: int) -> tuple[Disk, Array, Array]:
    random = np.random.default_rng(seed)
    return random_disk(random), *random_state(random)


@seeds
def test_gyroscopic_forces_are_those_of_lagrange(frame: str, seed: int) -> None:
    disk, z, u = sample(seed)
    printed = MODULES[frame].gyroscopic_forces(disk, z, u)
    assert_close(printed, derived(frame, disk, z, u).gyroscopic_forces)


@seeds
@pytest.mark.parametrize("leaning", [False, True])
def test_gravity_is_the_falling_gradient_of_the_cog_height(
    frame: str, leaning: bool, seed: int
) -> None:
    disk, z, u = sample(seed)
    table = random_table(np.random.default_rng(seed)) if leaning else LEVEL
    forces = MODULES[frame].gravity_forces(disk, table, z)
    assert_close(forces, derived(frame, disk, z, u, table).gravity_forces)


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
    printed = getattr(MODULES[frame], name)(disk, z)
    assert_close(printed, getattr(derived(frame, disk, z, u), name))


@seeds
def test_gyroscopic_forces_are_quadratic_in_the_rates(seed: int) -> None:
    disk, z, u = sample(seed)
    once = equations.gyroscopic_forces(disk, z, u)
    assert_close(equations.gyroscopic_forces(disk, z, -3.0 * u), 9.0 * once)


def _inertial_coordinates(z: Array) -> Array:
    """Inertial coordinates q(z) of Eq. (10)."""
    c, s = np.cos(z[3]), np.sin(z[3])
    return np.array([c * z[0] - s * z[1], s * z[0] + c * z[1], *z[2:]])


@seeds
def test_rate_matrix_is_the_derivative_of_the_inertial_coordinates(seed: int) -> None:
    _, z, u = sample(seed)
    rates = derivative(lambda t: _inertial_coordinates(z + t * u))
    assert_close(inertial.rate_matrix(z) @ u, rates)


@seeds
def test_mass_matrices_are_linked_by_equation_14(seed: int) -> None:
    disk, z, _ = sample(seed)
    B = inertial.rate_matrix(z)
    M = inertial.mass_matrix(disk, _inertial_coordinates(z))
    assert_close(equations.mass_matrix(disk, z), B.T @ M @ B)


@seeds
def test_gyroscopic_forces_are_linked_by_equation_14(seed: int) -> None:
    disk, z, u = sample(seed)
    q, B = _inertial_coordinates(z), inertial.rate_matrix(z)
    B_rate = derivative(lambda t: inertial.rate_matrix(z + t * u))
    h = inertial.gyroscopic_forces(disk, q, B @ u)
    transformed = B.T @ (h - inertial.mass_matrix(disk, q) @ B_rate @ u)
    assert_close(equations.gyroscopic_forces(disk, z, u), transformed)


@seeds
def test_forces_are_linked_by_equation_14(seed: int) -> None:
    disk, z, _ = sample(seed)
    q, B = _inertial_coordinates(z), inertial.rate_matrix(z)
    table = random_table(np.random.default_rng(seed))
    expected = B.T @ inertial.gravity_forces(disk, table, q)
    assert_close(equations.gravity_forces(disk, table, z), expected)
    assert_close(equations.normal_direction(disk, z), B.T @ inertial.normal_direction(disk, q))


@seeds
def test_tangential_directions_are_linked_by_equation_14(seed: int) -> None:
    disk, z, _ = sample(seed)
    c, s = np.cos(z[3]), np.sin(z[3])
    # The inertial columns belong to e_x and e_y of I, the co-rotating ones to those of R.
    into_frame = np.array([[c, -s], [s, c]])
    W = inertial.tangential_directions(disk, _inertial_coordinates(z))
    transformed = inertial.rate_matrix(z).T @ W @ into_frame
    assert_close(equations.tangential_directions(disk, z), transformed)
