"""Error against run time of the compliant contact: its law, and the engine's step."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.ticker import NullFormatter

from analysis import STEEL_DISK, PenaltyContact, Scenario, Trajectory
from mbs_models import Scene
from mbs_models.rest_run import largest_step
from validation.kit import figures
from validation.kit.figures import Picture
from validation.kit.report import Job
from validation.kit.tables import Table
from validation.run import run, run_to_rest

END = 1.0
"""End in s, past the inversion; the error of the law grows no further until the fall."""

SPACING = 1e-2

CONTACTS = ((1e6, 8e-4), (1e6, 2e-4), (1e6, 5e-5), (1e5, 5e-5))
"""Stiffness in N/m and half thickness of the rim in m."""

PARTS = (0.6, 0.3, 0.15)
"""Steps as parts of the predicted stability limit, largest first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactRun:
    """One run of the engine.

    Parameters
    ----------
    stiffness : float
        In N/m.
    half_thickness : float
        In m.
    step : float
        In s.
    seconds : float
        Processor time per simulated second in s.
    law_error : float
        Largest deviation in rad of β and γ from Model 1 with its ideal contact: what contact and
        step do together.
    step_error : float
        Largest deviation in rad from the in-house run on the same contact: the step's alone.
    """

    stiffness: float
    half_thickness: float
    step: float
    seconds: float
    law_error: float
    step_error: float


def measure(stiffness: float, half_thickness: float) -> list[ContactRun]:
    """Run a contact with every step.

    Parameters
    ----------
    stiffness : float
        In N/m.
    half_thickness : float
        In m.
    """
    contact = PenaltyContact.rounded(
        STEEL_DISK, stiffness=stiffness, half_thickness=half_thickness
    )
    scenario = Scenario.rest(contact=contact)
    times = np.arange(round(END / SPACING) + 1) * SPACING
    ideal = run(Scenario(friction=scenario.friction), times, source="in-house", tolerance=1e-9)
    same = run_to_rest(
        scenario,
        END,
        source="in-house",
        spacing=SPACING,
        method="DOP853",
        local_tolerance=1e-10,
    )
    found = []
    for part in PARTS:
        step = part * largest_step(Scene(scenario))
        begin = time.process_time()
        motion = run_to_rest(scenario, END, step=step, spacing=SPACING)
        seconds = time.process_time() - begin
        shown = motion.to_trajectory()
        found.append(
            ContactRun(
                stiffness=stiffness,
                half_thickness=half_thickness,
                step=step,
                seconds=seconds / END,
                law_error=_deviation(shown, ideal),
                step_error=_deviation(shown, same.to_trajectory()),
            )
        )
    return found


def _deviation(one: Trajectory, other: Trajectory) -> float:
    return float(np.max(np.abs(one.coordinates[:, 4:] - other.coordinates[:, 4:])))


def jobs() -> list[Job]:
    """Runs behind the table and the diagram."""
    return [Job(("rest contact", *contact), measure, contact) for contact in CONTACTS]


def collect(results: Mapping[Any, Any]) -> list[ContactRun]:
    """All runs, from the results of `jobs`."""
    return [run for contact in CONTACTS for run in results[("rest contact", *contact)]]


def table(results: Mapping[Any, Any]) -> Table:
    """One row per run."""
    return Table.of(
        collect(results),
        {
            "stiffness in N/m": lambda run: run.stiffness,
            "half thickness in mm": lambda run: 1e3 * run.half_thickness,
            "step in s": lambda run: run.step,
            "time per simulated second in s": lambda run: run.seconds,
            "deviation from the ideal contact in rad": lambda run: run.law_error,
            "of it by the step": lambda run: run.step_error,
        },
        name="rest-contact",
        title="Contact law and step on the way to rest",
        note=f"Engine, RK44, from Table 3 over {END:g} s, half of the critical damping. Ideal "
        "contact: in-house Model 1. The step's share: against the in-house equations on the same "
        "contact, DOP853.",
    )


def draw(results: Mapping[Any, Any]) -> Picture:
    """Deviation from the ideal contact over run time, one line per contact."""
    figure, axes = figures.new_figure()
    for index, (stiffness, thickness) in enumerate(CONTACTS):
        runs = results["rest contact", stiffness, thickness]
        seconds = [run.seconds for run in runs]
        look: dict[str, Any] = {
            "color": figures.COLOURS[index],
            "marker": figures.MARKERS[index],
        }
        name = f"{1e3 * thickness:g} mm, {stiffness / 1e6:g} N/µm"
        axes.loglog(seconds, [run.law_error for run in runs], label=name, **look)
        axes.loglog(seconds, [run.step_error for run in runs], linestyle=":", **look)
    axes.set(
        xlabel="processor time per simulated second in s",
        ylabel="deviation of β and γ in rad",
        ylim=(1e-11, 1e-2),
    )
    axes.xaxis.set_minor_formatter(NullFormatter())
    figures.legend_above(axes, columns=2)
    return figures.render(
        figure,
        name="rest-contact",
        title="What the compliant contact costs and what it is worth",
        caption="Half thickness of the rim and stiffness. Smaller steps to the right, the largest "
        "at 0.6 of the predicted stability limit. Full lines: deviation from Model 1 with its "
        "ideal contact. Dotted: the step's share. From this start the disk stays on the table and "
        "any of these steps is fine enough for its angles; the rim and the compliance make the "
        "deviation. Through impacts and for the damper's energy it is not, and a run takes a "
        "tolerance.",
    )
