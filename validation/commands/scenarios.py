"""From options of the command line to the scenario that they describe."""

import argparse
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from analysis import (
    DISKS,
    Disk,
    Dissipation,
    FrictionLaw,
    PenaltyContact,
    Scenario,
    Start,
    State,
    load_run,
)
from analysis.data.angles import angle
from analysis.data.constraint_set import MODELS
from analysis.data.endings import named_conditions
from analysis.data.friction import LAWS, law_class, law_from, law_values
from analysis.data.own import is_own
from analysis.data.scenario_file import load_scenario
from analysis.data.scenario_keys import RING, SIX
from analysis.data.written import DOUBTED, warn_of_unit
from validation.commands.options import written_number

_ANGLES = ("alpha", "beta", "gamma", "inclination", "downhill")
_TABLE = ("gravity", "inclination", "downhill")
_CONTACT = ("stiffness", "damping", "half_thickness", "bilateral")
_START = tuple(field.name for field in fields(Start))
_LOSSES = {
    "rolling": "rolling_dry",
    "rolling_viscous": "rolling_viscous",
    "pivoting": "pivoting",
    "air_drag": "air_drag",
}
_LAW_AXES = ("law=", "friction.law=")
_FRICTION = {"mu": "coefficient", "eps": "smoothing", "load": "load"}


def chosen_scenario(options: argparse.Namespace, *, rest: bool = False) -> Scenario:
    """Scenario of --scenario, or the default one, with what the other options change.

    Parameters
    ----------
    options : Namespace
        Some of those of `validation.parser.groups`; None for what is not given.
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
    base = file or (Scenario.rest() if rest else Scenario())
    if type(base.friction) not in LAWS.values():
        _look_here()
    disk = _disk(options, base.disk)
    computed = file is None and rest
    chosen = Scenario(
        constraints=_constraints(options, base),
        disk=disk,
        friction=_friction(options, base.friction),
        table=replace(base.table, **_given(options, _TABLE)),
        contact=_rounded(options, disk) if computed else _contact(options, base.contact, disk),
        dissipation=_dissipation(options, base.dissipation),
        start=_start(options, base.start),
    )
    for field in DOUBTED:
        for name, value in _given(options, (field.rpartition(".")[2],)).items():
            warn_of_unit(field, getattr(options, name), value)
    if (condition := getattr(options, "stop_when", None)) is not None:
        named_conditions(condition, chosen.initial_state)
    return chosen


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
    """Import what --law and --stop-when name of one's own; the working directory is looked in.

    A stored run with a law of one's own can be read then. An axis of a sweep may name one, too.

    Raises
    ------
    ValueError
        If that cannot be, or a name is unknown.
    """
    law, condition = (getattr(options, name, None) for name in ("law", "stop_when"))
    axes = getattr(options, "axes", None) or ()
    if is_own(law) or is_own(condition) or any(axis.startswith(_LAW_AXES) for axis in axes):
        _look_here()
    if law is not None:
        law_class(law.partition(",")[0])
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


def _given(options: argparse.Namespace, names: Iterable[str]) -> dict[str, Any]:
    """What is given of some options, angles as numbers."""
    given = {name: getattr(options, name, None) for name in names}
    return {
        name: angle(name, value) if name in _ANGLES else value
        for name, value in given.items()
        if value is not None
    }


def _constraints(options: argparse.Namespace, base: Scenario) -> Any:
    if options.model is not None:
        return MODELS[options.model]
    if options.constraints is not None:
        return [name.strip() for name in options.constraints.split(",")]
    return base.constraints


def _disk(options: argparse.Namespace, base: Disk) -> Disk:
    own = _given(options, SIX)
    hole = _given(options, RING[1:])
    if not hole and ("radius" not in own or len(own) == len(SIX)):
        return replace(base if options.disk is None else DISKS[options.disk], **own)
    if not hole:
        ways = ([name for name in names if name not in own] for names in (RING, SIX))
        geometry, values = (", ".join(map(_option, missing)) for missing in ways)
        raise ValueError(
            "--radius would keep mass and moments of inertia of another disk: give with it "
            f"{geometry}, from which they follow, or {values}"
        )
    foreign = [name for name in ("disk", *SIX[1:]) if getattr(options, name) is not None]
    if foreign:
        raise ValueError(
            f"{_option(foreign[0])} does not go together with {_option(list(hole)[-1])}: a disk "
            "with a round hole is told by its geometry and density"
        )
    ring = {name: own[name] for name in RING[:1] if name in own} | hole
    missing = [name for name in RING if name not in ring]
    if missing:
        raise ValueError(f"a disk with a round hole needs {', '.join(map(_option, missing))}, too")
    return Disk.ring(**ring)


def _friction(options: argparse.Namespace, base: FrictionLaw) -> FrictionLaw:
    law, behind = base, set()
    if options.law is not None:
        name, *parameters = options.law.split(",")
        told = law_values(base)
        # The same law keeps what is not given anew, as all else does.
        values = (told if told["law"] == name else {"load": base.load}) | {"law": name}
        for parameter in parameters:
            key, equals, text = parameter.partition("=")
            if not equals:
                raise ValueError(
                    f"--law must hold parameter=value behind its name, got {parameter!r}"
                )
            key = key.strip()
            if key in behind:
                raise ValueError(f"--law must hold each parameter once, got {key} twice")
            behind.add(key)
            values[key] = written_number(f"--law: {key}", text)
        law = law_from(values)
    changes = {}
    for option, name in _FRICTION.items():
        value = getattr(options, option)
        if value is None:
            continue
        if name in behind:
            raise ValueError(f"--{option} and --law both give the {name}: leave one of them out")
        known = [field.name for field in fields(law)]
        if name not in known:
            raise ValueError(
                f"--{option} needs a friction law with a {name}; {type(law).__name__} has "
                f"{', '.join(known)}, to be given behind --law"
            )
        changes[name] = value
    return replace(law, **changes)


def _rounded(options: argparse.Namespace, disk: Disk) -> PenaltyContact:
    # Its damping follows from the stiffness and the disk, unless it is given.
    contact = PenaltyContact.rounded(disk, **_given(options, ("stiffness", "half_thickness")))
    return replace(contact, **_given(options, ("damping", "bilateral")))


def _contact(
    options: argparse.Namespace, base: PenaltyContact | None, disk: Disk
) -> PenaltyContact | None:
    given = _given(options, _CONTACT)
    if base is not None:
        return replace(base, **given)
    if not given:
        return None
    if "stiffness" not in given:
        name, value = next(iter(given.items()))
        raise ValueError(f"{_option(name)} needs the penalty contact of --stiffness, got {value}")
    return replace(PenaltyContact.damped(given["stiffness"], disk), **given)


def _dissipation(options: argparse.Namespace, base: Dissipation) -> Dissipation:
    given = {
        name: value
        for option, name in _LOSSES.items()
        if (value := getattr(options, option, None)) is not None
    }
    return replace(base, **given)


def _start(options: argparse.Namespace, base: Start | State) -> Start | State:
    given = _given(options, _START)
    if given and isinstance(base, State):
        raise ValueError(
            f"{_option(next(iter(given)))} cannot change a start that is told by its coordinates "
            "and rates; change those"
        )
    return replace(base, **given)


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"
