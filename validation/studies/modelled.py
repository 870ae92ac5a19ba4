"""What is modelled: the formulations and all parameters; the rest is in the text."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from analysis import LEVELS, MODELS, Scenario
from analysis.data.disk import STEEL_RING
from analysis.data.quantities import QUANTITIES, RING, SIX
from analysis.models.forms import FORMS
from mbs_models import FORMULATIONS, Scene, formulations
from validation.kit.differences import flat
from validation.page.content import Content, Rows
from validation.study import Row, Study, equal

TITLE = "What is modelled"
STUDIES: tuple[Study, ...] = ()

INHOUSE = {"index-1": LEVELS, "reduced": LEVELS[-1:]}
"""Models of the in-house formulations."""

SYMBOLS = {
    "disk.radius": "r",
    "disk.hole_radius": "a",
    "disk.hole_distance": "b",
    "disk.thickness": "h",
    "disk.density": "ρ",
    "disk.mass": "m",
    "disk.eccentricity": "e",
    "disk.inertia_x": "A",
    "disk.inertia_y": "B",
    "disk.inertia_z": "C",
    "table.gravity": "g",
    "friction.coefficient": "μ",
    "friction.smoothing": "ε",
    "start.beta": "β",
    "start.gamma": "γ",
    "start.spin": "α̇",
    "start.gamma_rate": "γ̇",
    "start.x": "x̄",
}
"""The paper's, by quantity."""

UNITS = {"m": (1e3, "mm"), "kg m²": (1e6, "10⁻⁶ kg m²")}
"""In which a small disk has handy numbers, and how many of them are in that of a quantity."""

MOTION = [key for key in SYMBOLS if not key.startswith("disk.")]
"""Quantities of table, friction and start that are not zero or follow from others."""


def present(rows: Rows) -> Content:
    """The tables; nothing is measured."""
    del rows
    held = Scenario(constraints=MODELS[2])
    at_first = {"start.gamma_rate": 0.0, "start.x": held.initial_state.coordinates[0]}
    known = flat(held.values()) | at_first
    known |= {f"disk.{name}": value for name, value in STEEL_RING.items()}
    known |= {f"disk.{name}": getattr(held.disk, name) for name in SIX}
    built = ways()
    return Content(
        numbers={"ways": built},
        tables={
            "disk": parameters([f"disk.{name}" for name in (*RING, *SIX[1:])], known),
            "motion": parameters(MOTION, known),
        },
        checks=[
            equal("modelled: formulations that build a model",
                  sum(bool(built[way]["models"]) for way in FORMULATIONS), len(FORMULATIONS))
        ],
    )  # fmt: skip


def ways() -> dict[str, Row]:
    """Models that each formulation builds, and those with constraints left to the engine."""
    scenarios = {level: Scenario(constraints=MODELS[level]) for level in LEVELS}
    found: dict[str, Row] = {}
    for way in FORMULATIONS:
        built = [level for level in LEVELS if way in formulations(scenarios[level])]
        tied = [level for level in built if Scene(scenarios[level], way).has_constraints]
        found[way] = {"side": "engine", "models": built, "tied": tied}
    for form in FORMS:
        found[form] = {"side": "in-house", "models": INHOUSE.get(form, ()), "tied": ()}
    return found


def parameters(keys: Sequence[str], known: Mapping[str, Any]) -> pd.DataFrame:
    """Quantities of a scenario with their symbols, values and units."""
    found = []
    for each in (QUANTITIES[key] for key in keys):
        size, unit = UNITS.get(each.unit or "", (1, each.unit))
        found.append(
            {
                "of": each.table,
                "parameter": each.name.replace("_", " "),
                "symbol": SYMBOLS.get(each.key, ""),
                "value": size * known[each.key],
                "unit": unit,
            }
        )
    return pd.DataFrame(found)
