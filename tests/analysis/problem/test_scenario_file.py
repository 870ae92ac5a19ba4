"""Scenarios as TOML files."""

import pickle
import re
import sys
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from analysis import (
    DISKS,
    LOADS,
    MODELS,
    POSSIBLE_SETS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Dissipation,
    PenaltyContact,
    Scenario,
    Start,
    State,
    Stribeck,
    Table,
    TanhCoulomb,
    load_scenario,
    scenario_text,
)
from analysis.problem.quantities import SECTIONS
from analysis.problem.scenario_file import LARGEST_FILE
from analysis.problem.values import SPELLED_ANGLES, angle
from tests.bodies import BODIES, RINGS
from tests.helpers import ROLLING, TILTED
from tests.scenario_texts import with_key
from tests.wayward_law import Own


def reals(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


AMOUNT = reals(0.0, 1.0)
LOAD = st.sampled_from(LOADS)
TEXT = st.text(st.characters(exclude_categories=["Cs"]))
ANGLES = reals(-7.0, 7.0) | st.sampled_from((pi / 2, pi / 90, -pi / 2 + 0.1))
IDEAL = st.builds(
    Scenario,
    constraints=st.sampled_from([*POSSIBLE_SETS, *TILTED]),
    disk=st.sampled_from([*DISKS.values()]) | st.builds(Disk.ring, radius=reals(0.04, 2.0)),
    friction=st.builds(TanhCoulomb, load=LOAD, coefficient=AMOUNT)
    | st.builds(Own, load=LOAD, strength=AMOUNT, kind=TEXT),
    table=st.builds(Table, inclination=reals(0.0, 1.5), downhill=ANGLES),
    start=st.builds(Start, beta=reals(0.1, 3.0), gamma=ANGLES, spin=reals(-1e5, 1e5)),
)
FREE = st.builds(
    Scenario,
    disk=st.sampled_from([*(BODIES | RINGS).values()]),
    start=st.builds(Start, beta_rate=st.none() | reals(-10.0, 10.0), x=st.none() | AMOUNT)
    | st.builds(
        State,
        coordinates=st.tuples(*[reals(-1.0, 1.0)] * 4, reals(0.1, 3.0), ANGLES),
        rates=st.tuples(*[reals(-1e3, 1e3)] * 6),
    ),
)
COMPLIANT = st.builds(
    Scenario,
    contact=st.builds(PenaltyContact, stiffness=reals(1e5, 1e9), bilateral=st.booleans()),
    dissipation=st.builds(Dissipation, pivoting=AMOUNT, air_drag=AMOUNT),
    start=st.builds(Start, height=st.none() | AMOUNT),
)


@pytest.mark.filterwarnings("ignore::analysis.problem.values.UnitWarning")
@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(IDEAL | FREE | COMPLIANT)
@example(Scenario(disk=replace(STEEL_DISK, eccentricity=0.0)))
def test_scenario_is_the_same_again(tmp_path: Path, scenario: Scenario) -> None:
    path = tmp_path / "my.toml"
    path.write_text(scenario_text(scenario), encoding="utf-8")
    copies = (
        load_scenario(path),
        Scenario.from_values(scenario.values()),
        pickle.loads(pickle.dumps(scenario)),  # noqa: S301 - ours
    )
    for again in copies:
        assert again == scenario
        assert again.values() == scenario.values()


def test_text_is_the_same_in_every_encoding_of_a_terminal() -> None:
    assert scenario_text(Scenario()).isascii()


@pytest.mark.parametrize("level", [1, 4])
def test_taking_in_what_was_left_out_changes_nothing_or_is_the_contact_of_the_way_to_rest(
    level: Any, tmp_path: Path
) -> None:
    scenario = Scenario(constraints=MODELS[level], start=Start(beta=1.2, gamma=0.3))
    text, path = scenario_text(scenario), tmp_path / "my.toml"
    contact, others, start = (text.index(each) for each in ("# [cont", "# What else", "[start]"))

    def taken_in(begin: int, end: int) -> Scenario:
        bare = re.sub(r"^# (?=\[|\w+ =)", "", text[begin:end], flags=re.MULTILINE)
        path.write_text(text[:begin] + bare + text[end:])
        return load_scenario(path)

    full = taken_in(start, len(text))
    assert isinstance(full.start, Start)
    assert None not in (full.start.x, full.start.gamma_rate, full.start.height)
    assert full.initial_state == scenario.initial_state
    if level == 1:
        assert taken_in(contact, others).contact == Scenario.rest().contact


def test_short_file_holds_what_it_must_and_angles_may_be_text(tmp_path: Path) -> None:
    text = """format = 1\nmodel = 3\ndisk.name = "steel-rounded"\n[friction]
[table]\ninclination = "2deg"\ndownhill = "pi/2"\n[start]\nbeta = "80 deg"\n"""
    path = tmp_path / "my.toml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert load_scenario(path) == Scenario(
        constraints=MODELS[3],
        disk=ROUNDED_STEEL_DISK,
        table=Table(inclination=pi / 90, downhill=pi / 2),
        start=Start(beta=80 * pi / 180),
    )
    angles = 'coordinates = [0, 0, 0.04, "pi", "pi/2", "45deg"]'
    path.write_text(
        f'format = 1\nmodel = 1\ndisk.name = "steel"\n[friction]\n[table]\n[start]\n{angles}\n'
        "rates = [0, 0, 0, 9, 0, 0]\n"
    )
    whole = State(coordinates=(0, 0, 0.04, pi, pi / 2, pi / 4), rates=(0, 0, 0, 9, 0, 0))
    assert load_scenario(path).start == whole


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi/2", pi / 2),
        ("-pi/2 + 0.1", -pi / 2 + 0.1),
        ("2*pi/3 - 45 deg", 2 * pi / 3 - 45 * pi / 180),
        ("2pi/3", 2 * pi / 3),
        ("1E-3", 1e-3),
        ("+.5", 0.5),
        *((text, value) for value, text in SPELLED_ANGLES.items()),
    ],
)
def test_angle_is_a_sum_of_products(text: str, value: float) -> None:
    assert angle("beta", text) == value


