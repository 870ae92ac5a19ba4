"""The penalty contact against the ideal one as it gets stiffer."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd

import analysis
from analysis import LOADS, STEEL_DISK, Load, PenaltyContact, Scenario, SmoothCoulomb
from validation.comparison.differences import deviation
from validation.comparison.limits import largest
from validation.comparison.ways import Way
from validation.study import Content, Row, Study, at_most

STIFFNESSES = (1e4, 1e5, 1e6, 1e7)
"""In N/m; beyond, the error meets that of the integration."""

TOLERANCE = 1e-9

ORDER = 0.1
"""Largest deviation from one of the order in which it tends to the ideal contact."""

INTEGRATED = 0.01
"""Largest error of its integration over its difference from the ideal contact."""

SETTLED = 0.05
"""Time in s after which the bounce of the start is gone."""


def measure(case: tuple[float, Load]) -> Iterator[Row]:
    """Compare the damped penalty contact with the in-house Model 1 over 0.5 s from Table 3.

    The disk starts at its resting penetration. The normal force at the start of Model 1 is
    not quite the weight, so a small bounce is left, which the damping takes away.

    Yields
    ------
    dict
        A row with the largest differences from Model 1 of beta and gamma in rad (`angles`) and,
        once it has settled, of the normal force in N (`normal_force`); and the run's own
        `estimate`, of its integration, in rad.
    """
    stiffness, load = case
    ideal = Scenario(friction=SmoothCoulomb(load=load))
    times = np.linspace(0.0, 0.5, 51)
    truth = analysis.simulate(ideal, times, tolerance=1e-10)
    contact = PenaltyContact.damped(stiffness, STEEL_DISK)
    way, tolerance = Way("engine", "euler-tree", "RK44"), max(TOLERANCE, 1e-3 / stiffness)
    run = way.run(replace(ideal, contact=contact), times, tolerance=tolerance)
    force = np.abs(run.normal_force - truth.normal_force)[times >= SETTLED]
    yield {
        "stiffness": stiffness,
        "load": load,
        "angles": deviation(run, truth),
        "normal_force": np.max(force),
        "estimate": run.error_estimate,
    }


STUDY = Study(
    name="robustness-penalty",
    cases=lambda: {
        f"{each:g} N/m, load {load}": (each, load) for each, load in product(STIFFNESSES, LOADS)
    },
    measure=measure,
)


def present(table: pd.DataFrame) -> Content:
    """Differences from the ideal contact, and the order in which they vanish."""
    checks = []
    for load in LOADS:
        rows = table[table["load"] == load].set_index("stiffness").reindex(STIFFNESSES)
        for column in ("angles", "normal_force"):
            # Over a decade of stiffness each.
            orders = -np.diff(np.log10(rows[column]))
            worst = largest(np.abs(orders - 1.0))
            checks.append(at_most(f"penalty: load {load}, {column}, order less one", worst, ORDER))
        integrated = largest(rows["estimate"] / rows["angles"])
        name = f"penalty: load {load}, error of integration"
        checks.append(at_most(name, integrated, INTEGRATED))
    return Content(tables={"penalty": table.drop(columns="case")}, checks=checks)
