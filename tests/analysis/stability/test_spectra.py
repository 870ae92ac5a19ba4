"""Eigenvalues of stacks, and branches that stay whole."""

import numpy as np
import pytest

from analysis import MODELS, MOTIONS, POSSIBLE_SETS, Level, Motion, Scenario, SmoothCoulomb
from analysis.problem.constraints import set_name
from analysis.stability.spectra import System, branches, eigenvalues, follow, matrices_over_spin
from tests.helpers import mostly_slow
from validation.studies.comparisons import distance


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize(("level", "system"), [(1, "full"), (1, "numeric"), (2, None), (4, None)])
def test_eigenvalues_and_branches_are_those_of_the_matrices(
    level: Level, system: System | None, motion: Motion
) -> None:
    spins = np.array([2.0, 17.0, 29.0, 43.0])
    scenario = Scenario(constraints=MODELS[level])
    found = eigenvalues(scenario, spins, system, motion)
    followed = branches(scenario, spins, system, motion)
    matrices = matrices_over_spin(scenario, system, motion)(spins)
    for index, values in enumerate(np.linalg.eigvals(matrices).astype(complex)):
        drift = np.array((1j, -1j)) * spins[index] if level == 1 else ()
        for each in (found[index], followed[index]):
            assert distance(each, np.append(values, drift)) < 1e-9
        falling = [(-value.real, -value.imag) for value in found[index].tolist()]
        assert falling == sorted(falling)
    # The pair of the place on the table is exact.
    if level == 1:
        np.testing.assert_array_equal(followed[:, 2:4].T, [1j * spins, -1j * spins])


SMOOTH = {f"smoothing {eps}": Scenario(friction=SmoothCoulomb(smoothing=eps)) for eps in (0.01, 1)}
SETS = {set_name(held): Scenario(constraints=held) for held in POSSIBLE_SETS}


@pytest.mark.parametrize(
    "name", mostly_slow([*SETS, *SMOOTH], [*map(set_name, MODELS.values()), *SMOOTH])
)
def test_branches_are_continuous(name: str) -> None:
    scenario = {**SETS, **SMOOTH}[name]
    for motion in MOTIONS:
        values = branches(scenario, np.linspace(0.0, 60.0, 3001), motion=motion)
        jumps = np.abs(np.diff(values, axis=0))
        # Colliding eigenvalues leave with the root of the step; a mix-up would jump by more.
        assert np.max(jumps) < 2.0
        assert np.sum(jumps > 0.2) < 60


@pytest.mark.parametrize("gradient", [1e-3, 0.05, 0.8, 1.9, 3.0, 100.0])
@pytest.mark.parametrize("motion", MOTIONS)
def test_a_branch_is_the_same_whatever_spins_are_asked_for(
    motion: Motion, gradient: float
) -> None:
    scenario = Scenario(friction=SmoothCoulomb(coefficient=gradient, smoothing=1.0))
    spins = np.linspace(-100.0, 100.0, 2001)
    fine = branches(scenario, spins, motion=motion)
    few = branches(scenario, spins[::250], motion=motion)
    np.testing.assert_allclose(few, fine[::250], atol=1e-9)
    single = branches(scenario, spins[-1:], motion=motion)
    np.testing.assert_allclose(single, fine[-1:], atol=1e-9)


def test_branches_go_on_as_they_have_come_past_others_collisions_and_zeros_that_stay() -> None:
    p = np.linspace(-2.0, 2.0, 400)
    crossing, colliding, meeting = np.zeros((3, p.size, 4, 4))
    lines = np.column_stack((p, -p, 0.5 * np.sin(1.5 * p) + 0.1, np.full_like(p, -0.33)))
    crossing[:, range(4), range(4)] = lines
    # Eigenvalues +-sqrt(p² - 1), and one that runs through the collisions.
    colliding[:, 0, 1], colliding[:, 1, 0] = 1.0, p**2 - 1.0
    colliding[:, 2, 2], colliding[:, 3, 3] = 0.8 * p, -5.0
    root = np.emath.sqrt(p**2 - 1.0)
    # Defective where one passes the zero: both eigenvectors are the same there.
    meeting[:, 0, 0], meeting[:, 0, 1], meeting[:, 2, 2], meeting[:, 3, 3] = p, 1.0, -3.0, -4.0
    # Of smooth eigenvectors.
    one, other = np.random.default_rng(0).normal(size=(2, 4, 4))
    vectors = np.eye(4) + 0.3 * one + np.linspace(0.0, 0.3, p.size)[:, None, None] * other
    others = (root, 0.8 * p, -root, 0 * p - 5.0), (0 * p, p, 0 * p - 3.0, 0 * p - 4.0)
    every = [lines, *map(np.column_stack, others)]
    for blocks, true in zip((crossing, colliding, meeting), every, strict=True):
        found = follow(vectors @ blocks @ np.linalg.inv(vectors))
        np.testing.assert_allclose(found, true[:, np.argsort(-true[0].real)], atol=1e-7)


def test_pairs_are_numbered_from_even_places_and_a_real_eigenvalue_gives_way() -> None:
    matrix = np.array([[2.0, 0, 0, 0], [0, -1, 1, 0], [0, -1, -1, 0], [0, 0, 0, -3]])
    np.testing.assert_allclose(follow(matrix[None]), [[2.0, -3.0, -1.0 + 1j, -1.0 - 1j]])
