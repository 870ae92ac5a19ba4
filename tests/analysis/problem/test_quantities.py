"""Every quantity is declared once: types, files, options, axes, changes and refusals know it."""

import re
from dataclasses import MISSING, asdict, fields, replace
from math import inf
from pathlib import Path
from typing import Any

import pytest

from analysis import (
    BODIES,
    LAWS,
    MODELS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Scenario,
    SmoothCoulomb,
    Start,
    Stribeck,
    load_scenario,
    scenario_text,
)
from analysis.problem.disk import STEEL_RING
from analysis.problem.names import ArgumentError, full_name
from analysis.problem.quantities import QUANTITIES, RING, Quantity, default
from analysis.problem.scenario import KINDS, as_plain
from analysis.problem.variations import changed
from tests.calls import printed, run
from tests.scenario_texts import with_key
from validation.sweeps.axes import axis_from_text

EVERY = pytest.mark.parametrize("quantity", QUANTITIES.values(), ids=list(QUANTITIES))


def home(quantity: Quantity) -> Scenario:
    """A scenario in which a quantity has a place."""
    if quantity.table == "friction":
        laws = [law for law in LAWS.values() if hasattr(law, quantity.name)]
        return Scenario(friction=laws[0]() if laws else LAWS["tanh"]())
    if quantity.table == "disk" and quantity.name not in (*RING, "name"):
        every = ((name, each.name) for name, kind in BODIES.items() for each in fields(kind))
        kinds = [kind for kind, name in every if name == quantity.name]
        # "body" is no field of any.
        return changed(Scenario(disk=ROUNDED_STEEL_DISK), {"disk.body": (kinds or ["disk"])[0]})
    soft = quantity.table in ("contact", "dissipation") or quantity.name == "height"
    return Scenario.rest() if soft else Scenario()


def other(quantity: Quantity, scenario: Scenario) -> float | str:
    """Another value, near that of a scenario if there is one."""
    if quantity.choices:
        return "contact" if quantity.key == "constraints" else quantity.choices[-1]
    now = as_plain(getattr(scenario, quantity.table)).get(quantity.name)
    return 1.01 * now if now else 1e-6


def beyond(quantity: Quantity) -> list[float | str]:
    """Values that are out of range."""
    if quantity.choices:
        return ["glue"]
    found: list[float | str] = [float("nan")]
    if quantity.least > -inf:
        found.append(quantity.least if quantity.is_above else 2.0 * quantity.least - 1.0)
    if quantity.most < inf:
        found.append(quantity.most if quantity.is_below else 2.0 * quantity.most)
    return found


def test_every_number_of_a_data_type_is_declared_with_its_default() -> None:
    for table, kind in (KINDS | {"disk": Disk, "start": Start}).items():
        for field in fields(kind):
            assert field.default in (default(f"{table}.{field.name}"), None, MISSING)
    for law in LAWS.values():
        for field in fields(law):
            assert field.default == default(f"friction.{field.name}")


@EVERY
def test_a_quantity_is_found_by_name_an_axis_and_a_commented_key(quantity: Quantity) -> None:
    assert full_name(quantity.key) == full_name(quantity.name) == quantity.key
    assert quantity.is_word or full_name(quantity.flag.lstrip("-")) == quantity.key
    assert sum(each.flag == quantity.flag for each in QUANTITIES.values()) == 1
    if quantity.choices:
        values = ",".join(str(each).lower() for each in quantity.choices)
        assert axis_from_text(f"{quantity.key}={values}").size == len(quantity.choices)
    else:
        assert axis_from_text(f"{quantity.key}=0.1:0.2:3").at(0) == 0.1
    text = scenario_text(home(quantity))
    assert max(map(len, text.split("\n"))) <= 99
    if quantity.table and quantity.key != "disk.name":
        comment = re.escape(quantity.comment)
        assert re.search(rf"^(# )?{quantity.name} = \S.*  # {comment}$", text, re.MULTILINE)
    else:
        assert f"{quantity.name} = " in text


