"""The creep that sliding friction alone leaves, and its law.

A disk without loss would roll as Euler's disk does: its centre of gravity at rest, the contact
point running round it with the precession rate, Omega² = m g r / (I sin(beta)). With its centre
of gravity off its centre by e, and its moments across the axis apart by 2 Delta, it cannot do that
without slip, and the contact's force makes it tilt and turn, in the time of one and of half a turn
of gamma, which changes the slip by as much. Friction so weak that the centre of gravity stays at
rest over the table leaves a slip of the amplitudes `slips`, in parts of e Omega sin²(beta). Far
below epsilon the law is viscous and takes 1/2 (mu m g / epsilon) times the sum of their squares,
all but in proportion to beta³ at small beta. With an energy of 3/2 m g r sin(beta),

    1 / beta² = 1 / beta_0² + k t,  where k = 2 mu m g e² / (3 epsilon I) * (sum of squares)

with I the mean moment of inertia across the axis about the centre of gravity.

Friction that drags the centre of gravity along makes k smaller. The contact's damper, which takes
ever more as the disk sinks (as 1 / beta), is left out.
"""

from dataclasses import replace
from math import cos, sin, sqrt

import numpy as np
import pandas as pd

from analysis import MODELS, Scenario, SmoothCoulomb, Start
from analysis.problem.checks import Array
from analysis.problem.contact import CAUSES
from validation.comparison.limits import largest
from validation.run import run_to_rest
from validation.study import Check, Content, Row, Study, at_most, relative

START = 0.28
"""Inclination in rad at which the runs of the law start, about where the fall ends."""

TIMES = (30.0, 45.0, 60.0)
"""In s: what is left of the start has died away, end of the fit, end of its check."""

STEP_ERROR = 1e-12
"""Allowed in a step: the rate then holds to 1e-7 of it. With 1e-9 it is off by 2e-3, and differs
by 1e-5 from one processor to the next."""

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


def slips(scenario: Scenario, beta: float) -> Array:
    """Amplitudes of the slip along the edge and across it, at one and two turns of gamma.

    To first order in the eccentricity and in the difference of the moments of inertia, in parts of
    e Omega sin²(beta).
    """
    disk, sb, cb = scenario.disk, sin(beta), cos(beta)
    r, e, across = disk.radius, disk.eccentricity, _across(scenario)
    x, y, axial = disk.inertia_about_cog
    apart, mu = (x - y) / 2.0 / across, disk.mass * r * r / across
    tilt = (-3.0 * cb - sb * sb / cb + mu * cb**3) / (2.0 * cb**2 - mu * cb**4)
    twice = apart * (sb * sb / (2.0 * cb) - 2.0 * cb) / (cb**2 + 4.0 * mu * cb**4)
    one = across / (axial * cb), -cb * tilt - 1.0
    two = r / e * apart * across / (2.0 * axial * cb), 2.0 * r / e * cb * twice
    return np.array((*one, *two))


def weak_friction_rate(scenario: Scenario) -> float:
    """Rate k of the law in 1/s for friction so weak that the centre of gravity stays at rest."""
    viscosity = scenario.friction.gradient * scenario.weight
    scale = 2.0 / 3.0 * viscosity * scenario.disk.eccentricity**2 / _across(scenario)
    return float(scale * np.sum(slips(scenario, START) ** 2))


def measure(smoothing: float) -> list[Row]:
    """The law of a run."""
    scenario = scenario_of(smoothing)
    motion = run_to_rest(
        scenario, TIMES[-1], source="in-house", spacing=1e-2, local_tolerance=STEP_ERROR
    )
    # As if the contact's damper took nothing.
    energies = motion.energies.sum(axis=1) + motion.dissipated[:, CAUSES.index("damping")]
    block = round(MEAN_TIME / 1e-2)
    times, energy = (
        values[: values.size // block * block].reshape(-1, block).mean(axis=1)
        for values in (motion.times, energies)
    )
    # Inclinations of Euler's disk of the same energy.
    tilts = np.arcsin(energy / (1.5 * scenario.weight * scenario.disk.radius))
    rate, error = fit(times, tilts)
    return [{"rate": rate, "part": rate / weak_friction_rate(scenario), "error": error}]


def fit(times: Array, tilts: Array) -> tuple[float, float]:
    """Fit the law to the second part of a run and check it with the third.

    Returns
    -------
    rate : float
        Of 1 / beta² in 1/s.
    error : float
        Largest relative deviation of beta behind the fit.
    """
    settled, end, _ = TIMES
    fitted, checked = (times >= settled) & (times < end), times >= end
    rate, offset = np.polyfit(times[fitted], tilts[fitted] ** -2, 1)
    predicted = (offset + rate * times[checked]) ** -0.5
    return float(rate), largest(np.abs(tilts[checked] / predicted - 1.0).tolist())


STUDY = Study(
    name="rest-creep",
    cases=lambda: SMOOTHINGS,
    measure=measure,
    sample=(next(reversed(SMOOTHINGS)),),
    confirm={"rate": relative("rate", 1e-6), "part": 1e-6, "error": 1e-7},
    columns={
        "rate": "growth in 1/s, fitted",
        "part": "part of that for weak friction",
        "error": "largest relative deviation in β",
    },
)


def present(table: pd.DataFrame) -> Content:
    """The law for each smoothing, and how long it takes."""
    table = table.set_index("case").loc[list(SMOOTHINGS)]
    shown = table.rename(columns=STUDY.columns)
    gradients = [scenario_of(each).friction.gradient for each in SMOOTHINGS.values()]
    shown.insert(0, "ε/μ in m/s", 1.0 / np.array(gradients))
    shown[f"from {START:g} to {START / 2:g} rad in min"] = 3 * START**-2 / table["rate"] / 60
    parts = table["part"].tolist()
    rising = bool(np.all(np.diff([0.0, *parts, 1.0]) > 0.0))
    name = "rest, creep: parts of the rate for weak friction"
    wanted = "rise with weaker friction, up to 1"
    checks = [
        at_most(f"rest, creep at {case}: deviation from the law", error, DEVIATION, "stored")
        for case, error in table["error"].items()
    ]
    return Content(
        tables={"creep": shown},
        checks=[*checks, Check(name, str(np.round(parts, 3).tolist()), wanted, "stored", rising)],
    )
