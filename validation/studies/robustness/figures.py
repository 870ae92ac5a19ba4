"""Figures of the hard cases: what became of them, and the largest steps that work."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from validation.kit.figures import COLOURS, MARKERS, STYLES, new_figure
from validation.studies.robustness.outcomes import GOOD

RIGHT = LinearSegmentedColormap.from_list("right", ["#ffffff", "#0072b2"])
WRONG = LinearSegmentedColormap.from_list("wrong", ["#ffffff", "#d55e00"])
"""Blue for what is as it should be and vermilion for what is not, the stronger the more."""

DARK = 0.55
"""Share from which on a number is written in white."""


def matrix(counts: pd.DataFrame, axes: Axes | None = None) -> Axes:
    """Number of cases by what is extreme about them and by verdict, coloured by their share.

    Parameters
    ----------
    counts : DataFrame
        A row for each axis, a column for each verdict.
    axes : Axes, optional
    """
    if axes is None:
        axes = new_figure(width=8.0, height=6.2)[1]
    shares = counts.div(counts.sum(axis=1), axis=0).to_numpy()
    for column, verdict in enumerate(counts):
        colours = RIGHT if verdict in GOOD else WRONG
        for row, share in enumerate(shares[:, column]):
            number = counts.iloc[row, column]
            # What is rare has to be seen as well.
            shade = 0.0 if number == 0 else 0.15 + 0.85 * share
            axes.fill_between(
                (column - 0.5, column + 0.5),
                row - 0.5,
                row + 0.5,
                color=colours(shade),
                linewidth=0,
            )
            if number:
                ink = "white" if shade > DARK else "black"
                axes.text(column, row, str(number), ha="center", va="center", color=ink)
    good = sum(verdict in GOOD for verdict in counts)
    axes.axvline(good - 0.5, color="black", linewidth=1.2)
    axes.set_xticks(range(counts.shape[1]), counts.columns, rotation=35, ha="left")
    axes.set_yticks(range(len(counts)), counts.index)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    axes.set(xlim=(-0.5, counts.shape[1] - 0.5), ylim=(len(counts) - 0.5, -0.5))
    return axes


_NAMES = {"smoothing": "smoothing ε in m/s", "stiffness": "contact stiffness in N/m"}


def steps(limits: pd.DataFrame, accuracy: float) -> Figure:
    """Largest stable and largest accurate steps over the smoothing and over the stiffness."""
    figure, panels = new_figure(columns=2, width=8.6, height=5.2)
    for axes, (over, name) in zip(panels, _NAMES.items(), strict=True):
        chosen = limits[limits["over"] == over]
        _stable(axes, chosen[chosen["kind"] == "stable"])
        _accurate(axes, chosen[chosen["kind"] == "accurate"], accuracy)
        axes.set(xscale="log", yscale="log", ylim=(1e-9, 1e-1), xlabel=f"{name} (log scale)")
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), fontsize=8.5, frameon=False)
    panels[0].invert_xaxis()
    panels[0].set_ylabel("largest step in s (log scale)")
    panels[1].tick_params(labelleft=False)
    return figure


def _stable(axes: Axes, limits: pd.DataFrame) -> None:
    for index, (integrator, found) in enumerate(limits.groupby("integrator")):
        look: dict[str, Any] = {"color": COLOURS[index]}
        axes.plot(
            found["value"],
            found["predicted"],
            linestyle=STYLES[index],
            label=f"stable, {integrator}: predicted",
            **look,
        )
        axes.plot(
            found["value"],
            found["step"],
            linestyle="none",
            marker="x+"[index],
            markersize=8,
            label=f"stable, {integrator}: measured",
            **look,
        )


def _accurate(axes: Axes, limits: pd.DataFrame, accuracy: float) -> None:
    ways = limits.groupby(["formulation", "integrator"], sort=False)
    for index, ((formulation, integrator), found) in enumerate(ways):
        axes.plot(
            # Shifted a little, so that equal steps do not hide each other.
            found["value"] * 10 ** (0.08 * (index - 1.5)),
            found["step"].astype(float).replace(0.0, np.nan),
            linestyle="none",
            marker=MARKERS[index],
            markerfacecolor="white",
            color=COLOURS[index],
            label=f"error ≤ {accuracy:g} rad: {formulation}, {integrator}",
        )
