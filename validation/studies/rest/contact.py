"""Error against run time of the compliant contact: its law, and the engine's step."""

import time
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import STEEL_DISK, PenaltyContact, Scenario, Trajectory
from mbs_models import Scene
from mbs_models.rest_run import largest_step
from validation.kit.figures import COLOURS, MARKERS, legend_above, new_figure
from validation.page.content import Content, Rows
from validation.run import run, run_to_rest
from validation.study import Row, Study, at_most, relative

END = 1.0
"""End in s, past the inversion; the error of the law grows no further until the fall."""

SPACING = 1e-2

CONTACTS = ((1e6, 8e-4), (1e6, 2e-4), (1e6, 5e-5), (1e5, 5e-5))
"""Stiffness in N/m and half thickness of the rim in m."""

PARTS = (0.6, 0.3, 0.15)
"""Steps as parts of the predicted stability limit, largest first."""

SHARE = 1e-2
"""Largest part of the deviation that the step makes, from the second of `PARTS` on."""

ORDER = 4
"""Of the integrator: half the step leaves at most this power of a half of its error."""


def cases() -> dict[str, tuple[float, float]]:
    """Contacts by name."""
    return {f"{1e3 * each[1]:g} mm, {each[0] / 1e6:g} N/µm": each for each in CONTACTS}


def measure(case: tuple[float, float]) -> list[Row]:
    """Run a contact with every step."""
    stiffness, half_thickness = case
    contact = PenaltyContact.rounded(
        STEEL_DISK, stiffness=stiffness, half_thickness=half_thickness
    )
    scenario = Scenario.rest(contact=contact)
    times = np.arange(round(END / SPACING) + 1) * SPACING
    ideal = run(Scenario(friction=scenario.friction), times, source="in-house", tolerance=1e-9)
    same = run_to_rest(
        scenario, END, source="in-house", spacing=SPACING, method="DOP853", local_tolerance=1e-10
    ).to_trajectory()
    found = []
    for index, part in enumerate(PARTS):
        row: Row = {"run": index, "stiffness": stiffness, "half_thickness": half_thickness}
        row["step"] = part * largest_step(Scene(scenario))
        begin = time.process_time()
        motion = run_to_rest(scenario, END, step=row["step"], spacing=SPACING)
        row["seconds"] = (time.process_time() - begin) / END
        shown = motion.to_trajectory()
        row |= {"law_error": _deviation(shown, ideal), "step_error": _deviation(shown, same)}
        found.append(row)
    return found


def _deviation(one: Trajectory, other: Trajectory) -> float:
    return float(np.max(np.abs(one.coordinates[:, 4:] - other.coordinates[:, 4:])))


STUDY = Study(
    name="rest-contact",
    cases=cases,
    measure=measure,
    keys=("run",),
    sample=tuple(cases())[-1:],
    confirm={
        "step": relative("step", 1e-6),
        "law_error": relative("law_error", 1e-3),
        "step_error": relative("step_error", 0.05, 1e-10),
    },
    timed=("seconds",),
    columns={
        "stiffness": "in N/m",
        "half_thickness": "of the rim in m",
        "step": "of the engine in s",
        "seconds": "processor time per simulated second in s",
        "law_error": "largest deviation of β and γ from Model 1 with its ideal contact in rad",
        "step_error": "the same from the in-house run on the same contact in rad",
    },
)
STUDIES = (STUDY,)


def present(rows: Rows) -> Content:
    """Table and diagram, and how the step's share falls."""
    table = rows[STUDY.name]
    checks = []
    for name in cases():
        runs = table[table["case"] == name].set_index("run").loc[list(range(len(PARTS)))]
        steps, share = runs["step_error"], runs["step_error"] / runs["law_error"]
        less = max(after / before for before, after in pairwise(steps))
        checks += [
            at_most(f"rest, contact of {name}: the step's share", share[1], SHARE, "stored"),
            at_most(f"rest, contact of {name}: left by half the step", less, 0.5**ORDER, "stored"),
        ]
    headings = {
        "stiffness": "stiffness in N/m",
        "half_thickness": "half thickness in m",
        "step": "step in s",
        "seconds": "time per simulated second in s",
        "law_error": "deviation from the ideal contact in rad",
        "step_error": "of it by the step",
    }
    finest = table[table["run"] == len(PARTS) - 1]["law_error"]
    return Content(
        numbers={"contact_errors": finest.tolist()},
        tables={"contact": table[list(headings)].rename(columns=headings)},
        figures={"contact": draw(table)},
        checks=checks,
    )


def draw(table: pd.DataFrame) -> Figure:
    """Deviation from the ideal contact over run time, one line per contact."""
    figure, axes = new_figure()
    for index, name in enumerate(cases()):
        runs = table[table["case"] == name]
        look: dict[str, Any] = {"color": COLOURS[index], "marker": MARKERS[index]}
        axes.loglog(runs["seconds"], runs["law_error"], label=name, **look)
        axes.loglog(runs["seconds"], runs["step_error"], linestyle=":", **look)
    axes.set(
        xlabel="processor time per simulated second in s (log)",
        ylabel="deviation of β and γ in rad (log)",
        ylim=(1e-11, 1e-2),
        xticks=(0.1, 0.2, 0.5, 1.0),
        xticklabels=("0.1", "0.2", "0.5", "1"),
    )
    axes.minorticks_off()
    legend_above(axes, columns=2)
    return figure
