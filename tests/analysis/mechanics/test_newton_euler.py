"""The equations of motion against Newton's, Euler's and Lagrange's laws, and the paper's."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from analysis import (
    LAWS,
    LOADS,
    MULTIPLIERS,
    STEEL_DISK,
    ConstraintSet,
    Load,
    Scenario,
    Start,
    Table,
    ViscousFriction,
    multiplier_names,
)
from analysis.mechanics import paper
from analysis.mechanics.attitude import state_of
from analysis.mechanics.constraints import SLIPS, velocity_residuals
from analysis.mechanics.dual import rate
from analysis.mechanics.recorded import accelerations, solver
from analysis.mechanics.recorded import jacobian as exact_jacobian
from analysis.problem.checks import Array
from tests.helpers import (
    all_sets,
    assert_close,
    jacobian,
    lagrange,
    more_sets,
    random_scenario,
)

loads = pytest.mark.parametrize("load", LOADS)


PRODUCTS = 0.25
"""Largest product of inertia of a random disk, whose moments are of order one."""


def derived(scenario: Scenario, z: Array, u: Array) -> tuple[Array, ...]:
    """Mass matrix, forces, and directions of what is held and of the slips, by Lagrange."""
    M, gyroscopic, gravity, normal, slips, cog = lagrange()(scenario.disk, scenario.table, z, u)
    columns = np.column_stack((normal, cog, slips, np.eye(6)[:, 3:5]))
    every = dict(zip(MULTIPLIERS, columns.T, strict=True))
    W = np.array([every[name] for name in multiplier_names(scenario.constraints)])
    return M, gyroscopic + gravity, W, slips.T


def printed(scenario: Scenario, z: Array, u: Array) -> tuple[Array, ...]:
    """The same as the paper prints them."""
    disk = scenario.disk
    others = paper.gyroscopic_forces(disk, z, u) + paper.gravity_forces(scenario, z)
    W = paper.constraint_directions(scenario.constraints, disk, z)
    return paper.mass_matrix(disk, z), others, W, paper.tangential_directions(disk, z).T


def missing(scenario: Scenario, terms: Callable[..., tuple[Array, ...]] = derived) -> float:
    """What is missing in the equations of motion at the start, relative to their largest terms."""
    state, law = scenario.initial_state, scenario.friction
    z, u = np.array(state.coordinates), np.array(state.rates)
    acceleration, forces = accelerations(scenario, z, u)
    M, others, W, across = terms(scenario, z, u)
    pressing = max(0.0, forces[0]) if law.load == "contact" else scenario.weight
    # Eq. (3); what is held does not slip.
    free = np.array([way not in scenario.constraints for way in SLIPS])
    along, sideways = (across @ u * free).tolist()
    rubbing = np.array(law.force(along, sideways, pressing)) * free * scenario.rubs
    left = M @ acceleration - others - W.T @ forces - across.T @ rubbing
    return float(np.linalg.norm(left) / np.linalg.norm([*(M * acceleration).flat, *forces]))


def changes(scenario: Scenario, state: Array) -> Array:
    """Time derivative of a state."""
    return np.array(solver(scenario)(*state.tolist())[:12])


@more_sets
@loads
@pytest.mark.parametrize("products", [0.0, PRODUCTS])
def test_accelerations_and_forces_meet_lagranges_equations_and_what_is_held_stays(
    constraints: ConstraintSet, load: Load, products: float
) -> None:
    for seed, law in enumerate(LAWS.values()):
        scenario, z, u = random_scenario(constraints, seed, law(load=load), products)
        assert missing(scenario) < 1e-12
        residuals = partial(velocity_residuals, constraints, scenario.disk)
        state = state_of(scenario.disk, z, u)
        change = changes(scenario, np.array(state))
        np.testing.assert_allclose(rate(residuals, state, change), 0.0, rtol=0.0, atol=1e-12)
        if "held-tilt-rate" in constraints:
            assert abs(change[10]) < 1e-12


@all_sets
@pytest.mark.parametrize("tilt", [1e-6, 1e-3])
def test_a_nearly_flat_disk_loses_no_more_digits_than_its_angles(
    constraints: ConstraintSet, tilt: float
) -> None:
    scenario, _, _ = random_scenario(constraints, seed=0)
    assert isinstance(scenario.start, Start)
    start = replace(scenario.start, beta=tilt)
    # The angular velocity tells the rates of alpha and gamma apart by the sine of beta alone.
    assert missing(replace(scenario, start=start, table=Table()), printed) < 1e-15 / tilt


@all_sets
@loads
def test_jacobian_is_the_slope_of_the_time_derivative(
    constraints: ConstraintSet, load: Load
) -> None:
    for seed, law in enumerate(LAWS.values()):
        scenario, z, u = random_scenario(constraints, seed, law(load=load), PRODUCTS)
        state = np.array(state_of(scenario.disk, z, u))
        slopes = jacobian(partial(changes, scenario), state)
        assert_close(exact_jacobian(scenario)(state), slopes, relative=1e-9)


@all_sets
@loads
def test_every_law_of_one_slope_is_at_no_slip_as_the_viscous_one(
    constraints: ConstraintSet, load: Load
) -> None:
    # Differences err by the kink of the law, however small their step.
    upright = Scenario(constraints=constraints, start=Start(gamma=np.pi / 2, spin=30.0))
    start = upright.initial_state
    state = np.array(state_of(upright.disk, start.coordinates, start.rates))
    for law in LAWS.values():
        if law().is_simple:
            slope = law().gradient
            found, expected = (
                exact_jacobian(replace(upright, friction=each))(state)
                for each in (law(load=load), ViscousFriction(viscosity=slope))
            )
            assert_close(found, expected)


def test_a_flat_disk_is_called_singular() -> None:
    centred = Scenario(disk=replace(STEEL_DISK, eccentricity=0.0))
    with pytest.raises(ArithmeticError, match="singular index-1 system of Model 1"):
        accelerations(centred, np.zeros(6), np.ones(6))
