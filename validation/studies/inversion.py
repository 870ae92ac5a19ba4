"""The inversion from Table 3: Figures 7 to 9, engine against in-house equations."""

from collections.abc import Iterator, Mapping, Sequence
from math import nan
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import LEVELS, MODELS, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.motion.inversion import DEFINITION  # noqa: F401 # the text states it
from analysis.motion.quantities import filled
from analysis.problem.checks import Array
from analysis.problem.choices import SOURCES, Source
from validation.comparison.differences import deviation
from validation.display.figures import (
    COLOURS,
    MARKERS,
    comparison,
    draw_still,
    legend_above,
    new_figure,
)
from validation.run import run
from validation.study import Content, Row, Rows, Study, at_most, grade

TITLE = "The inversion"

TOLERANCE = 1e-7
"""Tolerance of all runs in rad."""

END, SPACING = 4.0, 5e-3
"""Of the runs of Models 1 to 4 and of their samples in s."""

INSTANTS = (0.0, 0.2, 0.3, 0.38, 0.45, 0.55, 0.8)
"""Times in s at which the disk is drawn."""

PRINTED_SPIN, PRINTED_CHANGE, PRINTED_TIME = 35.0, 1e-2, 0.5
"""What the paper says in Section 5 of the spin after the inversion in rad/s, and in Section 4.1 of
what the load changes in rad and of the time in s within which gamma comes to pi / 2."""

CONTACT = "Model 1, load λ_N"
"""Case of Figure 7,"""

NAMES = [f"Model {level}" for level in LEVELS]
"""and those of Figures 8 and 9."""

CURVES = filled(Trajectory)


Runs = Mapping[tuple[str, Source], Trajectory]
"""By case and source."""


def cases() -> dict[str, tuple[Scenario, float]]:
    """Models 1 to 4, and Model 1 with the contact force as the friction's load; with ends in s."""
    models = [(Scenario(constraints=MODELS[level]), END) for level in LEVELS]
    contact = Scenario(friction=SmoothCoulomb(load="contact"))
    return {CONTACT: (contact, 2.0), **dict(zip(NAMES, models, strict=True))}


def measure(case: tuple[Scenario, float]) -> Iterator[Row]:
    """The runs of both sides."""
    scenario, end = case
    times = np.linspace(0.0, end, round(end / SPACING) + 1)
    runs = [run(scenario, times, source=source, tolerance=TOLERANCE) for source in SOURCES]
    # Of all digits, before most are left out.
    apart = agreement(*runs)
    for found in runs:
        yield {
            "source": found.source,
            "formulation": found.method["formulation"],
            "error_estimate": found.error_estimate,
            **apart,
            **{name: getattr(found, name) for name in CURVES},
        }


STUDY = Study(name="inversion", cases=cases, measure=measure)
STUDIES = (STUDY,)


def motions(table: pd.DataFrame) -> Runs:
    """The runs by case and source."""
    found = {}
    for row in table.to_dict("records"):
        curves: Any = {name: np.array(row[name]) for name in CURVES}
        found[row["case"], row["source"]] = Trajectory(
            scenario=cases()[row["case"]][0],
            source=row["source"],
            method={"formulation": row["formulation"], "tolerance": TOLERANCE},
            error_estimate=row["error_estimate"],
            **curves,
        )
    return found


# --- What is shown ------------------------------------------------------------------------------

ANGLES = "β and γ apart in rad"
LIMITS = {
    ANGLES: 2 * TOLERANCE,
    "spin apart in rad/s": 1e-6 * Start().spin,
    "normal force apart in N": 1e-6 * Scenario().weight,
    "inversions apart in s": 1e-6,
    "engine's error estimate in rad": TOLERANCE,
    "in-house error estimate in rad": TOLERANCE,
}
"""What both sides may differ by, and what they promise, by column of the table."""


