"""Pictures of maps: time to inversion in perceptually even colours, other outcomes in greys."""

from collections.abc import Sequence
from textwrap import fill
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
from validation.maps.problems import critical_points
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
    "upper face": "face that is up at β < π/2",
    "lower face": "face that is up at β > π/2",
}

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

_WIDTH, _HEIGHT = 3.4, 4.4
"""Of a panel in inches."""

_LINE = 34
"""Letters of a title beside others in a line."""


def draw(
    panels: Sequence[Panel],
    *,
    width: float | None = None,
    points: bool = True,
    theory: bool = True,
) -> Figure:
    """Figure of maps beside each other.

    Parameters
    ----------
    panels : sequence of Panel
    width : float, optional
        In inches.
    points : bool
        Whether the cases that were run are marked, unless all were.
    theory : bool
        Whether critical speeds are drawn in, where a map has any.
    """
    points = points and any(len(panel.classes) < np.prod(panel.shape) for panel in panels)
    if width is None:
        width = 7.5 if len(panels) == 1 else _WIDTH * len(panels) + 1.0
    figure, axes = new_figure(columns=len(panels), width=width, height=_HEIGHT, share=False)
    axes = np.atleast_1d(axes).tolist()
    times = [_times(panel) for panel in panels]
    found = np.concatenate([each[np.isfinite(each)] for each in times])
    norm = mpl.colors.Normalize(*(np.percentile(found, [0, 98]) if found.size else (0.0, 1.0)))
    critical = [
        critical_points(panel.problem, panel.sweep.scenario) if theory else np.empty((0, 2))
        for panel in panels
    ]
    for panel, inverted, lines, each in zip(panels, times, critical, axes, strict=True):
        _fill(panel, inverted, norm, each)
        _mark(panel, lines, each, points=points)
    _name(panels, axes)
    if found.size:
        image = mpl.cm.ScalarMappable(norm, "viridis")
        figure.colorbar(image, ax=axes, label="time to inversion in s", extend="max")
    figure.legend(handles=_legend(panels, critical, points=points), loc="outside upper left",
                  ncols=1 + len(panels), fontsize=9, frameon=False)  # fmt: skip
    return figure


def _name(panels: Sequence[Panel], axes: Sequence[Axes]) -> None:
    """Titles and labels, the latter once where neighbours share them."""
    of_models = len({panel.problem.title for panel in panels}) == 1
    label = ""
    for panel, each in zip(panels, axes, strict=True):
        problem = panel.problem
        each.set(xlabel=problem.labels[0])
        if problem.labels[1] != label:
            label = problem.labels[1]
            each.set(ylabel=label)
        if len(panels) > 1:
            title = panel.sweep.scenario.name if of_models else problem.title
            each.set_title(fill(title, _LINE), fontsize=10, loc="left")


def _times(panel: Panel) -> Array:
    """Time to inversion over the finest grid in s, nan where there is none."""
    if not panel.times:
        return np.full(panel.shape, np.nan)
    places, values = panel.places(list(panel.times)), np.array(list(panel.times.values()))
    whole = np.indices(panel.shape)
    result = NearestNDInterpolator(places, values)(*whole)
    if all(np.unique(place).size > 1 for place in places.T):
        between = LinearNDInterpolator(places, values)(*whole)
        result = np.where(np.isfinite(between), between, result)
    return np.where(panel.filled == "inverted", result, np.nan)


def _fill(panel: Panel, times: Array, norm: Any, axes: Axes) -> None:
    y, x = panel.values()
    names, classes = list(GREYS), panel.filled
    codes = np.full(panel.shape, np.nan)
    for code, name in enumerate(names):
        codes[classes == name] = code
    look: Any = {"shading": "nearest", "rasterized": True}
    colours = ListedColormap([GREYS[name] for name in names])
    axes.pcolormesh(x, y, codes, cmap=colours, vmin=-0.5, vmax=len(names) - 0.5, **look)
    if panel.times:
        axes.pcolormesh(x, y, times, cmap="viridis", norm=norm, **look)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))


def _mark(panel: Panel, theory: Array, axes: Axes, *, points: bool) -> None:
    """Cases that were run, those that the other side has seen, and critical speeds."""
    y, x = panel.values()

    def plot(numbers: Sequence[int], look: Any, **more: Any) -> None:
        rows, columns = panel.places(numbers).T
        axes.plot(x[columns], y[rows], **(look | more))

    if points:
        plot(list(panel.classes), _DOT, alpha=0.5)
    for agree, look in ((True, _ALIKE), (False, _OTHER)):
        seen = [number for number, each in panel.witnesses.items() if each.alike is agree]
        # A white rim keeps them apart from every colour.
        plot(seen, look, **_RIM)
        plot(seen, look)
    if theory.size:
        axes.plot(*theory.T, **(_THEORY | {"color": "white", "markersize": 7}))
        axes.plot(*theory.T, **_THEORY)
    axes.grid(visible=False)


def _legend(panels: Sequence[Panel], theory: Sequence[Array], *, points: bool) -> list[Any]:
    present = {name for panel in panels for name in panel.classes.values()}
    handles: list[Any] = [
        Patch(facecolor=GREYS[name], edgecolor="#999999", label=_MEANING[name])
        for name in GREYS
        if name in present
    ]
    agrees = {each.alike for panel in panels for each in panel.witnesses.values()}
    looks = (
        (True in agrees, _ALIKE, "the other side agrees"),
        (False in agrees, _OTHER, "it does not"),
        (any(each.size for each in theory), _THEORY, "critical speeds of inverted spinning"),
        (points, _DOT, "runs"),
    )
    return handles + [Line2D([], [], label=label, **look) for shown, look, label in looks if shown]
