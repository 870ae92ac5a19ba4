"""Pictures of maps: time to inversion in perceptually even colours, other outcomes in greys."""

from collections.abc import Sequence
from math import ceil
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from analysis.data.checks import Array
from validation.kit.figures import new_figure
from validation.maps.panel import Panel
from validation.maps.problems import critical_points, label

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

_BARE: Any = {"linestyle": "none"}
_DOT = _BARE | {"marker": ".", "markersize": 1.2, "color": "black"}
_THEORY = _BARE | {"marker": ".", "markersize": 4, "color": "black"}
_ALIKE = _BARE | {
    "marker": "o",
    "markersize": 5,
    "markerfacecolor": "none",
    "markeredgecolor": "black",
    "markeredgewidth": 0.6,
}
_OTHER = _BARE | {"marker": "x", "markersize": 7, "markeredgecolor": "#d55e00"}
_RIM: Any = {"markeredgecolor": "white", "markeredgewidth": 2.0}

_WIDTH, _HEIGHT = 3.4, 3.4
"""Of a panel beside others in inches."""

_LINE = 34
"""Letters of a title beside others in a line."""


def draw(panels: Sequence[Panel], *, points: bool = True) -> Figure:
    """Figure of maps, two in a row; critical speeds are drawn in where a map has any.

    Parameters
    ----------
    panels : sequence of Panel
    points : bool
        Whether the cases that were run are marked, unless all were.
    """
    points = points and any(len(panel.cells) < np.prod(panel.shape) for panel in panels)
    columns = min(2, len(panels))
    rows = ceil(len(panels) / columns)
    size = (2 * _WIDTH + 1.0, rows * _HEIGHT + 1.0) if rows * columns > 1 else (6.5, 4.4)
    figure, found = new_figure(rows, columns=columns, width=size[0], height=size[1], share=False)
    axes, spare = np.split(np.ravel(found), [len(panels)])
    times = [_times(panel) for panel in panels]
    known = np.concatenate([each[np.isfinite(each)] for each in times])
    norm = mpl.colors.Normalize(*(np.percentile(known, [0, 98]) if known.size else (0.0, 1.0)))
    critical = [_critical(panel) for panel in panels]
    for panel, inverted, lines, each in zip(panels, times, critical, axes, strict=True):
        _fill(panel, inverted, norm, each)
        _mark(panel, lines, each, points=points)
        _name(panel, panels, each)
    for each in spare:
        each.set_axis_off()
    if known.size:
        image = mpl.cm.ScalarMappable(norm, "viridis")
        figure.colorbar(image, ax=axes.tolist(), label="time to inversion in s", extend="max")
    handles = _legend(panels, points=points, theory=any(each.size for each in critical))
    figure.legend(handles=handles, loc="outside upper left", ncols=2, fontsize=9, frameon=False)
    return figure


def _critical(panel: Panel) -> Array:
    """Critical speeds that belong to a map, shape (n, 2)."""
    if panel.problem is None or panel.problem.to_rest:
        return np.empty((0, 2))
    return critical_points(panel.sweep)


def _name(panel: Panel, panels: Sequence[Panel], axes: Axes) -> None:
    """Labels, and beside others what tells it apart."""
    up, right = (label(axis.field) for axis in panel.sweep.design.axes)
    axes.set(xlabel=right, ylabel=up)
    if len(panels) > 1:
        is_one = len({each.problem for each in panels}) == 1
        asked = None if is_one else panel.problem
        title = panel.sweep.scenario.name if asked is None else asked.title
        axes.set_title(fill(title, _LINE), fontsize=10, loc="left")


def _times(panel: Panel) -> Array:
    """Time to inversion over the finest grid in s, nan where there is none."""
    timed = panel.cells.dropna(subset="time")
    if timed.empty:
        return np.full(panel.shape, np.nan)
    places, values = panel.places(timed), timed["time"].to_numpy(float)
    whole = np.indices(panel.shape)
    result = NearestNDInterpolator(places, values)(*whole)
    if all(np.unique(place).size > 1 for place in places.T):
        between = LinearNDInterpolator(places, values)(*whole)
        result = np.where(np.isfinite(between), between, result)
    return np.where(panel.outcomes == "inverted", result, np.nan)


def _fill(panel: Panel, times: Array, norm: Any, axes: Axes) -> None:
    """Colours of the outcomes, and of the times to inversion over those inverted."""
    up, right = panel.values
    outcomes = panel.outcomes
    codes = np.full(panel.shape, np.nan)
    for code, name in enumerate(OUTCOMES):
        codes[outcomes == name] = code
    look: Any = {"shading": "nearest", "rasterized": True}
    colours = ListedColormap([colour for colour, _ in OUTCOMES.values()])
    axes.pcolormesh(right, up, codes, cmap=colours, vmin=-0.5, vmax=len(OUTCOMES) - 0.5, **look)
    axes.pcolormesh(right, up, times, cmap="viridis", norm=norm, **look)
    axes.set(xlim=(right[0], right[-1]), ylim=(up[0], up[-1]))


def _mark(panel: Panel, theory: Array, axes: Axes, *, points: bool) -> None:
    """Cases that were run, those that the other side has seen, and critical speeds."""
    up, right = panel.values

    def plot(cells: pd.DataFrame, look: Any, **more: Any) -> None:
        rows, columns = panel.places(cells).T
        axes.plot(right[columns], up[rows], **(look | more))

    if points:
        plot(panel.cells, _DOT, alpha=0.5)
    for agree, look in ((True, _ALIKE), (False, _OTHER)):
        seen = panel.seen[panel.seen["alike"] == agree]
        # A white rim keeps them apart from every colour.
        plot(seen, look, **_RIM)
        plot(seen, look)
    if theory.size:
        axes.plot(*theory.T, **(_THEORY | {"color": "white", "markersize": 7}))
        axes.plot(*theory.T, **_THEORY)
    axes.grid(visible=False)


def _legend(panels: Sequence[Panel], *, points: bool, theory: bool) -> list[Any]:
    cells = pd.concat([panel.cells for panel in panels])
    present = {*cells["outcome"]}
    handles: list[Any] = [
        Patch(facecolor=colour, edgecolor="#999999", label=meaning)
        for name, (colour, meaning) in OUTCOMES.items()
        if name in present
    ]
    agrees = {*cells["alike"][cells["seen"]]}
    looks = (
        (True in agrees, _ALIKE, "the other side agrees"),
        (False in agrees, _OTHER, "it does not"),
        (theory, _THEORY, "critical speeds of inverted spinning"),
        (points, _DOT, "runs"),
    )
    return handles + [Line2D([], [], label=label, **look) for shown, look, label in looks if shown]
