"""What became of the hard cases, as a figure."""

import numpy as np
import pandas as pd
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from validation.kit.figures import new_figure
from validation.studies.robustness.outcomes import GOOD

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