def test_every_quantity_is_told_with_what_it_means_and_its_default_if_there_is_one() -> None:
    shown = " ".join(printed("scenario --help").split())
    for quantity in QUANTITIES.values():
        assert re.search(rf"{quantity.flag}\b[^-].*{re.escape(quantity.meaning)}", shown)
    assert f"in m ({STEEL_DISK.radius}) --hole-radius" in shown
    assert "in kg --eccentricity" in shown


@EVERY
def test_an_option_changes_its_quantity_and_nothing_else(
    quantity: Quantity, tmp_path: Path
) -> None:
    scenario, path = home(quantity), tmp_path / "my.toml"
    path.write_text(scenario_text(scenario))
    value = other(quantity, scenario)
    words = [f"{quantity.flag}={value}"]
    if quantity.is_switch:
        words = [quantity.flag.replace("--", "--no-")]
    shown = printed("scenario", str(path), *words)
    assert shown == scenario_text(changed(scenario, {quantity.key: value}))
    assert quantity.is_switch or value == "contact" or shown != scenario_text(scenario)


@EVERY
def test_what_is_out_of_range_is_refused_by_name(
    quantity: Quantity, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario, path = home(quantity), tmp_path / "my.toml"
    text = scenario_text(scenario)
    for value in beyond(quantity):
        with pytest.raises((ArgumentError, KeyError)) as refused:
            changed(scenario, {quantity.key: value})
        assert quantity.name in str(refused.value) or quantity.key == "model"
        path.write_text(text)
        assert run("scenario", str(path), f"{quantity.flag}={value}") == 2
        said = capsys.readouterr().err.splitlines()[-1]
        named = rf"(argument )?{quantity.flag}(/--no\S*)?"
        assert re.fullmatch(rf"tippedisk scenario: error: {named}: .*", said)
        if quantity.table and quantity.key != "disk.name":
            literal = f'"{value}"' if isinstance(value, str) else str(value)
            path.write_text(with_key(text, quantity.table, quantity.name, literal))
            with pytest.raises(ValueError, match=rf"my\.toml, line \d+: .*{quantity.name} ") as at:
                load_scenario(path)
            line = int(str(at.value).partition("line ")[2].partition(":")[0])
            assert path.read_text().split("\n")[line - 1] == f"{quantity.name} = {literal}"


# --- Quantities that vary ------------------------------------------------------------------------

PAPER = Scenario(friction=SmoothCoulomb(smoothing=0.05))
SMALL_HOLE = Disk.ring(**(STEEL_RING | {"hole_radius": 0.01}))
TWICE = {name: 2.0 * value for name, value in asdict(STEEL_DISK).items()}


@pytest.mark.parametrize(
    ("changes", "field", "value"),
    [
        ({"start.spin": 12.0}, "start", Start(spin=12.0)),
        ({"model": 4}, "constraints", MODELS[4]),
        ({"constraints": "contact+fixed-cog"}, "constraints", MODELS[2]),
        ({"friction.static": 0.6, "friction.law": "stribeck"}, "friction", Stribeck(static=0.6)),
        (
            {"friction.load": "contact", "friction.law": "smooth-coulomb"},
            "friction",
            replace(PAPER.friction, load="contact"),
        ),
        (
            {"disk.eccentricity": 2e-3, "disk.name": "steel-rounded"},
            "disk",
            replace(ROUNDED_STEEL_DISK, eccentricity=2e-3),
        ),
        ({"disk.hole_radius": 0.01}, "disk", SMALL_HOLE),
        ({"disk.hole_radius": 0.01, "disk.body": "disk"}, "disk", SMALL_HOLE),
        (
            {"disk.body": "disk"} | {f"disk.{key}": each for key, each in STEEL_RING.items()},
            "disk",
            STEEL_DISK,
        ),
        ({f"disk.{name}": value for name, value in TWICE.items()}, "disk", Disk(**TWICE)),
    ],
)
def test_case_is_the_scenario_with_its_fields_changed(
    changes: Any, field: str, value: Any
) -> None:
    assert changed(PAPER, changes) == replace(PAPER, **{field: value})
