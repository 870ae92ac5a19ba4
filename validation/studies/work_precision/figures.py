"""Diagrams of error against run time and against work."""

from collections.abc import Callable, Iterable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validation.kit.figures import Picture, render
from validation.studies.work_precision.problems import PROBLEMS, ProblemName
from validation.studies.work_precision.runs import (
    GOALS,
    Curve,
    Run,
    by_hindsight,
    front,
    grouped,
    observed_order,
)
from validation.studies.work_precision.stored import Study

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
_LEAST_ENERGY = 1e-16


def fronts(study: Study, here: Study | None = None) -> Picture:
    """What each formulation can do with the best of its integrators, one panel per problem.

    Parameters
    ----------
    study : Study
        Whose curves are drawn.
    here : Study, optional
        Quick study on the spot, laid over.
    """
    figure, panels, spare = _panels(study)
    for name, panel in panels.items():
        floor = _floor(study, panel, name)
        runs = [run for curve in study.of(name) for run in curve.runs]
        for formulation, group in grouped(runs, lambda run: run.formulation).items():
            told = _measurable(front(group), floor)
            _line(panel, told, formulation, cost=_milliseconds, floor=floor)
        if here is not None:
            spot = [run for curve in here.of(name) for run in curve.runs]
            for formulation, group in grouped(spot, lambda run: run.formulation).items():
                _crosses(panel, _measurable(front(group), floor), formulation, floor)
    if "undamped" in panels:
        _energy_panel(spare, study)
    else:
        spare.set_axis_off()
    _labels(panels.values(), "processor time in ms")
    handles = _handles(LOOKS)
    if here is not None:
        handles.append(_key("#444444", "x", "measured on the spot"))
        handles[-1].set_linestyle("")
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)
    spot_text = " Crosses: the quick selection, measured on the spot." if here else ""
    return render(
        figure,
        name="work-precision",
        title="Error against run time of each formulation",
        caption="Down and to the left is better. Each line joins the runs of a formulation that "
        "no other run of it beats in both time and error, with any integrator, extrapolated or "
        "not. Dotted: the goals of the tables. Shaded: where the references no longer agree; "
        f"better runs are drawn on its edge.{spot_text}",
        stacked=True,
    )


def orders(study: Study) -> Picture:
    """Single methods against their work, with observed orders, one panel per problem."""
    figure, panels, spare = _panels(study)
    for name, panel in panels.items():
        floor = _floor(study, panel, name)
        told: list[tuple[Curve, float | None]] = []
        for curve in study.of(name):
            for kind, group in grouped(curve.runs, lambda run: run.kind).items():
                if not _shown(group[0]):
                    continue
                line = [run for run in group if run.error < _HIGHEST]
                extrapolated = kind == "extrapolated"
                _line(
                    panel,
                    line,
                    curve.formulation,
                    cost=lambda run: run.work,
                    floor=floor,
                    extrapolated=extrapolated,
                )
                if line and curve.scheme != "trapezoidal":
                    _tell_scheme(panel, line[0], floor)
                if not extrapolated:
                    told.append((curve, observed_order(group, floor).value))
        _tell_orders(panel, told)
    spare.set_axis_off()
    handles = _handles({name: LOOKS[name] for name in LOOKS if name != "reduced"})
    handles += [
        _key("#444444", "", "one step size or tolerance"),
        Line2D(
            [],
            [],
            color="#444444",
            linestyle="--",
            marker="o",
            markerfacecolor="white",
            markersize=4.5,
            label="extrapolated, all runs counted",
        ),
    ]
    spare.legend(handles=handles, loc="center", frameon=False, fontsize=9.5)
    _labels(panels.values(), "evaluations")
    return render(
        figure,
        name="work-precision-orders",
        title="Error against work of single methods",
        caption="The same on every machine. Evaluations of the right-hand side, one per Newton "
        "iteration. Contact tree: RK44, RK67 and DOPRI5; other formulations: trapezoidal rule; "
        "in-house: DOP853 and Radau. In the corners: observed orders, where four rungs tell one.",
        stacked=True,
    )


def _panels(study: Study) -> tuple[Figure, dict[ProblemName, Axes], Axes]:
    """A panel for each problem of the study, three in a row, and one to spare."""
    names = [name for name in PROBLEMS if study.of(name)]
    rows = 1 + len(names) // 3
    figure = Figure(figsize=(10.5, 0.4 + 3.2 * rows), layout="constrained")
    axes = list(figure.subplots(rows, 3, squeeze=False, sharex=True).flat)
    for panel in axes:
        panel.tick_params(labelbottom=True)
        panel.spines[["right", "top"]].set_visible(False)
        panel.grid(alpha=0.3)
    panels = dict(zip(names, axes, strict=False))
    for panel in axes[len(names) + 1 :]:
        panel.set_axis_off()
    return figure, panels, axes[len(names)]


