"""The constraints of Table 2 and the check of a start against them."""

import re
from dataclasses import replace
from math import cos, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analysis import LEVELS, STEEL_DISK, Level, State, consistent_start
from analysis import multiplier_names as names
from analysis.models import constraints, equations
from tests.helpers import (
    assert_close,
    cog,
    derivative,
    jacobian,
    random_admissible,
    random_disk,
    random_state,
    rotation,
    slip,
    turn_z,
)

levels = pytest.mark.parametrize("level", LEVELS)
seeds = pytest.mark.parametrize("seed", range(4))
angles = st.floats(-10.0, 10.0)
tilts = st.floats(0.01, pi - 0.01)
spins = st.floats(-100.0, 100.0)
reproducible = settings(derandomize=True, database=None, deadline=None, max_examples=60)


def shifted(start: State, field: str, index: int, amount: float) -> State:
    values = list(getattr(start, field))
    values[index] += amount
    return replace(start, **{field: tuple(values)})


@seeds
def test_contact_distance_is_the_height_of_the_lowest_point_of_the_rim(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    around = np.linspace(-pi, pi, 200_001)
    rim = disk.radius * np.array([np.cos(around), np.sin(around), np.zeros_like(around)])
    lowest = np.min(z[2] + rotation(z)[2] @ rim)
    # The lowest of the sampled points lies at most radius * step² / 8 above the lowest of all.
    assert constraints.positions(1, disk, z)[0] == pytest.approx(lowest, abs=1e-9)


@seeds
def test_cog_constraint_holds_the_cog_above_the_origin(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    in_frame = turn_z(-z[3]) @ cog(disk, z)
    assert_close(constraints.positions(2, disk, z)[1:], in_frame[:2])


@levels
@seeds
def test_directions_are_the_gradient_of_the_positions(level: Level, seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    gradient = jacobian(lambda place: constraints.positions(level, disk, place), z)
    rows = min(len(names(level)), 3)
    assert_close(constraints.directions(level, disk, z)[:rows], gradient)


@levels
@seeds
def test_acceleration_terms_are_the_change_of_the_directions(level: Level, seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, u) = random_disk(random), random_state(random)
    change = derivative(lambda t: constraints.directions(level, disk, z + t * u))
    assert_close(constraints.acceleration_terms(level, disk, z, u), change @ u)


@seeds
def test_slip_row_gives_the_contact_points_velocity_along_the_track(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, u) = random_disk(random), random_state(random)
    along = slip(disk, lambda t: z + t * u)[0]
    assert constraints.directions(3, disk, z)[3] @ u == pytest.approx(along, rel=1e-11)


@seeds
def test_contact_forces_have_the_directions_of_the_equations(seed: int) -> None:
    random = np.random.default_rng(seed)
    disk, (z, _) = random_disk(random), random_state(random)
    rows = constraints.directions(3, disk, z)
    np.testing.assert_array_equal(rows[0], equations.normal_direction(disk, z))
    np.testing.assert_array_equal(rows[3], equations.tangential_directions(disk, z)[:, 0])


def test_spin_row_is_the_rate_of_alpha_alone() -> None:
    z, _ = random_state(np.random.default_rng(0))
    row = constraints.directions(4, STEEL_DISK, z)[4]
    np.testing.assert_array_equal(row, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0])


@levels
def test_models_add_their_constraints_one_after_another(level: Level) -> None:
    z, u = random_state(np.random.default_rng(0))
    count = {1: 1, 2: 3, 3: 4, 4: 5}[level]
    rows = constraints.directions(level, STEEL_DISK, z)
    terms = constraints.acceleration_terms(level, STEEL_DISK, z, u)
    np.testing.assert_array_equal(rows, constraints.directions(4, STEEL_DISK, z)[:count])
    np.testing.assert_array_equal(
        terms, constraints.acceleration_terms(4, STEEL_DISK, z, u)[:count]
    )


@levels
@given(beta=tilts, gamma=angles, spin=spins, beta_rate=spins)
@reproducible
def test_consistent_start_meets_every_constraint(
    level: Level, *, beta: float, gamma: float, spin: float, beta_rate: float
) -> None:
    start = consistent_start(
        level, STEEL_DISK, beta=beta, gamma=gamma, spin=spin, beta_rate=beta_rate
    )
    constraints.check_admissible(level, STEEL_DISK, start, tolerance=1e-14)
    assert start.coordinates[3:] == (0.0, beta, gamma)
    assert start.rates[3:5] == (spin, beta_rate)


@pytest.mark.parametrize("level", [1, 2])
@given(beta=tilts, gamma=angles, spin=spins, beta_rate=spins, gamma_rate=spins)
@reproducible
def test_models_that_slip_start_with_any_gamma_rate(
    level: Level, *, beta: float, gamma: float, spin: float, beta_rate: float, gamma_rate: float
) -> None:
    start = consistent_start(
        level,
        STEEL_DISK,
        beta=beta,
        gamma=gamma,
        spin=spin,
        beta_rate=beta_rate,
        gamma_rate=gamma_rate,
    )
    assert start.rates[5] == gamma_rate
    constraints.check_admissible(level, STEEL_DISK, start, tolerance=1e-14)


@pytest.mark.parametrize("level", [3, 4])
def test_rolling_models_refuse_another_gamma_rate(level: Level) -> None:
    with pytest.raises(
        ValueError, match=rf"gamma_rate must be .* = -20 rad/s in Model {level} .*"
    ):
        consistent_start(level, STEEL_DISK, beta=pi / 3, gamma_rate=-20.0 * (1.0 + 1e-11))


@pytest.mark.parametrize("level", [3, 4])
def test_rolling_models_accept_the_rolling_gamma_rate(level: Level) -> None:
    start = consistent_start(level, STEEL_DISK, beta=pi / 3, gamma_rate=-40.0 * cos(pi / 3))
    constraints.check_admissible(level, STEEL_DISK, start)


@levels
def test_default_start_is_table_3_made_consistent(level: Level) -> None:
    start = consistent_start(level, STEEL_DISK)
    eccentricity = 0.0 if level == 1 else STEEL_DISK.eccentricity
    place = (-eccentricity * np.sin(0.1), 0.0, 0.045, 0.0, pi / 2, -pi / 2 + 0.1)
    np.testing.assert_allclose(start.coordinates, place, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(start.rates, (0, 0, 0, 40, 0, 0), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("level", [2, 3, 4])
def test_table_3_as_printed_breaks_the_cog_constraint_by_a_quarter_millimetre(
    level: Level,
) -> None:
    printed = consistent_start(1, STEEL_DISK)
    assert STEEL_DISK.eccentricity * cos(printed.coordinates[5]) == pytest.approx(
        0.25e-3, rel=2e-3
    )
    message = (
        "start breaks 'fixed centre of gravity g_Sx = x + e cos(gamma) = 0' "
        f"of Model {level} on position level by 2.496e-04 m"
    )
    with pytest.raises(ValueError, match=re.escape(message)):
        constraints.check_admissible(level, STEEL_DISK, printed)


@pytest.mark.parametrize(
    ("name", "field", "index", "kind", "unit"),
    [
        ("normal_force", "coordinates", 2, "position", "m"),
        ("cog_force_x", "coordinates", 0, "position", "m"),
        ("cog_force_y", "coordinates", 1, "position", "m"),
        ("normal_force", "rates", 2, "velocity", "m/s"),
        ("cog_force_x", "rates", 0, "velocity", "m/s"),
        ("cog_force_y", "rates", 1, "velocity", "m/s"),
    ],
)
def test_broken_constraint_is_named_with_its_amount(
    name: str, field: str, index: int, kind: str, unit: str
) -> None:
    start = consistent_start(2, STEEL_DISK, beta=1.0, spin=0.5)
    broken = shifted(start, field, index, 2e-6)
    label = re.escape(constraints.LABELS[name])
    amount = rf"of Model 2 on {kind} level by 2\.000e-06 {unit}, allowed is 1\.0e-09$"
    with pytest.raises(ValueError, match=f"'{label}' {amount}"):
        constraints.check_admissible(2, STEEL_DISK, broken)


@pytest.mark.parametrize("level", [3, 4])
def test_broken_slip_constraint_is_named_with_its_amount(level: Level) -> None:
    beta, gamma, extra = 1.0, 0.3, 1e-3
    start = consistent_start(level, STEEL_DISK, beta=beta, gamma=gamma, spin=0.5)
    # Turning faster about the COG moves the contact point at its distance from the axis.
    lever = (STEEL_DISK.radius + STEEL_DISK.eccentricity * np.sin(gamma)) * np.cos(beta)
    amount = re.escape(f"by {lever * extra:.3e} m/s")
    broken = shifted(start, "rates", 3, extra)
    with pytest.raises(ValueError, match=rf"no tangential slip .* on velocity level {amount}"):
        constraints.check_admissible(level, STEEL_DISK, broken)


def test_a_residual_is_let_through_up_to_the_tolerance() -> None:
    start = shifted(consistent_start(1, STEEL_DISK), "coordinates", 2, 1e-6)
    constraints.check_admissible(1, STEEL_DISK, start, tolerance=1.01e-6)
    with pytest.raises(ValueError, match=r"allowed is 9\.9e-07"):
        constraints.check_admissible(1, STEEL_DISK, start, tolerance=9.9e-7)


def test_velocity_tolerance_grows_with_the_spin() -> None:
    start = shifted(consistent_start(1, STEEL_DISK, spin=50.0), "rates", 2, 1e-6)
    constraints.check_admissible(1, STEEL_DISK, start, tolerance=2.1e-8)
    with pytest.raises(ValueError, match="on velocity level"):
        constraints.check_admissible(1, STEEL_DISK, start, tolerance=1.9e-8)


@levels
@seeds
def test_constraints_do_not_look_at_alpha(level: Level, seed: int) -> None:
    start = random_admissible(level, STEEL_DISK, np.random.default_rng(seed))
    constraints.check_admissible(level, STEEL_DISK, shifted(start, "coordinates", 3, 2.0))


@pytest.mark.parametrize("beta", [0.0, pi, -0.1, 4.0])
def test_start_refuses_a_singular_tilt(beta: float) -> None:
    with pytest.raises(ValueError, match=r"^beta must lie in the open interval \(0, pi\)"):
        consistent_start(1, STEEL_DISK, beta=beta)


@pytest.mark.parametrize("name", ["beta", "gamma", "spin", "beta_rate", "gamma_rate"])
def test_start_names_the_argument_that_is_not_finite(name: str) -> None:
    with pytest.raises(ValueError, match=f"^{name} must be a finite number, got nan$"):
        consistent_start(1, STEEL_DISK, **{name: float("nan")})


@pytest.mark.parametrize("level", [0, 5, "1"])
def test_start_refuses_an_unknown_level(level: Level) -> None:
    with pytest.raises(ValueError, match=f"^level must be one of 1, 2, 3, 4, got {level!r}$"):
        consistent_start(level, STEEL_DISK)
