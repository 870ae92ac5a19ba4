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

from dataclasses import dataclass, replace
from math import sin, sqrt
from typing import Any

import numpy as np
import pandas as pd

from analysis import MODELS, Disk, Scenario, SmoothCoulomb, SpatialMotion, Start
from analysis.data.checks import Array
from validation.kit.figures import COLOURS, MARKERS, new_figure
from validation.kit.limits import largest
from validation.page.content import Content, Rows
from validation.run import run_to_rest
from validation.study import Check, Row, Study, at_most

START = 0.28
"""Inclination in rad at which the runs of the law start, about where the fall ends."""

TIMES = (30.0, 45.0, 60.0)
"""In s: what is left of the start has died away, end of the fit, end of its check."""

SMOOTHINGS = (0.1, 0.3, 3.0)
"""Of the friction in m/s, the strongest friction first."""

MEAN_TIME = 2.5
"""Time in s over which the energy is averaged."""

DEVIATION = 2e-4
"""Largest relative deviation of a run from the law fitted to the stretch before."""

FAR = 0.05
"""Inclination in rad to which the law is extrapolated."""

BEGIN = "the first 10 s"
"""Of the strongest friction, which is what is run again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """1 / beta² = offset + rate * t, fitted to a run.

    Parameters
    ----------
    offset, rate : float
        In 1/rad² and 1/s.
    error : float
        Largest relative deviation of the inclination from the law behind the time of the fit.
    """

    offset: float
    rate: float
    error: float

    def time_between(self, first: float, last: float) -> float:
        """Time in s that the law takes from one inclination to another."""
        return (last**-2 - first**-2) / self.rate


def scenario_of(smoothing: float) -> Scenario:
    """The disk as Euler's would roll, on friction of this smoothing."""
    scenario = Scenario.rest(friction=SmoothCoulomb(smoothing=smoothing, load="contact"))
    precession = sqrt(
        scenario.weight * scenario.disk.radius / (_across(scenario.disk) * sin(START))
    )
    # The rates keep the centre of gravity over its place, as the constraint of Model 2 would.
    start = Start(beta=START, gamma=0.0, spin=precession)
    held = start.state(MODELS[2], scenario.disk)
    (x, y), (x_rate, y_rate) = held.coordinates[:2], held.rates[:2]
    start = replace(start, x=x, y=y, x_rate=x_rate, y_rate=y_rate)
    return replace(scenario, start=start)


def cases() -> dict[str, tuple[float, float]]:
    """Smoothing in m/s and end in s of each run."""
    runs = {f"ε = {smoothing:g} m/s": (smoothing, TIMES[-1]) for smoothing in SMOOTHINGS}
    return {**runs, BEGIN: (SMOOTHINGS[0], 10.0)}


def measure(case: tuple[float, float]) -> list[Row]:
    """Mean inclinations over time."""
    smoothing, end = case
    scenario = scenario_of(smoothing)
    motion = run_to_rest(scenario, end, source="in-house", spacing=1e-2, local_tolerance=1e-9)
    times, tilts = means(motion)
    return [{"smoothing": smoothing, "times": times, "tilts": tilts}]


STUDY = Study(
    name="rest-creep",
    cases=cases,
    measure=measure,
    sample=(BEGIN,),
    confirm={"tilts": 1e-6, "times": 1e-9},
    columns={"tilts": f"of Euler's disk of the same energy, mean of {MEAN_TIME:g} s, in rad"},
)
STUDIES = (STUDY,)


def means(motion: SpatialMotion) -> tuple[Array, Array]:
    """Times, and inclinations of Euler's disk of the same mean energy, about which a disk nods."""
    block = round(MEAN_TIME / (motion.times[1] - motion.times[0]))
    count = motion.times.size // block * block
    times = motion.times[:count].reshape(-1, block).mean(axis=1)
    energy = motion.energies.sum(axis=1)[:count].reshape(-1, block).mean(axis=1)
    scenario = motion.scenario
    return times, np.arcsin(energy / (1.5 * scenario.weight * scenario.disk.radius))


