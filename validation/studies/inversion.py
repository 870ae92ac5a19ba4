"""The inversion from Table 3: Figures 7 to 9, engine against in-house equations."""

from collections.abc import Callable, Mapping, Sequence
from math import nan
from operator import methodcaller
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import LEVELS, MODELS, Level, Load, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.checks import Array
from analysis.data.inversion import DEFINITION
from analysis.data.trajectory import SOURCES, Source
from validation.kit.animation import picture
from validation.kit.animation.keyframes import keyframes
from validation.kit.animation.player import player
from validation.kit.figures import COLOURS, MARKERS, STYLES, angle_axis, legend_above, new_figure
from validation.page.content import Content, Rows, Verdict
from validation.page.section import power
from validation.run import run
from validation.study import Row, Study, at_most

TITLE = "The inversion"

TOLERANCE = 1e-7
"""Tolerance of all runs in rad."""

SPACING = 5e-3
"""Of their samples in s."""

SHORT = 2.0
"""End in s of Figure 7."""

INSTANTS = (0.0, 0.2, 0.3, 0.38, 0.45, 0.55, 0.8)
"""Times in s at which the disk is drawn."""

PRINTED_SPIN, PRINTED_CHANGE, PRINTED_TIME = 35.0, 1e-2, 0.5
"""What the paper says in Section 5 of the spin after the inversion in rad/s, and in Section 4.1 of
what the load changes in rad and of the time in s within which gamma comes to pi / 2."""

CONTACT = "Model 1, load λ_N"

Case = tuple[Level, Load, float]
"""Model, load of the friction law, and end in s."""

Runs = Mapping[tuple[str, Source], Trajectory]
"""By case and source."""


def cases() -> dict[str, Case]:
    """Models 1 to 4, and Model 1 with the contact force as the load of the friction law."""
    found: dict[str, Case] = {f"Model {level}": (level, "weight", 4.0) for level in LEVELS}
    return {CONTACT: (1, "contact", SHORT), **found}


def scenario_of(level: Level, load: Load) -> Scenario:
    """What is run: from Table 3."""
    return Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))


def measure(case: Case) -> list[Row]:
    """The runs of both sides."""
    level, load, end = case
    times = np.linspace(0.0, end, round(end / SPACING) + 1)
    found = []
    for source in SOURCES:
        made = run(scenario_of(level, load), times, source=source, tolerance=TOLERANCE)
        way = made.method.get("formulation") or made.method["form"]
        found.append({"source": source, "level": level, "load": load, "formulation": way})
        names = ("error_estimate", "times", "coordinates", "rates", "multipliers")
        found[-1] |= {name: getattr(made, name) for name in names}
    return found


STUDY = Study(
    name="inversion",
    cases=cases,
    measure=measure,
    keys=("source",),
    columns={
        "error_estimate": "of β and γ in rad",
        "times": "of the samples in s",
        "coordinates": "x̄, ȳ, z in m, α, β, γ in rad by time",
        "multipliers": "constraint forces by time in N and N m",
    },
)
STUDIES = (STUDY,)


def motions(table: pd.DataFrame, until: float = np.inf) -> Runs:
    """The runs by case and source, up to a time in s."""
    return {(row["case"], row["source"]): _motion(row, until) for row in table.to_dict("records")}


def _motion(row: Mapping[Any, Any], until: float) -> Trajectory:
    shown = np.array(row["times"]) <= until
    return Trajectory(
        scenario=scenario_of(row["level"], row["load"]),
        source=row["source"],
        method={"formulation": row["formulation"], "tolerance": TOLERANCE},
        error_estimate=row["error_estimate"],
        times=np.array(row["times"])[shown],
        coordinates=np.array(row["coordinates"])[shown],
        rates=np.array(row["rates"])[shown],
        multipliers=np.array(row["multipliers"])[shown],
    )


# --- What is shown ------------------------------------------------------------------------------

