"""Centred disks against the textbook, and their last moments against power laws."""

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
import pandas as pd

from analysis import CENTRED_DISK as DISK
from analysis import Dissipation, PenaltyContact, Scenario, SmoothCoulomb, Start
from analysis.data.trajectory import SOURCES
from analysis.rest.final_stage import PowerLaw, fit_power_law, precession
from analysis.rest.stationary_rolling import (
    axial_spin,
    euler_disk_energy,
    euler_disk_precession,
    rolling_start,
    time_to_flat,
    upright_rolling_spin,
)
from mbs_models import Scene
from mbs_models.rest_run import largest_step
from validation.kit.figures import COLOURS, new_figure
from validation.kit.limits import largest
from validation.page.content import Content, Rows
from validation.run import run_to_rest
from validation.study import Check, Row, Study, at_most

RIM = PenaltyContact.rounded(DISK, half_thickness=2e-5)
STICKY = SmoothCoulomb(coefficient=2.0, smoothing=5e-3, load="contact")
"""Friction in which a rolling disk hardly slips."""

ON_TABLE = Scenario.rest(disk=DISK, friction=STICKY, contact=RIM)

EULER_BETA = 0.2
"""Inclination of Euler's disk in rad."""

ROLLING = (0.8, 20.0)
"""Inclination in rad and precession in rad/s of a disk that rolls with spin about its axis."""

UPRIGHT = {"upright, 5 % faster": 1.05, "upright, 5 % slower": 0.95}
"""Spins of a disk that rolls upright, in those from which on that is stable."""

LEAN = 1e-2
"""Lean in rad that a disk rolling upright stays below, if it is stable."""

CLOSE = 1e-2
"""Largest relative difference from a closed form."""

SAME = 1e-3
"""Largest relative difference between both sides."""

FLAT_START = 0.1
"""Inclination in rad at which the last moments begin."""

FIT = (0.08, 0.02)
"""Inclinations in rad between which the laws are fitted: small, and far above the rim's shape."""

STAGES = {
    "viscous rolling": (Dissipation(rolling_viscous=2e-4), Fraction(1, 2), Fraction(-1, 4)),
    "dry rolling": (Dissipation(rolling_dry=1e-3), Fraction(2, 3), Fraction(-1, 3)),
}
"""Losses, and the exponents of the time to go that theory gives for β and Ω."""


def _start(name: str) -> tuple[Start, float]:
    """Start of a rolling disk, and for how long in s to run it."""
    if name == "Euler's disk":
        rate = euler_disk_precession(ON_TABLE, EULER_BETA)
        return rolling_start(DISK, EULER_BETA, rate, 0.0), 1.0
    if name == "rolling":
        beta, rate = ROLLING
        return rolling_start(DISK, beta, rate, axial_spin(ON_TABLE, beta, rate)), 0.3
    spin = UPRIGHT[name] * upright_rolling_spin(ON_TABLE)
    # Along a line, slightly pushed to a side.
    push = {"x_rate": -DISK.radius * spin, "beta_rate": 1e-3, "gamma_rate": spin}
    return Start(gamma=0.0, spin=0.0, **push), 2.5


def stage_scenario(name: str) -> Scenario:
    """Euler's disk with this loss."""
    scenario = Scenario.rest(disk=DISK, contact=RIM, dissipation=STAGES[name][0])
    rate = euler_disk_precession(scenario, FLAT_START)
    return replace(scenario, start=rolling_start(DISK, FLAT_START, rate, 0.0))


def cases() -> dict[str, str]:
    """Names of what rolls, and of what comes to lie flat."""
    return {name: name for name in ("Euler's disk", "rolling", *UPRIGHT, *STAGES)}


def measure(case: str) -> list[Row]:
    """Means of what rolls, on both sides; the last moments over time, in-house."""
    if case in STAGES:
        scenario = stage_scenario(case)
        end = 1.1 * time_to_flat(scenario, FLAT_START)
        motion = run_to_rest(scenario, end, source="in-house", local_tolerance=1e-10)
        # Up to where it lies all but flat and has no precession.
        upright = slice(0, int(np.argmax(motion.leaning < 0.5 * FIT[1])))
        return [
            {
                "source": "in-house",
                "times": motion.times,
                "leaning": motion.leaning,
                "turning": precession(motion)[upright],
            }
        ]
    start, end = _start(case)
    scenario = replace(ON_TABLE, start=start)
    found = []
    for source in SOURCES:
        step = 0.6 * largest_step(Scene(scenario))
        control: Any = {"step": step} if source == "engine" else {"local_tolerance": 1e-10}
        motion = run_to_rest(scenario, end, source=source, spacing=1e-2, **control)
        found.append(
            {
                "source": source,
                "precession": np.mean(precession(motion)),
                "energy": np.mean(motion.energies[:, :2].sum(axis=1)),
                "force": np.mean(motion.normal_force),
                "tilt": np.mean(motion.tilt),
                "farthest": np.max(np.abs(motion.tilt - pi / 2)),
            }
        )
    return found


