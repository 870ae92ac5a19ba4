"""Model 4 in minimal coordinates against its projection from the full equations of motion."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import sympy

from analysis import LAWS, MODELS, FrictionLaw, Scenario, SmoothCoulomb, Table
from analysis.data.checks import Array
from analysis.mechanics import paper, reduced
from analysis.mechanics.recorded import accelerations
from tests.helpers import (
    assert_close,
    derivative,
    model,
    parameter_values,
    random_disk,
    rigid_body,
)

seeds = pytest.mark.parametrize("seed", range(6))
coefficients = pytest.mark.parametrize("coefficient", [0.0, 0.3])


def sample(seed: int, coefficient: float = 0.3) -> tuple[Scenario, float, tuple[float, ...]]:
    """Model 4 with a disk of order one, spin and minimal state."""
    random = np.random.default_rng(seed)
    scenario = model(
        4,
        disk=random_disk(random),
        friction=SmoothCoulomb(coefficient=coefficient),
        table=Table(gravity=random.uniform(2.0, 12.0)),
    )
    beta, gamma = random.uniform(0.4, 2.7), random.uniform(-3.0, 3.0)
    return scenario, random.uniform(-3.0, 3.0), (beta, gamma, random.uniform(-3.0, 3.0))


@pytest.fixture(scope="module")
def projection() -> Callable[..., list[Any]]:
    """Terms of Eq. (101), with B(z) and beta(z, t) solved for from the constraints.

    The constraints come from the geometry of the rigid body, so Eqs. (97) and (102)-(108) have
    no part in this. In order: projected mass, everything else without friction, direction of
    the lateral friction and lateral slip.
    """
    body = rigid_body(rotating=True)
    z, u = body.coordinates, body.rates
    beta, gamma, spin, v = z[4], z[5], sympy.Symbol("Omega"), u[4]
    held = sympy.Matrix([z[2] - body.height, body.cog[0], body.cog[1]])
    # Contact and COG fix the position of G. Nothing depends on alpha, so any value will do.
    at_zero = {z[3]: 0}
    place = sympy.solve(list(held.subs(at_zero)), list(z[:3, 0]), dict=True)[0]

    def on_manifold(matrix: Any) -> Any:
        return matrix.subs(at_zero).subs(place)

    rows = on_manifold(held.jacobian(z).col_join(body.tangential_directions[:, 0].T))
    rows = rows.col_join(sympy.eye(6)[3, :])
    others = [0, 1, 2, 3, 5]
    solved = rows[:, others].LUsolve(sympy.Matrix([0, 0, 0, 0, spin]) - rows[:, 4] * v)
    rates = sympy.Matrix([*solved[:4, 0], v, solved[4]])
    B = rates.diff(v)
    change = rates.diff(beta) * v + rates.diff(gamma) * rates[5]
    moving = dict(zip(u, rates, strict=True))
    M, W_y = on_manifold(body.mass_matrix), on_manifold(body.tangential_directions[:, 1])
    h, f = on_manifold(body.gyroscopic_forces).subs(moving), on_manifold(body.gravity_forces)
    terms = [B.T * M * B, B.T * (h + f - M * change), B.T * W_y, W_y.T * rates]
    arguments = [body.parameters, spin, [beta, gamma, v]]
    function: Callable[..., list[Any]] = sympy.lambdify(arguments, terms, cse=True)
    return function


@coefficients
@seeds
def test_reduced_equations_are_the_projection_of_the_full_ones(
    projection: Callable[..., list[Any]], coefficient: float, seed: int
) -> None:
    scenario, spin, x = sample(seed, coefficient)
    terms = projection(parameter_values(scenario.disk, scenario.table), spin, x)
    mass, force, direction, slip = (float(term[0, 0]) for term in terms)
    force += direction * -coefficient * scenario.weight * slip / (abs(slip) + 0.1)
    assert reduced.solver(scenario, spin)(*x)[2] == pytest.approx(force / mass, rel=1e-12)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_index_1_system_of_model_4_moves_as_the_reduced_one(law: type[FrictionLaw]) -> None:
    scenario, spin, x = sample(0)
    scenario = replace(scenario, friction=law())
    z, u = reduced.expand(scenario.disk, spin, np.array([1.7]), np.array([x]))
    found, _ = accelerations(scenario, z[0], u[0])
    right = np.array(reduced.solver(scenario, spin)(*x)[:3])

    def rates(t: float) -> Array:
        _, rows = reduced.expand(scenario.disk, spin, np.array([1.7]), np.array([x]) + t * right)
        return rows.ravel()

    assert_close(found, derivative(rates), relative=1e-11)


@seeds
def test_expanded_states_meet_all_constraints_and_move_at_their_rates(seed: int) -> None:
    scenario, spin, x = sample(seed)
    z, u = reduced.expand(scenario.disk, spin, np.array([1.7]), np.array([x]))
    residuals = paper.constraint_directions(MODELS[4], scenario.disk, z[0]) @ u[0]
    positions = paper.constraint_positions(MODELS[4], scenario.disk, z[0])
    np.testing.assert_allclose(positions, 0.0, rtol=0, atol=1e-15)
    np.testing.assert_allclose(residuals[:4], 0.0, rtol=0.0, atol=1e-14)
    assert residuals[4] == spin
    right = np.array(reduced.solver(scenario, spin)(*x)[:3])

    def coordinates(t: float) -> Array:
        states = np.array([x]) + t * right
        rows, _ = reduced.expand(scenario.disk, spin, np.array([1.7 + spin * t]), states)
        return rows.ravel()

    assert_close(u[0], derivative(coordinates))


@pytest.mark.parametrize("seed", range(3))
def test_reduced_acceleration_takes_arrays_and_complex_numbers(seed: int) -> None:
    scenario, spin, x = sample(seed)
    law = SmoothCoulomb()
    assert scenario.friction == law

    def force(slip: Any) -> Any:
        # The paper's law, continued to complex numbers from either side.
        size = slip * np.sign(np.real(slip))
        return law.coefficient * slip / (size + law.smoothing)

    def found(x: Any) -> Any:
        directions = np.sin(x[0]), np.cos(x[0]), np.sin(x[1]), np.cos(x[1])
        return reduced.acceleration_from(scenario, spin, directions, x[2], force)

    many = np.array(x)[:, None] + np.array((0.0, 0.01, 0.02))
    for column, value in zip(many.T, found(many), strict=True):
        expected = reduced.solver(scenario, spin)(*column.tolist())[2]
        assert value == pytest.approx(expected, rel=1e-13)

    def stepped(t: float) -> Array:
        states = (np.array(x) + t * np.eye(3)).tolist()
        return np.array([reduced.solver(scenario, spin)(*state)[2] for state in states])

    exact = found(np.array(x)[:, None] + 1e-100j * np.eye(3)).imag / 1e-100
    assert_close(exact, derivative(stepped), 1e-9)