@pytest.mark.parametrize(
    "text", ["", "x", "--1", "1 2", "deg", "pi pi", "3-", "nan", "1_0", "١", "1/0", "1e400", "(1)"]
)
def test_what_is_no_angle_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"beta must be (an angle|finite|a finite number)"):
        angle("beta", text)


TOP = f"a scenario holds format, model, constraints, {', '.join([*SECTIONS][1:])}"


NO_SCENARIOS: dict[str, str | bytes] = {
    ", line 2: not TOML: Invalid value": "format = 1\nmodel = \n",
    ", line 2: not TOML: ": 'format = 1\nlaw = """\n\n',
    ", line 1: not TOML: nested too deeply": "a = " + "[" * 5000,
    ", line 3: disk must be a table, got 3": "format = 1\nmodel = 1\ndisk = 3\n",
    ", line 3: disk must be a table, got [": "format = 1\nmodel = 1\n[[disk]]\nname = 'steel'\n",
    ", line 4: name must be one of steel": "format = 1\nmodel = 1\n[disk]\n\"name\" = 'gold'\n",
    f", line 2: unknown key 'spim'; {TOP}; did you mean spin?": "format = 1\nspim = 1",
    " is no TOML: not text in UTF-8": b"PK\x03\x04\xff\xfe",
    " is too large: more than 1000000 bytes": b"#" * (LARGEST_FILE + 1),
}


@pytest.mark.parametrize("message", NO_SCENARIOS)
def test_what_is_no_scenario_is_refused_with_its_line(message: str, tmp_path: Path) -> None:
    path, content = tmp_path / "my.toml", NO_SCENARIOS[message]
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ValueError, match=re.escape(f"my.toml{message}")):
        load_scenario(path)


def test_file_runs_the_module_of_its_law_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own_law.py").write_text(
        "from tests.wayward_law import Own\n\nclass Rough(Own):\n    pass\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    path, law = tmp_path / "my.toml", '"own_law:Rough"'
    short = 'format = 1\nmodel = 1\ndisk.name = "steel"\ntable = {}\n'
    path.write_text(f"{short}friction = {{}}\nstart.gamma = {law}\n")
    with pytest.raises(ValueError, match="gamma must be an angle"):
        load_scenario(path)
    assert "own_law" not in sys.modules
    path.write_text(f"{short}start = {{}}\nfriction.law = {law}\n")
    try:
        assert type(load_scenario(path).friction).__module__ == "own_law"
    finally:
        sys.modules.pop("own_law", None)


