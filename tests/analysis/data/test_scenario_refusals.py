"""Each refusal of the data types is reachable from a scenario's file, with key and line."""

import re
from pathlib import Path

import pytest

from analysis import ROUNDED_STEEL_DISK, Scenario, State, Stribeck, load_scenario, scenario_text
from analysis.data.quantities import SECTIONS
from tests.scenario_texts import with_key

PAPER = Scenario()
SOFT = Scenario.rest()
ROUNDED = Scenario(disk=ROUNDED_STEEL_DISK)
STATE = Scenario(start=State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.1), rates=(0.0,) * 6))
SLIP_FREE = Scenario(constraints=("contact", "no-slip-along", "no-slip-across"))
HELD = Scenario(constraints=("contact", "fixed-cog", "no-slip-across"))

REFUSED: list[tuple[Scenario, str, str, str]] = [
    # What the file itself says: keys with their values, the message, and the key to blame.
    (PAPER, "format = 2", "format 2 is newer than this version", "format"),
    (PAPER, "model = 5", "model must be one of 1, 2, 3, 4, got '5'", "model"),
    (PAPER, 'constraints = ["contact"]', "constraints do not go together with", "constraints"),
    (PAPER, "radius = 0.1", "radius must stand in the table [disk]", "radius"),
    (PAPER, "colour = 3", "unknown key 'colour'; a scenario holds format, model", "colour"),
    (PAPER, "disk.colour = 3", "colour is unknown here; [disk] takes name; or radius", "colour"),
    (PAPER, "disk.density =", "[disk] lacks density", "[disk]"),
    (ROUNDED, 'disk.name = "steel"', "radius is unknown here; [disk] takes name; or", "radius"),
    (PAPER, "start.coordinates = [1]", "beta is unknown here; [start] takes coord", "beta"),
    (STATE, "start.rates =", "[start] lacks rates", "[start]"),
    (SOFT, "contact.stiffness =", "[contact] lacks stiffness", "[contact]"),
    # Values of the wrong kind, among them wrong units.
    (PAPER, 'disk.radius = "45mm"', "radius must be a number in m, got '45mm'", "radius"),
    (PAPER, "disk.radius = 1" + 400 * "0", "radius must be a finite number, got one", "radius"),
    (PAPER, 'table.inclination = "2 grad"', "inclination must be an angle", "inclination"),
    (PAPER, "friction.law = []", "law must be text, got []", "law"),
    (PAPER, 'friction.law = ".x:Law"', "friction law '.x:Law' cannot be loaded", "law"),
    (STATE, "start.rates = [1]", "rates must hold 6 numb", "rates"),
    (STATE, 'start.coordinates = [0, 0, 0, 0, 0, "pi"]', "coordinates[gamma] must", "coordinates"),
    # Values that do not fit each other.
    (PAPER, "disk.hole_distance = 1", "hole_distance + hole_radius must be", "hole_distance"),
    (ROUNDED, "disk.eccentricity = 1", "eccentricity must lie in [0, radius)", "eccentricity"),
    (ROUNDED, "disk.inertia_y = 1e-9", "inertia_y must leave principal", "inertia_y"),
    (ROUNDED, "disk.inertia_z = 1", "inertia_z must leave principal", "inertia_z"),
    (PAPER, "friction.smoothing = 1e-12; friction.coefficient = 1e8",
     "smoothing must be at least coefficient / 1e+12", "smoothing"),
    (Scenario(friction=Stribeck()), "friction.static = 0.1", "kinetic must not exceed", "kinetic"),
    (PAPER, "start.beta = 1e-9", "beta must keep 1e-06 rad from 0 and pi", "beta"),
    (STATE, "start.coordinates = [0, 0, 0, 0, 4, 0]", "beta must lie in the open", "[start]"),
    (PAPER, "start.height = 0.1", "height must be 0 or left out on an ideal", "height"),
    (PAPER, "dissipation.pivoting = 1e-4", "dissipation acts on a penalty", "[dissipation]"),
    (SOFT, "model = 2", "contact must be left out, or constraints be", "[contact]"),
    (SOFT, "contact.stiffness = 1.0", "stiffness must be at least weight", "stiffness"),
    (SOFT, "contact.half_thickness = 1e-12", "half_thickness must be 0 or", "half_thickness"),
    (SOFT, "contact.half_thickness = 0.1", "half_thickness must not ex", "half_thickness"),
    # Starts that break a constraint.
    *((PAPER, f"model = 2; start.{name} = 1", f"{name} must be", name)
      for name in ("x", "y_rate")),
    (PAPER, "model = 3; start.gamma_rate = 5", "gamma_rate must be -2.44929e-15 in Model 3",
     "gamma_rate"),
    (SLIP_FREE, "start.x_rate = 1", "x_rate must be", "x_rate"),
    (HELD, "start.beta_rate = 1", "beta_rate must be", "beta_rate"),
    # Sets of constraints that are none.
    *((HELD, f"constraints = {given}", f"constraints must {fault}", "constraints")
      for given, fault in (
        ('["contact", "glue"]', "be one of contact, "),
        ('["contact", "contact"]', "name each constraint once"),
        ('["fixed-cog"]', "hold 'contact': without it"),
        ('"contact"', "be a list of names, got 'contact'"),
        ('["contact", "fixed-cog", "no-slip-along", "no-slip-across", "constant-spin"]',
         "leave the disk a freedom"),
    )),
]  # fmt: skip


def refusal(text: str, folder: Path) -> tuple[str, str]:
    """Message that refuses a text, and the line it names."""
    path = folder / "my.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"my\.toml, line \d+: ") as found:
        load_scenario(path)
    message = re.fullmatch(r".*my\.toml, line (\d+): (.*)", str(found.value))
    assert message is not None
    return message[2], text.split("\n")[int(message[1]) - 1]


@pytest.mark.parametrize(
    ("scenario", "entries", "message", "place"), REFUSED, ids=[each[1][:60] for each in REFUSED]
)
def test_refusal_names_key_and_line(
    scenario: Scenario, entries: str, message: str, place: str, tmp_path: Path
) -> None:
    text = scenario_text(scenario)
    for entry in entries.split("; "):
        name, _, literal = entry.partition(" =")
        table, _, key = name.rpartition(".")
        text = with_key(text, table, key, literal.strip() or None)
    said, line = refusal(text, tmp_path)
    assert said.startswith(message)
    assert line.startswith(place)


@pytest.mark.parametrize("table", [name for name, each in SECTIONS.items() if each.needed])
def test_missing_table_is_named_with_the_shortest_way_to_it(table: str, tmp_path: Path) -> None:
    text = re.sub(rf"\[{table}\]\n(.*\n)*?(?=\n|\Z)", "", scenario_text(PAPER))
    said, _ = refusal(text, tmp_path)
    assert said == f"the table [{table}] is missing; {SECTIONS[table].needed}"


@pytest.mark.parametrize("key", ["format", "model"])
def test_missing_key_is_named(key: str, tmp_path: Path) -> None:
    said, _ = refusal(with_key(scenario_text(PAPER), "", key, None), tmp_path)
    assert re.match(rf"{key} .*missing", said)
