"""Scenarios as TOML files: `load_scenario` reads one, and says which line is wrong."""

import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.data.constraint_set import MODELS
from analysis.data.names import ArgumentError, nearest
from analysis.data.parts import made_part
from analysis.data.quantities import QUANTITIES, SECTIONS
from analysis.data.scenario import Scenario
from analysis.data.scenario_text import FORMAT
from analysis.data.written import read_value

LARGEST_FILE = 1_000_000
"""Bytes that are read; a scenario takes some thousand."""

_TABLES = tuple(name for name in SECTIONS if name)
_TOP = ("format", "model", "constraints", *_TABLES)
_KEY = re.compile(r"\s*(\[\[?)?\s*([\w\"'.\- ]+?)\s*[\]=]")
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
    with Path(path).open("rb") as stream:
        content = stream.read(LARGEST_FILE + 1)
    if len(content) > LARGEST_FILE:
        raise ValueError(f"{path} is too large: more than {LARGEST_FILE} bytes")
    try:
        text = content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no TOML: not text in UTF-8") from None
    try:
        return tomllib.loads(text), text
    except (ValueError, RecursionError) as error:
        raise _no_toml(path, text, error) from None


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
    if type(given) is not int or given != FORMAT:
        missing = f"is missing; it must be {FORMAT}"
        fault = missing if given is None else f"must be {FORMAT}, got {given!r}"
        raise ArgumentError("format", fault)
    parts = {"constraints": _constraints(values)}
    for table in _TABLES:
        if table in values:
            parts[table] = made_part(table, _read(table, values[table]))
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
    if level is not None and given is not None:
        raise ArgumentError("constraints", "do not go together with model")
    return given if level is None else MODELS[read_value("model", level)]  # type: ignore[index]


def _read(table: str, values: Any) -> Any:
    """What a table holds, its values read as everywhere."""
    if not isinstance(values, Mapping):
        return values
    keys = {name: f"{table}.{name}" for name in values}
    return {
        name: read_value(keys[name], value, name) if keys[name] in QUANTITIES else value
        for name, value in values.items()
    }


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
    places += [each for each in _TABLES if f"{each}.{name}" in QUANTITIES]
    places.append(name.partition(".")[0])
    last = 1 if name == "format" else len(rows)
    return next((lines[each] for each in places if each in lines), last)
