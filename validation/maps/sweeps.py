"""Pictures of sweeps: curves of the outcomes over one axis, a map over two, pairs of more."""

from collections.abc import Mapping
from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.data.written import is_text
from validation.kit import figures as kit
from validation.maps import figures
from validation.maps.panel import Panel, cell
from validation.maps.problems import label
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

_LETTERS = 20
"""Of a label in a line beside a panel of a pair."""

_BINS = 10
"""In which the cases that are drawn, and lie on no grid, are counted over an axis."""


def check_drawable(sweep: Sweep) -> None:
    """Raise `ValueError` if there is no picture of a sweep."""
    axes, layout = sweep.design.axes, sweep.design.layout
    if len(axes) > MOST_PAIRED:
        raise ValueError(f"at most {MOST_PAIRED} axes can be drawn, got {len(axes)}")
    if len(axes) > 1 and layout == "grid" and min(sweep.design.shape) < 2:
        raise ValueError("several axes can be drawn if each has two values at least")
    for axis in axes:
        if is_text(axis.field) or axis.field in ("model", "contact.bilateral"):
            raise ValueError(f"axis {axis.field} cannot be drawn, since it holds no measure")
        if list(axis.values) != sorted(axis.values):
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
    if len(results.axes) == 1:
        return _curves(results, cells["outcome"].tolist())
    title = f"Sweep of {sweep.scenario.name}"
    if len(results.axes) > 2 or sweep.design.layout != "grid":
        return _pairs(results, cells["outcome"].to_numpy(), title)
    figure = figures.draw([Panel(sweep=sweep, cells=cells)])
    up, right = sweep.design.axes
    figure.axes[0].set(xscale=_scale(right), yscale=_scale(up))
    return figure


def _scale(axis: Axis) -> str:
    return "log" if axis.log else "linear"


def _curves(results: Results, outcomes: list[str]) -> Figure:
    (axis,) = results.sweep.design.axes
    figure, axes = kit.new_figure(1 + len(_CURVES), height=9.0)
    order = np.argsort(results.columns[axis.field])
    x = results.columns[axis.field][order]
    named = [name for name in ("inverted", *figures.OUTCOMES) if name in outcomes]
    axes[0].plot(
        x, [named.index(outcomes[row]) for row in order], "o", markersize=4, color="black"
    )
    axes[0].set_yticks(range(len(named)), named)
    axes[0].set(ylim=(-0.5, len(named) - 0.5))
    for each, (text, columns) in zip(axes[1:], _CURVES, strict=True):
        shown = {told: results.columns[name][order] for name, told in columns.items()}
        _curve(each, x, shown)
        each.set(ylabel=text)
    axes[-1].set(xlabel=label(axis.field), xscale=_scale(axis))
    return figure


def _curve(axes: Axes, x: Any, columns: Mapping[str, Any]) -> None:
    shown = {told: values for told, values in columns.items() if np.any(np.isfinite(values))}
    for index, (told, values) in enumerate(shown.items()):
        look: Any = {"color": kit.COLOURS[index], "linestyle": kit.STYLES[index]}
        axes.plot(x, values, marker=kit.MARKERS[index], markersize=3, label=told, **look)
    if shown:
        kit.legend_above(axes)


def _pairs(results: Results, outcomes: Any, title: str) -> Figure:
    """Share of cases with an outcome over each axis, and over each pair of axes below."""
    design = results.sweep.design
    to_rest = results.sweep.plan.to_rest
    counted, told = ("upper face", "upper face up") if to_rest else ("inverted",) * 2
    judged = ~np.isin(outcomes, ("refused", "failed"))
    hits = np.where(judged, outcomes == counted, np.nan)
    values = [results.columns[axis.field] for axis in design.axes]
    labels = [fill(label(axis.field), _LETTERS) for axis in design.axes]
    count = len(values)
    figure, axes = kit.new_figure(count, columns=count, width=1.6 * count + 1.2,
                                  height=1.4 * count + 0.8)  # fmt: skip
    image: Any = None
    for row, column in np.ndindex(count, count):
        each = axes[row, column]
        if column > row:
            each.set_axis_off()
            continue
        each.set(xscale=_scale(design.axes[column]))
        if row == column:
            each.plot(*_shares(values[row], hits, binned=design.layout != "grid"), ".-k", ms=4)
            each.set(ylim=(-0.05, 1.05))
            each.set_ylabel(f"share {told}" if row == 0 else "", fontsize=8)
        else:
            image = _scatter(each, values[column], values[row], hits)
            each.set(yscale=_scale(design.axes[row]))
        each.tick_params(labelsize=7, labelleft=column in (0, row))
        if row == count - 1:
            each.set_xlabel(labels[column], fontsize=8)
        if column == 0 < row:
            each.set_ylabel(labels[row], fontsize=8)
    figure.colorbar(image, ax=axes, label=f"share of cases: {told}", shrink=0.6)
    without = np.count_nonzero(~judged)
    title = f"{title}: {np.count_nonzero(judged)} cases"
    figure.suptitle(title + (f", × {without} without a motion" if without else ""), fontsize=10)
    return figure


def _shares(values: Any, hits: Any, *, binned: bool) -> tuple[Any, Any]:
    """Mean of what is hit over the values of an axis, or over bins with equally many cases."""
    if binned:
        order = np.argsort(values)
        parts = np.array_split(order, min(_BINS, len(order)))
    else:
        parts = [np.flatnonzero(values == value) for value in np.unique(values)]
    parts = [part for part in parts if np.any(np.isfinite(hits[part]))]
    return [values[part].mean() for part in parts], [np.nanmean(hits[part]) for part in parts]


def _scatter(axes: Axes, x: Any, y: Any, hits: Any) -> Any:
    """The same over two axes, as coloured points; crosses where there is nothing to count."""
    share = pd.DataFrame({"x": x, "y": y, "hit": hits}).groupby(["x", "y"])["hit"].mean()
    some, none = share.dropna().reset_index(), share[share.isna()].reset_index()
    axes.plot(none["x"], none["y"], "x", color="#999999", markersize=3)
    look: Any = {"s": 9, "cmap": "viridis", "vmin": 0.0, "vmax": 1.0, "zorder": 3}
    return axes.scatter(some["x"], some["y"], c=some["hit"], **look)
