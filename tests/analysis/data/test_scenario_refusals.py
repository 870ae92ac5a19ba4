"""Each refusal of the data types is reachable from a scenario's file, with key and line."""

import re
from pathlib import Path

import pytest

from analysis.data.constraint_set import POSSIBLE_SETS
from analysis.data.disk import ROUNDED_STEEL_DISK
from analysis.data.friction import Stribeck
from analysis.data.quantities import SECTIONS
from analysis.data.scenario import Scenario
from analysis.data.scenario_file import load_scenario
from analysis.data.scenario_text import scenario_text
from analysis.data.state import State
from tests.scenario_texts import with_key

Entry = tuple[str, str, str | None]


def refusal(text: str, folder: Path) -> tuple[str, str]:
    """Message that refuses a text, and the line it names."""
    path = folder / "my.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"my\.toml, line \d+: ") as found:
        load_scenario(path)
    message = str(found.value)
    assert "\n" not in message
    match = re.search(r"my\.toml, line (\d+): (.*)", message)
    assert match is not None
    return match[2], text.split("\n")[int(match[1]) - 1]


REFUSED: list[tuple[list[Entry], str, str]] = [
    # What the file itself says.
    ([("", "format", "2")], "format 2 is newer than this version", "format"),
    ([("", "format", "0")], "format must be 1, got 0", "format"),
    ([("", "format", "true")], "format must be 1, got True", "format"),
    ([("", "model", "5")], "model must be one of 1, 2, 3, 4, got 5", "model"),
    ([("", "model", "1.0")], "model must be one of 1, 2, 3, 4, got 1.0", "model"),
    ([("", "model", "true")], "model must be one of 1, 2, 3, 4, got True", "model"),
    ([("", "constraints", '["contact"]')], "constraints do not go together with", "constraints"),
    ([("", "radius", "0.1")], "radius must stand in the table [disk]", "radius"),
    ([("", "colour", "3")], "unknown key 'colour'; a scenario holds format, model", "colour"),
    ([("disk", "colour", "3")], "colour is unknown here; [disk] takes name; or radius", "colour"),
    ([("table", "angle", "3")], "angle is unknown here; [table] takes gravity, inc", "angle"),
    ([("disk", "mass", "1.0")], "mass is unknown here; [disk] takes name; or radius", "mass"),
    ([("disk", "density", None)], "[disk] lacks density", "[disk]"),
    ([("friction", "viscosity", "1.0")], "viscosity is unknown here; [friction]", "viscosity"),
    # Values of the wrong kind, among them wrong units.
    ([("disk", "radius", '"45mm"')], "radius must be a number in m, got '45mm'", "radius"),
    ([("disk", "radius", "true")], "radius must be a finite number, got True", "radius"),
    ([("disk", "radius", "1979-05-27")], "radius must be a finite number, got", "radius"),
    ([("disk", "radius", "[1.0]")], "radius must be a finite number, got [1.0]", "radius"),
    ([("disk", "radius", "1" + 400 * "0")], "radius must be a finite number, got one", "radius"),
    ([("table", "inclination", '"2 grad"')], "inclination must be an angle", "inclination"),
    ([("friction", "law", "[]")], "friction law must be one of smooth-coulomb", "law"),
    ([("friction", "law", '"math:sin"')], "friction law 'math:sin' must be a class", "law"),
    ([("friction", "law", '"nowhere:Law"')], "friction law 'nowhere:Law' cannot be", "law"),
    ([("friction", "law", '".x:Law"')], "friction law '.x:Law' cannot be loaded", "law"),
    (
        [
            ("friction", "law", '"analysis.data.friction:FrictionLaw"'),
            ("friction", "coefficient", None),
            ("friction", "smoothing", None),
        ],
        "friction law 'analysis.data.friction:FrictionLaw' cannot be made: Can't inst",
        "law",
    ),
    # Values that do not fit each other.
    ([("disk", "hole_distance", "1")], "hole_distance + hole_radius must be", "hole_distance"),
    (
        [("friction", "coefficient", "1e8"), ("friction", "smoothing", "1e-9")],
        "smoothing must be at least coefficient / 1e+12",
        "smoothing",
    ),
    ([("start", "beta", "1e-9")], "beta must keep 1e-06 rad from 0 and pi", "beta"),
    ([("start", "height", "0.1")], "height must be 0 or left out on an ideal", "height"),
    (
        [("", "model", "3"), ("start", "gamma_rate", "5")],
        "gamma_rate must be -2.44929e-15 in Model 3",
        "gamma_rate",
    ),
    ([("", "model", "2"), ("start", "x", "0")], "x must be -0.000249584 in Model 2", "x"),
    ([("", "model", "2"), ("start", "y", "1")], "y must be", "y"),
    ([("", "model", "2"), ("start", "x_rate", "1")], "x_rate must be", "x_rate"),
    ([("", "model", "2"), ("start", "y_rate", "1")], "y_rate must be", "y_rate"),
    ([("dissipation", "pivoting", "1e-4")], "dissipation acts on a penalty cont", "[dissipation]"),
    ([("start", "coordinates", "[1]")], "beta is unknown here; [start] takes coord", "beta"),
]

REFUSED_OF_CONTACT: list[tuple[list[Entry], str, str]] = [
    ([("", "model", "2")], "contact must be left out, or constraints be", "[contact]"),
    ([("contact", "stiffness", None)], "[contact] lacks stiffness", "[contact]"),
    ([("contact", "stiffness", "1.0")], "stiffness must be at least weight", "stiffness"),
    ([("contact", "half_thickness", "1e-12")], "half_thickness must be 0 or", "half_thickness"),
    ([("contact", "half_thickness", "0.1")], "half_thickness must not exceed", "half_thickness"),
]

