"""The equations of motion: the paper's as printed, the index-1 and the reduced system.

Lagrange's equations, derived by SymPy, and derivatives of positions tell what is right.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from analysis import (
    COORDINATES,
    LAWS,
    LOADS,
    MODELS,
    MOTIONS,
    MULTIPLIERS,
    Body,
    ConstraintSet,
    Disk,
    FrictionLaw,
    Load,
    Motion,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    multiplier_names,
)
from analysis.mechanics import paper, reduced
from analysis.mechanics.attitude import state_of
from analysis.mechanics.constraints import SLIPS, velocity_residuals
from analysis.mechanics.dual import rate
from analysis.mechanics.recorded import accelerations, solver
from analysis.mechanics.recorded import jacobian as exact_jacobian
from analysis.problem.checks import Array
from analysis.problem.constraints import PRESCRIBED
from analysis.problem.elementary import exp, log
from analysis.problem.quantities import SIX
from tests.bodies import ELLIPSE
from tests.helpers import (
    all_sets,
    assert_close,
    centre,
    derivative,
    jacobian,
    lagrange,
    model,
    more_sets,
    random_disk,
    random_scenario,
    random_state,
    slip,
)

# --- As the paper prints them --------------------------------------------------------------------

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
    np.testing.assert_allclose(rates, [(2.0, 2.0, 1.0)] * 2, atol=0.05)


# --- The index-1 system ------------------------------------------------------------------------

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Ellipsoid(Body):
    """A body whose semi-axes have names that the recorded equations use, too."""

    beta: float = 0.9
    t5: float = 0.7
    force: float = 0.8

    def lowest_point(self, up: Any, half_thickness: Any = 0.0) -> Any:  # noqa: ARG002
        axes = [self.radius * part for part in (self.beta, self.t5, self.force)]
        x, y, z = (axis * along for axis, along in zip(axes, up, strict=True))
        # A square root by other functions.
        depth = exp(0.5 * log(x * x + y * y + z * z))
        a, b, c = axes
        return -(a * x) / depth, -(b * y) / depth, -(c * z) / depth


class Shared(Ellipsoid):
    """The same, with code for all of the class."""

    SURFACE = ("beta", "t5", "force", "radius")


def test_fields_of_a_surface_may_have_any_names() -> None:
    found = []
    for kind in (Ellipsoid, Shared):
        body: Body = kind(**{name: getattr(ELLIPSE, name) for name in SIX})
        start = Scenario(disk=body, start=Start(beta=1.1, gamma=0.4, spin=5.0)).initial_state
        found.append(accelerations(Scenario(disk=body), start.coordinates, start.rates))
    assert_close(found[1][0], found[0][0])
    assert_close(found[1][1], found[0][1])


# --- The reduced system ------------------------------------------------------------------------


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


@pytest.mark.parametrize("motion", MOTIONS)
def test_printed_linear_equations_leave_a_disk_that_spins_elsewhere_where_it_is(
    motion: Motion,
) -> None:
    printed = paper.printed_matrices(paper.paper_numbers(Scenario(), motion))
    (matrix,) = paper.first_order(printed, 30.0, 4.0)
    # A place that stays is seen to go back from a frame that turns.
    back = 30.0 * np.array(((0.0, 1.0), (-1.0, 0.0)))
    elsewhere = np.zeros((8, 2))
    elsewhere[:2], elsewhere[4:6] = np.eye(2), back
    np.testing.assert_allclose(matrix @ elsewhere, elsewhere @ back, atol=1e-10)
