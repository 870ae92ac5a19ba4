"""The inversion from Table 3: Figures 7 to 9, engine against in-house equations."""

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from analysis import LEVELS, MODELS, Level, Load, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.checks import Array
from analysis.data.inversion import DEFINITION
from analysis.data.trajectory import SOURCES, Source
from validation.kit import snapshots
from validation.kit.animation.player import player
from validation.kit.figures import COLOURS, MARKERS, STYLES, angle_axis, legend_above, new_figure
from validation.page.content import Content, Rows, Verdict
from validation.run import run
from validation.study import Check, Row, Study, at_most

TITLE = "The inversion"

TOLERANCE = 1e-7
"""Tolerance of all runs in rad."""

SPACING = 5e-3
"""Of their samples in s."""

SHORT = 2.0
"""End in s of Figure 7."""

PART = 1e-6
"""Of the spin and of the weight, to which both sides' rates and forces have to agree."""

INSTANTS = (0.0, 0.2, 0.3, 0.38, 0.45, 0.55, 0.8)
"""Times in s at which the disk is drawn."""

PRINTED_SPIN, PRINTED_CHANGE, PRINTED_TIME = 35.0, 1e-2, 0.5
"""What the paper says in Section 5 of the spin after the inversion in rad/s, and in Section 4.1 of
what the load changes in rad and of the time in s within which gamma comes to pi / 2."""

Runs = Mapping[tuple[str, Source], Trajectory]
"""By case and source."""

Case = tuple[Level, Load, float]
"""Model, load of the friction law, and end in s."""

CONTACT = "Model 1, load λ_N"


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
        found.append(
            {
                "source": source,
                "level": level,
                "load": load,
                "formulation": made.method.get("formulation") or made.method["form"],
                "inversion_time": made.inversion_time,
                "error_estimate": made.error_estimate,
                "times": made.times,
                "coordinates": made.coordinates,
                "rates": made.rates,
                "multipliers": made.multipliers,
                "normal_force": made.normal_force,
            }
        )
    return found


STUDY = Study(
    name="inversion",
    cases=cases,
    measure=measure,
    keys=("source",),
    columns={
        "inversion_time": "when the disk is inverted in s",
        "error_estimate": "of β and γ in rad",
        "times": "of the samples in s",
        "coordinates": "x̄, ȳ, z in m, α, β, γ in rad by time",
        "multipliers": "constraint forces by time in N and N m",
        "normal_force": "in N",
    },
)
STUDIES = (STUDY,)


def motions(table: pd.DataFrame, until: float = np.inf) -> Runs:
    """The runs by case and source, up to a time in s."""
    return {(row["case"], row["source"]): _motion(row, until) for row in table.to_dict("records")}


def _motion(row: Mapping[Hashable, Any], until: float) -> Trajectory:
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


def present(rows: Rows) -> Content:
    """Figures 7 to 9, the disk at some instants, and how far both sides agree."""
    table = rows[STUDY.name]
    whole, short = motions(table), motions(table, SHORT)
    models = [case for case in cases() if case != CONTACT]
    apart = agreement(whole)
    contact, weight = short[CONTACT, "engine"], short["Model 1", "engine"]
    gamma = contact.coordinate("gamma")
    times = [whole[case, "engine"].inversion_time for case in models]
    numbers = {
        "definition": DEFINITION,
        "times": times,
        "short": np.pi / 2 - gamma[round(PRINTED_TIME / SPACING)],
        "beyond": np.max(gamma) - np.pi / 2,
        "force": np.max(np.abs(contact.normal_force / contact.scenario.weight - 1.0)),
        "change": np.max(np.abs(weight.coordinates - contact.coordinates)[:, 4:]),
        "spins": [whole[case, "engine"].rate("alpha")[-1] for case in models[:3]],
        "tolerance": TOLERANCE,
    }
    return Content(
        numbers=numbers,
        tables={"agreement": apart},
        figures={
            "snapshots": snapshots.strip(weight, INSTANTS),
            "load": draw_load(short),
            "models": draw_angles(short, models),
            "spin": draw_spin(whole, models),
        },
        animations={
            "animation": player(
                weight,
                name="inversion-animation",
                title="The inversion",
                caption="Table 3's start. Drag to turn the view.",
            )
        },
        checks=checks(apart),
        verdicts=[verdict(times, apart)],
    )


def verdict(times: list[float | None], apart: pd.DataFrame) -> Verdict:
    """Whether all models turn over, from their times in s."""
    inverted = [f"{time:.2f}" for time in times if time is not None]
    return Verdict(
        statement="The disk turns itself upside down.",
        answer="yes" if len(inverted) == len(LEVELS) else "partly" if inverted else "no",
        numbers=f"From Table 3, at {Start().spin:g} rad/s, {len(inverted)} of the "
        f"{len(times)} models are inverted, after {', '.join(inverted) or '–'} s; engine and "
        f"in-house equations stay within {apart[ANGLES].max():.0e} rad of each other.",
        criterion=DEFINITION,
        good=len(inverted) == len(LEVELS),
    )


