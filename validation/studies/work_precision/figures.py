"""Diagram of error against run time."""

from math import inf

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.studies.work_precision.measuring import GOALS, USEFUL
from validation.studies.work_precision.problems import TITLES
from validation.studies.work_precision.tables import NAMES

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


def fronts(runs: pd.DataFrame, floors: dict[str, float]) -> Figure:
    """What each formulation can do with the best of its integrators, one panel per problem."""
    figure = Figure(figsize=(10.5, 10.4), layout="constrained")
    *panels, spare = figure.subplots(3, 3).flat
    for panel, (problem, title) in zip(panels, TITLES.items(), strict=True):
        found = runs[runs["problem"] == problem]
        for formulation, group in found.groupby("formulation", sort=False):
            _line(panel, front(group), LOOKS[formulation], floors[problem])
        panel.set_title(title, fontsize=10, loc="left")
        panel.set(xscale="log", yscale="log", ylim=(_LOWEST, _HIGHEST))
        panel.set(xlabel="processor time in ms", ylabel="largest error")
        panel.margins(x=0.12)
        panel.set_yticks([10.0**-digits for digits in range(0, 12, 3)])
        panel.axhspan(_LOWEST, floors[problem], color="#e6e6e6", zorder=0)
        for goal in GOALS:
            panel.axhline(goal, color="#777777", linewidth=0.8, linestyle=":")
        panel.spines[["right", "top"]].set_visible(False)
        panel.grid(alpha=0.3)
    for name, (colour, marker) in LOOKS.items():
        spare.plot([], [], color=colour, marker=marker, markersize=5, label=NAMES[name])
    spare.set_axis_off()
    spare.legend(loc="center", frameon=False)
    return figure


def front(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs that no other beats in both time and error, the fastest first."""
    ranked = runs[(runs["kind"] != "tolerance") & ~runs["failed"]].sort_values(
        ["seconds", "error"]
    )
    best = ranked["error"].cummin().shift(fill_value=inf).clip(upper=USEFUL)
    return ranked[ranked["error"] < best]


def _line(axes: Axes, runs: pd.DataFrame, look: tuple[str, str], floor: float) -> None:
    """Draw runs up to the first that is too good to be measured, that one on the edge."""
    told = runs[(runs["error"] > floor).shift(fill_value=True).cummin()]
    error, (colour, marker) = told["error"].clip(lower=floor), look
    axes.plot(
        told["milliseconds"], error, color=colour, marker=marker, markersize=4.5, linewidth=1.2
    )
