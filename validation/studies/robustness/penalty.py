"""The penalty contact against the ideal one as it gets stiffer."""

from dataclasses import replace
from itertools import product

import numpy as np

import analysis
import mbs_models
from analysis import LOADS, STEEL_DISK, Load, PenaltyContact, Scenario, SmoothCoulomb
from mbs_models import Scene
from validation.kit.references import deviation
from validation.study import Row, Study

STIFFNESSES = (1e4, 1e5, 1e6, 1e7)
"""In N/m; beyond, the error meets that of the integration."""

TOLERANCE = 1e-9

SETTLED = 0.05
"""Time in s after which the bounce of the start is gone."""


def measure(case: tuple[float, Load]) -> list[Row]:
    """Compare the damped penalty contact with the in-house Model 1 over 0.5 s from Table 3.

    The disk starts at its resting penetration. The normal force at the start of Model 1 is
    not quite the weight, so a small bounce is left, which the damping takes away.
    """
    stiffness, load = case
    ideal = Scenario(friction=SmoothCoulomb(load=load))
    times = np.linspace(0.0, 0.5, 51)
    truth = analysis.simulate(ideal, times, tolerance=1e-10)
    contact = PenaltyContact.damped(stiffness, STEEL_DISK)
    run = mbs_models.simulate(
        Scene(replace(ideal, contact=contact), "euler-tree"),
        times,
        tolerance=max(TOLERANCE, 1e-3 / stiffness),
        integrator="RK44",
    )
    force = np.abs(run.normal_force - truth.normal_force)[times >= SETTLED]
    return [
        {
            "stiffness": stiffness,
            "load": load,
            "angles": deviation(run, truth),
            "normal_force": np.max(force),
            "estimate": run.error_estimate,
            "step": run.method["step"],
        }
    ]


PENALTY = Study(
    name="robustness-penalty",
    cases=lambda: {
        f"{each:g} N/m, load {load}": (each, load) for each, load in product(STIFFNESSES, LOADS)
    },
    measure=measure,
    columns={
        "angles": "largest difference of beta and gamma from Model 1 in rad",
        "normal_force": "largest difference in N once it has settled",
        "estimate": "the run's own, of its integration, in rad",
        "step": "in s",
    },
)
