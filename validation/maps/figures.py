"""Pictures of maps: time to inversion in perceptually even colours, other outcomes in greys.

And of sweeps: curves of the outcomes over one axis, a map over two, pairs of more.
"""

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
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
from scipy.spatial import QhullError

from analysis.problem.checks import Array
from analysis.problem.quantities import declared
from analysis.problem.scenario import require_level
from analysis.problem.variations import changed
from validation.display.figures import MARKED, legend_above, new_figure
from validation.maps.panel import Panel, cell
from validation.maps.problems import critical_points
from validation.sweeps.axes import Axis
from validation.sweeps.results import Results
from validation.sweeps.sweep import Sweep

OUTCOMES = {
    "not inverted": ("#f2f2f2", "not inverted"),
    "flat": ("#c9c9c9", "falls flat"),
    "pulls": ("#8f8f8f", "the ideal contact would pull"),
    "refused": ("#3a3a3a", "start refused, such as one that pulls"),
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
    "run by the other code, too: agrees": _HOLLOW,
    "it does not": _MARK | {"marker": "x", "markersize": 7, "markeredgecolor": "#d55e00"},
    "inverted spinning: Hopf point": _MARK | {"markersize": 2.5, "color": "black"},
    "a real eigenvalue zero": _MARK | {"marker": "+", "markeredgecolor": "black"},
}
"""Looks of what is marked; a white rim keeps it apart from every colour."""

_WIDTH, _HEIGHT = 3.4, 3.4
"""Of a panel beside others in inches."""

_MANY = 50
"""Inverted cells from which on the latest ones go beyond the scale of colours."""

_LINE = 34
"""Letters of a title beside others in a line."""

_CURVES: tuple[tuple[str, Mapping[str, str]], ...] = (
    (
        "time in s",
        {"inverted_at": "to inversion", "lost_at": "to its loss", "rest_from": "to rest"},
    ),
    ("spin in rad/s", {"spin_after": "1 s after inversion", "spin_end": "at the end"}),
    ("normal force in N", {"force_least": "least", "force_largest": "largest"}),
)
"""Label of each picture below that of the outcomes, and its columns with their meaning."""

MOST_PAIRED = 8
"""Axes that are drawn in pairs: with more, the panels are too small."""

_LETTERS = 22
"""Of a label in a line beside a panel of a pair."""

_LEVEL = 6
"""Letters of the longest name along an axis that is written level."""

_BINS = 10
"""In which cases that lie on no grid are counted over an axis."""


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
    # Of many, a few late ones are not to take the colours of the others.
    highest, extend = (98, "max") if known.size > _MANY else (100, "neither")
    first, last = np.percentile(known, [0, highest]) if known.size else (0.0, 1.0)
    # Where all stand inverted at the start, colours are not to tell of times before it.
    norm = mpl.colors.Normalize(first, last or 1.0)
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
        figure.colorbar(image, ax=axes.tolist(), label="time to inversion in s", extend=extend)
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
        values = timed["time"].to_numpy(float)
        # There is nothing between places on a line.
        with suppress(QhullError):
            result = panel.spread(timed, values, "linear")
        nearest = panel.spread(timed, values, "nearest")
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
    rows, columns = panel.places(panel.seen).T
    seen, alike = np.column_stack((right[columns], up[rows])), panel.seen["alike"].to_numpy(bool)
    points = (seen[alike], seen[~alike], *critical_points(panel.sweep).values())
    rim = [withStroke(linewidth=2.5, foreground="white")]
    for (name, look), places in zip(MARKS.items(), points, strict=True):
        if len(places):
            axes.plot(*places.T, label=name, path_effects=rim, **look)
    axes.grid(visible=False)


# --- Sweeps -------------------------------------------------------------------------------------