def fit(times: Array, tilts: Array) -> Law:
    """Fit the law to the second part of a run and check it with the third."""
    settled, end, _ = TIMES
    fitted = (times >= settled) & (times < end)
    rate, offset = np.polyfit(times[fitted], tilts[fitted] ** -2, 1)
    checked = times >= end
    law = (offset + rate * times[checked]) ** -0.5
    error = largest(np.abs(tilts[checked] / law - 1.0).tolist())
    return Law(offset=float(offset), rate=float(rate), error=error)


def weak_friction_rate(scenario: Scenario) -> float:
    """Rate k of the law in 1/s for friction so weak that the centre of gravity stays at rest."""
    viscosity = scenario.friction.gradient * scenario.weight
    disk = scenario.disk
    return 2.0 / 3.0 * viscosity * disk.eccentricity**2 / _across(disk)


def _across(disk: Disk) -> float:
    """Mean moment of inertia across the axis about the centre of gravity in kg m²."""
    return sum(disk.inertia_about_cog[:2]) / 2.0


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """The law for each smoothing, and how long it takes."""
    stored = rows[STUDY.name].set_index("case")
    curves = {
        smoothing: (np.array(row["times"]), np.array(row["tilts"]))
        for name, row in stored.iterrows()
        if name != BEGIN
        for smoothing in [row["smoothing"]]
    }
    laws = {smoothing: fit(*curves[smoothing]) for smoothing in SMOOTHINGS}
    shares = [laws[each].rate / weak_friction_rate(scenario_of(each)) for each in SMOOTHINGS]
    begin, whole = np.array(stored.loc[BEGIN, "tilts"]), curves[SMOOTHINGS[0]][1]
    checks = [
        *(
            at_most(f"rest, creep at ε = {each:g} m/s: deviation from the law", law.error,
                    DEVIATION, "stored")
            for each, law in laws.items()
        ),
        Check("rest, creep: parts of the rate for weak friction", str(np.round(shares, 3)),
              "rise with weaker friction, up to 1", "stored",
              bool(np.all(np.diff([0.0, *shares, 1.0]) > 0.0))),
        at_most("rest, creep: its first 10 s in rad",
                largest(np.abs(begin - whole[: begin.size]).tolist()), 1e-6, "stored"),
    ]  # fmt: skip
    law = laws[SMOOTHINGS[0]]
    return Content(
        numbers={
            "creep_rate": law.rate,
            "creep_start": START,
            "creep_far": FAR,
            "creep_minutes": law.time_between(START, START / 2) / 60.0,
            "creep_hours": law.time_between(START, FAR) / 3600.0,
            "creep_times": TIMES,
        },
        tables={"creep": law_table(laws, shares)},
        figures={"creep": draw(laws, curves)},
        checks=checks,
    )


def law_table(laws: dict[float, Law], shares: list[float]) -> pd.DataFrame:
    """The law for each smoothing."""
    return pd.DataFrame(
        [
            {
                "ε/μ in m/s": 1.0 / scenario_of(smoothing).friction.gradient,
                "growth in 1/s, fitted": law.rate,
                "part of that for weak friction": share,
                "largest relative deviation in β": law.error,
                f"from {START:g} to {0.5 * START:g} rad in min": law.time_between(
                    START, 0.5 * START
                )
                / 60.0,
                f"to {FAR:g} rad in h": law.time_between(START, FAR) / 3600.0,
            }
            for (smoothing, law), share in zip(laws.items(), shares, strict=True)
        ]
    )


def draw(laws: dict[float, Law], curves: dict[float, tuple[Array, Array]]) -> Any:
    """1 / beta² over time, with the fitted lines."""
    figure, axes = new_figure()
    for index, (smoothing, law) in enumerate(laws.items()):
        times, tilts = curves[smoothing]
        name = f"ε/μ = {1.0 / scenario_of(smoothing).friction.gradient:.3g} m/s"
        colour, marker = COLOURS[index], MARKERS[index]
        axes.plot(times, tilts**-2, marker=marker, linestyle="", label=name, color=colour)
        axes.plot(times, law.offset + law.rate * times, linestyle=":", color=colour)
    axes.axvspan(*TIMES[:2], color="#dddddd", zorder=0)
    axes.set(xlabel="time in s", ylabel="1/β² in 1/rad²")
    axes.legend(loc="upper left")
    return figure
