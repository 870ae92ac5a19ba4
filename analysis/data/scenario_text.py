"""The commented text of a scenario's file."""

import json
from dataclasses import asdict
from numbers import Integral, Real
from typing import Any

from analysis.data.body import PRODUCTS
from analysis.data.checks import instance
from analysis.data.constraint_set import MODELS
from analysis.data.contact import PenaltyContact
from analysis.data.disk import STEEL_RING
from analysis.data.quantities import CONSTRAINTS, QUANTITIES, SIX, of_table
from analysis.data.scenario import Scenario
from analysis.data.state import COORDINATES
from analysis.data.written import spelled_angle

FORMAT = 1
"""Of the files written here."""

_HEAD = f"""\
# A problem of the tippedisk, whole: tippedisk simulate --scenario FILE --out run.npz
# Angles are in rad, or text: "pi/2", "-pi/2 + 0.1", "90deg".
format = {FORMAT}
"""

_ABOUT = {
    "disk": """\
# A disk by its name; a disk of uniform density: radius, thickness and density with one hole, or
# in place of that with several, [x, y, radius], and small masses, [x, y, mass]; any disk:
# radius, mass, eccentricity and moments of inertia; or another body, which takes its values too.
""",
    "friction": f"""\
# Laws: {QUANTITIES["friction.law"].allowed}.
""",
    "table": "",
    "contact": """\
# Without this table the disk neither leaves the table nor sinks into it (ideal contact).
# With it, the contact is a spring and a damper at the lowest point; for Model 1.
""",
    "dissipation": """\
# What else takes energy, on the contact of [contact].
""",
    "start": f"""\
# What is left out follows from the rest and from the constraints. A start may also be told by
# all of its coordinates and rates: coordinates = [{", ".join(COORDINATES)}] and rates = [...].
""",
}

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
        If it is no scenario, or a friction law of one's own has a parameter that TOML cannot
        hold.

    Examples
    --------
    >>> from analysis import Scenario, Start, scenario_text
    >>> "spin = 35.0" in scenario_text(Scenario(start=Start(spin=35.0)))
    True
    """
    told, usual = instance("scenario", scenario, Scenario).values(), _usual(scenario)
    tables = (_table(name, told.get(name), usual.get(name, {})) for name in _ABOUT)
    return "\n".join((_HEAD, _constraints(scenario), *tables))


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


def _usual(scenario: Scenario) -> dict[str, dict[str, Any]]:
    """What is shown of keys that are not told: to take it in changes nothing, or little."""
    state, disk = scenario.initial_state, scenario.disk
    rates = {f"{name}_rate": rate for name, rate in zip(COORDINATES, state.rates, strict=True)}
    return {
        "disk": STEEL_RING
        | {name: getattr(disk, name) for name in (*SIX, *PRODUCTS)}
        | {"holes": [], "masses": []},
        "contact": asdict(PenaltyContact.rounded(disk)),
        "start": dict(zip(COORDINATES, state.coordinates, strict=True))
        | rates
        | {"spin": state.rates[3], "height": 0.0},
    }


def _table(table: str, told: dict[str, Any] | None, usual: dict[str, Any]) -> str:
    """A table with the keys that tell it, and all others as comments; one if it is left out."""
    known = {name: each.default for name, each in of_table(table).items()}
    values = known | {name: each for name, each in usual.items() if name in known | _OF_LIST}
    lines = [_ABOUT[table], f"{'# ' if told is None else ''}[{table}]\n"]
    # TOML has no word for what is left out.
    told = {name: each for name, each in (told or {}).items() if each is not None}
    for name, value in (values | told).items():
        quantity = QUANTITIES.get(f"{table}.{name}")
        spelled = spelled_angle(value) if quantity is not None and quantity.is_angle else None
        literal = _literal(name, value if spelled is None else spelled)
        about = _OF_LIST.get(name, _OWN.get(table, "")) if quantity is None else quantity.comment
        lines.append(f"{'' if name in told else '# '}{name} = {literal}  # {about}\n")
    return "".join(lines)


def _literal(name: str, value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return repr(float(value))
    if isinstance(value, list | tuple):
        return f"[{', '.join(_literal(name, each) for each in value)}]"
    raise ValueError(f"{name} cannot be written to a scenario's file: {value!r}")