# --- Refusals of the data types, each reachable from a file, with key and line -------------------

PAPER = Scenario()
SOFT = Scenario.rest()
ROUNDED = Scenario(disk=ROUNDED_STEEL_DISK)
STATE = Scenario(start=State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.1), rates=(0.0,) * 6))
SLIP_FREE = Scenario(constraints=ROLLING)
HELD = Scenario(constraints=("contact", "fixed-cog", "no-slip-across"))

REFUSED: list[tuple[Scenario, str, str, str]] = [
    # What the file itself says: keys with their values, the message, and the key to blame.
    (PAPER, "format = 2", "format 2 is newer than this version", "format"),
    (PAPER, "format =", "format is missing; it must be 1", ""),
    (PAPER, "model =", "model or constraints is missing; model = 1", ""),
    (PAPER, "model = 5", "model must be one of 1, 2, 3, 4, got '5'", "model"),
    (PAPER, 'constraints = ["contact"]', "constraints do not go together with", "constraints"),
    (PAPER, "radius = 0.1", "radius must stand in the table [disk]", "radius"),
    (PAPER, "mu = 0.1", "mu must stand in the table [friction] as coefficient", "mu"),
    (PAPER, "colour = 3", "unknown key 'colour'; a scenario holds format, model", "colour"),
    (PAPER, "disk.colour = 3", "colour is unknown here; [disk] takes name; or radius", "colour"),
    (PAPER, "disk.density =", "[disk] lacks density", "[disk]"),
    (PAPER, "start.coordinates = [1]", "beta is unknown here; [start] takes coord", "beta"),
    # Values of the wrong kind, among them wrong units.
    (PAPER, 'disk.radius = "45mm"', "radius must be a number in m, got '45mm'", "radius"),
    (PAPER, "disk.radius = 1" + 400 * "0", "radius must be a finite number, got one", "radius"),
    (PAPER, "friction.law = []", "law must be text, got []", "law"),
    (PAPER, 'friction.law = ".x:Law"', "friction law '.x:Law' cannot be loaded", "law"),
    (STATE, 'start.coordinates = [0, 0, 0, 0, 1, "up"]', "coordinates[gamma] must", "coordinates"),
    (STATE, 'start.coordinates = [0, 0, "pi", 0, 1, 0]', "coordinates[z] must be", "coordinates"),
    # Values that do not fit each other.
    (PAPER, "disk.hole_distance = 1", "hole_distance must be less than radius", "hole_distance"),
    (ROUNDED, "disk.eccentricity = 1", "eccentricity must be less than radius", "eccentricity"),
    (PAPER, "friction.smoothing = 1e-12; friction.coefficient = 1e8",
     "smoothing must be at least coefficient / 1e+12", "smoothing"),
    (Scenario(friction=Stribeck()), "friction.static = 0.1", "kinetic must not exceed", "kinetic"),
    (PAPER, "start.beta = 1e-9", "beta must keep more than 1e-06 rad from 0", "beta"),
    (STATE, "start.coordinates = [0, 0, 0, 0, 4, 0]", "beta must lie in the open", "[start]"),
    (PAPER, "start.height = 0.1", "height must be 0 or left out on an ideal", "height"),
    (PAPER, "dissipation.pivoting = 1e-4",
     "dissipation acts on a penalty contact alone, which has a stiffness", "[dissipation]"),
    (SOFT, "model = 2", "contact must be left out, or constraints be", "[contact]"),
    (SOFT, "contact.stiffness = 1.0", "stiffness must be at least weight", "stiffness"),
    (SOFT, "contact.half_thickness = 1e-12", "half_thickness must be 0 or", "half_thickness"),
    (SOFT, "contact.half_thickness = 0.1", "half_thickness must not ex", "half_thickness"),
    # Starts that break a constraint.
    *((PAPER, f"model = 2; start.{name} = 1", f"{name} must be", name)
      for name in ("x", "y_rate")),
    (PAPER, "model = 3; start.gamma_rate = 5", "gamma_rate must be 0 in Model 3",
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
