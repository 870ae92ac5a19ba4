"""Figures of the hard cases: what became of them, and the largest steps that work."""

import numpy as np
import pandas as pd
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from validation.kit.figures import COLOURS, MARKERS, STYLES, new_figure
from validation.studies.robustness.outcomes import GOOD
from validation.studies.robustness.steps import ACCURACY

RIGHT, WRONG = (
    LinearSegmentedColormap.from_list("", ["#ffffff", dark]) for dark in ("#0072b2", "#d55e00")
)
"""Blue for what is as it should be and vermilion for what is not, the stronger the more."""

DARK = 0.55
"""Shade from which on a number is written in white."""


def matrix(counts: pd.DataFrame) -> Figure:
    """Number of cases by what is extreme about them and by verdict, coloured by their share.

    Parameters
    ----------
    counts : DataFrame
        A row for each axis, a column for each verdict.
    """
    figure, axes = new_figure(width=8.0, height=6.2)
    numbers, totals = counts.to_numpy(), counts.sum(axis=1)
    # What is rare has to be seen as well.
    shades = np.where(numbers > 0, 0.15 + 0.85 * numbers / totals.to_numpy()[:, None], 0.0)
    good = np.isin(counts.columns, GOOD)
    axes.imshow(np.where(good[:, None], RIGHT(shades), WRONG(shades)), aspect="auto")
    for row, column in zip(*np.nonzero(numbers), strict=True):
        ink = "white" if shades[row, column] > DARK else "black"
        axes.text(column, row, str(numbers[row, column]), ha="center", va="center", color=ink)
    axes.axvline(good.sum() - 0.5, color="black", linewidth=1.2)
    axes.set_xticks(range(counts.shape[1]), counts.columns, rotation=35, ha="left")
    axes.set_yticks(range(len(counts)), [f"{name} ({totals[name]})" for name in counts.index])
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    return figure


_NAMES = {"smoothing": "smoothing ε in m/s", "stiffness": "contact stiffness in N/m"}


def steps(limits: pd.DataFrame) -> Figure:
    """Largest stable and largest accurate steps over the smoothing and over the stiffness."""
    figure, panels = new_figure(columns=2, width=8.6, height=5.2)
    for axes, (over, name) in zip(panels, _NAMES.items(), strict=True):
        ways = limits[limits["over"] == over].groupby(
            ["kind", "formulation", "integrator"], sort=False
        )
        counts = {"stable": 0, "accurate": 0}
        for (kind, formulation, integrator), found in ways:
            index = counts[kind]
            counts[kind] += 1
            mark, label = "x+"[index % 2], f"stable, {integrator}: measured"
            shift = 0.0
            if kind == "stable":
                line = found["value"], found["predicted"], STYLES[index]
                axes.plot(*line, color=COLOURS[index], label=f"stable, {integrator}: predicted")
            else:
                # Equal steps must not hide each other.
                mark, shift = MARKERS[index], 0.08 * (index - 1.5)
                label = f"error ≤ {ACCURACY:g} rad: {formulation}, {integrator}"
            axes.plot(
                found["value"] * 10.0**shift,
                found["step"].astype(float),
                mark,
                markersize=8 if kind == "stable" else 6,
                markerfacecolor="white",
                color=COLOURS[index],
                label=label,
            )
        axes.set(xscale="log", yscale="log", ylim=(1e-9, 1e-1), xlabel=f"{name} (log scale)")
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), fontsize=8.5, frameon=False)
    panels[0].invert_xaxis()
    panels[0].set_ylabel("largest step in s (log scale)")
    panels[1].tick_params(labelleft=False)
    return figure
