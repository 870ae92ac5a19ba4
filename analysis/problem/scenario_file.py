"""Scenarios as TOML files: their commented text, and reading one, which says what is wrong."""

import json
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import asdict
from numbers import Integral, Real
from pathlib import Path
from textwrap import wrap
from typing import Any

from analysis.problem.body import PRODUCTS
from analysis.problem.checks import instance, path_like
from analysis.problem.constraints import MODELS
from analysis.problem.contact import PenaltyContact
from analysis.problem.disk import STEEL_RING
from analysis.problem.names import ArgumentError, nearest
from analysis.problem.quantities import CONSTRAINTS, KEYS, SECTIONS, SIX, declared, of_table
from analysis.problem.scenario import Scenario, made_part, told_constraints
from analysis.problem.start import COORDINATES
from analysis.problem.values import SPELLED_ANGLES, read_value

FORMAT = 1
"""Of the files written here."""

_MODELS = ", ".join(f"{level} {each[-1]}" for level, each in MODELS.items())
_FURTHER = "\n# ".join(wrap(", ".join(f'"{each}"' for each in CONSTRAINTS[1:]), 97))

_ABOUT: dict[str, str] = {
    "": f"""\
# A problem of the tippedisk, whole: tippedisk simulate --scenario FILE --out run.npz
# Angles are in rad, or text: "pi/2", "-pi/2 + 0.1", "90deg".
format = {FORMAT}

# What holds the disk: a model of the paper, each of which adds a constraint
# ({_MODELS}), or in place of it
# "contact" and some, not all, of
# {_FURTHER}.
""",
    "disk": """\
# A disk by its name; a disk of uniform density: radius, thickness and density with one hole, or
# in place of that with several, [x, y, radius], and small masses, [x, y, mass]; any disk:
# radius, mass, eccentricity and moments of inertia; or another body, which takes its values too.
""",
    "friction": f"""\
# Laws: {declared("friction.law").allowed}.
""",
    "contact": """\
# Without this table the disk neither leaves the table nor sinks into it (ideal contact).
# With it, the contact is a spring and a damper at the lowest point; for Model 1.
""",
    "start": f"""\
# What is left out follows from the rest and from the constraints. A start may also be told by
# all of its coordinates and rates: coordinates = [{", ".join(COORDINATES)}] and rates = [...].
""",
}

_OF_LIST = {
    "coordinates": f"{', '.join(COORDINATES)} in m and rad",
    "rates": "their rates in m/s and rad/s",
    "holes": "in m, in axes of the plate",
    "masses": "in m and kg",
}


def scenario_text(scenario: Scenario) -> str:
    """TOML text of a scenario, with every key, its unit and what is allowed.

    `load_scenario` makes an equal scenario from it.

    Parameters
    ----------
    scenario : Scenario

    Raises
    ------
    ValueError
        If it is no scenario, or a friction law of one's own has a parameter that TOML cannot
        hold.

    Examples
    --------
    >>> from analysis import Scenario, Start, scenario_text
    >>> "spin = 35.0" in scenario_text(Scenario(start=Start(spin=35.0)))
    True
    """
    values, usual = instance("scenario", scenario, Scenario).values(), _usual(scenario)
    told = "constraints" if scenario.model is None else "model"
    values[""] = {told: usual[""][told]}
    return "\n".join(_table(name, values.get(name), usual.get(name, {})) for name in SECTIONS)


def _usual(scenario: Scenario) -> dict[str, dict[str, Any]]:
    """What is shown of keys that are not told: to take it in changes nothing, or little."""
    state, disk = scenario.initial_state, scenario.disk
    rates = {f"{name}_rate": rate for name, rate in zip(COORDINATES, state.rates, strict=True)}
    return {
        "": {"model": scenario.model or 1, "constraints": scenario.constraints},
        "disk": STEEL_RING
        | {name: getattr(disk, name) for name in (*SIX, *PRODUCTS)}
        | {"holes": [], "masses": []},
        "contact": asdict(PenaltyContact.rounded(disk)),
        "start": dict(zip(COORDINATES, state.coordinates, strict=True))
        | rates
        | {"spin": state.rates[3], "height": 0.0},
    }


def _table(table: str, given: dict[str, Any] | None, usual: dict[str, Any]) -> str:
    """A table with the keys that tell it, and all others as comments; one if it is left out.

    What stands before the tables has no heading, and is told of above its keys alone.
    """
    known = of_table(table)
    values = {name: each.default for name, each in known.items()}
    values |= {name: each for name, each in usual.items() if name in values | _OF_LIST}
    heading = f"{'# ' if given is None else ''}[{table}]\n" if table else ""
    lines = [_ABOUT.get(table, f"# {SECTIONS[table].about}\n"), heading]
    # TOML has no word for what is left out.
    given = {name: each for name, each in (given or {}).items() if each is not None}
    for name, value in (values | given).items():
        quantity = known.get(name) or declared(f"{table}.{name}")
        literal = _literal(name, SPELLED_ANGLES.get(value, value) if quantity.is_angle else value)
        about = f"  # {_OF_LIST.get(name, quantity.comment)}" if table else ""
        lines.append(f"{'' if name in given else '# '}{name} = {literal}{about}\n")
    return "".join(lines)


