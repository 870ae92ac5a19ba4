"""The final stage of a centred disk with one dissipation at a time, and its power law."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from analysis import CENTRED_DISK as DISK
from analysis import Dissipation, PenaltyContact, Scenario, SpatialMotion
from analysis.rest.final_stage import fit_power_law, precession
from analysis.rest.stationary_rolling import euler_disk_precession, rolling_start, time_to_flat
from validation.kit import figures
from validation.kit.figures import Picture
from validation.kit.report import Job
from validation.kit.tables import Table
from validation.run import run_to_rest

START = 0.1
"""Inclination at the start in rad."""

FIT = (0.08, 0.02)
"""Inclinations in rad between which the laws are fitted: small, and far above the rim's shape."""

STAGES = {
    "viscous rolling": (Dissipation(rolling_viscous=2e-4), "1/2", "-1/4"),
    "dry rolling": (Dissipation(rolling_dry=1e-3), "2/3", "-1/3"),
}


def scenario_of(name: str) -> Scenario:
    """Euler's disk with this dissipation."""
    scenario = Scenario.rest(
        disk=DISK,
        contact=PenaltyContact.rounded(DISK, half_thickness=2e-5),
        dissipation=STAGES[name][0],
    )
    start = rolling_start(DISK, START, euler_disk_precession(scenario, START), 0.0)
    return replace(scenario, start=start)


def run_stage(name: str) -> SpatialMotion:
    """Euler's disk until flat with this dissipation."""
    scenario = scenario_of(name)
    return run_to_rest(
        scenario,
        1.1 * time_to_flat(scenario, START),
        source="in-house",
        local_tolerance=1e-10,
    )


def jobs() -> list[Job]:
    """Runs behind the table."""
    return [Job(("final stage", name), run_stage, (name,)) for name in STAGES]


def _fitted(motion: SpatialMotion) -> slice:
    leaning = motion.leaning
    return slice(int(np.argmax(leaning < FIT[0])), int(np.argmax(leaning < FIT[1])))


def table(results: Mapping[Any, Any]) -> Table:
    """Fitted exponents beside those of the theory."""
    rows = []
    for name, (_, tilting, turning) in STAGES.items():
        motion = results["final stage", name]
        part = _fitted(motion)
        law = fit_power_law(motion.times[part], motion.leaning[part])
        rate = fit_power_law(motion.times[part], precession(motion)[part], law.end)
        rows.append(
            (
                name, tilting, law.exponent, turning, rate.exponent,
                time_to_flat(motion.scenario, START), law.end, law.error, law.decades,
            )
        )  # fmt: skip
    return Table(
        name="rest-final-stage",
        title="Power laws of the final stage",
        columns=(
            "dissipation", "β, theory", "β, fitted", "Ω, theory", "Ω, fitted",
            "end in s, theory", "end in s, fitted", "largest relative deviation", "decades",
        ),
        rows=rows,
        note=f"Centred disk from β = {START:g} rad, fitted to {FIT[0]:g} > β > {FIT[1]:g} rad. "
        "With pivoting friction alone the rate of β falls faster than β, so it never ends.",
    )  # fmt: skip


def draw(results: Mapping[Any, Any]) -> Picture:
    """Inclination over the time to go, with the fitted laws."""
    figure, axes = figures.new_figure()
    for index, (name, (_, tilting, _)) in enumerate(STAGES.items()):
        motion = results["final stage", name]
        part = _fitted(motion)
        law = fit_power_law(motion.times[part], motion.leaning[part])
        before = motion.times < law.end
        to_go = law.end - motion.times[before]
        colour = figures.COLOURS[index]
        axes.loglog(to_go, motion.leaning[before], color=colour, label=name)
        axes.loglog(
            to_go, law.scale * to_go**law.exponent, color=colour, linestyle=":",
            label=f"fitted power {law.exponent:.3f}, theory {tilting}",
        )  # fmt: skip
    for limit in FIT:
        axes.axhline(limit, color="#888888", linewidth=0.8)
    axes.set(xlabel="time to go in s", ylabel="β in rad", xlim=(1e-3, None), ylim=(1e-3, None))
    axes.legend()
    return figures.render(
        figure,
        name="rest-final-stage",
        title="The final stage follows its power law",
        caption="Grey: range of the fit. The laws take the disk to sink slowly as it turns, "
        "which ends in its last turn; neither a thinner rim nor a stiffer contact moves that.",
    )
