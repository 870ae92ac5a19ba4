"""Fields of a scenario by their dotted names, as the keys of its file: start.spin."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from typing import Any

from analysis.data.angles import angle
from analysis.data.checks import choice
from analysis.data.constraint_set import LEVELS, MODELS
from analysis.data.disk import DISKS, STEEL_DISK, STEEL_RING, Disk
from analysis.data.friction import law_class, law_from
from analysis.data.names import SHORT, nearest
from analysis.data.scenario import Scenario
from analysis.data.scenario_keys import KEYS, RING, SIX
from analysis.data.start import Start
from analysis.data.written import warn_of_unit

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
    result = value
    if isinstance(value, str) and unit(field) != "rad":
        try:
            result = float(value)
        except ValueError:
            raise ValueError(f"{field} must be a number, got {value!r}") from None
    result = angle(field, result)
    if isinstance(value, str):
        warn_of_unit(field, value, result)
    return result


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
    if table == "disk" and "disk.name" not in others:
        varied = [name.partition(".")[2] for name in others if name.startswith("disk.")]
        _check_disk(scenario.disk, [key, *varied])
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
        if table == "disk":
            parts[table] = _changed_disk(part, values)
            continue
        for key in values:
            choice(table, key, [each.name for each in fields(part)])
        parts[table] = replace(part, **values)
    return replace(scenario, **parts)


def _changed_disk(disk: Disk, values: Mapping[str, Any]) -> Disk:
    """Disk with some values changed; with a geometry, from which the others follow."""
    _check_disk(disk, values)
    if set(SIX) <= set(values) or not set(values) & set(RING):
        return replace(disk, **values)
    return Disk.ring(**(STEEL_RING | dict(values)))


def _check_disk(disk: Disk, keys: Iterable[str]) -> None:
    """Raise if a geometry would vary and leave mass and moments of inertia as they are."""
    given = set(keys)
    geometry = [key for key in RING if key in given]
    others = [key for key in SIX[1:] if key in given]
    if not geometry or given == set(SIX):
        return
    if others:
        raise ValueError(
            f"{others[0]} does not go together with {geometry[0]}, from which it follows, unless "
            f"{', '.join(SIX)} are all given and nothing else"
        )
    if disk != STEEL_DISK:
        raise ValueError(
            f"{geometry[0]} varies the paper's ring alone, of which mass and moments of inertia "
            "follow, and the scenario's disk is another"
        )
