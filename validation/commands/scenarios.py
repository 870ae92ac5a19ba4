"""From options of the command line to the scenario that they describe."""

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from analysis import BODIES, LAWS, PenaltyContact, Scenario, load_run, load_scenario
from analysis.data.changes import changed
from analysis.data.endings import named_conditions
from analysis.data.names import ArgumentError
from analysis.data.own import is_own
from analysis.data.quantities import QUANTITIES
from analysis.data.written import read_value

_OWN_KEYS = ("friction.law", "disk.body")
"""Quantities that may name a class of one's own, with parameters behind it."""

_OWN_AXES = tuple(name for key in _OWN_KEYS for name in (f"{key}=", f"{key.split('.')[1]}="))


def chosen_scenario(options: argparse.Namespace, *, rest: bool = False) -> Scenario:
    """Scenario of --scenario, or the default one, with what the other options change.

    Parameters
    ----------
    options : Namespace
        By the keys of quantities; None for what is not given.
    rest : bool
        Whether the default is that of the way to rest.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If the file is none, or an option is out of range or does not fit the rest.
    """
    find_own(options)
    with _modules_here():
        file = None if options.scenario is None else read_scenario(options.scenario)
    given = _given(options)
    base = file or (_to_rest(given) if rest else Scenario())
    if type(base.friction) not in LAWS.values() or type(base.disk) not in BODIES.values():
        _look_here()
    chosen = changed(base, given)
    if (condition := getattr(options, "stop_when", None)) is not None:
        named_conditions(condition, chosen.initial_state)
    return chosen


def _given(options: argparse.Namespace) -> dict[str, Any]:
    """What the options tell of quantities, by key."""
    given: dict[str, Any] = {}
    for key, quantity in QUANTITIES.items():
        value = getattr(options, key, None)
        if value is not None:
            given[key] = read_value(key, value, quantity.name)
    for key in _OWN_KEYS:
        _split(given, key)
    return given


def _split(given: dict[str, Any], key: str) -> None:
    """Take the parameters behind the name of a class, which are parted by commas, for options."""
    table, _, option = key.rpartition(".")
    name, *parameters = str(given.get(key, "")).split(",")
    for parameter in parameters:
        field, equals, text = parameter.partition("=")
        field = f"{table}.{field.strip()}"
        if not equals:
            raise ArgumentError(
                option, f"must hold parameter=value behind its name, got {parameter!r}"
            )
        own = field.rpartition(".")[2]
        if field in given:
            raise ArgumentError(option, f"tells {own}, which is told twice")
        given[field] = read_value(field, text, own)
    if name:
        given[key] = name


def _to_rest(given: dict[str, Any]) -> Scenario:
    """Scenario of the way to rest, whose damping follows from the stiffness and the disk."""
    of_disk = {key: given.pop(key) for key in list(given) if key.startswith("disk.")}
    disk = changed(Scenario(), of_disk).disk
    named = {name: f"contact.{name}" for name in ("stiffness", "half_thickness")}
    told = {name: given.pop(key) for name, key in named.items() if key in given}
    return Scenario.rest(disk=disk, contact=PenaltyContact.rounded(disk, **told))


def read_scenario(path: Path) -> Scenario:
    """Scenario from its file, or from a stored run (.npz) of either kind.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is neither.
    """
    return load_run(path).scenario if path.suffix.lower() == ".npz" else load_scenario(path)


def find_own(options: argparse.Namespace) -> None:
    """Import what --law, --body and --stop-when name; the working directory is looked in.

    A stored run with a law of one's own can be read then. An axis of a sweep may name one, too.

    Raises
    ------
    ValueError
        If that cannot be, or a name is unknown.
    """
    law = getattr(options, "friction.law", None) or getattr(options, "law", None)
    body = getattr(options, "disk.body", None) or getattr(options, "body", None)
    condition = getattr(options, "stop_when", None)
    axes = getattr(options, "axes", None) or ()
    named = any(map(is_own, (law, body, condition)))
    if named or any(axis.startswith(_OWN_AXES) for axis in axes):
        _look_here()
    if law is not None:
        LAWS.find(law.partition(",")[0])
    if body is not None:
        BODIES.find(body.partition(",")[0])
    if condition is not None:
        named_conditions(condition)


def _look_here() -> None:
    """Find modules of the working directory for the rest of a command.

    Worker processes take that over: they import laws and conditions again.
    """
    sys.path.insert(0, "")


@contextmanager
def _modules_here() -> Iterator[None]:
    """Find modules of the working directory, for the law that a scenario's file may name."""
    sys.path.insert(0, "")
    try:
        yield
    finally:
        sys.path.remove("")
