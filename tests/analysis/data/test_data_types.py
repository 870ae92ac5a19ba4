"""What the data types accept, refuse and compute."""

import re
from dataclasses import asdict, fields, replace
from inspect import signature
from math import pi
from typing import Any

import numpy as np
import pytest

from analysis import (
    DISKS,
    GRAVITY,
    MODELS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    PenaltyContact,
    Scenario,
    Start,
    Table,
    ViscousFriction,
)


@pytest.mark.parametrize(("radius", "distance"), [(0.015, 0.02), (0.001, 0.03), (0.04, 0.001)])
def test_disk_tells_the_hole_it_was_made_with(radius: float, distance: float) -> None:
    disk = Disk.ring(
        radius=0.9, hole_radius=20 * radius, hole_distance=20 * distance, thickness=0.2
    )
    assert disk.hole == pytest.approx((20 * radius, 20 * distance), rel=1e-6)


def test_disk_that_no_hole_explains_has_none() -> None:
    full = Disk.ring(hole_radius=0.0)
    assert (full.hole, full.eccentricity) == (None, 0.0)
    assert full.inertia_x == full.inertia_y
    assert replace(STEEL_DISK, eccentricity=0.02, inertia_y=4.3e-4, inertia_z=6e-4).hole is None


def test_named_disks_are_the_unrounded_ring_and_table_1() -> None:
    assert DISKS == {"steel": STEEL_DISK, "steel-rounded": ROUNDED_STEEL_DISK}
    unrounded = (0.045, 0.4354247, 2.5e-3, 2.485550e-4, 2.267837e-4, 4.680816e-4)
    exact, printed = asdict(STEEL_DISK), asdict(ROUNDED_STEEL_DISK)
    assert [*exact.values()][:6] == pytest.approx(unrounded, rel=2e-7)
    assert printed == pytest.approx({name: float(f"{x:.2e}") for name, x in exact.items()})


def test_data_types_show_their_fields_to_help() -> None:
    for kind in (Scenario, Disk, ViscousFriction):
        assert [*signature(kind).parameters] == [each.name for each in fields(kind)]


def test_weight_is_mass_times_what_presses_of_gravity() -> None:
    assert GRAVITY == 9.81
    assert Scenario().weight == STEEL_DISK.mass * GRAVITY
    table = Table(gravity=2.0, inclination=pi / 6, downhill=pi / 2)
    np.testing.assert_allclose(table.vector, (0.0, 1.0, -np.sqrt(3.0)), atol=1e-15)
    assert table.pressing == pytest.approx(np.sqrt(3.0))
    assert Scenario(table=table).weight == STEEL_DISK.mass * table.pressing


@pytest.mark.parametrize(
    ("name", "axis"), [("inertia_x", "x"), ("inertia_y", "y"), ("inertia_z", "z")]
)
def test_disk_refuses_inertia_above_the_triangle_bound(name: str, axis: str) -> None:
    about_cog = dict(zip("xyz", STEEL_DISK.inertia_about_cog, strict=True))
    slack = sum(about_cog.values()) - 2 * about_cog[axis]
    bound = getattr(STEEL_DISK, name) + slack
    # A lamina lies on the bound.
    for part in (1.0 - 1e-9, 1.0):
        assert replace(STEEL_DISK, **{name: bound * part}).mass == STEEL_DISK.mass
    message = f"^{name} must not exceed the sum of the two other moments .* about the {axis} axis$"
    with pytest.raises(ValueError, match=message):
        replace(STEEL_DISK, **{name: bound * (1 + 1e-9)})


SOFT = PenaltyContact(stiffness=1e5)


@pytest.mark.parametrize(
    ("name", "value", "kind"),
    [
        ("disk", 3, "a Body"),
        ("friction", "stick", "a FrictionLaw"),
        ("table", None, "a Table"),
        ("contact", 1e6, "a PenaltyContact"),
        ("start", (1, 2), "a Start or a State"),
    ],
)
def test_scenario_refuses_what_is_of_another_kind(name: str, value: Any, kind: str) -> None:
    with pytest.raises(ValueError, match=f"^{name} must be {kind}, got {re.escape(repr(value))}"):
        Scenario(**{name: value})


def test_replacing_one_field_of_a_scenario_changes_all_that_follows_from_it() -> None:
    plain = Scenario()
    soft = replace(plain, contact=SOFT)
    sunk = plain.weight / SOFT.stiffness
    assert soft.initial_state.coordinates[2] == pytest.approx(0.045 * np.cos(0) - sunk, rel=1e-9)
    heavy = replace(soft, table=Table(gravity=2 * GRAVITY))
    assert heavy.initial_state.coordinates[2] == pytest.approx(0.045 - 2 * sunk, rel=1e-9)
    assert replace(soft, contact=None) == plain
    held = replace(plain, constraints=MODELS[2])
    assert held.initial_state.coordinates[0] == pytest.approx(-0.0025 * np.sin(0.1), rel=1e-9)
    other = replace(held, disk=replace(STEEL_DISK, eccentricity=0.001))
    assert other.initial_state.coordinates[0] == pytest.approx(-0.001 * np.sin(0.1), rel=1e-9)
    with pytest.raises(ValueError, match=r"^gamma_rate must be .* in Model 3"):
        replace(replace(plain, start=Start(gamma_rate=3.0)), constraints=MODELS[3])


def test_a_disk_dropped_from_a_height_starts_at_it() -> None:
    sharp = Scenario(contact=SOFT, start=Start(height=0.005))
    assert sharp.initial_state.coordinates[2] == pytest.approx(0.05, rel=1e-12)
    rounded = Scenario.rest(start=Start(beta=0.3, height=0.005))
    reach = np.hypot(0.045 * np.sin(0.3), 2e-4 * np.cos(0.3))
    assert rounded.initial_state.coordinates[2] == pytest.approx(0.005 + reach, rel=1e-12)
