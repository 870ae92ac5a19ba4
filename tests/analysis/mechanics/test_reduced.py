"""Model 4 in minimal coordinates against the full equations of motion and the constraints."""

import numpy as np
import pytest

from analysis import LAWS, MODELS, FrictionLaw, Table
from analysis.mechanics import paper, reduced
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from tests.helpers import assert_close, derivative, model, random_disk, slip


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_reduced_system_moves_as_the_index_1_system_of_model_4(law: type[FrictionLaw]) -> None:
    random = np.random.default_rng(len(law.__name__))
    table = Table(gravity=random.uniform(2.0, 12.0))
    scenario = model(4, disk=random_disk(random), friction=law(), table=table)
    x = np.array([random.uniform(0.4, 2.7), *random.uniform(-3.0, 3.0, size=2)])
    spin = random.uniform(-3.0, 3.0)

    def expanded(alpha: float, x: Array) -> Array:
        """Coordinates and rates, shape (2, 6)."""
        return np.array(reduced.expanded(scenario.disk, spin, alpha, x.tolist()))

    solved = reduced.solver(scenario, spin)(*x.tolist())
    change = np.array(solved[:3])
    z, u = expanded(1.7, x)
    positions = paper.constraint_positions(MODELS[4], scenario.disk, z)
    np.testing.assert_allclose(positions, 0.0, rtol=0.0, atol=1e-15)
    found, forces = accelerations(scenario, z, u)
    moving = derivative(lambda t: expanded(1.7 + spin * t, x + t * change))
    assert_close(moving[0], u)
    assert_close(moving[1], found, relative=1e-11)
    assert solved[3] == pytest.approx(forces[0], rel=1e-12)
    assert solved[4] == pytest.approx(slip(scenario.disk, lambda t: z + t * u)[1], rel=1e-10)
