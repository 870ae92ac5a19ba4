"""From Table 3 to rest: phases, energy budget and final stage, engine against in-house."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

import mbs_models
from analysis import (
    CAUSES,
    STEEL_DISK,
    Dissipation,
    PenaltyContact,
    Phases,
    SpatialMotion,
    consistent_start,
    find_phases,
    simulate_to_rest,
)
from mbs_models import Scene
from validation import figures, rest_final
from validation.figures import Picture
from validation.report import Job, Section
from validation.tables import Cell, Table

CASES = {
    "sliding friction only": Dissipation(),
    "dry rolling, pivoting": Dissipation(rolling_dry=1e-3, pivoting=5e-5),
    "viscous rolling, pivoting": Dissipation(rolling_viscous=1e-3, pivoting=5e-5),
}
SHOWN = "dry rolling, pivoting"

VARIANTS = ("as it is", "stiffness doubled", "rim half as thick", "spin 0.001 rad/s faster")

SPACING = 5e-3
_CAUSE_NAMES = {
    "damping": "contact's damper",
    "sliding": "sliding",
    "rolling_dry": "dry rolling",
    "rolling_viscous": "viscous rolling",
    "pivoting": "pivoting",
    "air_drag": "air",
}

_SHADES = (
    "#0072b2", "#56b4e9", "#000000", "#d55e00", "#e69f00", "#f0e442", "#cc79a7", "#009e73"
)  # fmt: skip
"""Okabe and Ito's palette: kinetic, potential, then the causes."""


def run_engine(case: str, end: float) -> SpatialMotion:
    """Run a case in the engine."""
    scene = Scene.rest(dissipation=CASES[case])
    return mbs_models.simulate_to_rest(scene, end, step=1e-4, spacing=SPACING)


def run_in_house(case: str, end: float, variant: str = VARIANTS[0]) -> SpatialMotion:
    """Run a case, or a variant of it, with the in-house equations."""
    stiffness = 2e6 if variant == VARIANTS[1] else 1e6
    half_thickness = 1e-4 if variant == VARIANTS[2] else 2e-4
    spin = 40.001 if variant == VARIANTS[3] else 40.0
    contact = PenaltyContact.rounded(
        STEEL_DISK, stiffness=stiffness, half_thickness=half_thickness
    )
    return simulate_to_rest(
        end,
        contact=contact,
        dissipation=CASES[case],
        start=contact.lowered(STEEL_DISK, consistent_start(1, STEEL_DISK, spin=spin)),
        spacing=SPACING,
    )


def jobs(quick: bool = False) -> list[Job]:
    """Runs behind the section; shorter ones if `quick`."""
    end = 28.0 if quick else 60.0
    result = rest_final.jobs()
    for case in CASES:
        result.append(Job(("rest", case, "engine"), run_engine, (case, end)))
        result.append(Job(("rest", case, "in-house"), run_in_house, (case, end)))
    result += [Job(("rest", SHOWN, v), run_in_house, (SHOWN, end, v)) for v in VARIANTS[1:]]
    return result


def section(results: dict[Any, Any]) -> Section:
    """Section of the report."""
    shown = results["rest", SHOWN, "engine"]
    return Section(
        name="rest",
        title="To rest",
        paragraphs=[
            (
                "The disk is a thin spheroid on a stiff, damped, unilateral contact, so that its "
                "lowest point is defined in every attitude. Sliding friction acts on the actual "
                "contact force. With sliding friction alone the disk does not come to lie flat: "
                "once it rolls, slip is so slow that the smoothed friction law is viscous, and "
                "what it takes vanishes with its smoothing speed. Lying flat needs rolling "
                "resistance, and lying still needs pivoting friction."
            )
        ],
        pictures=[*draw(shown), rest_final.draw(results)],
        tables=[
            phase_table(results),
            variant_table(results),
            budget(results),
            rest_final.table(results),
        ],
    )


def phase_table(results: dict[Any, Any]) -> Table:
    """When each phase began, by case and source, and how far the two sources agree."""
    rows: list[tuple[Cell, ...]] = []
    for case in CASES:
        pair = [results["rest", case, source] for source in ("engine", "in-house")]
        count = min(motion.times.size for motion in pair)
        difference = float(np.max(np.abs(pair[0].tilt[:count] - pair[1].tilt[:count])))
        for motion, shown in zip(pair, (None, difference), strict=True):
            times = _times(find_phases(motion))
            rows.append((case, motion.source, *times, _face(motion), shown))
    return Table(
        name="rest-phases",
        title="Phases on the way to rest",
        columns=("dissipation", "source", *_PHASE_COLUMNS, "face up", "largest difference in β"),
        rows=rows,
        note=f"Times in s, to {SPACING:g} s. The difference is that of engine and in-house run.",
    )


