"""The creep that sliding friction alone leaves, and its law.

A disk without loss would roll as Euler's disk does: its centre of gravity at rest, the contact
point running round it with the precession rate, Omega² = m g r / (A sin(beta)). With its centre
of gravity off its centre by e, it cannot do that without slip. Friction so weak that the centre of
gravity stays at rest leaves a slip of amplitude e Omega sin²(beta). Far below epsilon the law is
viscous and takes 1/2 (mu m g / epsilon) times its square, in proportion to beta³ at small beta.
With an energy of 3/2 m g r sin(beta),

    1 / beta² = 1 / beta_0² + k t,  where k = 2 mu m g e² / (3 epsilon A) for weak friction.

Friction that drags the centre of gravity along makes k smaller, but keeps the law.
"""

from dataclasses import replace
from math import sin, sqrt
from typing import NamedTuple

import numpy as np
import pandas as pd

from analysis import MODELS, Scenario, SmoothCoulomb, Start
from analysis.data.checks import Array
from validation.kit.limits import largest
from validation.page.content import Content, Rows
from validation.run import run_to_rest
from validation.study import Check, Row, Study, at_most

START, FAR = 0.28, 0.05
"""Inclinations in rad at which the runs of the law start, about where the fall ends, and to which
it is extrapolated."""

TIMES = (30.0, 45.0, 60.0)
"""In s: what is left of the start has died away, end of the fit, end of its check."""

MEAN_TIME = 2.5
"""Time in s over which the energy is averaged."""

DEVIATION = 2e-4
"""Largest relative deviation of a run from the law fitted to the stretch before."""

SMOOTHINGS = {f"ε = {smoothing:g} m/s": smoothing for smoothing in (0.1, 0.3, 3.0)}
"""Of the friction in m/s, the strongest friction first."""


def scenario_of(smoothing: float) -> Scenario:
    """The disk as Euler's would roll, on friction of this smoothing."""
    scenario = Scenario.rest(friction=SmoothCoulomb(smoothing=smoothing, load="contact"))
    disk = scenario.disk
    precession = sqrt(scenario.weight * disk.radius / (_across(scenario) * sin(START)))
    # The rates keep the centre of gravity over its place, as the constraint of Model 2 would.
    start = Start(beta=START, gamma=0.0, spin=precession)
    held = start.state(MODELS[2], disk)
    (x, y), (x_rate, y_rate) = held.coordinates[:2], held.rates[:2]
    return replace(scenario, start=replace(start, x=x, y=y, x_rate=x_rate, y_rate=y_rate))


def _across(scenario: Scenario) -> float:
    """Mean moment of inertia across the axis about the centre of gravity in kg m²."""
    return sum(scenario.disk.inertia_about_cog[:2]) / 2.0


def weak_friction_rate(scenario: Scenario) -> float:
    """Rate k of the law in 1/s for friction so weak that the centre of gravity stays at rest."""
    viscosity = scenario.friction.gradient * scenario.weight
    return 2.0 / 3.0 * viscosity * scenario.disk.eccentricity**2 / _across(scenario)


def measure(smoothing: float) -> list[Row]:
    """Mean inclinations over time."""
    scenario = scenario_of(smoothing)
    motion = run_to_rest(
        scenario, TIMES[-1], source="in-house", spacing=1e-2, local_tolerance=1e-9
    )
    block = round(MEAN_TIME / 1e-2)
    times, energy = (
        values[: values.size // block * block].reshape(-1, block).mean(axis=1)
        for values in (motion.times, motion.energies.sum(axis=1))
    )
    tilts = np.arcsin(energy / (1.5 * scenario.weight * scenario.disk.radius))
    return [{"times": times, "tilts": tilts}]


STUDY = Study(
    name="rest-creep",
    cases=lambda: SMOOTHINGS,
    measure=measure,
    sample=(next(reversed(SMOOTHINGS)),),
    confirm={"tilts": 1e-6, "times": 1e-9},
    columns={"tilts": f"of Euler's disk of the same energy, mean of {MEAN_TIME:g} s, in rad"},
)
STUDIES = (STUDY,)


class Law(NamedTuple):
    """Rate k of 1 / beta² in 1/s, and the largest relative deviation behind the fit."""

    rate: float
    error: float

    def time_between(self, first: float, last: float) -> float:
        """Time in s that the law takes from one inclination to another."""
        return (last**-2 - first**-2) / self.rate


def fit(times: Array, tilts: Array) -> Law:
    """Fit the law to the second part of a run and check it with the third."""
    settled, end, _ = TIMES
    fitted, checked = (times >= settled) & (times < end), times >= end
    rate, offset = np.polyfit(times[fitted], tilts[fitted] ** -2, 1)
    predicted = (offset + rate * times[checked]) ** -0.5
    error = largest(np.abs(tilts[checked] / predicted - 1.0).tolist())
    return Law(float(rate), error)


def present(rows: Rows) -> Content:
    """The law for each smoothing, and how long it takes."""
    runs = rows[STUDY.name].set_index("case").map(np.array)
    laws = {case: fit(*runs.loc[case, ["times", "tilts"]]) for case in SMOOTHINGS}
    scenarios = {case: scenario_of(smoothing) for case, smoothing in SMOOTHINGS.items()}
    table = pd.DataFrame(
        {
            "ε/μ in m/s": 1.0 / scenarios[case].friction.gradient,
            "growth in 1/s, fitted": law.rate,
            "part of that for weak friction": law.rate / weak_friction_rate(scenarios[case]),
            "largest relative deviation in β": law.error,
            f"from {START:g} to {START / 2:g} rad in min": law.time_between(START, START / 2) / 60,
            f"to {FAR:g} rad in h": law.time_between(START, FAR) / 3600,
        }
        for case, law in laws.items()
    )
    shares = table["part of that for weak friction"]
    rising = bool(np.all(np.diff([0.0, *shares, 1.0]) > 0.0))
    name, wanted = (
        "rest, creep: parts of the rate for weak friction",
        "rise with weaker friction, up to 1",
    )
    checks = [
        at_most(f"rest, creep at {case}: deviation from the law", law.error, DEVIATION, "stored")
        for case, law in laws.items()
    ]
    return Content(
        numbers={"creep_law": table.iloc[0].tolist()},
        tables={"creep": table},
        checks=[*checks, Check(name, str(shares.round(3).tolist()), wanted, "stored", rising)],
    )
