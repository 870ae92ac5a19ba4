"""Figures of the study of numerical stability."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis import Level
from validation.kit.figures import (
    COLOURS,
    MARKERS,
    STYLES,
    Picture,
    legend_above,
    new_figure,
    render,
)
from validation.studies.robustness.cases import TOLERANCE
from validation.studies.robustness.drift import Drift
from validation.studies.robustness.penalty_limit import PenaltyError
from validation.studies.robustness.run import Outcome, Verdict
from validation.studies.robustness.steps import ACCURACY, Axis, StepLimit
from validation.studies.work_precision.figures import LOOKS, NAMES

_BANDS: dict[Verdict, str] = {
    "reference in doubt": "in doubt",
    "time limit": "time limit",
    "not finished in the limit": "not finished",
    "diverged": "diverged",
    "refused": "refused",
    "crashed": "crashed",
}
"""Verdicts without an error, from the lowest to the highest band above them, and their names."""

_LOWEST = 1e-13


def verdicts(outcomes: Sequence[Outcome]) -> list[Picture]:
    """Error or failure of every case, one panel per axis, one picture per model.

    Sets of constraints that are none of the paper's models share a picture.
    """
    levels = dict.fromkeys(outcome.level for outcome in outcomes)
    return [
        _verdicts(level, [each for each in outcomes if each.level == level]) for level in levels
    ]


def _verdicts(level: Level | None, outcomes: Sequence[Outcome]) -> Picture:
    by_axis: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        by_axis.setdefault(outcome.axis, []).append(outcome)
    failed = [
        verdict
        for verdict in _BANDS
        if any(each.verdict == verdict and each.error is None for each in outcomes)
    ]
    bands = {verdict: 10.0 ** (2 * row + 2) for row, verdict in enumerate(failed)}
    rows, columns = (len(by_axis) + 2) // 3, min(len(by_axis), 3)
    # Labels of many lines leave too little of a panel.
    breaks = max(_broken(outcome.label).count("\n") for outcome in outcomes)
    height = rows * (3.0 + 0.2 * len(failed) + 0.4 * max(breaks - 1, 0))
    figure = Figure(figsize=(10.5, height), layout="constrained")
    panels = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for panel in panels.flat[len(by_axis) :]:
        panel.set_axis_off()
    for panel, (axis, found) in zip(panels.flat, by_axis.items(), strict=False):
        panel.set_title(axis, fontsize=10, loc="left")
        _panel(panel, found, bands)
    panels.flat[0].annotate(
        "asked for",
        (1.0, TOLERANCE),
        xycoords=("axes fraction", "data"),
        ha="right",
        va="bottom",
        fontsize=8,
        color="#777777",
    )
    for panel in panels.flat[: len(by_axis)]:
        # Each panel may stand alone on a narrow screen.
        panel.tick_params(labelleft=True)
        panel.set_ylabel("error of β, γ in rad")
    _legend(figure, panels.flat[0], {outcome.way.formulation for outcome in outcomes})
    return render(
        figure,
        name="robustness-other-sets" if level is None else f"robustness-model-{level}",
        title=f"Hard cases, {'other sets' if level is None else f'Model {level}'}",
        caption="Each mark is a run with one integrator; dotted: the largest error that was asked "
        "for. Hollow: accurate up to where the run ends early. Above the line, if there are any: "
        "runs without a result. Crosses: results that are inaccurate in an angle, in the energy "
        "or in where they end.",
        stacked=True,
    )


def _broken(label: str) -> str:
    return label.replace(", ", ",\n").replace(" + ", " +\n")


def _legend(figure: Figure, panel: Axes, used: set[str]) -> None:
    for name, text in NAMES.items():
        if name in used:
            colour, marker = LOOKS[name]
            panel.plot([], [], linestyle="none", color=colour, marker=marker, label=text)
    figure.legend(
        handles=panel.get_legend_handles_labels()[0],
        loc="outside upper center",
        ncols=2,
        frameon=False,
    )


def _panel(axes: Axes, outcomes: Sequence[Outcome], bands: Mapping[Verdict, float]) -> None:
    """Errors over the cases of an axis; what gave none lies in bands above."""
    labels = list(dict.fromkeys(outcome.label for outcome in outcomes))
    ways = list(dict.fromkeys(outcome.way for outcome in outcomes))
    # Marks that look alike are drawn together, which takes a fraction of the time.
    looks: dict[tuple[str, str, bool, bool], list[tuple[float, float]]] = {}
    for outcome in outcomes:
        place = (ways.index(outcome.way) + 0.5) / len(ways) - 0.5
        error = bands.get(outcome.verdict, 1.0)
        if outcome.error is not None:
            error = min(max(outcome.error, _LOWEST), 1.0)
        crossed = outcome.verdict == "inaccurate"
        look = (*LOOKS[outcome.way.formulation], crossed, outcome.verdict.startswith("ends"))
        looks.setdefault(look, []).append((labels.index(outcome.label) + 0.7 * place, error))
    for (colour, marker, crossed, hollow), points in looks.items():
        axes.plot(
            *zip(*points, strict=True),
            linestyle="none",
            marker="X" if crossed else marker,
            markersize=8 if crossed else 4.5,
            color=colour,
            fillstyle="none" if hollow else "full",
        )
    asked = {labels.index(each.label): each.tolerance for each in outcomes}
    low, high = ([number + side for number in asked] for side in (-0.5, 0.5))
    axes.hlines(list(asked.values()), low, high, color="#777777", linewidth=0.8, linestyle=":")
    if bands:
        axes.axhline(10.0, color="#777777", linewidth=0.8)
    top = 10.0 * max(bands.values(), default=0.1)
    axes.set(yscale="log", ylim=(0.3 * _LOWEST, top), xlim=(-0.6, len(labels) - 0.4))
    errors = [10.0**-digits for digits in (12, 9, 6, 3, 0)]
    axes.set_yticks(
        [*errors, *bands.values()],
        [
            *(f"$10^{{{-digits}}}$" for digits in (12, 9, 6, 3, 0)),
            *(_BANDS[each] for each in bands),
        ],
    )
    axes.minorticks_off()
    axes.set_xticks(
        range(len(labels)),
        [_broken(each) for each in labels],
        rotation=50,
        ha="right",
        rotation_mode="anchor",
        fontsize=8,
    )
    axes.spines[["right", "top"]].set_visible(False)
    axes.grid(axis="y", alpha=0.3)


def steps(limits: Sequence[StepLimit], axis: Axis, axes: Axes | None = None) -> Picture:
    """Largest steps over the smoothing or the stiffness."""
    figure = None
    if axes is None:
        figure, axes = new_figure(height=6.5)
    assert axes is not None
    chosen = [limit for limit in limits if limit.axis == axis]
    _stable(axes, [limit for limit in chosen if limit.kind == "stable"])
    _accurate(axes, [limit for limit in chosen if limit.kind == "accurate"])
    names = {"smoothing": "smoothing ε in m/s", "stiffness": "contact stiffness in N/m"}
    axes.set(xscale="log", yscale="log", xlabel=names[axis], ylabel="largest step in s")
    if axis == "smoothing":
        axes.invert_xaxis()
    legend_above(axes, columns=1)
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
    axes[0].set(ylabel="position residual\nso far in m", ylim=(1e-16, None))
    axes[1].set(ylabel="energy residual so far\n/ (weight · radius)", xlabel="time in s")
    legend_above(axes[0], columns=1, size=8.5)
    return render(
        figure,
        name="drift",
        title="Constraint drift and energy balance over time",
        caption="Largest residual so far, from Table 3. Minimal coordinates have no position "
        "residual to show. The energy residual holds the error of Simpson's rule over the samples "
        "that integrates the work of friction, some 4e-7.",
    )


def _envelope(values: Any) -> Any:
    largest = np.maximum.accumulate(np.abs(values))
    return np.where(largest > 0.0, largest, np.nan)
