"""Pictures of sweeps: curves of the outcomes over one axis, a map over two."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.data.fields import is_text, unit
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


def check_drawable(sweep: Sweep) -> None:
    """Raise `ValueError` if there is no picture of a sweep."""
    axes, layout = sweep.design.axes, sweep.design.layout
    if len(axes) > 2:
        raise ValueError(f"one or two axes can be drawn, got {len(axes)}")
    if len(axes) == 2 and layout != "grid":
        raise ValueError(f"two axes can be drawn on a grid, got layout {layout}")
    if len(axes) == 2 and min(axis.size or 0 for axis in axes) < 2:
        raise ValueError("two axes can be drawn if each has two values at least")
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
    return _curves(results) if len(results.axes) == 1 else _map(results)


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
