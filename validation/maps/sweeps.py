"""Pictures of sweeps: curves of the outcomes over one axis, a map over two, pairs of more."""

from collections.abc import Mapping
from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from analysis.problem.quantities import declared
from validation.kit import figures as kit
from validation.maps import figures
from validation.maps.panel import Panel, cell
from validation.sweeps.axes import Axis
from validation.sweeps.results import Results
from validation.sweeps.sweep import Sweep

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

_TITLED = 11
"""Letters of a title in a line for each inch of a figure."""

_BINS = 10
"""In which cases that lie on no grid are counted over an axis."""


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


def draw(results: Results) -> Figure:
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
    sweep, to_rest = results.sweep, results.sweep.plan.to_rest
    cells = pd.DataFrame([cell(sweep, row, to_rest=to_rest) for row in results.rows()])
    table = pd.DataFrame(results.columns).assign(outcome=cells["outcome"])
    axes = sweep.design.axes
    for axis in filter(_is_named, axes):
        table[axis.field] = table[axis.field].map(axis.values.index)
    if len(axes) == 1:
        return _curves(axes[0], table.sort_values(axes[0].field))
    if len(axes) > 2 or sweep.design.layout != "grid" or any(map(_is_named, axes)):
        return _pairs(sweep, table)
    figure = figures.draw({"": Panel(sweep=sweep, cells=cells)})
    figure.axes[0].set(xscale=_scale(axes[1]), yscale=_scale(axes[0]))
    return figure


def _scale(axis: Axis) -> str:
    return "log" if axis.log else "linear"


def _is_named(axis: Axis) -> bool:
    """Whether values are names or marks, which are drawn at the places they have in their list."""
    return declared(axis.field).is_word


def _mark(axes: Axes, way: str, axis: Axis) -> None:
    """Mark the values of an axis along "x" or "y"."""
    axes.set(**{f"{way}scale": _scale(axis)})
    if _is_named(axis):
        ticks, names = range(len(axis.values)), list(map(str, axis.values))
        axes.set(**{f"{way}ticks": ticks, f"{way}ticklabels": names})


def _curves(axis: Axis, table: pd.DataFrame) -> Figure:
    figure, (first, *others) = kit.new_figure(1 + len(_CURVES), height=9.0)
    x = table[axis.field]
    known = [name for name in ("inverted", *figures.OUTCOMES) if name in set(table["outcome"])]
    first.plot(x, table["outcome"].map(known.index), "o", markersize=4, color="black")
    first.set_yticks(range(len(known)), known)
    first.set(ylim=(-0.5, len(known) - 0.5))
    for axes, (text, columns) in zip(others, _CURVES, strict=True):
        shown = [name for name in columns if table[name].notna().any()]
        for name, look in zip(shown, kit.MARKED, strict=False):
            (line,) = axes.plot(x, table[name], markersize=3, label=columns[name], **look)
            if _is_named(axis):
                line.set_linestyle("none")  # nothing lies between names
        if shown:
            kit.legend_above(axes)
        axes.set(ylabel=text)
    _mark(others[-1], "x", axis)
    others[-1].set(xlabel=axis.label)
    return figure


def _pairs(sweep: Sweep, table: pd.DataFrame) -> Figure:
    """Share of cases with an outcome over each axis, and over each pair of axes below."""
    design, count = sweep.design, len(sweep.design.axes)
    counted = "upper face" if sweep.plan.to_rest else "inverted"
    decided = ~table["outcome"].isin(("refused", "failed", "not decided"))
    table["hit"] = (table["outcome"] == counted).where(decided).astype(float)
    figure, axes = kit.new_figure(
        count, columns=count, width=1.6 * count + 1.2, height=1.4 * count + 0.8
    )
    image: Any = None
    for row, column in np.ndindex(count, count):
        each, up, right = axes[row, column], design.axes[row], design.axes[column]
        if column > row:
            each.set_axis_off()
            continue
        _mark(each, "x", right)
        if row == column:
            # Cases drawn on a range lie on no grid: as many each are counted together.
            values = table[up.field]
            is_few = up.values or design.layout == "grid" or len(values) < _BINS
            bins = values if is_few else pd.qcut(values, _BINS)
            shares = table.groupby(bins, observed=True)[[up.field, "hit"]].mean().dropna()
            each.plot(shares[up.field], shares["hit"], ".k" if _is_named(up) else ".-k", ms=4)
            each.set(ylim=(-0.05, 1.05))
        else:
            image = _scatter(each, table.groupby([right.field, up.field])["hit"].mean())
            _mark(each, "y", up)
            _thin(each, "y", up)
        _thin(each, "x", right)
        each.tick_params(labelsize=7, labelleft=column in (0, row))
        if row == count - 1:
            each.set_xlabel(fill(right.label, _LETTERS), fontsize=8)
        if column == 0:
            text = fill(up.label, _LETTERS) if row else f"share {counted}"
            each.set_ylabel(text, fontsize=8)
    figure.colorbar(image, ax=axes, label=f"share of cases: {counted}", shrink=0.6)
    varies = "model" in (axis.field for axis in sweep.design.axes)
    what = "several models" if varies else sweep.scenario.name
    title = f"Sweep of {what}: {decided.sum()} cases"
    without = f", × {(~decided).sum()} without a motion or not decided" * (not decided.all())
    figure.suptitle(fill(title + without, int(_TITLED * figure.get_figwidth())), fontsize=10)
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