def check_drawable(sweep: Sweep) -> None:
    """Raise `ValueError` if there is no picture of a sweep."""
    axes, layout = sweep.design.axes, sweep.design.layout
    if len(axes) > MOST_PAIRED:
        raise ValueError(f"at most {MOST_PAIRED} axes can be drawn, got {len(axes)}")
    if len(axes) > 1 and layout == "grid" and min(sweep.design.shape) < 2:
        raise ValueError("several axes can be drawn if each has two values at least")
    for axis in axes:
        if not _is_named(axis) and list(axis.values) != sorted(axis.values):
            raise ValueError(
                f"axis {axis.field} can be drawn if its values rise, got {axis.values}"
            )
    if sweep.plan.to_rest:
        steepest: dict[str, Any] = {
            axis.field: max(axis.draw(0.0), axis.draw(1.0))
            for axis in axes
            if axis.field == "table.inclination"
        }
        require_level(changed(sweep.scenario, steepest), "a picture of the face that is up")


def draw_sweep(results: Results) -> Figure:
    """Picture of a sweep that has been run.

    Parameters
    ----------
    results : Results

    Raises
    ------
    ValueError
        If `check_drawable` does.
    """
    check_drawable(results.sweep)
    sweep, by_face = results.sweep, results.sweep.plan.to_rest
    cells = pd.DataFrame([cell(sweep, row, by_face=by_face) for row in results.rows()])
    table = pd.DataFrame(results.columns).assign(outcome=cells["outcome"])
    axes = sweep.design.axes
    for axis in filter(_is_named, axes):
        table[axis.field] = table[axis.field].map(axis.values.index)
    if len(axes) == 1:
        return _curves(axes[0], table.sort_values(axes[0].field))
    if len(axes) > 2 or sweep.design.layout != "grid" or any(map(_is_named, axes)):
        return _pairs(sweep, table)
    figure = draw({"": Panel(sweep=sweep, cells=cells)})
    for way, axis in zip("yx", axes, strict=True):
        _mark_values(figure.axes[0], way, axis)
    return figure


def _is_named(axis: Axis) -> bool:
    """Whether values are names or marks, which are drawn at the places they have in their list."""
    return declared(axis.field).is_word


def _mark_values(axes: Axes, way: str, axis: Axis) -> None:
    """Mark the values of an axis along "x" or "y"."""
    axes.set(**{f"{way}scale": "log" if axis.log else "linear"})
    if axis.log:
        lines, ends = getattr(axes, f"{way}axis"), [float(axis.draw(end)) for end in (0.0, 1.0)]
        narrow = max(ends) < 100.0 * min(ends)
        lines.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if narrow else (1.0,)))
        lines.set_major_formatter("{x:g}")
        lines.set_minor_formatter(NullFormatter())
    if _is_named(axis):
        ticks, names = range(len(axis.values)), list(map(str, axis.values))
        axes.set(**{f"{way}ticks": ticks, f"{way}ticklabels": names})
        if way == "x" and max(map(len, names)) > _LEVEL:
            for label in axes.get_xticklabels():
                label.set(rotation=30, ha="right", rotation_mode="anchor")


def _curves(axis: Axis, table: pd.DataFrame) -> Figure:
    x, filled = table[axis.field], table.columns[table.notna().any()]
    # What no case has gets no panel.
    shown = [(text, heads) for text, heads in _CURVES if not filled.intersection(heads).empty]
    figure, axes = new_figure(1 + len(shown), height=3.6 + 1.8 * len(shown))
    first, *others = panels = np.atleast_1d(axes)
    known = [name for name in ("inverted", *OUTCOMES) if name in set(table["outcome"])]
    first.plot(x, table["outcome"].map(known.index), "o", markersize=4, color="black")
    first.set_yticks(range(len(known)), known)
    first.set(ylim=(-0.5, len(known) - 0.5))
    for panel, (text, heads) in zip(others, shown, strict=True):
        for name, look in zip(filter(heads.get, filled), MARKED, strict=False):
            (line,) = panel.plot(x, table[name], markersize=3, label=heads[name], **look)
            if _is_named(axis):
                line.set_linestyle("none")  # nothing lies between names
        legend_above(panel)
        panel.set(ylabel=text)
    _mark_values(panels[-1], "x", axis)
    panels[-1].set(xlabel=axis.label)
    return figure


