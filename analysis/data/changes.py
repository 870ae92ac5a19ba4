"""Scenarios with some quantities changed: by a sweep, an ensemble or the command line."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from analysis.data.body import Body
from analysis.data.checks import choice
from analysis.data.constraint_set import MODELS
from analysis.data.contact import PenaltyContact
from analysis.data.disk import DISKS, Disk
from analysis.data.friction import LAWS
from analysis.data.names import ArgumentError
from analysis.data.parts import KINDS, held, made_part, maker
from analysis.data.quantities import RING, SIX
from analysis.data.scenario import Scenario
from analysis.data.start import Start

Numbers = dict[str, Any]


def check_fields(scenario: Scenario, values: Mapping[str, Any]) -> None:
    """Check that quantities can be varied together in a scenario.

    Parameters
    ----------
    scenario : Scenario
    values : mapping
        One of the values of each, by key.

    Raises
    ------
    ArgumentError
        If the scenario has no such quantity.
    """
    for table, given in _by_table(values).items():
        if table == "contact" and scenario.contact is None:
            key = f"contact.{next(iter(given))}"
            raise ArgumentError(key, "needs a penalty contact, and the scenario's is ideal")
        if table:
            maker(table, _merged(scenario, table, given))
        elif len(given) > 1:
            raise ArgumentError("constraints", "do not go together with model")


def changed(scenario: Scenario, changes: Mapping[str, Any]) -> Scenario:
    """Scenario with some quantities changed.

    Parameters
    ----------
    scenario : Scenario
    changes : mapping
        Values by key; a `Members` changes all members of an ensemble.

    Raises
    ------
    ArgumentError
        If a value is out of range or does not fit the rest.
    """
    numbers = _by_table(changes)
    parts: dict[str, Any] = {}
    if "" in numbers:
        parts["constraints"] = _constraints(**numbers[""])
    # What a new contact is like follows from the disk, which comes before it.
    for table in (*KINDS, "start"):
        if table in numbers:
            disk = parts.get("disk", scenario.disk)
            parts[table] = made_part(table, _merged(scenario, table, numbers[table], disk))
    return replace(scenario, **parts)


def _by_table(values: Mapping[str, Any]) -> dict[str, Numbers]:
    found: dict[str, Numbers] = {}
    for key, value in values.items():
        table, _, name = key.rpartition(".")
        found.setdefault(table, {})[name] = value
    return found


def _constraints(model: Any = None, constraints: Any = None) -> Any:
    if constraints is None:
        return MODELS[model]
    if model is not None:
        raise ArgumentError("constraints", "do not go together with model")
    return [name.strip() for name in constraints.replace("+", ",").split(",")]


def _merged(scenario: Scenario, table: str, given: Numbers, disk: Body | None = None) -> Numbers:
    """Data of a part with some of it changed; a new contact is one for this disk."""
    part = getattr(scenario, table)
    if table == "disk":
        return _body(part, given)
    if table == "friction":
        # The same law keeps what is not given anew.
        same = "law" not in given or LAWS.find(given["law"]) is type(part)
        return {"law": type(part)} | (held(part) if same else {"load": part.load}) | given
    if table == "start" and not isinstance(part, Start):
        fault = "cannot change: the start is told by its coordinates and rates"
        raise ArgumentError(next(iter(given)), fault)
    if part is None and disk is not None:
        if "stiffness" not in given:
            name, value = next(iter(given.items()))
            fault = f"needs a penalty contact, told by its stiffness, got {value}"
            raise ArgumentError(name, fault)
        part = PenaltyContact.damped(given["stiffness"], disk)
    return held(part) | given


def _body(disk: Body, given: Numbers) -> Numbers:
    """Data of a body with some of it changed; with a geometry, from which the others follow."""
    if given.keys() >= {*RING} or given.keys() == {"name"}:
        return given
    if "name" in given:
        disk = DISKS[choice("name", given["name"], DISKS)]
        given = {name: value for name, value in given.items() if name != "name"}
    if "body" in given:
        return {each.name: getattr(disk, each.name) for each in fields(Body)} | given
    geometry = [name for name in RING if name in given]
    if not isinstance(disk, Disk) or not geometry or given.keys() >= {*SIX}:
        return {"body": type(disk)} | held(disk) | given
    ring = None if disk.parts is None else disk.parts.ring
    if ring is None:
        raise ArgumentError(
            geometry[0],
            "varies a ring alone, of which mass and moments of inertia follow, and the "
            f"scenario's disk is another: give all of {', '.join(RING)}, or all of "
            f"{', '.join(SIX)}",
        )
    return ring | given
