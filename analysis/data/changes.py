"""Scenarios with some quantities changed: by a sweep, an ensemble or the command line."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from typing import Any

from analysis.data.bodies import BODIES
from analysis.data.body import PRODUCTS, Body
from analysis.data.checks import choice
from analysis.data.constraint_set import MODELS
from analysis.data.contact import PenaltyContact
from analysis.data.disk import DISKS, STEEL_DISK, STEEL_RING, Disk
from analysis.data.friction import LAWS, FrictionLaw, law_values
from analysis.data.names import ArgumentError
from analysis.data.quantities import RING, SIX
from analysis.data.scenario import Scenario
from analysis.data.start import Start

Numbers = dict[str, Any]


def check_field(scenario: Scenario, key: str, others: Mapping[str, Any]) -> None:
    """Check that a quantity can be varied in a scenario.

    Parameters
    ----------
    scenario : Scenario
    key : str
        Of the quantity.
    others : mapping
        All that vary by their keys, each with one of its values.

    Raises
    ------
    ArgumentError
        If the scenario has no such quantity.
    """
    table, _, name = key.rpartition(".")
    if table == "contact" and scenario.contact is None:
        raise ArgumentError(key, "needs a penalty contact, and the scenario's is ideal")
    if table == "start":
        _check_start(scenario, key)
    if table == "disk" and not {"disk.name", "disk.body"} & set(others):
        varied = [each.rpartition(".")[2] for each in others if each.startswith("disk.")]
        _check_disk(scenario.disk, [name, *varied])
    if table == "friction" and name != "law":
        law = others.get("friction.law")
        kind = type(scenario.friction) if law is None else LAWS.find(law)
        choice(key, name, [each.name for each in fields(kind)])
    if key == "constraints" and "model" in others:
        raise ArgumentError(key, "do not go together with model")


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
    numbers: dict[str, Numbers] = {}
    for key, value in changes.items():
        table, _, name = key.rpartition(".")
        numbers.setdefault(table, {})[name] = value
    parts: dict[str, Any] = {}
    if of_set := numbers.pop("", {}):
        parts["constraints"] = _constraints(**of_set)
    if "disk" in numbers:
        parts["disk"] = _disk(scenario.disk, numbers.pop("disk"))
    if "friction" in numbers:
        parts["friction"] = _friction(scenario.friction, numbers.pop("friction"))
    if "contact" in numbers and scenario.contact is None:
        disk = parts.get("disk", scenario.disk)
        parts["contact"] = _contact(disk, numbers["contact"])
    if "start" in numbers:
        _check_start(scenario, next(iter(numbers["start"])))
    for table, values in numbers.items():
        parts[table] = replace(parts.get(table, getattr(scenario, table)), **values)
    return replace(scenario, **parts)


def _constraints(model: Any = None, constraints: Any = None) -> Any:
    if constraints is None:
        return MODELS[model]
    if model is not None:
        raise ArgumentError("constraints", "do not go together with model")
    return [name.strip() for name in constraints.replace("+", ",").split(",")]


def _disk(disk: Body, values: Numbers) -> Body:
    """Body with some values changed; with a geometry, from which the others follow."""
    name = values.pop("name", None)
    if name is None and set(values) == set(RING):
        return Disk.ring(**values)
    if "body" in values:
        shared = {each.name: getattr(disk, each.name) for each in fields(Body)}
        return BODIES.made(**(shared | values))
    if name is not None:
        disk = DISKS[choice("name", name, DISKS)]
    _check_disk(disk, values)
    if not isinstance(disk, Disk) or set(SIX) <= set(values) or not set(values) & set(RING):
        return replace(disk, **values)
    return Disk.ring(**(_ring(disk) or {}) | values)


def _ring(disk: Disk) -> dict[str, float] | None:
    """Arguments of `Disk.ring` for a disk that is one."""
    if disk == STEEL_DISK:
        return STEEL_RING
    return None if disk.parts is None else disk.parts.ring


def _check_disk(disk: Body, names: Iterable[str]) -> None:
    """Raise if a geometry would vary and leave mass and moments of inertia as they are."""
    given = set(names) - {"name", "body"}
    geometries = RING[1:] if isinstance(disk, Disk) else ()
    for name in given:
        choice(f"disk.{name}", name, [*(each.name for each in fields(disk)), *geometries])
    if not isinstance(disk, Disk):
        return
    geometry = [name for name in RING if name in given]
    others = [name for name in (*SIX[1:], *PRODUCTS) if name in given]
    if not geometry or given >= set(SIX):
        return
    if others:
        raise ArgumentError(
            others[0],
            f"does not go together with {geometry[0]}, from which it follows, unless "
            f"{', '.join(SIX)} are all given and nothing else",
        )
    if _ring(disk) is None:
        raise ArgumentError(
            geometry[0],
            "varies a ring alone, of which mass and moments of inertia follow, and the "
            f"scenario's disk is another: give all of {', '.join(RING)}, or all of "
            f"{', '.join(SIX)}",
        )


def _friction(law: FrictionLaw, values: Numbers) -> FrictionLaw:
    """Law with some values changed; the same law keeps what is not given anew."""
    if {each.name for each in fields(law)}.issuperset(values):
        return replace(law, **values)
    told = law_values(law)
    if values.get("law", told["law"]) != told["law"]:
        told = {"load": law.load}
    return LAWS.made(**(told | values))


def _contact(disk: Body, values: Numbers) -> PenaltyContact:
    if "stiffness" not in values:
        name, value = next(iter(values.items()))
        raise ArgumentError(name, f"needs a penalty contact, told by its stiffness, got {value}")
    return PenaltyContact.damped(values["stiffness"], disk)


def _check_start(scenario: Scenario, key: str) -> None:
    if not isinstance(scenario.start, Start):
        raise ArgumentError(
            key.rpartition(".")[2], "cannot change: the start is told by its coordinates and rates"
        )