def _milliseconds(run: Run) -> float:
    return 1e3 * run.seconds


def _measurable(runs: Sequence[Run], floor: float) -> list[Run]:
    """Runs up to the first that is too good to be measured: no later one is told from it."""
    above = [run for run in runs if run.error > floor]
    return [*above, *runs[len(above) : len(above) + 1]]


_SHOWN = {"RK44", "RK67", "DOPRI5", "trapezoidal", "DOP853", "Radau"}


def _shown(run: Run) -> bool:
    explicit = run.formulation == "contact-tree"
    if run.kind == "tolerance" or run.formulation == "reduced":
        return False
    if explicit and run.kind == "extrapolated":
        return False
    return run.scheme in _SHOWN - ({"trapezoidal"} if explicit else set())


def _floor(study: Study, axes: Axes, name: ProblemName) -> float:
    """Prepare a panel; smallest error that can be told in it."""
    axes.set_title(PROBLEMS[name].title, fontsize=10, loc="left")
    axes.set(xscale="log", yscale="log", ylim=(_LOWEST, _HIGHEST))
    axes.margins(x=0.12)
    axes.set_yticks([10.0**-digits for digits in range(0, 12, 3)])
    for goal in GOALS:
        axes.axhline(goal, color="#777777", linewidth=0.8, linestyle=":")
    floor = study.agreements[name].floor
    axes.axhspan(_LOWEST, floor, color="#e6e6e6", zorder=0)
    return floor


def _line(
    axes: Axes,
    runs: Sequence[Run],
    formulation: str,
    *,
    cost: Callable[[Run], float],
    floor: float,
    extrapolated: bool = False,
) -> None:
    """Draw runs, the ones that are too good to be measured on the edge of what can be."""
    colour, marker = LOOKS[formulation]
    axes.plot(
        [cost(run) for run in runs],
        [max(run.error, floor) for run in runs],
        color=colour,
        marker=marker,
        markersize=4.5,
        markerfacecolor="white" if extrapolated else colour,
        linestyle="--" if extrapolated else "-",
        linewidth=1.2,
    )


def _crosses(axes: Axes, runs: Sequence[Run], formulation: str, floor: float) -> None:
    axes.plot(
        [_milliseconds(run) for run in runs],
        [max(run.error, floor) for run in runs],
        color=LOOKS[formulation][0],
        marker="x",
        markersize=7,
        linestyle="",
    )


def _tell_scheme(axes: Axes, first: Run, floor: float) -> None:
    """Write the name of an integrator to the left of its first run."""
    axes.annotate(
        first.scheme,
        (first.work, max(first.error, floor)),
        xytext=(-5, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize=8,
        color=LOOKS[first.formulation][0],
    )


def _tell_orders(axes: Axes, told: Sequence[tuple[Curve, float | None]]) -> None:
    """Write orders, where there are any, into the corner that the curves leave free."""
    known = [(curve, order) for curve, order in told if order is not None]
    for line, (curve, order) in enumerate(known):
        name = curve.scheme
        if name == "trapezoidal":
            name = NAMES[curve.formulation].removeprefix("floating, ")
        axes.text(
            0.99,
            0.95 - 0.06 * line,
            f"{name} {order:.1f}",
            ha="right",
            transform=axes.transAxes,
            fontsize=8,
            color=LOOKS[curve.formulation][0],
        )


def _energy_panel(axes: Axes, study: Study) -> None:
    """Error in the energy of the undamped problem, which ought to stay constant."""
    axes.set_title("Undamped: error in the energy", fontsize=10, loc="left")
    axes.set(xscale="log", yscale="log", xlabel="processor time in ms", ylabel="energy error in J")
    runs = by_hindsight(run for curve in study.of("undamped") for run in curve.runs)
    for formulation, group in grouped(runs, lambda run: run.formulation).items():
        colour, marker = LOOKS[formulation]
        points: list[tuple[float, float]] = []
        useful = [run for run in group if run.error < _HIGHEST]
        for run in sorted(useful, key=lambda run: run.seconds):
            if run.errors is not None:
                energy = max(run.errors.energy, _LEAST_ENERGY)
                if not points or energy < points[-1][1]:
                    points.append((_milliseconds(run), energy))
        if points:
            axes.plot(*zip(*points, strict=True), color=colour, marker=marker, markersize=4.5)


def _labels(panels: Iterable[Axes], horizontal: str) -> None:
    # All of them, since each panel stands alone on a narrow screen.
    for panel in panels:
        panel.set(xlabel=horizontal, ylabel="largest error in rad")


def _handles(looks: dict[str, tuple[str, str]]) -> list[Line2D]:
    return [_key(colour, marker, NAMES[name]) for name, (colour, marker) in looks.items()]


def _key(colour: str, marker: str, text: str) -> Line2D:
    return Line2D([], [], color=colour, marker=marker, markersize=5, label=text)