def _literal(name: str, value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return repr(float(value))
    if isinstance(value, list | tuple):
        return f"[{', '.join(_literal(name, each) for each in value)}]"
    raise ValueError(f"{name} cannot be written to a scenario's file: {value!r}")


LARGEST_FILE = 1_000_000
"""Bytes that are read; a scenario takes some thousand."""

_TABLES = tuple(name for name in SECTIONS if name)
_TOP = ("format", "model", "constraints", *_TABLES)
_KEY = re.compile(r"\s*(\[\[?)?\s*([\w\"'.\- ]+?)\s*[\]=]")
_LINE = re.compile(r" \(at (?:line (\d+), column \d+|end of document)\)$")


def load_scenario(path: str | os.PathLike[str]) -> Scenario:
    """Read a scenario from a TOML file, as `scenario_text` writes it.

    Nothing is executed but the modules of a friction law and a body that the file names, as
    `module:Class`.

    Parameters
    ----------
    path : path-like

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no TOML, has a newer format, lacks a key or a table, or holds an unknown key or
        a value of the wrong kind or out of range. The message names the file, the line, the key
        and what is allowed.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from analysis import Scenario, load_scenario, scenario_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "paper.toml"
    ...     length = path.write_text(scenario_text(Scenario()))
    ...     load_scenario(path) == Scenario()
    True
    """
    values, text = read_toml(path)
    try:
        return _scenario(values)
    except ValueError as error:
        line = _line_of(text, getattr(error, "argument", ""))
        raise ValueError(f"{path}, line {line}: {error}") from None


def read_toml(path: str | os.PathLike[str]) -> tuple[dict[str, Any], str]:
    """What a TOML file holds, and its text.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no TOML. The message names the file and the line.
    """
    with Path(path_like("path", path)).open("rb") as stream:
        content = stream.read(LARGEST_FILE + 1)
    if len(content) > LARGEST_FILE:
        raise ValueError(f"{path} is too large: more than {LARGEST_FILE} bytes")
    try:
        text = content.decode("utf-8-sig").replace("\r\n", "\n")
        return tomllib.loads(text), text
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no TOML: not text in UTF-8") from None
    except RecursionError:
        message = "nested too deeply"
    except ValueError as error:
        message = " ".join(str(error).split())
    at_line = _LINE.search(message)
    line = at_line[1] if at_line and at_line[1] else text.rstrip("\n").count("\n") + 1
    raise ValueError(f"{path}, line {line}: not TOML: {_LINE.sub('', message)}")


def _scenario(values: Mapping[str, Any]) -> Scenario:
    """Scenario of what a file holds; errors carry the key."""
    for key in values:
        if key not in _TOP:
            raise ArgumentError(key, *_stray(key))
    given = values.get("format")
    if type(given) is int and given > FORMAT:
        fault = f"is newer than this version of tippedisk, which reads {FORMAT}"
        raise ArgumentError("format", fault, f"format {given}")
    if type(given) is not int or given != FORMAT:
        missing = f"is missing; it must be {FORMAT}"
        fault = missing if given is None else f"must be {FORMAT}, got {given!r}"
        raise ArgumentError("format", fault)
    parts = {"constraints": told_constraints(values.get("model"), values.get("constraints"))}
    for table in _TABLES:
        if table in values:
            parts[table] = made_part(table, _read(table, values[table]))
        elif SECTIONS[table].needed:
            fault = f"is missing; {SECTIONS[table].needed}"
            raise ArgumentError("end of file", fault, f"the table [{table}]")
    return Scenario(**parts)


def _stray(key: str) -> tuple[str, str]:
    """What is wrong with an unknown key outside of the tables, and what to call it."""
    table, _, name = KEYS.get(key, "").rpartition(".")
    if table:
        called = "" if name == key else f" as {name}"
        return f"must stand in the table [{table}]{called}", key
    known = nearest(key, [*_TOP, *KEYS])
    return f"a scenario holds {', '.join(_TOP)}{known}", f"unknown key {key!r};"


def _read(table: str, values: Any) -> Any:
    """What a table holds, its values read as everywhere."""
    if not isinstance(values, Mapping):
        return values
    known = of_table(table)
    found = {
        name: read_value(known[name].key, value, name) if name in known else value
        for name, value in values.items()
    }
    if isinstance(state := values.get("coordinates"), list) and len(state) == len(COORDINATES):
        found["coordinates"] = state[:3] + [
            read_value(f"start.{name}", each, f"coordinates[{name}]")
            for name, each in zip(COORDINATES[3:], state[3:], strict=True)
        ]
    return found


def _line_of(text: str, argument: str) -> int:
    """Line at which an argument stands, or the table that it belongs to, or else the last."""
    rows = text.rstrip("\n").split("\n")
    lines: dict[str, int] = {}
    table = ""
    for line, row in enumerate(rows, 1):
        if key := _KEY.match(row):
            name = re.sub(r"[\s\"']", "", key[2])
            if key[1]:
                table = full = name
            else:
                full = f"{table}.{name}" if table else name
            for part in (full, full.partition(".")[0]):
                lines.setdefault(part, line)
    # An entry of a list is found by the list.
    name = argument.partition("[")[0]
    places = [name, *(f"{each}.{name}" for each in _TABLES)]
    places += [KEYS.get(name, name).partition(".")[0], name.partition(".")[0]]
    last = 1 if name == "format" else len(rows)
    return next((lines[each] for each in places if each in lines), last)
