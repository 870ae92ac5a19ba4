"""The paper's printed equations against Lagrange's equations, and its closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import MODELS, MOTIONS, ConstraintSet, Disk, Motion, Scenario, SmoothCoulomb, Table
from analysis.mechanics import paper
from analysis.problem.checks import Array
from tests.helpers import (
    all_sets,
    assert_close,
    centre,
    derivative,
    jacobian,
    lagrange,
    random_disk,
    random_state,
)

seeds = pytest.mark.parametrize("seed", range(3))


def sample(seed: int) -> tuple[Disk, Array, Array]:
    random = np.random.default_rng(seed)
    return random_disk(random), *random_state(random)


@seeds
@pytest.mark.parametrize("prefix", ["", "inertial_"])
def test_printed_terms_are_those_of_lagrange(prefix: str, seed: int) -> None:
    disk, z, u = sample(seed)
    found = lagrange(rotating=not prefix)(disk, Table(), z, u)
    assert_close(getattr(paper, f"{prefix}mass_matrix")(disk, z), found.mass_matrix)
    assert_close(getattr(paper, f"{prefix}gyroscopic_forces")(disk, z, u), found.gyroscopic_forces)
    slips = getattr(paper, f"{prefix}tangential_directions")(disk, z)
    assert_close(slips, found.tangential_directions)
    # These two are the same in both.
    assert_close(paper.gravity_forces(Scenario(disk=disk), z), found.gravity_forces)
    assert_close(paper.normal_direction(disk, z), found.normal_direction)


@seeds
def test_rate_matrix_is_the_derivative_of_the_inertial_coordinates(seed: int) -> None:
    _, z, u = sample(seed)
    # Eq. (10)
    rates = derivative(lambda t: np.append(centre(z + t * u)[:2], (z + t * u)[2:]))
    assert_close(paper.rate_matrix(z) @ u, rates)


@all_sets
@seeds
def test_directions_are_gradients_of_positions_and_terms_their_changes(
    constraints: ConstraintSet, seed: int
) -> None:
    disk, z, u = sample(seed)
    gradient = jacobian(lambda place: paper.constraint_positions(constraints, disk, place), z)
    found = paper.constraint_directions(constraints, disk, z)
    assert_close(found[: len(gradient)], gradient)
    change = derivative(lambda t: paper.constraint_directions(constraints, disk, z + t * u))
    terms = paper.constraint_changes(constraints, disk, z, u)
    np.testing.assert_allclose(terms, change @ u, rtol=0.0, atol=1e-11)


REDUCED = Scenario(constraints=MODELS[4])


@pytest.mark.parametrize("motion", MOTIONS)
def test_closed_form_converges_with_the_smoothing(motion: Motion) -> None:
    errors = []
    for smoothing in (1e-2, 1e-3, 1e-4):
        scenario = replace(REDUCED, friction=SmoothCoulomb(smoothing=smoothing))
        values = np.linalg.eigvals(paper.reduced_matrices(scenario, 40.0, motion)[0])
        approximate = paper.closed_form(scenario, 40.0, motion)[0]
        errors.append([np.min(np.abs(values - value)) for value in approximate])
    rates = np.log10(np.array(errors)[:-1] / np.array(errors)[1:])
    # lambda_1,2 are off by O(epsilon²), lambda_3 by O(epsilon), as Eq. (122) says
    assert np.all(rates[:, 2] == pytest.approx(1.0, abs=0.05))
    assert np.all(rates[:, :2] > 0.95)
