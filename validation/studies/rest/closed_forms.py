"""Centred disks against the textbook, and their last moments against power laws."""

from dataclasses import replace
from fractions import Fraction
from math import nan, pi
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import CENTRED_DISK as DISK
from analysis import Dissipation, PenaltyContact, Scenario, SmoothCoulomb, SpatialMotion, Start
from analysis.data.trajectory import SOURCES
from analysis.rest.final_stage import fit_power_law, precession
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
from validation.page.content import Content, Rows
from validation.run import run_to_rest
from validation.study import Check, Row, Study, at_most

RIM = PenaltyContact.rounded(DISK, half_thickness=2e-5)
STICKY = SmoothCoulomb(coefficient=2.0, smoothing=5e-3, load="contact")
ON_TABLE = Scenario.rest(disk=DISK, friction=STICKY, contact=RIM)
"""Friction in which a rolling disk hardly slips."""

EULER_BETA = 0.2
"""Inclination of Euler's disk in rad."""

ROLLING = (0.8, 20.0)
"""Inclination in rad and precession in rad/s of a disk that rolls with spin about its axis."""

UPRIGHT = {"upright, 5 % faster": 1.05, "upright, 5 % slower": 0.95}
"""Spins of a disk that rolls upright, in those from which on that is stable."""

LEAN = 1e-2
"""Lean in rad that a disk rolling upright stays below if it is stable, and exceeds if not."""

CLOSE, SAME = 1e-2, 1e-3
"""Largest relative differences from a closed form, and between both sides."""

FLAT_START = 0.1
"""Inclination in rad at which the last moments begin."""

FIT = (0.08, 0.02)
"""Inclinations in rad between which the laws are fitted: small, and far above the rim's shape."""

STAGES = {
    "viscous rolling": (Dissipation(rolling_viscous=2e-4), Fraction(1, 2), Fraction(-1, 4)),
    "dry rolling": (Dissipation(rolling_dry=1e-3), Fraction(2, 3), Fraction(-1, 3)),
}
"""Losses, and the exponents of the time to go that theory gives for β and Ω."""


def cases() -> dict[str, str]:
    """Names of what rolls, and of what comes to lie flat."""
    return {name: name for name in ("Euler's disk", "rolling", *UPRIGHT, *STAGES)}


def measure(case: str) -> list[Row]:
    """Quantities with their closed forms: of what rolls on both sides, else in-house."""
    if case in STAGES:
        return [{"source": "in-house", **row} for row in _last_moments(case)]
    start, end = _start(case)
    scenario = replace(ON_TABLE, start=start)
    step = 0.6 * largest_step(Scene(scenario))
    controls: dict[Any, Any] = {"engine": {"step": step}, "in-house": {"local_tolerance": 1e-10}}
    found = []
    for source in SOURCES:
        motion = run_to_rest(scenario, end, source=source, spacing=1e-2, **controls[source])
        for quantity, (exact, value) in _rolling(case, motion).items():
            found.append({"source": source, "quantity": quantity, "exact": exact, "value": value})
    return found


def _start(case: str) -> tuple[Start, float]:
    """Start of a rolling disk, and for how long in s to run it."""
    if case == "Euler's disk":
        rate = euler_disk_precession(ON_TABLE, EULER_BETA)
        return rolling_start(DISK, EULER_BETA, rate, 0.0), 1.0
    if case == "rolling":
        return rolling_start(DISK, *ROLLING, axial_spin(ON_TABLE, *ROLLING)), 0.3
    spin = UPRIGHT[case] * upright_rolling_spin(ON_TABLE)
    # Along a line, slightly pushed to a side.
    push = {"x_rate": -DISK.radius * spin, "beta_rate": 1e-3, "gamma_rate": spin}
    return Start(gamma=0.0, spin=0.0, **push), 2.5


def _rolling(case: str, motion: SpatialMotion) -> dict[str, tuple[float, float]]:
    """Closed form and value of each quantity of a rolling disk."""
    if case in UPRIGHT:
        return {"largest lean in rad": (nan, float(np.max(np.abs(motion.tilt - pi / 2))))}
    turning = float(np.mean(precession(motion)))
    if case == "rolling":
        return {
            "β in rad": (ROLLING[0], float(np.mean(motion.tilt))),
            "Ω in rad/s": (ROLLING[1], turning),
        }
    energy = float(np.mean(motion.energies[:, :2].sum(axis=1)))
    return {
        "Ω in rad/s": (euler_disk_precession(ON_TABLE, EULER_BETA), turning),
        "energy in J": (euler_disk_energy(ON_TABLE, EULER_BETA), energy),
        "contact force in N": (ON_TABLE.weight, float(np.mean(motion.normal_force))),
    }


