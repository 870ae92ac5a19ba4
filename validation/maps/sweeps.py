"""Pictures of sweeps: curves of the outcomes over one axis, a map over two, pairs of more."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.data.written import is_text, unit
from validation.kit import figures as kit
from validation.maps import figures
from validation.maps.problems import Problem, classify
from validation.maps.run import Panel
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

_BINS = 10
"""In which the cases that are drawn, and lie on no grid, are counted over an axis."""


def check_drawable(sweep: Sweep) -> None:
    """Raise `ValueError` if there is no picture of a sweep."""
    axes, layout = sweep.design.axes, sweep.design.layout
    if len(axes) > MOST_PAIRED:
        raise ValueError(f"at most {MOST_PAIRED} axes can be drawn, got {len(axes)}")
    if len(axes) > 1 and layout == "grid" and min(axis.size or 0 for axis in axes) < 2:
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
    if len(results.axes) == 1:
        return _curves(results)
    is_map = len(results.axes) == 2 and results.sweep.design.layout == "grid"
    return _map(results) if is_map else _pairs(results)


def _classes(results: Results, problem: Problem) -> dict[int, str]:
    judge, columns = classify(problem), results.columns
    rows: list[dict[str, Any]] = [
        dict(zip(columns, cells, strict=True))
        for cells in zip(*(column.tolist() for column in columns.values()), strict=True)
    ]
    return {row["number"]: judge(results.sweep.scenario, row) for row in rows}


def _problem(sweep: Sweep) -> Problem:
    """The sweep as a map, its last axis to the right; a single axis counts as both."""
    right, up = sweep.design.axes[-1], sweep.design.axes[0]
    return Problem(
        title=f"Sweep of {sweep.scenario.name}",
        axes=tuple((axis.field, *_ends(axis)) for axis in (right, up)),  # type: ignore[arg-type]
        labels=(_label(right), _label(up)),
        to_rest=sweep.plan.to_rest,
    )


def _ends(axis: Axis) -> tuple[Any, Any]:
    return (axis.values[0], axis.values[-1]) if axis.values else (axis.first, axis.last)


def _label(axis: Axis) -> str:
    name, measure = axis.field.replace("_", " ").replace(".", ": "), unit(axis.field)
    return f"{name} in {measure}" if measure else name


def _map(results: Results) -> Figure:
    problem = _problem(results.sweep)
    panel = Panel.of(problem, _classes(results, problem), results)
    figure = figures.draw([panel], theory=False)
    up, right = results.sweep.design.axes
    figure.axes[0].set(xscale=_scale(right), yscale=_scale(up))
    return figure


def _scale(axis: Axis) -> str:
    return "log" if axis.log else "linear"


def _curves(results: Results) -> Figure:
    (axis,) = results.sweep.design.axes
    figure, axes = kit.new_figure(1 + len(_CURVES), height=9.0)
    order = np.argsort(results.columns[axis.field])
    x = results.columns[axis.field][order]
    problem = _problem(results.sweep)
    found = _classes(results, problem)
    classes = [found[number] for number in results.columns["number"][order].tolist()]
    named = [name for name in ("inverted", *figures.GREYS) if name in classes]
    axes[0].plot(x, [named.index(name) for name in classes], "o", markersize=4, color="black")
    axes[0].set_yticks(range(len(named)), named)
    axes[0].set(ylim=(-0.5, len(named) - 0.5))
    for each, (label, columns) in zip(axes[1:], _CURVES, strict=True):
        _curve(each, x, {told: results.columns[name][order] for name, told in columns.items()})
        each.set(ylabel=label)
    axes[-1].set(xlabel=_label(axis), xscale=_scale(axis))
    return figure


def _curve(axes: Axes, x: Any, columns: Mapping[str, Any]) -> None:
    shown = {told: values for told, values in columns.items() if np.any(np.isfinite(values))}
    for index, (told, values) in enumerate(shown.items()):
        look: Any = {"color": kit.COLOURS[index], "linestyle": kit.STYLES[index]}
        axes.plot(x, values, marker=kit.MARKERS[index], markersize=3, label=told, **look)
    if shown:
        kit.legend_above(axes)


def _pairs(results: Results) -> Figure:
    """Share of cases with an outcome over each axis, and over each pair of axes below."""
    design, problem = results.sweep.design, _problem(results.sweep)
    counted, label = ("upper face", "upper face up") if problem.to_rest else ("inverted",) * 2
    classes = _classes(results, problem)
    told = np.array([classes[number] for number in results.columns["number"].tolist()])
    judged = ~np.isin(told, ("refused", "failed"))
    hits = np.where(judged, told == counted, np.nan)
    values = [results.columns[axis.field] for axis in design.axes]
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
            each.set_ylabel(f"share {label}" if row == 0 else "", fontsize=8)
        else:
            image = _scatter(each, values[column], values[row], hits)
            each.set(yscale=_scale(design.axes[row]))
        each.tick_params(labelsize=7, labelleft=column in (0, row))
        if row == count - 1:
            each.set_xlabel(_label(design.axes[column]).replace(": ", ":\n"), fontsize=8)
        if column == 0 < row:
            each.set_ylabel(_label(design.axes[row]).replace(": ", ":\n"), fontsize=8)
    figure.colorbar(image, ax=axes, label=f"share of cases: {label}", shrink=0.6)
    title = f"{problem.title}: {np.count_nonzero(judged)} cases"
    without = np.count_nonzero(~judged)
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
    places, index = np.unique(np.column_stack((x, y)), axis=0, return_inverse=True)
    known = np.isfinite(hits)
    counts = np.bincount(index[known], minlength=len(places))
    found = np.bincount(index[known], weights=hits[known], minlength=len(places))
    some = counts > 0
    share = found[some] / counts[some]
    (right, up), (empty_right, empty_up) = places[some].T, places[~some].T
    axes.plot(empty_right, empty_up, "x", color="#999999", markersize=3)
    look: Any = {"s": 9, "cmap": "viridis", "vmin": 0.0, "vmax": 1.0, "zorder": 3}
    return axes.scatter(right, up, c=share, **look)
