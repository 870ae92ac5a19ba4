"""What a scenario and its parts accept, refuse and compute; constraints, and starts under them."""

from dataclasses import asdict, replace
from math import pi

import numpy as np
import pytest

from analysis import (
    COORDINATES,
    DISKS,
    GRAVITY,
    LEVELS,
    MODELS,
    MULTIPLIERS,
    POSSIBLE_SETS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    ConstraintSet,
    Level,
    PenaltyContact,
    Scenario,
    Start,
    State,
    Table,
    multiplier_names,
)
from analysis.mechanics import constraints as rows
from analysis.problem.limits import LEAST_TILT
from tests.helpers import all_sets, model, random_scenario, shifted


def test_all_sets_but_the_one_without_freedom_are_possible() -> None:
    assert len(POSSIBLE_SETS) == len(set(POSSIBLE_SETS)) == 2**4 - 1
    assert set(MODELS.values()) <= set(POSSIBLE_SETS)


def test_models_add_their_constraints_one_after_another_in_any_order() -> None:
    expected = [name for name in MULTIPLIERS if name != "lateral_force"]
    for level, count in zip(LEVELS, (1, 3, 4, 5), strict=True):
        assert list(multiplier_names(MODELS[level])) == expected[:count]
        assert Scenario(constraints=MODELS[level][::-1]) == model(level)


@all_sets
@pytest.mark.parametrize("seed", range(4))
def test_start_keeps_all_that_is_free(constraints: ConstraintSet, seed: int) -> None:
    scenario, z, u = random_scenario(constraints, seed)
    rows.check_admissible(scenario, scenario.initial_state, tolerance=1e-13)
    # Constraints do not look at alpha.
    rows.check_admissible(scenario, shifted(scenario.initial_state, "coordinates", 3, 2.0))
    asked = {name: value for name, value in asdict(scenario.start).items() if value is not None}
    got = dict(zip(COORDINATES, z, strict=True)) | {
        f"{name}_rate": rate for name, rate in zip(COORDINATES, u, strict=True)
    }
    got["spin"] = u[3]
    assert {name: got[name] for name in asked} == asked


@pytest.mark.parametrize("level", LEVELS)
def test_default_start_is_table_3_made_consistent(level: Level) -> None:
    start = model(level).initial_state
    eccentricity = 0.0 if level == 1 else STEEL_DISK.eccentricity
    place = (-eccentricity * np.sin(0.1), 0.0, 0.045, 0.0, pi / 2, -pi / 2 + 0.1)
    np.testing.assert_allclose(start.coordinates, place, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(start.rates, (0, 0, 0, 40, 0, 0), rtol=0.0, atol=1e-14)


def test_tolerance_grows_with_the_spin_on_velocity_level() -> None:
    for field, allowed in (("coordinates", 1e-6), ("rates", 2e-8)):
        start = shifted(Start(spin=50.0).state(MODELS[1], STEEL_DISK), field, 2, 1e-6)
        rows.check_admissible(Scenario(), start, tolerance=1.01 * allowed)
        with pytest.raises(ValueError, match=r"allowed is 9\.9e-07"):
            rows.check_admissible(Scenario(), start, tolerance=0.99 * allowed)


# --- Disk, table and contact -------------------------------------------------------------------


def test_named_disks_are_the_unrounded_ring_and_table_1() -> None:
    assert DISKS == {"steel": STEEL_DISK, "steel-rounded": ROUNDED_STEEL_DISK}
    unrounded = (0.045, 0.4354247, 2.5e-3, 2.485550e-4, 2.267837e-4, 4.680816e-4)
    exact, printed = asdict(STEEL_DISK), asdict(ROUNDED_STEEL_DISK)
    assert [*exact.values()][:6] == pytest.approx(unrounded, rel=2e-7)
    assert printed == pytest.approx({name: float(f"{x:.2e}") for name, x in exact.items()})


def test_weight_is_mass_times_what_presses_of_gravity() -> None:
    assert GRAVITY == 9.81
    assert Scenario().weight == STEEL_DISK.mass * GRAVITY
    table = Table(gravity=2.0, inclination=pi / 6, downhill=pi / 2)
    np.testing.assert_allclose(table.vector, (0.0, 1.0, -np.sqrt(3.0)), atol=1e-15)
    assert table.pressing == pytest.approx(np.sqrt(3.0))
    assert Scenario(table=table).weight == STEEL_DISK.mass * table.pressing


@pytest.mark.parametrize("axis", "xyz")
def test_disk_refuses_inertia_above_the_triangle_bound(axis: str) -> None:
    name, about_cog = f"inertia_{axis}", STEEL_DISK.inertia_about_cog
    slack = sum(about_cog) - 2 * about_cog["xyz".index(axis)]
    bound = getattr(STEEL_DISK, name) + slack
    # A lamina lies on the bound.
    assert replace(STEEL_DISK, **{name: bound}).mass == STEEL_DISK.mass
    with pytest.raises(ValueError, match=f"^{name} must leave principal moments about the COG"):
        replace(STEEL_DISK, **{name: bound * (1 + 1e-9)})


SOFT = PenaltyContact(stiffness=1e5)


def test_a_disk_dropped_from_a_height_starts_at_it() -> None:
    sharp = Scenario(contact=SOFT, start=Start(height=0.005))
    assert sharp.initial_state.coordinates[2] == pytest.approx(0.05, rel=1e-12)
    rounded = Scenario.rest(start=Start(beta=0.3, height=0.005))
    reach = np.hypot(0.045 * np.sin(0.3), 2e-4 * np.cos(0.3))
    assert rounded.initial_state.coordinates[2] == pytest.approx(0.005 + reach, rel=1e-12)


@pytest.mark.parametrize("is_turned", [False, True])
def test_a_disk_that_starts_flat_is_refused_unless_its_rim_is_rounded(*, is_turned: bool) -> None:
    def lying(part: float) -> State:
        leaning = part * LEAST_TILT
        beta = pi - leaning if is_turned else leaning
        return shifted(Scenario().initial_state, "coordinates", 4, beta - pi / 2)

    for contact in (None, SOFT):
        assert Scenario(contact=contact, start=lying(1.001)).contact == contact
        with pytest.raises(ValueError, match=r"^beta must keep more than 1e-06 rad from 0"):
            Scenario(contact=contact, start=lying(0.999))
    rounded = Scenario.rest(start=lying(0.999))
    assert rounded.initial_state == rounded.start
