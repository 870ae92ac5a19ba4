"""Figures of the study of numerical stability."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from validation.figures import COLOURS, MARKERS, STYLES, Picture, legend_above, new_figure, render
from validation.penalty_limit import PenaltyError
from validation.robustness_drift import Drift
from validation.robustness_run import Outcome
from validation.robustness_steps import ACCURACY, Axis, StepLimit

_LOOKS: dict[str, tuple[str, str]] = {
    "accurate": (COLOURS[3], "o"),
    "inaccurate": (COLOURS[2], "X"),
    "diverged": (COLOURS[1], "s"),
    "refused": ("#777777", "d"),
    "too slow": (COLOURS[0], "v"),
    "crashed": (COLOURS[0], "*"),
}
"""Colour and marker of each verdict; the markers tell them apart in grey."""


def outcome_map(outcomes: Sequence[Outcome]) -> Picture:
    """Verdict of every case: problems down, ways across."""
    problems = list(dict.fromkeys(outcome.problem for outcome in outcomes))
    names = list(dict.fromkeys(outcome.way.name for outcome in outcomes))
    rows = {problem: row for row, problem in enumerate(problems)}
    figure, axes = new_figure(width=8.5, height=1.8 + 0.2 * len(problems))
    for verdict, (colour, marker) in _LOOKS.items():
        chosen = [outcome for outcome in outcomes if outcome.verdict == verdict]
        if chosen:
            axes.plot(
                [names.index(outcome.way.name) for outcome in chosen],
                [rows[outcome.problem] for outcome in chosen],
                linestyle="none",
                marker=marker,
                color=colour,
                label=verdict,
            )
    labels = [f"{each.axis}: {each.label} (Model {each.level})" for each in problems]
    axes.set_yticks(range(len(problems)), labels, fontsize=8)
    ticks = [name.replace(", ", "\n") for name in names]
    axes.set_xticks(range(len(names)), ticks, rotation=45, ha="right", fontsize=8)
    axes.set(ylim=(len(problems) - 0.5, -0.5), xlim=(-0.5, len(names) - 0.5))
    legend_above(axes, columns=6)
    return render(
        figure,
        name="robustness",
        title="Hard cases",
        caption="Each mark is a run to its end or to its own failure.",
    )


def steps(limits: Sequence[StepLimit], axis: Axis, axes: Axes | None = None) -> Picture:
    """Largest steps over the smoothing or the stiffness."""
    figure = None
    if axes is None:
        figure, axes = new_figure(height=5.0)
    assert axes is not None
    chosen = [limit for limit in limits if limit.axis == axis]
    _stable(axes, [limit for limit in chosen if limit.kind == "stable"])
    _accurate(axes, [limit for limit in chosen if limit.kind == "accurate"])
    names = {"smoothing": "smoothing ε in m/s", "stiffness": "contact stiffness in N/m"}
    axes.set(xscale="log", yscale="log", xlabel=names[axis], ylabel="largest step in s")
    if axis == "smoothing":
        axes.invert_xaxis()
    legend_above(axes, columns=2)
    return render(
        figure or axes.figure,  # type: ignore[arg-type]  # axes of a figure of their own
        name=f"steps-{axis}",
        title=f"Largest steps over the {axis}",
        caption="Lines: largest stable step predicted from the fastest eigenvalue and the "
        "stability function measured on the engine; crosses on them: measured. Other markers: "
        f"largest step whose error from Table 3 stays below {ACCURACY:g} rad; missing where no "
        "step that was tried does.",
    )


def _stable(axes: Axes, limits: Sequence[StepLimit]) -> None:
    for index, name in enumerate(dict.fromkeys(limit.integrator for limit in limits)):
        found = [limit for limit in limits if limit.integrator == name]
        values = [limit.value for limit in found]
        axes.plot(
            values,
            [np.nan if limit.predicted is None else limit.predicted for limit in found],
            color=COLOURS[index],
            linestyle=STYLES[index],
            label=f"stable, {found[0].formulation}, {name}: predicted",
        )
        axes.plot(
            values,
            [np.nan if limit.step is None else limit.step for limit in found],
            color=COLOURS[index],
            linestyle="none",
            marker="x+"[index],
            markersize=8,
            label=f"stable, {found[0].formulation}, {name}: measured",
        )


def _accurate(axes: Axes, limits: Sequence[StepLimit]) -> None:
    ways = dict.fromkeys((limit.formulation, limit.integrator) for limit in limits)
    for index, way in enumerate(ways):
        found = [limit for limit in limits if (limit.formulation, limit.integrator) == way]
        axes.plot(
            # Shifted a little, so that equal steps do not hide each other.
            [limit.value * 10 ** (0.06 * (index - 1.5)) for limit in found],
            [np.nan if limit.step is None else limit.step for limit in found],
            linestyle="none",
            marker=MARKERS[index],
            markerfacecolor="white",
            color=COLOURS[index],
            label=f"accurate, {way[0]}, {way[1]}",
        )


def penalty(errors: Sequence[PenaltyError]) -> Picture:
    """Difference of the penalty contact from the ideal one over its stiffness."""
    figure, axes = new_figure()
    for index, load in enumerate(dict.fromkeys(error.load for error in errors)):
        found = [error for error in errors if error.load == load]
        axes.plot(
            [error.stiffness for error in found],
            [error.angles for error in found],
            color=COLOURS[1 + index],
            linestyle=STYLES[index],
            marker=MARKERS[index],
            label=f"load {'$λ_N$' if load == 'contact' else '$m g$'}",
        )
    first = errors[0]
    stiffness = np.array([first.stiffness, errors[-1].stiffness])
    axes.plot(
        stiffness,
        2.0 * first.angles * first.stiffness / stiffness,
        color="#999999",
        linewidth=0.8,
        label="one over the stiffness",
    )
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="contact stiffness in N/m",
        ylabel="largest difference of β, γ\nfrom Model 1 in rad",
    )
    legend_above(axes, columns=3)
    return render(
        figure,
        name="penalty",
        title="The penalty contact tends to the ideal one",
        caption="Half of critical damping, 0.5 s from Table 3 lowered by the resting penetration; "
        "errors of integration lie at least two digits below.",
    )


def drifts(found: Sequence[Drift]) -> Picture:
    """Position residuals and energy balance over time."""
    figure, axes = new_figure(2, height=8.0)
    for index, each in enumerate(each for each in found if not each.failure):
        look: Any = {
            "color": COLOURS[index % len(COLOURS)],
            "linestyle": STYLES[(index + index // len(COLOURS)) % len(STYLES)],
            "linewidth": 1.2,
        }
        axes[0].plot(each.times, _envelope(each.position), label=each.runner.label, **look)
        axes[1].plot(each.times, _envelope(each.energy), **look)
    for axis in axes:
        axis.set_yscale("log")
    axes[0].set(ylabel="position residual\nso far in m")
    axes[1].set(ylabel="energy residual so far\n/ (weight · radius)", xlabel="time in s")
    legend_above(axes[0], columns=1)
    return render(
        figure,
        name="drift",
        title="Constraint drift and energy balance over time",
        caption="Largest residual so far, from Table 3. Minimal coordinates have no position "
        "residual to show.",
    )


def _envelope(values: Any) -> Any:
    largest = np.maximum.accumulate(np.abs(values))
    return np.where(largest > 0.0, largest, np.nan)
