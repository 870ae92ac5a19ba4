"""Scenarios as TOML files: `load_scenario` reads one, and says which line is wrong."""

import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.data.angles import angle
from analysis.data.constraint_set import MODELS
from analysis.data.names import ArgumentError, nearest
from analysis.data.quantities import LEVELS, QUANTITIES, SECTIONS
from analysis.data.scenario import Scenario, made_part
from analysis.data.scenario_text import FORMAT
from analysis.data.written import warn_of_unit

LARGEST_FILE = 1_000_000
"""Bytes that are read; a scenario takes some thousand."""

_TABLES = tuple(name for name in SECTIONS if name)
_TOP = ("format", "model", "constraints", *_TABLES)
_HEADER = re.compile(r"\s*\[\[?\s*([^\[\]]+?)\s*\]")
_ENTRY = re.compile(r"\s*([\w\"'.\- ]+?)\s*=")
_LINE = re.compile(r" \(at (?:line (\d+), column \d+|end of document)\)$")


def load_scenario(path: str | os.PathLike[str]) -> Scenario:
    """Read a scenario from a TOML file, as `scenario_text` writes it.

    Nothing is executed but the module of a friction law `module:Class` that the file names.

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
    text = _text(path)
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise _no_toml(path, text, error) from None
    try:
        return _scenario(values)
    except ValueError as error:
        line = _line_of(text, getattr(error, "argument", ""), values)
        raise ValueError(f"{path}, line {line}: {error}") from None


def _text(path: str | os.PathLike[str]) -> str:
    with Path(path).open("rb") as stream:
        content = stream.read(LARGEST_FILE + 1)
    if len(content) > LARGEST_FILE:
        raise ValueError(f"{path} is no scenario: more than {LARGEST_FILE} bytes")
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no scenario: not text in UTF-8") from None


def _no_toml(path: str | os.PathLike[str], text: str, error: Exception) -> ValueError:
    """Error where a file is no TOML."""
    message = " ".join(str(error).split())
    match = _LINE.search(message)
    line = int(match[1]) if match and match[1] else text.rstrip("\n").count("\n") + 1
    cause = "nested too deeply" if isinstance(error, RecursionError) else message
    return ValueError(f"{path}, line {line}: not TOML: {_LINE.sub('', cause)}")


def _scenario(values: Mapping[str, Any]) -> Scenario:
    """Scenario of what a file holds; errors carry the key."""
    for key in values:
        if key not in _TOP:
            raise ArgumentError(key, *_stray(key))
    given = values.get("format")
    if type(given) is int and given > FORMAT:
        fault = f"is newer than this version of tippedisk, which reads {FORMAT}"
        raise ArgumentError("format", fault, f"format {given}")
    if given is None:
        raise ArgumentError("format", f"is missing; it must be {FORMAT}")
    if type(given) is not int or given != FORMAT:
        raise ArgumentError("format", f"must be {FORMAT}, got {given!r}")
    parts = {"constraints": _constraints(values)}
    for table in _TABLES:
        if table in values:
            parts[table] = _part(table, values[table])
        elif SECTIONS[table].needed:
            fault = f"is missing; {SECTIONS[table].needed}"
            raise ArgumentError("end of file", fault, f"the table [{table}]")
    return Scenario(**parts)


def _stray(key: str) -> tuple[str, str]:
    """What is wrong with an unknown key outside of the tables, and what to call it."""
    for quantity in QUANTITIES.values():
        if key == quantity.name:
            return f"must stand in the table [{quantity.table}]", key
    known = [*_TOP, *(quantity.name for quantity in QUANTITIES.values())]
    return f"a scenario holds {', '.join(_TOP)}{nearest(key, known)}", f"unknown key {key!r};"


def _constraints(values: Mapping[str, Any]) -> Any:
    given, level = values.get("constraints"), values.get("model")
    if level is None and given is None:
        raise ArgumentError(
            "model", "or constraints is missing; model = 1 is the disk on the table"
        )
    if level is None:
        if not isinstance(given, list) or not all(isinstance(each, str) for each in given):
            raise ArgumentError("constraints", f"must be a list of names, got {given!r}")
        return given
    if given is not None:
        raise ArgumentError("constraints", "do not go together with model")
    if type(level) is not int or level not in LEVELS:
        raise ArgumentError(
            "model", f"must be one of {', '.join(map(str, LEVELS))}, got {level!r}"
        )
    return MODELS[level]


def _part(table: str, values: Any) -> Any:
    """What a table describes, with a warning where a unit is in doubt."""
    if not isinstance(values, Mapping):
        return made_part(table, values)
    clean = {name: _value(f"{table}.{name}", name, value) for name, value in values.items()}
    made = made_part(table, clean)
    for name, value in values.items():
        warn_of_unit(f"{table}.{name}", value, clean[name])
    return made


def _value(key: str, name: str, value: Any) -> Any:
    """Value of a key: angles are worked out, and numbers are no text."""
    if name in ("coordinates", "rates"):
        if not isinstance(value, list):
            raise ArgumentError(name, f"must be a list of 6 numbers, got {value!r}")
        return tuple(value)
    quantity = QUANTITIES.get(key)
    if quantity is None or quantity.unit is None:
        return value
    if quantity.is_angle:
        return angle(name, value)
    if isinstance(value, str):
        unit = f" in {quantity.unit}" if quantity.unit else ""
        raise ArgumentError(name, f"must be a number{unit}, got {value!r}")
    return value


def _line_of(text: str, argument: str, values: Mapping[str, Any]) -> int:
    """Line at which an argument stands, or the table that it belongs to, or else the last."""
    rows = text.rstrip("\n").split("\n")
    lines: dict[tuple[str, ...], int] = {}
    table: tuple[str, ...] = ()
    for line, row in enumerate(rows, 1):
        if header := _HEADER.match(row):
            table = _parts(header[1])
            lines.setdefault(table, line)
        elif entry := _ENTRY.match(row):
            names = (*table, *_parts(entry[1]))
            for count in range(1, len(names) + 1):
                lines.setdefault(names[:count], line)
    # An entry of a list is found by the list.
    name = argument.partition("[")[0]
    homes: list[tuple[str, ...]] = [
        (key, name) for key, held in values.items() if isinstance(held, Mapping)
    ]
    homes += [(key,) for key in _TABLES if f"{key}.{name}" in QUANTITIES]
    candidates = [_parts(name), *homes, _parts(name)[:1]]
    if name == "format":
        return lines.get((name,), 1)
    return next((lines[each] for each in candidates if each in lines), len(rows))


def _parts(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip().strip("\"'") for part in dotted.split("."))
