"""Parts of a scenario as plain data, as its file and stored runs hold them, and made of it."""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from functools import cache
from typing import Any

from analysis.problem.bodies import BODIES
from analysis.problem.body import PRODUCTS, Body
from analysis.problem.checks import choice
from analysis.problem.constraints import MODELS
from analysis.problem.contact import Dissipation, PenaltyContact, Table
from analysis.problem.disk import DISKS, Disk
from analysis.problem.friction import LAWS, FrictionLaw
from analysis.problem.names import ArgumentError, nearest
from analysis.problem.quantities import PLATE, RING, SIX, listed
from analysis.problem.start import Start, State
from analysis.problem.values import read_value

KINDS: dict[str, type] = {
    "disk": Body,
    "friction": FrictionLaw,
    "table": Table,
    "contact": PenaltyContact,
    "dissipation": Dissipation,
}
"""Classes of the tables of a scenario that are told by their fields."""

_SHAPES = (("name",), (*SIX, *PRODUCTS), RING, (*PLATE, "holes", "masses"))
"""Names that tell a disk together."""

_DISK_FORMS = f"{'; or '.join(map(', '.join, _SHAPES))}; or body and what it takes"

Names = tuple[str, ...]


def as_plain(part: Any) -> dict[str, Any]:
    """Plain data of a part, to be stored; `made_part` makes it again."""
    if isinstance(part, Disk) and part.parts is not None:
        return part.parts.values()
    values = {each.name: getattr(part, each.name) for each in fields(part)}
    if isinstance(part, FrictionLaw):
        return {"law": LAWS.name_of(type(part))} | values
    if isinstance(part, Body):
        name = {} if type(part) is Disk else {"body": BODIES.name_of(type(part))}
        return name | {key: each for key, each in values.items() if each or key not in PRODUCTS}
    if isinstance(part, Start):
        return {name: value for name, value in values.items() if value is not None}
    return values


def made_part(table: str, values: Any) -> Any:
    """What a table of a scenario describes.

    Parameters
    ----------
    table : str
        Its name, or "constraints", which are handed on.
    values : mapping
        Data by the names of the fields; a disk by its name or its geometry, too.

    Raises
    ------
    ArgumentError
        If a key is missing or unknown, or a value out of range.
    """
    return values if table == "constraints" else maker(table, values)(**values)


def told_constraints(model: Any = None, constraints: Any = None) -> Any:
    """Constraints of a model of the paper, or those that are given in place of it."""
    if model is None and constraints is None:
        fault = "or constraints is missing; model = 1 is the disk on the table"
        raise ArgumentError("model", fault)
    if model is not None and constraints is not None:
        raise ArgumentError("constraints", "do not go together with model")
    if model is None:
        return constraints
    level: Any = read_value("model", model)
    return MODELS[level]


def maker(table: str, values: Any) -> Callable[..., Any]:
    """What makes the object of a table; `ArgumentError` if a key is missing or unknown."""
    if not isinstance(values, Mapping):
        raise ArgumentError(table, f"must be a table, got {values!r}")
    make, known, needed = _form(table, values)
    for name in values:
        if name not in known:
            is_shape = table == "disk" and "body" not in values
            allowed = _DISK_FORMS if is_shape else listed(known, "and")
            besides = {each for shape in _SHAPES if is_shape and name in shape for each in shape}
            apart = [each for each in values if besides and each not in besides]
            why = f"does not go with {listed(apart, 'or')}" if apart else "is unknown here"
            fault = f"{why}; [{table}] takes {allowed}{nearest(name, known)}"
            raise ArgumentError(f"{table}.{name}", fault, name)
    if missing := [name for name in needed if name not in values]:
        raise ArgumentError(table, f"lacks {listed(missing, 'and')}", f"[{table}]")
    return make


def _form(table: str, values: Mapping[str, Any]) -> tuple[Callable[..., Any], Names, Names]:
    """What makes the object of a table, the names that it takes, and those that it needs."""
    if table == "friction":
        return LAWS.made, *_names(LAWS.find(values.get("law")), "law")
    if table != "disk":
        is_state = table == "start" and ("coordinates" in values or "rates" in values)
        kind = State if is_state else KINDS.get(table, Start)
        return kind, *_names(kind)
    if "name" in values:
        return lambda name: DISKS[choice("name", name, DISKS)], ("name",), ()
    kind = BODIES.find(values.get("body"))
    if kind is Disk and ("holes" in values or "masses" in values):
        return _composed, (*PLATE, "holes", "masses"), PLATE
    if kind is Disk and any(name in values for name in RING[1:]):
        return Disk.ring, RING, RING
    return BODIES.made, *_names(kind, "body")


@cache
def _names(kind: Any, *further: str) -> tuple[Names, Names]:
    """Names that a class takes, and those that it needs."""
    needed = tuple(each.name for each in fields(kind) if each.default is MISSING)
    return (*further, *(each.name for each in fields(kind))), needed


def _composed(*, holes: Any = (), masses: Any = (), **plate: Any) -> Disk:
    return Disk.of_parts([plate[name] for name in PLATE], holes, masses)