INVERTED, ANGLES = "inverted after s", "β and γ apart in rad"
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
    whole, short = (motions(rows[STUDY.name], until) for until in (np.inf, SHORT))
    models = [case for case in cases() if case != CONTACT]
    apart = agreement(whole)
    contact, weight = short[CONTACT, "engine"], short["Model 1", "engine"]
    gamma = contact.coordinate("gamma")
    times = [time for case in models if (time := whole[case, "engine"].inversion_time)]
    told = ", ".join(f"{time:.2f}" for time in times) or "–"
    return Content(
        numbers={
            "times": told,
            "short": np.pi / 2 - gamma[round(PRINTED_TIME / SPACING)],
            "beyond": np.max(gamma) - np.pi / 2,
            "force": np.max(np.abs(contact.normal_force / contact.scenario.weight - 1.0)),
            "change": np.max(np.abs(weight.coordinates - contact.coordinates)[:, 4:]),
            "spins": [whole[case, "engine"].rate("alpha")[-1] for case in models[:3]],
        },
        tables={"agreement": apart},
        figures={
            "snapshots": draw_instants(weight, INSTANTS),
            "load": draw_load(short),
            "models": draw_models(whole, models),
        },
        animations={
            "animation": player(
                weight,
                name="inversion-animation",
                title="The inversion",
                caption="Table 3's start. Drag to turn the view.",
            )
        },
        checks=[
            at_most(f"inversion, {row['model']}: {name}", row[name], limit)
            for row in apart.to_dict("records")
            for name, limit in LIMITS.items()
        ],
        verdicts=[
            Verdict(
                statement="The disk turns itself upside down.",
                answer="yes" if len(times) == len(models) else "partly" if times else "no",
                numbers=f"From Table 3, at {Start().spin:g} rad/s, {len(times)} of {len(models)} "
                f"models are inverted, after {told} s; engine and in-house equations stay "
                f"within {power(apart[ANGLES].max())} rad of each other.",
                criterion=DEFINITION,
                good=len(times) == len(models),
            )
        ],
    )


def agreement(runs: Runs) -> pd.DataFrame:
    """How far engine and in-house equations are apart in each case."""
    found = []
    for case in cases():
        one, other = (runs[case, source] for source in SOURCES)
        pairs = (
            (one.coordinates[:, 4:], other.coordinates[:, 4:]),
            (one.rate("alpha"), other.rate("alpha")),
            (one.normal_force, other.normal_force),
            (one.inversion_time or nan, other.inversion_time or nan),
        )
        values = [*(np.max(np.abs(np.subtract(*pair))) for pair in pairs),
                  one.error_estimate, other.error_estimate]  # fmt: skip
        told = {"model": case, "formulation": one.method["formulation"]}
        told |= {INVERTED: one.inversion_time}
        found.append(told | dict(zip(LIMITS, values, strict=True)))
    return pd.DataFrame(found)


# --- Figures ------------------------------------------------------------------------------------


def draw_instants(trajectory: Trajectory, instants: Sequence[float]) -> Figure:
    """The disk at the samples nearest to some times in s, above the angle gamma over time."""
    figure, _ = new_figure(width=9.0, height=4.0)
    figure.clear()
    upper, lower = figure.subfigures(2, 1, height_ratios=(0.8, 1.0), squeeze=False)[:, 0]
    poses, radius = keyframes(trajectory), trajectory.scenario.disk.radius
    indices = [int(np.argmin(np.abs(trajectory.times - time))) for time in instants]
    for index, axes in zip(indices, upper.subplots(1, len(indices)), strict=True):
        pose = poses.at(trajectory.times[[index]])
        # From a quarter to the side, so that the disk shows its face whatever its spin.
        azimuth = trajectory.coordinate("alpha")[index] - np.pi / 2 + 0.35
        middle = np.append(pose.positions[0, :2], 0.75 * radius)
        picture.draw(axes, pose, picture.Camera(middle, azimuth, radius, 0.7))
        axes.set_title(f"{trajectory.times[index]:.2f} s", fontsize=10)
    axes, until = lower.subplots(), max(indices) + 1
    times, gamma = trajectory.times[:until], trajectory.coordinate("gamma")[:until]
    axes.plot(times, gamma, color=COLOURS[1])
    axes.plot(times[indices], gamma[indices], "o", color=COLOURS[0])
    marks = ("below", -np.pi / 2, "right", -1), ("above", np.pi / 2, "left", 0)
    for words, height, side, at in marks:
        axes.axhline(height, color="#999999", linewidth=0.8)
        place = (times[at], height)
        axes.annotate(f"COG {words} the centre", place, ha=side, va="bottom", fontsize=9)
    angle_axis(axes)
    axes.set(xlabel="time in s", ylabel="γ in rad")
    return figure


