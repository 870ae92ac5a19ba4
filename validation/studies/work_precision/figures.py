"""Diagrams of error against run time and against work."""

from math import inf
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validation.studies.work_precision.measuring import GOALS, USEFUL
from validation.studies.work_precision.problems import TITLES
from validation.studies.work_precision.tables import CURVE, NAMES

LOOKS = {
    "contact-tree": ("#000000", "o"),
    "euler-tree": ("#0072b2", "s"),
    "floating": ("#d55e00", "^"),
    "floating-lie": ("#cc79a7", "v"),
    "index-1": ("#009e73", "D"),
    "reduced": ("#8a8a8a", "P"),
}
"""Colour and marker of each formulation; they differ in grey, too."""

_LOWEST, _HIGHEST = 3e-12, 1.0
_LEAST_ENERGY = 1e-16


def fronts(runs: pd.DataFrame, floors: dict[str, float]) -> Figure:
    """What each formulation can do with the best of its integrators, one panel per problem."""
    figure, panels, spare = _panels(floors, "processor time in ms")
    for (problem, formulation), group in runs.groupby(["problem", "formulation"], sort=False):
        _line(panels[problem], front(group), "milliseconds", floors[problem])
        if problem == "undamped":
            kept = group[group["error"] < _HIGHEST]
            kept = kept.assign(energy_error=kept["energy_error"].clip(_LEAST_ENERGY))
            points = front(kept, "energy_error", inf)
            colour, marker = LOOKS[formulation]
            look: Any = {"color": colour, "marker": marker, "markersize": 4.5}
            spare.plot(points["milliseconds"], points["energy_error"], **look)
    spare.set_title("Undamped: error in the energy", fontsize=10, loc="left")
    spare.set(
        xscale="log", yscale="log", xlabel="processor time in ms", ylabel="energy error in J"
    )
    _legend(figure, LOOKS)
    return figure


def front(runs: pd.DataFrame, error: str = "error", worst: float = USEFUL) -> pd.DataFrame:
    """Runs that no other beats in both time and error, the fastest first."""
    ranked = runs[(runs["kind"] != "tolerance") & ~runs["failed"]]
    ranked = ranked.sort_values(["seconds", error])
    best = ranked[error].cummin().shift(fill_value=inf).clip(upper=worst)
    return ranked[ranked[error] < best]


def orders(runs: pd.DataFrame, floors: dict[str, float]) -> Figure:
    """Single methods against their work, one panel per problem."""
    figure, panels, spare = _panels(floors, "evaluations")
    spare.set_axis_off()
    useful = runs[(runs["error"] < _HIGHEST) & (runs["formulation"] != "reduced")]
    for key, group in useful.groupby([*CURVE, "kind"], sort=False):
        (problem, formulation, scheme, kind) = key
        explicit = formulation == "contact-tree"
        shown = {"RK44", "RK67", "DOPRI5"} if explicit else {"trapezoidal", "DOP853", "Radau"}
        if scheme not in shown or kind == "tolerance" or (explicit and kind == "extrapolated"):
            continue
        _line(panels[problem], group, "work", floors[problem], dashed=kind == "extrapolated")
    _legend(figure, {name: look for name, look in LOOKS.items() if name != "reduced"})
    return figure


def _panels(floors: dict[str, float], xlabel: str) -> tuple[Figure, dict[str, Axes], Axes]:
    """A panel for each problem, three in a row, with its goals and what cannot be measured."""
    figure = Figure(figsize=(10.5, 10.4), layout="constrained")
    *axes, spare = figure.subplots(3, 3).flat
    for panel, (problem, title) in zip(axes, TITLES.items(), strict=True):
        panel.set_title(title, fontsize=10, loc="left")
        panel.set(xscale="log", yscale="log", ylim=(_LOWEST, _HIGHEST))
        panel.set(xlabel=xlabel, ylabel="largest error in rad")
        panel.margins(x=0.12)
        panel.set_yticks([10.0**-digits for digits in range(0, 12, 3)])
        panel.axhspan(_LOWEST, floors[problem], color="#e6e6e6", zorder=0)
        for goal in GOALS:
            panel.axhline(goal, color="#777777", linewidth=0.8, linestyle=":")
    for panel in (*axes, spare):
        panel.spines[["right", "top"]].set_visible(False)
        panel.grid(alpha=0.3)
    return figure, dict(zip(TITLES, axes, strict=True)), spare


def _line(
    axes: Axes, runs: pd.DataFrame, cost: str, floor: float, *, dashed: bool = False
) -> None:
    """Draw runs up to the first that is too good to be measured, that one on the edge."""
    if runs.empty:
        return
    colour, marker = LOOKS[runs["formulation"].iloc[0]]
    told = runs[(runs["error"] > floor).shift(fill_value=True).cummin()]
    axes.plot(
        told[cost],
        told["error"].clip(lower=floor),
        color=colour,
        marker=marker,
        markersize=4.5,
        markerfacecolor="white" if dashed else colour,
        linestyle="--" if dashed else "-",
        linewidth=1.2,
    )


def _legend(figure: Figure, looks: dict[str, tuple[str, str]]) -> None:
    handles = [
        Line2D([], [], color=colour, marker=marker, markersize=5, label=NAMES[name])
        for name, (colour, marker) in looks.items()
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