def variant_table(results: dict[Any, Any]) -> Table:
    """How phase times move with stiffness, rim and start."""
    rows = []
    for variant in VARIANTS:
        motion = results["rest", SHOWN, "in-house" if variant == VARIANTS[0] else variant]
        rows.append((variant, *_times(find_phases(motion)), _face(motion)))
    return Table(
        name="rest-variants",
        title=f"What the phases depend on ({SHOWN})",
        columns=("variant", *_PHASE_COLUMNS, "face up"),
        rows=rows,
        note="In-house runs, times in s.",
    )


_PHASE_COLUMNS = tuple(field.name.replace("_", " ") for field in fields(Phases))


def _times(phases: Phases) -> Sequence[float | None]:
    return [getattr(phases, field.name) for field in fields(Phases)]


def _face(motion: SpatialMotion) -> str:
    return "first" if motion.tilt[-1] < np.pi / 2 else "second"


def budget(results: dict[Any, Any]) -> Table:
    """Where each joule went."""
    rows = []
    for case in CASES:
        motion = results["rest", case, "engine"]
        start, left = motion.energies[0].sum(), motion.energies[-1].sum()
        taken = motion.dissipated[-1].tolist()
        rows.append(
            (
                case,
                float(start),
                *taken,
                float(left),
                float(np.max(np.abs(motion.energy_residual))),
            )
        )
    return Table(
        name="rest-budget",
        title="Where the energy went, in J",
        columns=("dissipation", "at first", *_CAUSE_NAMES.values(), "left", "unexplained"),
        rows=rows,
        note="Engine runs. Left is what a disk at rest has by its height, and what still moves.",
    )


def draw(motion: SpatialMotion) -> list[Picture]:
    """The whole story over time, and the path on the table."""
    figure, axes = figures.new_figure(5, height=11.0)
    draw_story(motion, axes)
    story = figures.render(
        figure,
        name="rest-story",
        title="From Table 3 to rest",
        caption=f"With {_described(motion.dissipation)}. Dotted: beginnings of the phases.",
    )
    figure, path_axes = figures.new_figure(height=5.0)
    draw_path(motion, path_axes)
    path = figures.render(
        figure,
        name="rest-path",
        title="Path of the contact point on the table",
        caption="From the circle to the square.",
    )
    return [story, path]


def draw_story(motion: SpatialMotion, axes: Any) -> Any:
    """Draw tilt, COG height, spin, energies and contact force into five axes; returns them."""
    times, colours = motion.times, figures.COLOURS
    axes[0].plot(times, np.degrees(motion.tilt), color=colours[0])
    axes[0].set(ylabel="tilt β in °", ylim=(0, 180))
    axes[1].plot(times, 1e3 * motion.cog_height, color=colours[0])
    axes[1].set(ylabel="COG height in mm", ylim=(0, None))
    axes[2].plot(times, motion.spin, color=colours[0])
    axes[2].set(ylabel="vertical spin in rad/s")
    labels = ["kinetic", "potential", *(_CAUSE_NAMES[c] for c in CAUSES)]
    parts = np.column_stack(
        (motion.energies[:, 0], motion.energies[:, 1:].sum(axis=1), motion.dissipated)
    )
    used = [i for i in range(len(labels)) if i < 2 or parts[-1, i] > 1e-6 * parts[0].sum()]
    axes[3].stackplot(
        times,
        parts[:, used].T,
        labels=[labels[i] for i in used],
        colors=[_SHADES[i] for i in used],
    )
    axes[3].set(ylabel="energy in J")
    axes[3].legend(ncols=4, loc="lower left", bbox_to_anchor=(0.0, 1.0), fontsize=8, frameon=False)
    axes[4].plot(times, motion.normal_force, color=colours[0], linewidth=0.5)
    axes[4].set(ylabel="contact force in N", xlabel="time in s", xlim=(times[0], times[-1]))
    phases = find_phases(motion)
    for index, field in enumerate(fields(phases)):
        begin = getattr(phases, field.name)
        if begin is not None:
            for panel in axes:
                panel.axvline(begin, color="#888888", linestyle=":", linewidth=1.0)
            name = field.name.replace("_", " ")
            # Staggered, for phases that follow each other closely.
            axes[0].text(begin, 178 - 55 * (index % 2), name, rotation=90, va="top", fontsize=7)
    return axes


def draw_path(motion: SpatialMotion, axes: Any) -> Any:
    """Draw the path of the contact point into axes; returns them."""
    x, y = 1e3 * motion.contact_points[:, :2].T
    axes.plot(x, y, color=figures.COLOURS[1], linewidth=0.5)
    axes.plot(x[0], y[0], "o", color=figures.COLOURS[0])
    axes.plot(x[-1], y[-1], "s", color=figures.COLOURS[2])
    axes.set(xlabel="x in mm", ylabel="y in mm", aspect="equal")
    return axes


def _described(dissipation: Dissipation) -> str:
    on = [name for name in CAUSES[2:] if getattr(dissipation, name)]
    return ", ".join(["sliding friction", *(_CAUSE_NAMES[name] for name in on)])