def present(rows: Rows) -> Content:
    """Figures 7 to 9, the disk at some instants, and how far both sides agree."""
    runs = motions(rows[STUDY.name])
    engine, shown = rows[STUDY.name].query("source == 'engine'"), runs[NAMES[0], "engine"]
    apart = engine[["case", "formulation", "inverted after s", *LIMITS]]
    apart = apart.rename(columns={"case": "model"})
    times = [time for name in NAMES if (time := runs[name, "engine"].inversion_time)]
    listed = ", ".join(f"{time:.2f}" for time in times) or "–"
    caption = "Table 3's start. Drag to turn the view."
    return Content(
        numbers={
            "times": listed,
            "inverted": len(times),
            "answer": grade(yes=len(times) == len(NAMES), partly=bool(times)),
        },
        tables={"agreement": apart},
        figures={
            "snapshots": lambda: draw_instants(shown, INSTANTS),
            "load": lambda: draw_load(runs),
            "models": lambda: draw_models(runs),
        },
        animations={"animation": lambda: shown.animate(end=2.0, title=TITLE, caption=caption)},
        checks=[
            at_most(f"inversion, {row['model']}: {name}", row[name], limit)
            for row in apart.to_dict("records")
            for name, limit in LIMITS.items()
        ],
    )


def agreement(one: Trajectory, other: Trajectory) -> Row:
    """How far a run of the engine and one of the in-house equations are apart."""
    times = one.inversion_time or nan, other.inversion_time or nan
    found = (
        deviation(one, other),
        np.max(np.abs(one.spin - other.spin)),
        np.max(np.abs(one.normal_force - other.normal_force)),
        abs(times[0] - times[1]),
        *(one.error_estimate, other.error_estimate),
    )
    return {"inverted after s": times[0], **dict(zip(LIMITS, found, strict=True))}


def changes_by_load(runs: Runs) -> Array:
    """Coordinates of Model 1 under the weight less those under the contact force, shape (n, 6)."""
    weight, contact = (runs[name, "engine"].coordinates for name in (NAMES[0], CONTACT))
    return weight[: len(contact)] - contact


# --- Figures ------------------------------------------------------------------------------------


def draw_instants(trajectory: Trajectory, instants: Sequence[float]) -> Figure:
    """The disk at the samples nearest to some times in s."""
    figure, axes = new_figure(columns=len(instants), width=9.0, height=1.8, share=False)
    for time, each in zip(instants, axes, strict=True):
        index = int(np.argmin(np.abs(trajectory.times - time)))
        draw_still(each, trajectory.scenario.disk, trajectory.coordinates[index], 0.7)
        each.set_title(f"{trajectory.times[index]:.2f} s", fontsize=10)
    return figure


def draw(runs: Runs, names: Sequence[str], panels: int = 4) -> tuple[Figure, Any]:
    """Runs of the engine as lines, and those of the other side as sparse markers."""
    figure, axes = new_figure(panels, height=1.5 + 2.0 * panels)
    comparison([(name, runs[name, "engine"]) for name in names], axes[:4])
    comparison([("", runs[name, "in-house"]) for name in names], axes[:4])
    for each in axes[:4]:
        for index, line in enumerate(each.lines[len(names) :]):
            look: Any = {"marker": MARKERS[index], "markerfacecolor": "white", "markersize": 5}
            # Shifted, not to hide each other.
            line.set(linestyle="", markevery=(8 * index, 33), **look)
    legend_above(axes[0])
    return figure, axes


def draw_load(runs: Runs) -> Figure:
    """Figure 7: Model 1 under either load of the friction law, and what that changes."""
    figure, axes = draw(runs, (NAMES[0], CONTACT), panels=5)
    label = f"paper: γ at π/2 by {PRINTED_TIME} s"
    printed = axes[1].axvline(PRINTED_TIME, color="#888888", linestyle=":", label=label)
    axes[1].legend(handles=[printed], frameon=False, loc="lower right")
    times = runs[CONTACT, "engine"].times
    for name, change, style in zip("βγ", changes_by_load(runs)[:, 4:].T, ("-", "--"), strict=True):
        axes[4].plot(times, change, style, color=COLOURS[2], label=name)
    axes[4].legend(frameon=False, loc="lower right", ncols=2)
    axes[3].set(xlabel="")
    axes[4].set(xlim=(0.0, times[-1]), xlabel="time in s")
    axes[4].set_ylabel("change by the load in rad,\nm g less λ_N")
    return figure


def draw_models(runs: Runs) -> Figure:
    """Figures 8 and 9: all models."""
    figure, axes = draw(runs, NAMES)
    label = f"paper, after the inversion: about {PRINTED_SPIN:g}"
    printed = axes[2].axhline(PRINTED_SPIN, color="#888888", linestyle=":", label=label)
    axes[2].legend(handles=[printed], frameon=False, loc="upper right")
    return figure
