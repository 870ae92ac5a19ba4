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
    soft, held = replace(plain, contact=SOFT), replace(plain, constraints=MODELS[2])
    heavy = replace(soft, table=Table(gravity=2 * GRAVITY))
    other = replace(held, disk=replace(STEEL_DISK, eccentricity=0.001))
    sunk = plain.weight / SOFT.stiffness
    places = {soft: (0.0, 0.045 - sunk), heavy: (0.0, 0.045 - 2 * sunk)}
    places |= {held: (-0.0025 * np.sin(0.1), 0.045), other: (-0.001 * np.sin(0.1), 0.045)}
    for scenario, place in places.items():
        assert scenario.initial_state.coordinates[:3:2] == pytest.approx(place, rel=1e-9)
    assert replace(soft, contact=None) == plain
    with pytest.raises(ValueError, match=r"^gamma_rate must be .* in Model 3"):
        replace(replace(plain, start=Start(gamma_rate=3.0)), constraints=MODELS[3])


def test_a_disk_dropped_from_a_height_starts_at_it() -> None:
    sharp = Scenario(contact=SOFT, start=Start(height=0.005))
    assert sharp.initial_state.coordinates[2] == pytest.approx(0.05, rel=1e-12)
    rounded = Scenario.rest(start=Start(beta=0.3, height=0.005))
    reach = np.hypot(0.045 * np.sin(0.3), 2e-4 * np.cos(0.3))
    assert rounded.initial_state.coordinates[2] == pytest.approx(0.005 + reach, rel=1e-12)
