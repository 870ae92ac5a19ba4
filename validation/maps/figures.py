"""Pictures of maps: time to inversion in perceptually even colours, other outcomes in greys."""

from collections.abc import Mapping
from contextlib import suppress
from math import ceil
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from scipy.interpolate import griddata
from scipy.spatial import QhullError

from analysis.problem.checks import Array
from validation.kit.figures import new_figure
from validation.maps.panel import Panel
from validation.maps.problems import critical_points

OUTCOMES = {
    "not inverted": ("#f2f2f2", "not inverted"),
    "flat": ("#c9c9c9", "falls flat"),
    "pulls": ("#8f8f8f", "the ideal contact would pull"),
    "refused": ("#6b6b6b", "start refused, such as one that pulls"),
    "lost": ("#d9a3c7", "inverted, and lost again"),
    "not decided": ("#e6b8a2", "not decided"),
    "failed": ("#d55e00", "run failed"),
    "upper face": ("#440154", "face that is up at β < π/2"),
    "lower face": ("#fde725", "face that is up at β > π/2"),
}
"""Colours and meanings of all outcomes but "inverted", which has a scale."""

_MARK: Any = {"linestyle": "none", "marker": "o", "markersize": 5, "markeredgewidth": 0.6}
_HOLLOW: Any = _MARK | {"markerfacecolor": "none", "markeredgecolor": "black"}
MARKS: Any = {
    "the other side agrees": _HOLLOW,
    "it does not": _MARK | {"marker": "x", "markersize": 7, "markeredgecolor": "#d55e00"},
    "critical speeds of inverted spinning": _MARK | {"markersize": 2.5, "color": "black"},
}
"""Looks of what is marked; a white rim keeps it apart from every colour."""

_WIDTH, _HEIGHT = 3.4, 3.4
"""Of a panel beside others in inches."""

_LINE = 34
"""Letters of a title beside others in a line."""


def draw(panels: Mapping[str, Panel]) -> Figure:
    """Figure of maps, two in a row; critical speeds are drawn in where a map has any.

    Parameters
    ----------
    panels : mapping of str to Panel
        By their titles, of which a single one has none.
    """
    columns = min(2, len(panels))
    rows = ceil(len(panels) / columns)
    size = (2 * _WIDTH + 1.0, rows * _HEIGHT + 1.0) if rows * columns > 1 else (6.5, 4.4)
    figure, found = new_figure(rows, columns=columns, width=size[0], height=size[1], share=False)
    axes, spare = np.split(np.ravel(found), [len(panels)])
    times = [_times(panel) for panel in panels.values()]
    known = np.concatenate([each[np.isfinite(each)] for each in times])
    norm = mpl.colors.Normalize(*(np.percentile(known, [0, 98]) if known.size else (0.0, 1.0)))
    for (title, panel), inverted, each in zip(panels.items(), times, axes, strict=True):
        _fill(panel, inverted, norm, each)
        _mark(panel, each)
        up, right = (axis.label for axis in panel.sweep.design.axes)
        each.set(xlabel=right, ylabel=up)
        if len(panels) > 1:
            each.set_title(fill(title, _LINE), fontsize=10, loc="left")
    for each in spare:
        each.set_axis_off()
    if known.size:
        image = mpl.cm.ScalarMappable(norm, "viridis")
        figure.colorbar(image, ax=axes.tolist(), label="time to inversion in s", extend="max")
    present = {name for panel in panels.values() for name in panel.cells["outcome"]}
    shown: dict[str, Any] = {
        meaning: Patch(facecolor=colour, edgecolor="#999999")
        for name, (colour, meaning) in OUTCOMES.items()
        if name in present
    }
    shown |= {str(line.get_label()): line for each in axes for line in each.lines}
    how: Any = {"loc": "outside upper left", "ncols": 2, "fontsize": 9, "frameon": False}
    figure.legend([*shown.values()], [*shown], **how)
    return figure


def _times(panel: Panel) -> Array:
    """Time to inversion over the finest grid in s, nan where there is none."""
    timed = panel.cells.dropna(subset="time")
    result = np.full(panel.shape, np.nan)
    if not timed.empty:
        places, values = panel.places(timed), timed["time"].to_numpy(float)
        whole = tuple(np.indices(panel.shape))
        # There is nothing between places on a line.
        with suppress(QhullError):
            result = griddata(places, values, whole)
        nearest = griddata(places, values, whole, "nearest")
        result = np.where(np.isfinite(result), result, nearest)
    return np.where(panel.outcomes == "inverted", result, np.nan)


def _fill(panel: Panel, times: Array, norm: Any, axes: Axes) -> None:
    """Colours of the outcomes, and of the times to inversion over those inverted."""
    up, right = panel.values
    names = ["inverted", *OUTCOMES]
    codes = pd.Categorical(panel.outcomes.ravel(), names).codes.reshape(panel.shape)
    look: Any = {"shading": "nearest", "rasterized": True}
    colours = ListedColormap(["white", *(colour for colour, _ in OUTCOMES.values())])
    axes.pcolormesh(right, up, codes, cmap=colours, vmin=-0.5, vmax=len(names) - 0.5, **look)
    axes.pcolormesh(right, up, times, cmap="viridis", norm=norm, **look)
    axes.set(xlim=(right[0], right[-1]), ylim=(up[0], up[-1]))


def _mark(panel: Panel, axes: Axes) -> None:
    """Cases that the other side has seen, and critical speeds."""
    up, right = panel.values
    seen, alike = panel.places(panel.seen), panel.seen["alike"].to_numpy(bool)
    points = [
        np.column_stack((right[each[:, 1]], up[each[:, 0]]))
        for each in (seen[alike], seen[~alike])
    ]
    rim = [withStroke(linewidth=2.5, foreground="white")]
    points.append(critical_points(panel.sweep))
    for (name, look), places in zip(MARKS.items(), points, strict=False):
        if len(places):
            axes.plot(*places.T, label=name, path_effects=rim, **look)
    axes.grid(visible=False)
