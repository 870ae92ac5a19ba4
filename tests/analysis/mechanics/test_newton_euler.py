"""The equations of motion against Newton's, Euler's and Lagrange's laws, and the paper's."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial

import numpy as np
import pytest

from analysis import (
    COORDINATES,
    LAWS,
    LOADS,
    MULTIPLIERS,
    STEEL_DISK,
    Body,
    ConstraintSet,
    Load,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    multiplier_names,
)
from analysis.mechanics import paper
from analysis.mechanics.attitude import state_of
from analysis.mechanics.constraints import SLIPS, velocity_residuals
from analysis.mechanics.dual import rate
from analysis.mechanics.recorded import accelerations, solver
from analysis.mechanics.recorded import jacobian as exact_jacobian
from analysis.problem.checks import Array
from analysis.problem.constraints import PRESCRIBED
from tests.bodies import BODIES, random_start
from tests.helpers import (
    OUTER_STEP,
    all_sets,
    angular_velocity,
    arc,
    assert_close,
    centre,
    cog,
    derivative,
    jacobian,
    lagrange,
    more_sets,
    random_scenario,
    rotation,
    second_derivative,
    spin_momentum,
)

loads = pytest.mark.parametrize("load", LOADS)


PRODUCTS = 0.25
"""Largest product of inertia of a random disk, whose moments are of order one."""


def derived(scenario: Scenario, z: Array, u: Array) -> tuple[Array, ...]:
    """Mass matrix, forces, and directions of what is held and of the slips, by Lagrange."""
    M, gyroscopic, gravity, normal, slips, cog = lagrange()(scenario.disk, scenario.table, z, u)
    rates = [np.eye(6)[COORDINATES.index(held)] for held in PRESCRIBED.values()]
    columns = np.column_stack((normal, cog, slips, *rates))
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
@pytest.mark.parametrize("tilt", [1.1e-6, 1e-3])
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


def test_a_flat_disk_is_called_singular() -> None:
    centred = Scenario(disk=replace(STEEL_DISK, eccentricity=0.0))
    with pytest.raises(ArithmeticError, match="singular index-1 system of Model 1"):
        accelerations(centred, np.zeros(6), np.ones(6))


def lowest(body: Body, z: Array) -> Array:
    """Inertial lowest point."""
    turn = rotation(z)
    return centre(z) + turn @ np.array(body.lowest_point(turn[2]))


def enlarged(body: Body) -> Body:
    """The same of radius and mass one, so that it moves as slowly as differences want."""
    length, mass = 1.0 / body.radius, 1.0 / body.mass
    scales = {"radius": length, "other_radius": length, "eccentricity": length, "mass": mass}
    values = {each.name: getattr(body, each.name) for each in fields(body)}
    for name in values:
        scale = mass * length**2 if name.startswith("inertia") else scales.get(name, 1.0)
        values[name] *= scale
    return replace(body, **values)


@loads
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("body", [*map(enlarged, BODIES.values())], ids=list(BODIES))
def test_forces_at_the_lowest_point_change_the_momenta(body: Body, seed: int, load: Load) -> None:
    friction = SmoothCoulomb(load=load)
    table = Table(inclination=0.2, downhill=0.5)
    scenario = Scenario(disk=body, friction=friction, table=table, start=random_start(seed, 0.05))
    state = scenario.initial_state
    z, u = np.array(state.coordinates), np.array(state.rates)
    acceleration, (normal,) = accelerations(scenario, z, u)
    path = arc(z, u, acceleration)
    point, middle = lowest(body, z), cog(body, z)
    omega = angular_velocity(path)
    slip = derivative(lambda t: centre(path(t))) + np.cross(omega, point - centre(z))
    assert abs(slip[2]) < 1e-9
    pressing = max(0.0, normal) if load == "contact" else scenario.weight
    force = -pressing * friction.per_speed(float(np.hypot(*slip[:2]))) * slip
    force[2] = normal
    pulled = force / body.mass + table.vector
    scale = float(np.max(np.abs(pulled))) + 1.0
    found = second_derivative(lambda t: cog(body, path(t)))
    np.testing.assert_allclose(found, pulled, atol=1e-9 * scale)
    torque = np.cross(point - middle, force)
    turning = derivative(lambda t: spin_momentum(body, path, t), OUTER_STEP)
    size = float(np.max(np.abs(torque)) + np.max(np.abs(turning)))
    np.testing.assert_allclose(turning, torque, atol=1e-9 * size)
    rise = second_derivative(lambda t: lowest(body, path(t)))[2]
    assert abs(rise) < 1e-9 * scale
