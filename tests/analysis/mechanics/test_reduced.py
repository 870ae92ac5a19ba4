"""Model 4 in minimal coordinates against the full equations of motion and the constraints."""

import numpy as np
import pytest

from analysis import LAWS, MODELS, FrictionLaw, Scenario, SmoothCoulomb, Table
from analysis.mechanics import paper, reduced
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from tests.helpers import assert_close, derivative, model, random_disk, slip

Sample = tuple[Scenario, float, Array]


def sample(seed: int, law: type[FrictionLaw] = SmoothCoulomb) -> Sample:
    """Model 4 with a disk of order one, spin and minimal state."""
    random = np.random.default_rng(seed)
    table = Table(gravity=random.uniform(2.0, 12.0))
    scenario = model(4, disk=random_disk(random), friction=law(), table=table)
    state = random.uniform(0.4, 2.7), random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)
    return scenario, random.uniform(-3.0, 3.0), np.array(state)


def expanded(scenario: Scenario, spin: float, alpha: float, x: Array) -> Array:
    """Coordinates and rates, shape (2, 6)."""
    found = reduced.expand(scenario.disk, spin, np.array([alpha]), x[None])
    return np.concatenate(found)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_reduced_system_moves_as_the_index_1_system_of_model_4(law: type[FrictionLaw]) -> None:
    scenario, spin, x = sample(len(law.__name__), law)
    solved = reduced.solver(scenario, spin)(*x.tolist())
    change = np.array(solved[:3])
    z, u = expanded(scenario, spin, 1.7, x)
    found, forces = accelerations(scenario, z, u)
    moving = derivative(lambda t: expanded(scenario, spin, 1.7 + spin * t, x + t * change))
    assert_close(moving[0], u)
    assert_close(moving[1], found, relative=1e-11)
    assert solved[3] == pytest.approx(forces[0], rel=1e-12)
    assert solved[4] == pytest.approx(slip(scenario.disk, lambda t: z + t * u)[1], rel=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_expanded_states_meet_all_constraints(seed: int) -> None:
    scenario, spin, x = sample(seed)
    z, u = expanded(scenario, spin, 1.7, x)
    positions = paper.constraint_positions(MODELS[4], scenario.disk, z)
    np.testing.assert_allclose(positions, 0.0, rtol=0.0, atol=1e-15)
    *residuals, held = paper.constraint_directions(MODELS[4], scenario.disk, z) @ u
    np.testing.assert_allclose(residuals, 0.0, rtol=0.0, atol=1e-14)
    assert held == spin