def _last_moments(case: str) -> list[Row]:
    """Power laws of inclination and precession, fitted with one end."""
    losses, tilting, turning = STAGES[case]
    scenario = Scenario.rest(disk=DISK, contact=RIM, dissipation=losses)
    rate = euler_disk_precession(scenario, FLAT_START)
    scenario = replace(scenario, start=rolling_start(DISK, FLAT_START, rate, 0.0))
    flat = time_to_flat(scenario, FLAT_START)
    motion = run_to_rest(scenario, 1.1 * flat, source="in-house", local_tolerance=1e-10)
    times, leaning = motion.times, motion.leaning
    part = slice(int(np.argmax(leaning < FIT[0])), int(np.argmax(leaning < FIT[1])))
    law = fit_power_law(times[part], leaning[part])
    turn = fit_power_law(times[part], precession(motion)[part], law.end)
    names = ("exponent", "scale", "end", "error", "decades")
    curve = {name: getattr(law, name) for name in names} | {"times": times, "leaning": leaning}
    told = {"exponent of β": (float(tilting), law.exponent),
            "exponent of Ω": (float(turning), turn.exponent),
            "flat after s": (flat, law.end)}  # fmt: skip
    return [{"quantity": q, "exact": e, "value": v} | curve for q, (e, v) in told.items()]


STUDY = Study(
    name="rest-closed",
    cases=cases,
    measure=measure,
    keys=("source", "quantity"),
    columns={"exact": "by a closed form", "leaning": "in rad over time"},
)
STUDIES = (STUDY,)


# --- What is shown ------------------------------------------------------------------------------


def present(rows: Rows) -> Content:
    """Closed forms beside what both sides give."""
    table = rows[STUDY.name]
    keys = ["case", "quantity"]
    found = table[[*keys, "exact"]].drop_duplicates(keys)
    for source in SOURCES:
        values = table[table["source"] == source].set_index(keys)["value"]
        found[source] = values.reindex(pd.MultiIndex.from_frame(found[keys])).to_numpy()
    upright = found["case"].isin(UPRIGHT)
    leans, found = found[upright], found[~upright]
    ratios = found[list(SOURCES)].div(found["exact"], axis=0) - 1.0
    found = found.assign(difference=ratios.abs().max(axis=1))
    checks = []
    for row in found.to_dict("records"):
        name = f"rest, {row['case']}, {row['quantity']}"
        both = SOURCES if row["case"] not in STAGES else SOURCES[1:]
        worst = max(abs(row[source] / row["exact"] - 1.0) for source in both)
        checks.append(at_most(f"{name}: difference", worst, CLOSE))
        checks += [
            at_most(f"{name}: engine against in-house", abs(row["engine"] / row["in-house"] - 1.0),
                    SAME)
            for _ in both[1:]
        ]  # fmt: skip
    for row, stays in zip(leans.to_dict("records"), (True, False), strict=True):
        values = [row[source] for source in SOURCES]
        right = all(value < LEAN if stays else value > LEAN for value in values)
        limit = f"{'below' if stays else 'above'} {LEAN:g}"
        checks.append(
            Check(f"rest, {row['case']}: lean in rad", str(values), limit, "fresh", right)
        )
    laws = table[table["quantity"] == "exponent of β"].set_index("case")
    return Content(
        numbers={
            "upright_spin": upright_rolling_spin(ON_TABLE),
            "upright_leans": leans[list(SOURCES)].max(axis=1).tolist(),
            "laws": laws,
        },
        tables={"closed": found.rename(columns={"difference": "largest relative difference"})},
        figures={"final": draw(laws)},
        checks=checks,
    )


def draw(laws: pd.DataFrame) -> Figure:
    """Inclination over the time to go, with the fitted laws."""
    figure, axes = new_figure()
    for index, (name, law) in enumerate(laws.iterrows()):
        to_go, colour = law["end"] - np.array(law["times"]), COLOURS[index]
        before = to_go > 0.0
        axes.loglog(to_go[before], np.array(law["leaning"])[before], color=colour, label=name)
        fitted = law["scale"] * to_go[before] ** law["exponent"]
        words = f"fitted power {law['exponent']:.3f}, theory {law['exact']:.3f}"
        axes.loglog(to_go[before], fitted, color=colour, linestyle=":", label=words)
    axes.axhspan(*FIT[::-1], color="#dddddd", zorder=0)
    axes.set(xlabel="time to go in s (log)", ylabel="β in rad (log)")
    axes.set(xlim=(1e-3, None), ylim=(1e-3, None))
    axes.legend(loc="lower right")
    return figure