def _draw(
    axes: Any, runs: Runs, curves: Mapping[str, str], values: Callable[[Trajectory], Array]
) -> None:
    """Draw a quantity of the engine's runs as lines and of the in-house ones as sparse markers.

    `curves` are cases by label; markers of different ones are shifted, not to hide each other.
    """
    start = len(axes.lines) // 2
    for index, (label, case) in enumerate(curves.items(), start):
        one, other = (runs[case, source] for source in SOURCES)
        colour, every = COLOURS[index], (8 * index, 33)
        axes.plot(one.times, values(one), color=colour, linestyle=STYLES[index], label=label)
        look: Any = {"linestyle": "", "markerfacecolor": "white", "markersize": 5}
        look |= {"marker": MARKERS[index], "markeredgecolor": colour, "markevery": every}
        axes.plot(other.times, values(other), **look)


def _printed(axes: Any, values: Sequence[float], label: str) -> None:
    for value in values:
        axes.axhline(value, color="#888888", linestyle=":", label=label)
        label = ""


def draw_load(runs: Runs) -> Figure:
    """Figure 7: angles and normal force of Model 1, and what the load of the friction changes."""
    figure, axes = new_figure(3, height=7.5)
    contact, other = runs[CONTACT, "engine"], runs["Model 1", "engine"]
    for index, (name, symbol) in enumerate((("beta", "β"), ("gamma", "γ"))):
        _draw(axes[0], runs, {symbol: CONTACT}, methodcaller("coordinate", name))
        change = other.coordinate(name) - contact.coordinate(name)
        look = {"color": COLOURS[index], "linestyle": STYLES[index], "label": f"Δ{symbol}"}
        axes[2].plot(other.times, change, **look)
    angle_axis(axes[0])
    axes[0].axvline(PRINTED_TIME, color="#888888", linestyle=":",
                    label=f"paper: γ at π/2 by {PRINTED_TIME} s")  # fmt: skip
    axes[0].set(ylabel="angle in rad")
    weight = contact.scenario.weight
    label = "$λ_N / (m g)$"
    _draw(axes[1], runs, {label: CONTACT}, lambda run: run.normal_force / weight)
    axes[1].set(ylabel="normal force\nover weight")
    _printed(axes[2], (PRINTED_CHANGE, -PRINTED_CHANGE), "paper: some 10⁻² rad")
    axes[2].set(xlabel="time in s", ylabel="load $m g$ less\nload $λ_N$, in rad")
    for each in axes:
        legend_above(each, columns=3)
    return figure


def draw_models(runs: Runs, models: Sequence[str]) -> Figure:
    """Figures 8 and 9: beta, gamma and spinning velocity of all models."""
    figure, axes = new_figure(3, height=8.5)
    named = {case: case for case in models}
    for each, name, symbol in zip(axes, ("beta", "gamma"), "βγ", strict=False):
        _draw(each, runs, named, methodcaller("coordinate", name))
        each.axhline(np.pi / 2, color="#888888", linewidth=0.8, zorder=0)
        each.set(ylabel=f"{symbol} in rad")
    angle_axis(axes[1])
    _draw(axes[2], runs, named, methodcaller("rate", "alpha"))
    legend_above(axes[0])
    _printed(axes[2], (PRINTED_SPIN,), f"paper, after the inversion: about {PRINTED_SPIN:g}")
    axes[2].legend(handles=axes[2].lines[-1:], frameon=False, loc="upper right")
    axes[2].set(xlabel="time in s", ylabel="spinning velocity\n$\\dotα$ in rad/s")
    return figure
