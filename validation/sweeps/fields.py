"""Fields of a scenario by their dotted names, as the keys of its file: start.spin."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from difflib import get_close_matches
from typing import Any

from analysis import DISKS, LEVELS, MODELS, Disk, Scenario, Start
from analysis.data.angles import angle
from analysis.data.checks import choice
from analysis.data.disk import STEEL_DISK, STEEL_RING
from analysis.data.friction import law_class
from analysis.data.scenario_keys import KEYS, RING

Value = float | str | bool
"""What a field may be set to."""

_SHORT = {
    "mu": "friction.coefficient",
    "eps": "friction.smoothing",
    "rolling": "dissipation.rolling_dry",
}
"""Options of the command line that are not named as the key they stand for."""

_WHOLE = ("model", "constraints", "disk.name", "friction.law")
"""Fields that stand for more than one number; they are set before the others."""

_TEXT = ("constraints", "disk.name", "friction.law", "friction.load")


def full_name(name: str) -> str:
    """Dotted name of a field from that or from its last part alone.

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
    close = ", ".join(get_close_matches(name.rpartition(".")[2], known)) or "start.spin"
    raise ValueError(
        f"axis must be a field of a scenario, as `tippedisk scenario` lists them, such as "
        f"{close}; got {name!r}"
    )


def is_text(field: str) -> bool:
    """Whether a field takes words instead of numbers."""
    return field in _TEXT


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


def changed(base: Mapping[str, Any], changes: Mapping[str, Value]) -> Scenario:
    """Scenario with some fields changed.

    Parameters
    ----------
    base : mapping
        `Scenario.values()` of the scenario to change.
    changes : mapping
        Values by the dotted names of fields.

    Raises
    ------
    ValueError
        If a value is out of range or does not fit the rest.
    """
    values = dict(base)
    ordered = sorted(changes.items(), key=lambda item: item[0] not in _WHOLE)
    ring = {}
    for field, value in ordered:
        table, _, key = field.partition(".")
        if field == "model":
            values["constraints"] = MODELS[value]  # type: ignore[index]
        elif field == "constraints":
            values["constraints"] = str(value).split("+")
        elif field == "disk.name":
            values["disk"] = asdict(DISKS[choice("disk.name", str(value), DISKS)])
        elif field == "friction.law":
            values["friction"] = {"law": value, "load": values["friction"]["load"]}
        elif table == "disk" and key in RING[1:]:
            ring[key] = value
        else:
            values[table] = {**values[table], key: value}
    if ring:
        given = STEEL_RING | {"radius": values["disk"]["radius"]} | ring
        values["disk"] = asdict(Disk.ring(**given))
    return Scenario.from_values(values)
