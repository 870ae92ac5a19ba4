"""Diagrams of error against run time."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.figures import Picture, render
from validation.work_precision.problems import PROBLEMS, Agreement, ProblemName
from validation.work_precision.runs import Run, curves, front, observed_order

GOALS = (1e-3, 1e-6, 1e-9)
"""Errors to be reached."""

LOOKS: dict[str, tuple[str, str]] = {
    "contact-tree": ("#000000", "o"),
    "euler-tree": ("#0072b2", "s"),
    "floating": ("#d55e00", "^"),
    "floating-lie": ("#cc79a7", "v"),
    "index-1": ("#009e73", "D"),
    "reduced": ("#8a8a8a", "P"),
}
"""Colour and marker of each formulation; they differ in grey, too."""

NAMES = {
    "contact-tree": "contact tree",
    "euler-tree": "Euler tree",
    "floating": "floating, Euler parameters",
    "floating-lie": "floating, Lie group",
    "index-1": "in-house, index 1 (Python)",
    "reduced": "in-house, reduced (Python)",
}

_LOWEST, _HIGHEST = 3e-12, 1.0


def fronts(runs: Sequence[Run], agreements: Mapping[ProblemName, Agreement]) -> Picture:
    """What each formulation can do with the best of its integrators, one panel per problem."""
    figure, axes = _grid()
    by_problem = curves(runs, lambda run: run.problem)
    for panel, name in zip(axes.flat, PROBLEMS, strict=False):
        _panel(panel, PROBLEMS[name].title, agreements[name].floor)
        groups = curves(by_problem.get(name, []), lambda run: run.formulation)
        for formulation, group in groups.items():
            _line(panel, front(group), formulation, floor=agreements[name].floor)
    energy = axes.flat[len(PROBLEMS)]
    _energy_panel(energy, by_problem.get("undamped", []))
    _labels(axes)
    _legend(figure, axes, list(LOOKS))
    return render(
        figure,
        name="work-precision",
        title="Error against run time of each formulation",
        caption="Down and to the left is better. Each line joins the runs of a formulation that "
        "no other run of it beats in both time and error, with any integrator, extrapolated or "
        "not. Dotted: the goals of the table. Shaded: where the references no longer agree; "
        "better runs are drawn on its edge.",
    )


def orders(runs: Sequence[Run], agreements: Mapping[ProblemName, Agreement]) -> Picture:
    """Single methods with their observed orders, one panel per problem."""
    figure, axes = _grid()
    by_problem = curves(runs, lambda run: run.problem)
    for panel, name in zip(axes.flat, PROBLEMS, strict=False):
        floor = agreements[name].floor
        _panel(panel, PROBLEMS[name].title, floor)
        for group in curves(by_problem.get(name, [])).values():
            if _shown(group[0]):
                line = [run for run in group if run.error < _HIGHEST]
                _line(
                    panel,
                    line,
                    group[0].formulation,
                    floor=floor,
                    extrapolated=group[0].extrapolated,
                )
                if not group[0].extrapolated:
                    _order(panel, line, observed_order(group, floor), floor)
    axes.flat[-1].set_axis_off()
    axes[1, 2].tick_params(labelbottom=True)
    axes[1, 2].set_xlabel("processor time in ms")
    _labels(axes)
    _legend(figure, axes, [name for name in LOOKS if name != "reduced"])
    return render(
        figure,
        name="work-precision-orders",
        title="Error against run time of single methods",
        caption="Contact tree: RK44, RK67 and DOPRI5; other formulations: trapezoidal rule, "
        "dashed if extrapolated; in-house: DOP853 and Radau. At the end of the measurable "
        "part of each line its observed order. Rungs whose run failed are gaps.",
    )


def _grid() -> tuple[Figure, Any]:
    """Three by three panels; all problems and one to spare."""
    figure = Figure(figsize=(10.5, 10.0), layout="constrained")
    axes = figure.subplots(3, 3, sharex=True)
    for panel in axes.flat:
        panel.spines[["right", "top"]].set_visible(False)
        panel.grid(alpha=0.3)
    return figure, axes


_SHOWN = {"RK44", "RK67", "DOPRI5", "trapezoidal", "DOP853", "Radau"}


def _shown(run: Run) -> bool:
    explicit = run.formulation == "contact-tree"
    if run.variant or run.formulation == "reduced" or (explicit and run.extrapolated):
        return False
    return run.scheme in _SHOWN - ({"trapezoidal"} if explicit else set())


def _panel(axes: Axes, title: str, floor: float) -> None:
    axes.set_title(title, fontsize=10, loc="left")
    axes.set(xscale="log", yscale="log", ylim=(_LOWEST, _HIGHEST))
    axes.set_yticks([10.0**-digits for digits in range(0, 12, 3)])
    for goal in GOALS:
        axes.axhline(goal, color="#777777", linewidth=0.8, linestyle=":")
    axes.axhspan(_LOWEST, floor, color="#e6e6e6", zorder=0)


def _line(
    axes: Axes,
    runs: Sequence[Run],
    formulation: str,
    *,
    floor: float,
    extrapolated: bool = False,
) -> None:
    """Draw runs, the ones that are too good to be measured on the edge of what can be."""
    colour, marker = LOOKS[formulation]
    axes.plot(
        [1e3 * run.seconds for run in runs],
        [max(run.error, floor) for run in runs],
        color=colour,
        marker=marker,
        markersize=4.5,
        markerfacecolor="white" if extrapolated else colour,
        linestyle="--" if extrapolated else "-",
        linewidth=1.2,
    )


def _order(axes: Axes, runs: Sequence[Run], order: float | None, floor: float) -> None:
    shown = [run for run in runs if run.error > floor]
    if order is None or not shown:
        return
    last = min(shown, key=lambda run: run.error)
    axes.annotate(
        f"{order:.1f}",
        (1e3 * last.seconds, last.error),
        xytext=(4, 0),
        textcoords="offset points",
        fontsize=7.5,
        color=LOOKS[last.formulation][0],
    )


def _energy_panel(axes: Axes, runs: Sequence[Run]) -> None:
    """Error in the energy of the undamped problem, which ought to stay constant."""
    axes.set_title("Undamped: error in the energy", fontsize=10, loc="left")
    axes.set(xscale="log", yscale="log", ylabel="energy error in J")
    for formulation, group in curves(runs, lambda run: run.formulation).items():
        colour, marker = LOOKS[formulation]
        points: list[tuple[float, float]] = []
        useful = [run for run in group if run.error < _HIGHEST]
        for run in sorted(useful, key=lambda run: run.seconds):
            if run.errors is not None:
                energy = max(run.errors.energy, 1e-16)
                if not points or energy < points[-1][1]:
                    points.append((1e3 * run.seconds, energy))
        axes.plot(*np.array(points).reshape(-1, 2).T, color=colour, marker=marker, markersize=4.5)


def _labels(axes: Any) -> None:
    for panel in axes[-1]:
        panel.set_xlabel("processor time in ms")
    for panel in axes[:, 0]:
        panel.set_ylabel("largest error in rad")


def _legend(figure: Figure, axes: Any, formulations: Sequence[str]) -> None:
    panel = axes.flat[0]
    handles = [
        panel.plot([], [], color=LOOKS[name][0], marker=LOOKS[name][1], label=NAMES[name])[0]
        for name in formulations
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
