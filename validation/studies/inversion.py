"""The inversion from Table 3: Figures 7 to 9, engine against in-house equations."""

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from analysis import LEVELS, MODELS, Level, Load, Scenario, SmoothCoulomb, Trajectory
from analysis.data.trajectory import SOURCES, Source
from validation.run import run
from validation.study import Row, Study

TITLE = "The inversion"

TOLERANCE = 1e-7
"""Tolerance of all runs in rad."""

SPACING = 5e-3
"""Of their samples in s."""

SHORT = 2.0
"""End in s of Figure 7."""

Case = tuple[Level, Load, float]
"""Model, load of the friction law, and end in s."""

CONTACT = "Model 1, load λ_N"


def cases() -> dict[str, Case]:
    """Models 1 to 4, and Model 1 with the contact force as the load of the friction law."""
    found: dict[str, Case] = {f"Model {level}": (level, "weight", 4.0) for level in LEVELS}
    return {CONTACT: (1, "contact", SHORT), **found}


def scenario_of(level: Level, load: Load) -> Scenario:
    """What is run: from Table 3."""
    return Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))


def measure(case: Case) -> list[Row]:
    """The runs of both sides."""
    level, load, end = case
    times = np.linspace(0.0, end, round(end / SPACING) + 1)
    found = []
    for source in SOURCES:
        made = run(scenario_of(level, load), times, source=source, tolerance=TOLERANCE)
        found.append(
            {
                "source": source,
                "level": level,
                "load": load,
                "formulation": made.method.get("formulation") or made.method["form"],
                "inversion_time": made.inversion_time,
                "error_estimate": made.error_estimate,
                "times": made.times,
                "coordinates": made.coordinates,
                "rates": made.rates,
                "multipliers": made.multipliers,
                "normal_force": made.normal_force,
            }
        )
    return found


STUDY = Study(
    name="inversion",
    cases=cases,
    measure=measure,
    keys=("source",),
    columns={
        "inversion_time": "when the disk is inverted in s",
        "error_estimate": "of β and γ in rad",
        "times": "of the samples in s",
        "coordinates": "x̄, ȳ, z in m, α, β, γ in rad by time",
        "multipliers": "constraint forces by time in N and N m",
        "normal_force": "in N",
    },
)
STUDIES = (STUDY,)


def motions(table: pd.DataFrame) -> dict[tuple[str, Source], Trajectory]:
    """The runs by case and source."""
    return {(row["case"], row["source"]): _motion(row) for row in table.to_dict("records")}


def _motion(row: Mapping[Hashable, Any]) -> Trajectory:
    return Trajectory(
        scenario=scenario_of(row["level"], row["load"]),
        source=row["source"],
        method={"formulation": row["formulation"], "tolerance": TOLERANCE},
        error_estimate=row["error_estimate"],
        **{name: np.array(row[name]) for name in ("times", "coordinates", "rates", "multipliers")},
    )
