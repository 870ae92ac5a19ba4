"""Scenarios as TOML files."""

import re
import sys
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
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
    FrictionLaw,
    PenaltyContact,
    Scenario,
    Start,
    State,
    Table,
    TanhCoulomb,
    load_scenario,
    scenario_text,
)
from analysis.data.angles import angle, spelled_angle
from analysis.data.quantities import SECTIONS
from analysis.data.scenario_file import LARGEST_FILE
from tests.helpers import TILTED

QUICK = settings(
    max_examples=100,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Own(FrictionLaw):
    """A law of one's own, with a parameter of each kind."""

    strength: float = 0.3
    kind: str = 'quoted "so" \\ and\tso'
    order: int = 2
    smooth: bool = True
    nothing: float | None = None

    def per_speed(self, speed: float) -> float:
        return 0.3 / (self.order + speed)

    @property
    def finest_speed(self) -> float:
        return 1.0


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


@pytest.mark.filterwarnings("ignore::analysis.data.written.UnitWarning")
@QUICK
@given(IDEAL | FREE | COMPLIANT)
def test_scenario_comes_back_from_its_text(tmp_path: Path, scenario: Scenario) -> None:
    path = tmp_path / "my.toml"
    path.write_text(scenario_text(scenario), encoding="utf-8")
    assert load_scenario(path) == scenario


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


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi/2", pi / 2),
        ("-pi/2 + 0.1", -pi / 2 + 0.1),
        ("2*pi/3 - 45 deg", 2 * pi / 3 - 45 * pi / 180),
        ("2pi/3", 2 * pi / 3),
        ("1E-3", 1e-3),
        ("+.5", 0.5),
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


@given(ANGLES)
def test_angle_is_spelled_exactly_or_not_at_all(value: float) -> None:
    text = spelled_angle(value)
    assert text is None or angle("beta", text) == value


HELD = f"a scenario holds format, model, constraints, {', '.join([*SECTIONS][1:])}"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("format = 1\nmodel = \n", 2, "not TOML: Invalid value"),
        ('format = 1\nlaw = """\n\n', 2, "not TOML: "),
        ("a = " + "[" * 5000, 1, "not TOML: nested too deeply"),
        ("", 1, "format is missing; it must be 1"),
        ("format = 1\nmodel = 1\ndisk = 3\n", 3, "disk must be a table, got 3"),
        ("format = 1\nmodel = 1\n[disk]\n\"name\" = 'gold'\n", 4, "name must be one of steel"),
        ("format = 1\nspim = 1", 2, f"unknown key 'spim'; {HELD}; did you mean spin?"),
        ("format = 1\nmodel = 1\n[[disk]]\nname = 'steel'\n", 3, "disk must be a table, got ["),
    ],
)
def test_text_that_is_no_scenario_is_refused_with_its_line(
    text: str, line: int, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "my.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(f"my.toml, line {line}: {message}")):
        load_scenario(path)


def test_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    for content, message in (
        (b"PK\x03\x04\xff\xfe", "is no TOML: not text in UTF-8"),
        (b"#" * (LARGEST_FILE + 1), "is too large: more than 1000000 bytes"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=message):
            load_scenario(path)


def test_file_runs_the_module_of_its_law_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own_law.py").write_text(
        "from tests.analysis.data.test_scenario_file import Own\n\nclass Rough(Own):\n    pass\n"
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


def test_law_that_toml_cannot_hold_is_refused() -> None:
    law = Own(strength={1})  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"strength cannot be written to a scenario's file"):
        scenario_text(replace(Scenario(), disk=STEEL_DISK, friction=law))
