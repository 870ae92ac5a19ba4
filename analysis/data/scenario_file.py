"""Scenarios as TOML files: `load_scenario` reads one, and says which line is wrong."""

import os
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from analysis.data.angles import angle
from analysis.data.checks import choice
from analysis.data.constraint_set import LEVELS, MODELS
from analysis.data.disk import DISKS, Disk
from analysis.data.friction import law_class, law_from
from analysis.data.names import nearest
from analysis.data.scenario import KINDS, Scenario
from analysis.data.scenario_keys import KEYS, NEEDED, RING, SIX
from analysis.data.scenario_text import FORMAT, scenario_text
from analysis.data.start import Start
from analysis.data.state import State
from analysis.data.written import warn_of_unit

__all__ = ["load_scenario", "scenario_text"]

LARGEST_FILE = 1_000_000
"""Bytes that are read; a scenario takes some thousand."""

_TOP = ("format", "model", "constraints", *KEYS)
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
    places = _Places(str(path), text)
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise places.no_toml(error) from None
    for key in values:
        if key not in _TOP:
            raise places.error(_stray(key), key)
    _check_format(values, places)
    given: dict[str, Any] = {"constraints": _constraints(values, places)}
    for table in KEYS:
        if table in values:
            given[table] = _made(table, values[table], places)
        elif table in NEEDED:
            raise places.error(f"the table [{table}] is missing; {NEEDED[table]}", None)
    try:
        return Scenario(**given)
    except ValueError as error:
        raise places.blamed(str(error), values) from None


class _Places:
    """Where the keys of a file stand."""

    def __init__(self, path: str, text: str) -> None:
        self._path = path
        self._lines: dict[tuple[str, ...], int] = {}
        table: tuple[str, ...] = ()
        rows = text.rstrip("\n").split("\n")
        self._last = len(rows)
        for line, row in enumerate(rows, 1):
            if header := _HEADER.match(row):
                table = _names(header[1])
                self._lines.setdefault(table, line)
            elif entry := _ENTRY.match(row):
                names = (*table, *_names(entry[1]))
                for count in range(1, len(names) + 1):
                    self._lines.setdefault(names[:count], line)

    def error(self, message: str, *key: str | None) -> ValueError:
        """Error at a key, at its table if the key is not found, or at the end for None."""
        names = tuple(name for name in key if name is not None)
        while names and names not in self._lines:
            names = names[:-1]
        line = self._lines.get(names, self._last if None in key else 1)
        return ValueError(f"{self._path}, line {line}: {message}")

    def blamed(self, message: str, values: Mapping[str, Any]) -> ValueError:
        """Error at the key of some table that a message begins with."""
        word = _first_word(message)
        if word in values:
            return self.error(message, word)
        for table, held in values.items():
            if isinstance(held, Mapping) and word in held:
                return self.error(message, table, word)
        return self.error(message, next((name for name in KEYS if word in KEYS[name]), None))

    def no_toml(self, error: Exception) -> ValueError:
        """Error where a file is no TOML."""
        message = " ".join(str(error).split())
        match = _LINE.search(message)
        line = int(match[1]) if match and match[1] else self._last
        cause = "nested too deeply" if isinstance(error, RecursionError) else message
        return ValueError(f"{self._path}, line {line}: not TOML: {_LINE.sub('', cause)}")


def _names(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip().strip("\"'") for part in dotted.split("."))


def _text(path: str | os.PathLike[str]) -> str:
    with Path(path).open("rb") as stream:
        content = stream.read(LARGEST_FILE + 1)
    if len(content) > LARGEST_FILE:
        raise ValueError(f"{path} is no scenario: more than {LARGEST_FILE} bytes")
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no scenario: not text in UTF-8") from None


def _stray(key: str) -> str:
    """What to say of an unknown key outside of the tables."""
    for table, keys in KEYS.items():
        if key in keys:
            return f"{key} must stand in the table [{table}]"
    known = [*_TOP, *(name for keys in KEYS.values() for name in keys)]
    return f"unknown key {key!r}; a scenario holds {_listed(_TOP)}{nearest(key, known)}"