ANGLES = "β and γ apart in rad"
INVERTED = "inverted after s"
LIMITS = {
    ANGLES: 2 * TOLERANCE,
    "apart in s": PART,
    "spin apart in rad/s": PART * Start().spin,
    "normal force apart in N": PART * Scenario().weight,
    "engine's error estimate in rad": TOLERANCE,
    "in-house error estimate in rad": TOLERANCE,
}
"""What both sides may differ by, and what they promise, by column of the table."""


def agreement(runs: Runs) -> pd.DataFrame:
    """How far engine and in-house equations are apart in each case."""
    found = []
    for case in cases():
        engine, other = _both(runs, case)
        times = [np.nan if run.inversion_time is None else run.inversion_time
                 for run in (engine, other)]  # fmt: skip
        values = (
            _apart(engine.coordinates[:, 4:], other.coordinates[:, 4:]),
            abs(times[0] - times[1]),
            _apart(engine.rate("alpha"), other.rate("alpha")),
            _apart(engine.normal_force, other.normal_force),
            engine.error_estimate,
            other.error_estimate,
        )
        found.append(
            {"model": case, "formulation": engine.method["formulation"], INVERTED: times[0]}
            | dict(zip(LIMITS, values, strict=True))
        )
    return pd.DataFrame(found)


def _apart(one: Array, other: Array) -> float:
    return float(np.max(np.abs(one - other)))


def checks(apart: pd.DataFrame) -> list[Check]:
    """Each number of the table against its limit."""
    return [
        at_most(f"inversion, {row['model']}: {name}", row[name], limit)
        for row in apart.to_dict("records")
        for name, limit in LIMITS.items()
    ]


# --- Figures ------------------------------------------------------------------------------------

_EVERY = 33
"""Every so many samples an in-house marker is drawn."""


def _both(runs: Runs, case: str) -> list[Trajectory]:
    return [runs[case, source] for source in SOURCES]


def _draw(axes: Any, pair: list[Trajectory], index: int, values: Any, label: str) -> None:
    """Draw a quantity of the engine's run as a line and of the in-house one as sparse markers."""
    engine, other = pair
    colour = COLOURS[index]
    axes.plot(engine.times, values(engine), color=colour, linestyle=STYLES[index], label=label)
    # Markers of different curves are shifted, so that they do not hide each other.
    axes.plot(
        other.times,
        values(other),
        linestyle="none",
        marker=MARKERS[index],
        markersize=5,
        markerfacecolor="white",
        markeredgecolor=colour,
        markevery=(index * _EVERY // 4, _EVERY),
    )


def draw_load(runs: Runs) -> Figure:
    """Figure 7: angles and normal force of Model 1, and what the load of the friction changes."""
    figure, axes = new_figure(3, height=7.5)
    both, other = _both(runs, CONTACT), runs["Model 1", "engine"]
    contact = both[0]
    for index, (name, symbol) in enumerate((("beta", "β"), ("gamma", "γ"))):
        _draw(axes[0], both, index, lambda run, n=name: run.coordinate(n), symbol)
        change = other.coordinate(name) - contact.coordinate(name)
        axes[2].plot(
            other.times, change, color=COLOURS[index], linestyle=STYLES[index], label=f"Δ{symbol}"
        )
    angle_axis(axes[0])
    axes[0].axvline(
        PRINTED_TIME, color="#888888", linestyle=":", label=f"paper: γ at π/2 by {PRINTED_TIME} s"
    )
    axes[0].set(ylabel="angle in rad")
    weight = contact.scenario.weight
    _draw(axes[1], both, 0, lambda run: run.normal_force / weight, "$λ_N / (m g)$")
    axes[1].axhline(1.0, color="#888888", linewidth=0.8)
    axes[1].set(ylabel="normal force\nover weight")
    for sign in (1.0, -1.0):
        axes[2].axhline(
            sign * PRINTED_CHANGE,
            color="#888888",
            linestyle=":",
            label="paper: some 10⁻² rad" if sign > 0.0 else None,
        )
    axes[2].set(xlabel="time in s", ylabel="load $m g$ less\nload $λ_N$, in rad")
    for each in axes:
        legend_above(each, columns=3)
    return figure


def draw_angles(runs: Runs, models: list[str]) -> Figure:
    """Figure 8: beta and gamma of all models."""
    figure, axes = new_figure(2, height=6.0)
    for each, name, symbol in zip(axes, ("beta", "gamma"), "βγ", strict=True):
        for index, case in enumerate(models):
            _draw(each, _both(runs, case), index, lambda run, n=name: run.coordinate(n), case)
        each.axhline(np.pi / 2, color="#888888", linewidth=0.8, zorder=0)
        each.set(ylabel=f"{symbol} in rad")
    angle_axis(axes[1])
    legend_above(axes[0])
    axes[1].set(xlabel="time in s")
    return figure


def draw_spin(runs: Runs, models: list[str]) -> Figure:
    """Figure 9: spinning velocity of all models."""
    figure, axes = new_figure()
    for index, case in enumerate(models):
        _draw(axes, _both(runs, case), index, lambda run: run.rate("alpha"), case)
    axes.axhline(PRINTED_SPIN, color="#888888", linestyle=":", label="paper, after it: about 35")
    axes.set(xlabel="time in s", ylabel="spinning velocity $\\dotα$ in rad/s")
    legend_above(axes, columns=3)
    return figure