STUDY = Study(
    name="rest-closed",
    cases=cases,
    measure=measure,
    keys=("source",),
    columns={
        "precession": "mean in rad/s",
        "farthest": "largest lean in rad",
        "turning": "precession in rad/s over time",
    },
)
STUDIES = (STUDY,)


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Closed forms beside what both sides give."""
    runs = {(row["case"], row["source"]): row for row in rows[STUDY.name].to_dict("records")}
    laws = {name: fit(runs[name, "in-house"]) for name in STAGES}
    table = pd.DataFrame(
        [_row(*each) for each in [*_rolling(runs), *_last_moments(laws)]],
        columns=["quantity", "closed form", *SOURCES, "largest relative difference"],
    )
    checks = []
    for row in table.to_dict("records"):
        name = f"rest, {row['quantity']}"
        checks.append(at_most(name, row["largest relative difference"], CLOSE))
        if not pd.isna(row["engine"]):
            sides = abs(row["engine"] / row["in-house"] - 1.0)
            checks.append(at_most(f"{name}, engine against in-house", sides, SAME))
    leans = {name: [runs[name, source]["farthest"] for source in SOURCES] for name in UPRIGHT}
    for (name, found), stays in zip(leans.items(), (True, False), strict=True):
        limit, worst = f"{'below' if stays else 'above'} {LEAN:g}", [round(x, 6) for x in found]
        holds = all((lean < LEAN) if stays else (lean > LEAN) for lean in found)
        checks.append(Check(f"rest, {name}: lean in rad", str(worst), limit, "fresh", holds))
    return Content(
        numbers={
            "upright_spin": upright_rolling_spin(ON_TABLE),
            "upright_leans": [max(found) for found in leans.values()],
            "stage_decades": [law.decades for law, _ in laws.values()],
            "stage_error": max(law.error for law, _ in laws.values()),
            "stage_fit": FIT,
            "closed_largest": table["largest relative difference"].max(),
        },
        tables={"closed": table},
        figures={"final": draw(runs, laws)},
        checks=checks,
    )


def _row(quantity: str, exact: float, *values: float) -> list[Any]:
    return [quantity, exact, *values, largest(abs(v / exact - 1.0) for v in values if v == v)]  # noqa: PLR0124


def _rolling(runs: Mapping[Any, Row]) -> list[tuple[Any, ...]]:
    """Quantities of rolling disks: name, closed form, engine, in-house."""
    beta, rate = ROLLING
    wanted = (
        ("Euler's disk", "Ω in rad/s", "precession", euler_disk_precession(ON_TABLE, EULER_BETA)),
        ("Euler's disk", "energy in J", "energy", euler_disk_energy(ON_TABLE, EULER_BETA)),
        ("Euler's disk", "contact force in N", "force", ON_TABLE.weight),
        ("rolling", "β in rad", "tilt", beta),
        ("rolling", "Ω in rad/s", "precession", rate),
    )
    return [
        (f"{name}, {words}", exact, *(runs[name, source][column] for source in SOURCES))
        for name, words, column, exact in wanted
    ]


def _last_moments(laws: Mapping[str, tuple[PowerLaw, PowerLaw]]) -> list[tuple[Any, ...]]:
    """The same of the final stage, which is run in-house alone."""
    found: list[tuple[Any, ...]] = []
    for name, (tilt, turn) in laws.items():
        end = time_to_flat(stage_scenario(name), FLAT_START)
        found += [
            (f"{name}: exponent of β", float(STAGES[name][1]), np.nan, tilt.exponent),
            (f"{name}: exponent of Ω", float(STAGES[name][2]), np.nan, turn.exponent),
            (f"{name}: flat after s", end, np.nan, tilt.end),
        ]
    return found


def fit(row: Row) -> tuple[PowerLaw, PowerLaw]:
    """Power laws of inclination and precession, with one end."""
    times, leaning = np.array(row["times"]), np.array(row["leaning"])
    part = slice(int(np.argmax(leaning < FIT[0])), int(np.argmax(leaning < FIT[1])))
    law = fit_power_law(times[part], leaning[part])
    return law, fit_power_law(times[part], np.array(row["turning"])[part], law.end)


def draw(runs: Mapping[Any, Row], laws: Mapping[str, tuple[PowerLaw, PowerLaw]]) -> Any:
    """Inclination over the time to go, with the fitted laws."""
    figure, axes = new_figure()
    for index, (name, (law, _)) in enumerate(laws.items()):
        times, leaning = (np.array(runs[name, "in-house"][each]) for each in ("times", "leaning"))
        before = times < law.end
        to_go, colour = law.end - times[before], COLOURS[index]
        axes.loglog(to_go, leaning[before], color=colour, label=name)
        words = f"fitted power {law.exponent:.3f}, theory {STAGES[name][1]}"
        axes.loglog(
            to_go, law.scale * to_go**law.exponent, color=colour, linestyle=":", label=words
        )
    axes.axhspan(*FIT[::-1], color="#dddddd", zorder=0)
    axes.set(
        xlabel="time to go in s (log)",
        ylabel="β in rad (log)",
        xlim=(1e-3, None),
        ylim=(1e-3, None),
    )
    axes.legend(loc="lower right")
    return figure