def _listed(names: Iterable[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def _check_format(values: Mapping[str, Any], places: _Places) -> None:
    given = values.get("format")
    if given is None:
        raise places.error(f"format is missing; it must be {FORMAT}")
    if type(given) is int and given > FORMAT:
        raise places.error(
            f"format {given} is newer than this version of tippedisk, which reads {FORMAT}",
            "format",
        )
    if type(given) is not int or given != FORMAT:
        raise places.error(f"format must be {FORMAT}, got {given!r}", "format")


def _constraints(values: Mapping[str, Any], places: _Places) -> Any:
    if "model" not in values and "constraints" not in values:
        raise places.error("model or constraints is missing; model = 1 is the disk on the table")
    if "model" not in values:
        given = values["constraints"]
        if not isinstance(given, list) or not all(isinstance(each, str) for each in given):
            raise places.error(
                f"constraints must be a list of names, got {given!r}", "constraints"
            )
        return given
    if "constraints" in values:
        raise places.error("model and constraints do not go together", "constraints")
    level = values["model"]
    if type(level) is not int or level not in LEVELS:
        raise places.error(
            f"model must be one of {', '.join(map(str, LEVELS))}, got {level!r}", "model"
        )
    return MODELS[level]


def _made(table: str, values: Any, places: _Places) -> Any:
    """What a table describes."""
    if not isinstance(values, Mapping):
        raise places.error(f"{table} must be a table, got {values!r}", table)
    try:
        make, keys = _form(table, values)
    except ValueError as error:
        raise places.error(str(error), table, "law") from None
    clean = {}
    for key, value in values.items():
        if key not in keys:
            forms = _DISK_FORMS if table == "disk" else _listed(keys)
            known = KEYS["disk"] if table == "disk" else keys
            raise places.error(
                f"{key} is unknown here; [{table}] takes {forms}{nearest(key, known)}", table, key
            )
        try:
            clean[key] = _value(table, key, value)
        except ValueError as error:
            raise places.error(str(error), table, key) from None
    if missing := [key for key, needed in keys.items() if needed and key not in values]:
        raise places.error(f"[{table}] lacks {_listed(missing)}", table)
    try:
        made = make(**clean)
    except ValueError as error:
        raise places.error(str(error), table, _first_word(str(error))) from None
    for key, value in values.items():
        warn_of_unit(f"{table}.{key}", value, clean[key])
    return made


def _first_word(message: str) -> str:
    """Key that a message of the data types begins with."""
    word = re.split(r"\W", message, maxsplit=1)[0]
    return "law" if word == "friction" else word


_DISK_FORMS = f"name; or {_listed(SIX)}; or {_listed(RING)}"


def _form(table: str, values: Mapping[str, Any]) -> tuple[Callable[..., Any], dict[str, bool]]:
    """What makes the object of a table, and its keys with whether each is needed."""
    if table == "disk" and "name" in values:
        return lambda name: DISKS[choice("name", name, DISKS)], {"name": True}
    if table == "disk" and any(key in values for key in RING[1:]):
        return Disk.ring, dict.fromkeys(RING, True)
    if table == "friction":
        law = law_class(values.get("law", "smooth-coulomb"))
        return lambda **given: law_from(given), {"law": False} | _fields(law)
    if table == "start" and ("coordinates" in values or "rates" in values):
        return State, _fields(State)
    return _KINDS[table], _fields(_KINDS[table])


def _fields(kind: Any) -> dict[str, bool]:
    """Names of the fields of a data type, with whether each is needed."""
    return {
        field.name: field.default is MISSING and field.default_factory is MISSING
        for field in fields(kind)
    }


def _value(table: str, key: str, value: Any) -> Any:
    """Value of a key: angles are worked out, and numbers are no text."""
    meaning = KEYS[table].get(key)
    if meaning is None or key in {"law", "load", "name", "bilateral"}:
        return value
    if key in {"coordinates", "rates"}:
        if not isinstance(value, list):
            raise ValueError(f"{key} must be a list of 6 numbers, got {value!r}")
        return tuple(value)
    if meaning.unit == "rad":
        return angle(key, value)
    if isinstance(value, str):
        unit = f" in {meaning.unit}" if meaning.unit else ""
        raise ValueError(f"{key} must be a number{unit}, got {value!r}")
    return value


_KINDS = KINDS | {"start": Start}
