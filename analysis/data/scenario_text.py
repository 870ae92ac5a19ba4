"""The commented text of a scenario's file."""

import json
from collections.abc import Iterator
from dataclasses import asdict
from math import isfinite
from numbers import Integral, Real
from typing import Any

from analysis.data.angles import spelled_angle
from analysis.data.bodies import body_values
from analysis.data.body import PRODUCTS, Body
from analysis.data.constraint_set import MODELS
from analysis.data.contact import PenaltyContact
from analysis.data.disk import STEEL_RING, Disk
from analysis.data.friction import law_values
from analysis.data.quantities import CONSTRAINTS, PLATE, QUANTITIES, RING, SIX
from analysis.data.scenario import Scenario
from analysis.data.start import Start
from analysis.data.state import COORDINATES

FORMAT = 1
"""Of the files written here."""

_HEAD = f"""\
# A problem of the tippedisk, whole: tippedisk simulate --scenario FILE --out run.npz
# Angles are in rad, or text: "pi/2", "-pi/2 + 0.1", "90deg".
format = {FORMAT}
"""

_IDEAL = """\
# Without this table the disk neither leaves the table nor sinks into it (ideal contact).
# With it, the contact is a spring and a damper at the lowest point; for Model 1.
"""

_START = """\
# What is left out follows from the rest and from the constraints. A start may also be told by
# all of its coordinates and rates: coordinates = [{}] and rates = [...].
"""

_OWN = {"friction": "of this law", "disk": "of this body"}
_OF_LIST = {
    "coordinates": f"{', '.join(COORDINATES)} in m and rad",
    "rates": "their rates in m/s and rad/s",
    "holes": "in m, in axes of the plate",
    "masses": "in m and kg",
}


def scenario_text(scenario: Scenario) -> str:
    """TOML text of a scenario, with every key, its unit and what is allowed.

    `load_scenario` makes an equal scenario from it.

    Parameters
    ----------
    scenario : Scenario

    Raises
    ------
    ValueError
        If a friction law of one's own has a parameter that TOML cannot hold.

    Examples
    --------
    >>> from analysis import Scenario, Start, scenario_text
    >>> "spin = 35.0" in scenario_text(Scenario(start=Start(spin=35.0)))
    True
    """
    parts = (
        _HEAD + "\n" + _constraints(scenario),
        "[disk]\n" + "".join(_disk(scenario.disk)),
        "[friction]\n" + _friction(law_values(scenario.friction)),
        "[table]\n" + _lines("table", asdict(scenario.table)),
        _contact(scenario),
        "# What else takes energy, on the contact of [contact].\n[dissipation]\n"
        + _lines("dissipation", asdict(scenario.dissipation)),
        "".join(_start(scenario)),
    )
    return "\n".join(parts)


def _constraints(scenario: Scenario) -> str:
    model = ", ".join(f"{level} {each[-1]}" for level, each in MODELS.items())
    others = ", ".join(f'"{each}"' for each in CONSTRAINTS[1:])
    names = _literal("constraints", list(scenario.constraints))
    level = scenario.model
    return (
        "# What holds the disk: a model of the paper, each of which adds a constraint\n"
        f"# ({model}), or in place of it\n"
        f'# "contact" and some, not all, of\n# {others}.\n'
        f"{'# ' if level is None else ''}model = {level or 1}\n"
        f"{'' if level is None else '# '}constraints = {names}\n"
    )


def _disk(disk: Body) -> Iterator[str]:
    told = body_values(disk)
    is_disk = isinstance(disk, Disk)
    parts = disk.parts if isinstance(disk, Disk) else None
    ring, is_ring = STEEL_RING | (told if parts else {}), "hole_radius" in told
    yield "# What it is. Other bodies than a disk take their values from here:\n"
    yield _lines("disk", {"body": "disk"} | ({} if is_disk else told), off=is_disk)
    yield "# A disk of uniform density with a round hole:\n"
    for name in RING:
        off = parts is None or not (is_ring or name in PLATE)
        yield _lines("disk", {name: ring[name]}, off=off)
    yield "# In place of its hole, several holes [x, y, radius] and small masses [x, y, mass]:\n"
    lists = {name: told.get(name, []) for name in ("holes", "masses")}
    yield _lines("disk", lists, off=parts is None or is_ring)
    yield "# In place of it, any disk:\n"
    for name in (*SIX, *PRODUCTS):
        off = not is_disk or parts is not None or (name in PRODUCTS and name not in told)
        yield _lines("disk", {name: getattr(disk, name)}, off=off)
    names = " or ".join(f'"{name}"' for name in QUANTITIES["disk.name"].choices)
    yield f"# Or a disk by name: name = {names}\n"


def _friction(values: dict[str, Any]) -> str:
    laws = f"# Laws: {QUANTITIES['friction.law'].allowed}.\n"
    given = {name: value for name, value in values.items() if value is not None}
    return laws + _lines("friction", given)


def _contact(scenario: Scenario) -> str:
    contact = scenario.contact
    shown = PenaltyContact.rounded(scenario.disk) if contact is None else contact
    mark = "# " if contact is None else ""
    return f"{_IDEAL}{mark}[contact]\n" + _lines("contact", asdict(shown), off=contact is None)


def _start(scenario: Scenario) -> Iterator[str]:
    yield _START.format(", ".join(COORDINATES))
    yield "[start]\n"
    if not isinstance(scenario.start, Start):
        state = scenario.start
        yield _lines("start", {"coordinates": state.coordinates, "rates": state.rates})
        return
    # A key that is left out shows what follows from the rest: to take it in changes nothing.
    state = scenario.initial_state
    follows = dict(zip(COORDINATES, state.coordinates, strict=True)) | {
        f"{name}_rate": rate for name, rate in zip(COORDINATES, state.rates, strict=True)
    }
    for name, value in asdict(scenario.start).items():
        left_out = value is None
        shown = follows.get(name, 0.0) if left_out else value
        yield _lines("start", {name: shown}, off=left_out)


def _lines(table: str, values: dict[str, Any], *, off: bool = False) -> str:
    mark = "# " if off else ""
    lines = []
    for name, value in values.items():
        quantity = QUANTITIES.get(f"{table}.{name}")
        spelled = spelled_angle(value) if quantity is not None and quantity.is_angle else None
        literal = _literal(name, value if spelled is None else spelled)
        about = _OF_LIST.get(name, _OWN.get(table, "")) if quantity is None else quantity.comment
        lines.append(f"{mark}{name} = {literal}  # {about}\n")
    return "".join(lines)


def _literal(name: str, value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        number = float(value)
        return repr(number) if isfinite(number) else str(number)
    if isinstance(value, list | tuple):
        return f"[{', '.join(_literal(name, each) for each in value)}]"
    raise ValueError(f"{name} cannot be written to a scenario's file: {value!r}")
