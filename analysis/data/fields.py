"""Fields of a scenario by their dotted names, as the keys of its file: start.spin."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from analysis.data.angles import angle
from analysis.data.checks import choice
from analysis.data.constraint_set import LEVELS, MODELS
from analysis.data.disk import DISKS, STEEL_DISK, STEEL_RING, Disk
from analysis.data.friction import law_class, law_from
from analysis.data.names import SHORT, nearest
from analysis.data.scenario import Scenario
from analysis.data.scenario_keys import KEYS, RING
from analysis.data.start import Start

Value = float | str | bool
"""What a field may be set to."""

_SHORT = {short: f"friction.{name}" for short, name in SHORT.items()} | {
    "rolling": "dissipation.rolling_dry"
}
"""Options of the command line that are not named as the key they stand for."""

_TEXT = ("constraints", "disk.name", "friction.law", "friction.load")


def full_name(name: str, axis: str = "axis") -> str:
    """Dotted name of a field from that or from its last part alone.

    Parameters
    ----------
    name : str
    axis : str
        What to call it if there is no such field.

    Raises
    ------
    ValueError
        If there is no such field.
    """
    name = name.strip().replace("-", "_")
    if name in ("model", "constraints"):
        return name
    table, dot, key = name.partition(".")
    if dot:
        # A friction law of one's own has parameters of its own.
        if table in KEYS and (key in KEYS[table] or table == "friction"):
            return name
    elif name in _SHORT:
        return _SHORT[name]
    else:
        found = [f"{table}.{name}" for table, keys in KEYS.items() if name in keys]
        if found:
            return found[0]
    known = [key for keys in KEYS.values() for key in keys]
    raise ValueError(
        f"{axis} must be a field of a scenario, as `tippedisk scenario` lists them, such as "
        f"start.spin, got {name!r}{nearest(name.rpartition('.')[2], known)}"
    )


def is_text(field: str) -> bool:
    """Whether a field takes words instead of numbers."""
    return field in _TEXT


def is_word(field: str) -> bool:
    """Whether a field takes one of a few words or marks, between which nothing lies."""
    return is_text(field) or field in ("model", "contact.bilateral")


def unit(field: str) -> str:
    """Unit of a field, empty for a plain number."""
    table, _, key = field.partition(".")
    known = KEYS.get(table, {}).get(key)
    return (known.unit or "") if known else ""


def read_value(field: str, value: Any) -> Value:
    """Value of a field from text, as on the command line, or as TOML has it.

    Raises
    ------
    ValueError
        If it is of the wrong kind.
    """
    if is_text(field):
        if not isinstance(value, str):
            raise ValueError(f"{field} must be text, got {value!r}")
        return value.strip()
    if field == "contact.bilateral":
        return bool(choice(field, str(value).strip().lower(), ("true", "false")) == "true")
    if field == "model":
        return int(choice("model", str(value).strip(), map(str, LEVELS)))
    if isinstance(value, str) and unit(field) != "rad":
        try:
            value = float(value)
        except ValueError:
            raise ValueError(f"{field} must be a number, got {value!r}") from None
    return angle(field, value)


def check_field(scenario: Scenario, field: str, others: Mapping[str, Any]) -> None:
    """Check that a field can be varied in a scenario.

    Parameters
    ----------
    scenario : Scenario
    field : str
        Its dotted name.
    others : mapping
        All fields that vary, each with one of its values.

    Raises
    ------
    ValueError
        If the scenario has no such field.
    """
    table, _, key = field.partition(".")
    if table == "contact" and scenario.contact is None:
        raise ValueError(f"{field} needs a penalty contact, and the scenario's is ideal")
    if table == "start" and not isinstance(scenario.start, Start):
        raise ValueError(f"{field} cannot vary: the start is told by its coordinates and rates")
    if field in ("start.coordinates", "start.rates"):
        raise ValueError(f"{field} cannot vary as a whole; its parts can, such as start.spin")
    if table == "disk" and key in RING[1:] and scenario.disk != STEEL_DISK:
        raise ValueError(f"{field} varies the paper's ring alone, and the scenario's is another")
    if table == "friction" and key != "law":
        law = others.get("friction.law")
        kind = type(scenario.friction) if law is None else law_class(law)
        choice(field, key, [each.name for each in fields(kind)])
    if field == "constraints" and "model" in others:
        raise ValueError("constraints and model do not go together")


def changed(scenario: Scenario, changes: Mapping[str, Any]) -> Scenario:
    """Scenario with some fields changed.

    Parameters
    ----------
    scenario : Scenario
    changes : mapping
        Values by the dotted names of fields; a `Members` changes all members of an ensemble.

    Raises
    ------
    ValueError
        If a value is out of range or does not fit the rest.
    """
    parts: dict[str, Any] = {}
    numbers: dict[str, dict[str, Any]] = {}
    for field, value in changes.items():
        table, _, key = field.partition(".")
        if field == "model":
            parts["constraints"] = MODELS[value]
        elif field == "constraints":
            parts["constraints"] = str(value).split("+")
        elif field == "disk.name":
            parts["disk"] = DISKS[choice("disk.name", str(value), DISKS)]
        elif field == "friction.law":
            parts["friction"] = law_from({"law": value, "load": scenario.friction.load})
        else:
            numbers.setdefault(table, {})[key] = value
    for table, values in numbers.items():
        part = parts.get(table, getattr(scenario, table))
        is_ring = table == "disk" and any(key in RING[1:] for key in values)
        for key in values:
            choice(table, key, RING if is_ring else [each.name for each in fields(part)])
        if is_ring:
            parts[table] = Disk.ring(**(STEEL_RING | {"radius": part.radius} | values))
        else:
            parts[table] = replace(part, **values)
    return replace(scenario, **parts)
