"""Pictures of maps: time to inversion in perceptually even colours, other outcomes in greys."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from analysis.data.checks import Array
from validation.kit.figures import new_figure
from validation.maps.problems import Problem, critical_points
from validation.maps.run import Panel

GREYS = {
    "not inverted": "#f2f2f2",
    "flat": "#c9c9c9",
    "pulls": "#8f8f8f",
    "refused": "#6b6b6b",
    "lost": "#d9a3c7",
    "not decided": "#e6b8a2",
    "failed": "#d55e00",
    "upper face": "#440154",
    "lower face": "#fde725",
}
"""Colours of all classes but "inverted", which has a scale."""

_MEANING = {
    "not inverted": "not inverted",
    "flat": "falls flat",
    "pulls": "the ideal contact would pull",
    "refused": "start refused, such as one that pulls",
    "lost": "inverted, and lost again",
    "not decided": "not decided",
    "failed": "run failed",
    "upper face": "the one at β < π/2",
    "lower face": "the one at β > π/2",
}

_BARE: Any = {"linestyle": "none"}
_DOT = _BARE | {"marker": ".", "markersize": 1.2, "color": "black"}
_THEORY = _BARE | {"marker": ".", "markersize": 4, "color": "#d55e00"}
_ALIKE = _BARE | {
    "marker": "o",
    "markersize": 5,
    "markerfacecolor": "none",
    "markeredgecolor": "black",
    "markeredgewidth": 0.6,
}
_OTHER = _BARE | {"marker": "x", "markersize": 7, "markeredgecolor": "#d55e00"}
_RIM: Any = {"markeredgecolor": "white", "markeredgewidth": 2.0}

_WIDTH = 3.4
"""Of a panel in inches."""


def draw(problem: Problem, panels: Sequence[Panel], *, points: bool = True) -> Figure:
    """Figure of a map.

    Parameters
    ----------
    problem : Problem
    panels : sequence of Panel
    points : bool
        Whether the cases that were run are marked.
    """
    width = 7.5 if len(panels) == 1 else _WIDTH * len(panels) + 1.0
    figure, axes = new_figure(columns=len(panels), width=width, height=5.2, share=False)
    axes = np.atleast_1d(axes)
    times = [_times(panel) for panel in panels]
    found = np.concatenate([each[np.isfinite(each)] for each in times])
    norm = mpl.colors.Normalize(*(np.percentile(found, [0, 98]) if found.size else (0.0, 1.0)))
    image: Any = None
    theory = [critical_points(problem, panel.sweep.scenario) for panel in panels]
    for panel, inverted, lines, each in zip(panels, times, theory, axes, strict=True):
        image = _fill(problem, panel, inverted, norm, each)
        _mark(panel, lines, each, points=points)
        each.set(xlabel=problem.labels[0])
        if len(panels) > 1:
            each.set_title(panel.sweep.scenario.name, fontsize=10, loc="left")
    axes[0].set(ylabel=problem.labels[1])
    if not problem.to_rest:
        figure.colorbar(image, ax=list(axes), label="time to inversion in s", extend="max")
    figure.legend(handles=_legend(panels, theory, points=points), loc="outside upper left",
                  ncols=3 if len(panels) == 1 else 6, fontsize=9)  # fmt: skip
    return figure


def _times(panel: Panel) -> Array:
    """Time to inversion over the finest grid in s, nan where there is none."""
    columns = panel.results.columns
    is_inverted = columns["inversion"] == "inverted"
    if not np.any(is_inverted):
        return np.full(panel.shape, np.nan)
    places = panel.places(columns["number"][is_inverted])
    values = columns["inverted_at"][is_inverted]
    whole = np.indices(panel.shape)
    result = NearestNDInterpolator(places, values)(*whole)
    if all(np.unique(place).size > 1 for place in places.T):
        between = LinearNDInterpolator(places, values)(*whole)
        result = np.where(np.isfinite(between), between, result)
    return np.where(panel.filled == "inverted", result, np.nan)


def _fill(problem: Problem, panel: Panel, times: Array, norm: Any, axes: Axes) -> Any:
    y, x = (np.linspace(axis.first or 0.0, axis.last or 0.0, size)
            for axis, size in zip(panel.sweep.design.axes, panel.shape, strict=True))  # fmt: skip
    names, classes = list(GREYS), panel.filled
    codes = np.full(panel.shape, np.nan)
    for code, name in enumerate(names):
        codes[classes == name] = code
    axes.pcolormesh(
        x, y, codes, cmap=ListedColormap([GREYS[name] for name in names]),
        vmin=-0.5, vmax=len(names) - 0.5, shading="nearest", rasterized=True,
    )  # fmt: skip
    if problem.to_rest:
        return None
    return axes.pcolormesh(
        x, y, times, cmap="viridis", norm=norm, shading="nearest", rasterized=True
    )


def _mark(panel: Panel, theory: Array, axes: Axes, *, points: bool) -> None:
    """Cases that were run, those that the other side has seen, and critical speeds."""
    y, x = (panel.results.columns[name] for name in panel.results.axes)
    if points:
        axes.plot(x, y, **_DOT, alpha=0.5)
    for agree, look in ((panel.alike, _ALIKE), (panel.seen & ~panel.alike, _OTHER)):
        # A white rim keeps them apart from every colour.
        axes.plot(x[agree], y[agree], **(look | _RIM))
        axes.plot(x[agree], y[agree], **look)
    if theory.size:
        axes.plot(*theory.T, **(_THEORY | {"color": "white", "markersize": 7}))
        axes.plot(*theory.T, **_THEORY)
    axes.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()))
    axes.grid(visible=False)


def _legend(panels: Sequence[Panel], theory: Sequence[Array], *, points: bool) -> list[Any]:
    present = {name for panel in panels for name in panel.classes.values()}
    handles: list[Any] = [
        Patch(facecolor=GREYS[name], edgecolor="#999999", label=_MEANING[name])
        for name in GREYS
        if name in present
    ]
    looks = (
        (any(np.any(panel.alike) for panel in panels), _ALIKE, "the other side agrees"),
        (any(np.any(panel.seen & ~panel.alike) for panel in panels), _OTHER, "it does not"),
        (any(each.size for each in theory), _THEORY, "critical speeds of inverted spinning"),
        (points, _DOT, "runs"),
    )
    return handles + [Line2D([], [], label=label, **look) for shown, look, label in looks if shown]