STATE = State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.1), rates=(0.0,) * 6)

REFUSED_OF_OTHERS: list[tuple[Scenario, list[Entry], str, str]] = [
    (Scenario(start=STATE), [("start", "rates", None)], "[start] lacks rates", "[start]"),
    (Scenario(start=STATE), [("start", "rates", "3")], "rates must be a list of 6", "rates"),
    (Scenario(start=STATE), [("start", "rates", "[1]")], "rates must hold 6 numb", "rates"),
    (
        Scenario(start=STATE),
        [("start", "coordinates", '[0, 0, 0, 0, 0, "pi"]')],
        "coordinates[gamma] must be a finite number, got 'pi'",
        "coordinates",
    ),
    (
        Scenario(start=STATE),
        [("start", "coordinates", "[0, 0, 0, 0, 4, 0]")],
        "beta must lie in the open interval",
        "[start]",
    ),
    (Scenario(start=STATE), [("start", "spin", "4")], "spin is unknown here; [start]", "spin"),
    (
        Scenario(friction=Stribeck()),
        [("friction", "static", "0.1")],
        "kinetic must not exceed static = 0.1, got 0.3",
        "kinetic",
    ),
    (
        Scenario(disk=ROUNDED_STEEL_DISK),
        [("disk", "eccentricity", "1")],
        "eccentricity must lie in [0, radius) = [0, 0.045), got 1",
        "eccentricity",
    ),
    (
        Scenario(disk=ROUNDED_STEEL_DISK),
        [("disk", "inertia_y", "1e-9")],
        "inertia_y must exceed mass * eccentricity²",
        "inertia_y",
    ),
    (
        Scenario(disk=ROUNDED_STEEL_DISK),
        [("disk", "inertia_z", "1")],
        "inertia_z must not exceed the sum of the two other",
        "inertia_z",
    ),
    (
        Scenario(disk=ROUNDED_STEEL_DISK),
        [("disk", "name", '"steel"')],
        "radius is unknown here; [disk] takes name; or",
        "radius",
    ),
]

REFUSED_SETS = [
    ('["contact", "glue"]', "constraints must be one of contact, "),
    ('["contact", "contact"]', "constraints must name each constraint o"),
    ('["fixed-cog"]', "constraints must hold 'contact': without it"),
    ("[]", "constraints must hold 'contact': without it"),
    ("1.5", "constraints must be a list of names, got 1.5"),
    ('"contact"', "constraints must be a list of names, got 'contact'"),
    ("[1]", "constraints must be a list of names, got [1]"),
    (
        '["contact", "fixed-cog", "no-slip-along", "no-slip-across", "constant-spin"]',
        "constraints must leave the disk a freedom",
    ),
]

SLIP_FREE = Scenario(constraints=("contact", "no-slip-along", "no-slip-across"))
HELD = Scenario(constraints=("contact", "fixed-cog", "no-slip-across"))

REFUSED_OF_SETS: list[tuple[Scenario, list[Entry], str, str]] = [
    (SLIP_FREE, [("start", "x_rate", "1")], "x_rate must be", "x_rate"),
    (SLIP_FREE, [("start", "y_rate", "1")], "y_rate must be", "y_rate"),
    (HELD, [("start", "beta_rate", "1")], "beta_rate must be", "beta_rate"),
]

Case = tuple[Scenario, list[Entry], str, str]


def set_case(given: str, message: str) -> Case:
    scenario = Scenario(constraints=POSSIBLE_SETS[4])
    return scenario, [("", "constraints", given)], message, "constraints"


ALL_REFUSED: list[Case] = [
    *((Scenario(), *case) for case in REFUSED),
    *((Scenario.rest(), *case) for case in REFUSED_OF_CONTACT),
    *REFUSED_OF_OTHERS,
    *REFUSED_OF_SETS,
    *(set_case(given, message) for given, message in REFUSED_SETS),
]


@pytest.mark.parametrize(
    ("scenario", "entries", "message", "place"),
    ALL_REFUSED,
    ids=[
        " ".join(f"{table}.{key}={value}"[:60] for table, key, value in c[1]) for c in ALL_REFUSED
    ],
)
def test_refusal_names_key_and_line(
    scenario: Scenario, entries: list[Entry], message: str, place: str, tmp_path: Path
) -> None:
    text = scenario_text(scenario)
    for entry in entries:
        text = with_key(text, *entry)
    said, line = refusal(text, tmp_path)
    assert said.startswith(message)
    assert re.match(r"[\[\]\w]+", line)[0] == place  # type: ignore[index]


@pytest.mark.parametrize("table", [name for name, each in SECTIONS.items() if each.needed])
def test_missing_table_is_named_with_the_shortest_way_to_it(table: str, tmp_path: Path) -> None:
    text = re.sub(rf"\[{table}\]\n(.*\n)*?(?=\n|\Z)", "", scenario_text(Scenario()))
    said, _ = refusal(text, tmp_path)
    assert said == f"the table [{table}] is missing; {SECTIONS[table].needed}"


@pytest.mark.parametrize("key", ["format", "model"])
def test_missing_key_is_named(key: str, tmp_path: Path) -> None:
    said, _ = refusal(with_key(scenario_text(Scenario()), "", key, None), tmp_path)
    assert f"{key} " in said
    assert "missing" in said