def _pairs(sweep: Sweep, table: pd.DataFrame) -> Figure:
    """Share of cases with an outcome over each axis, and over each pair of axes below."""
    design, count = sweep.design, len(sweep.design.axes)
    counted = "upper face" if sweep.plan.to_rest else "inverted"
    decided = ~table["outcome"].isin(("refused", "failed", "not decided"))
    table["hit"] = (table["outcome"] == counted).where(decided).astype(float)
    figure, axes = new_figure(
        count, columns=count, width=1.6 * count + 1.2, height=1.4 * count + 0.8
    )
    image: Any = None
    for row, column in np.ndindex(count, count):
        each, up, right = axes[row, column], design.axes[row], design.axes[column]
        if column > row:
            each.set_axis_off()
            continue
        _mark_values(each, "x", right)
        if row == column:
            # Cases drawn on a range lie on no grid: as many each are counted together.
            values = table[up.field]
            is_few = up.values or design.layout == "grid" or len(values) < _BINS
            bins = values if is_few else pd.qcut(values, _BINS, duplicates="drop")
            shares = table.groupby(bins, observed=True)[[up.field, "hit"]].mean().dropna()
            # The axis is as long where some values, or all, have no share.
            each.update_datalim(np.column_stack((values, np.zeros(len(values)))))
            each.plot(shares[up.field], shares["hit"], ".k" if _is_named(up) else ".-k", ms=4)
            each.set(ylim=(-0.05, 1.05))
        else:
            image = _scatter(each, table.groupby([right.field, up.field])["hit"].mean())
            _mark_values(each, "y", up)
            _thin(each, "y", up)
        _thin(each, "x", right)
        each.tick_params(labelsize=7, labelleft=column in (0, row))
        if row == count - 1:
            each.set_xlabel(fill(right.label, _LETTERS), fontsize=8)
        if column == 0:
            text = fill(up.label, _LETTERS) if row else f"share {counted}"
            each.set_ylabel(text, fontsize=8)
    figure.colorbar(image, ax=axes, label=f"share of cases: {counted}", shrink=0.6)
    varies = {"model", "constraints"} & {axis.field for axis in sweep.design.axes}
    what = "several models" if varies else sweep.scenario.name
    title = f"Sweep of {what}: {decided.sum()} cases"
    without = f", × {(~decided).sum()} without a motion or not decided" * (not decided.all())
    figure.suptitle(title + without, fontsize=10, wrap=True)
    return figure


def _thin(axes: Axes, way: str, axis: Axis) -> None:
    """Leave as many marks along "x" or "y" as do not run into each other in so small a panel."""
    along: Any = getattr(axes, f"{way}axis")
    if axis.log:
        ends = (axis.first, axis.last)
        along.set_ticks(ends, labels=[f"{each:g}" for each in ends])
        along.set_ticks((), minor=True)
    elif way == "x" and not _is_named(axis):
        along.set_major_locator(MaxNLocator(3, steps=(1, 2, 5, 10)))


def _scatter(axes: Axes, shares: pd.Series) -> Any:
    """Shares over two axes, as coloured points; crosses where there is nothing to count."""
    parts = (shares[shares.isna()], shares.dropna())
    none, some = (part.reset_index().T.to_numpy(float) for part in parts)
    x, y, share = some
    axes.plot(*none[:2], "x", color="#999999", markersize=3)
    look: Any = {"s": 9, "cmap": "viridis", "vmin": 0.0, "vmax": 1.0, "zorder": 3}
    return axes.scatter(x, y, c=share, **look)
