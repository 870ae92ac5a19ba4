"""What figures share: colours and line styles that stay apart in grey and for the colour-blind."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from analysis import SpatialMotion, StoredRun
from analysis.data.checks import Array

COLOURS = ("#000000", "#0072b2", "#d55e00", "#009e73")
"""Black, blue, vermilion and green of the Okabe-Ito palette, darkest first."""

STYLES = ("-", "--", "-.", ":")
MARKERS = ("o", "s", "^", "D")

WIDTH = 5.8
"""Of a figure in inches, such that its letters can be read on a telephone."""

_DPI = 140
_PALETTE = 96
"""Colours of a drawing, shades at the edges of its lines included."""

_EDGE = 5
"""Pixels left around a panel that is cut out."""

_RC: Any = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.constrained_layout.use": True,
    "font.size": 10,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "svg.hashsalt": "tippedisk",
}


def new_figure(
    rows: int = 1,
    *,
    columns: int = 1,
    width: float = WIDTH,
    height: float = 4.2,
    share: bool = True,
) -> tuple[Figure, Any]:
    """Figure without a window, and its axes, which may share the horizontal one in a column."""
    with mpl.rc_context(_RC):
        figure = Figure(figsize=(width, height))
        axes = figure.subplots(rows, columns, sharex="col" if share else False)
    return figure, axes


class Curve(NamedTuple):
    """A curve of a panel.

    Parameters
    ----------
    x, y : array_like, shape (n,)
    label : str
        Without one, the legend leaves it out.
    how : mapping
        What `Axes.plot` takes; with `yerr`, `Axes.errorbar`. See `look`.
    """

    x: Any
    y: Any
    label: str = ""
    how: Mapping[str, Any] = {}


class Panel(NamedTuple):
    """A panel of a figure: curves, and grey lines by their labels.

    Parameters
    ----------
    y : str
        What its vertical axis shows, with the unit.
    curves : sequence of Curve
    across, upright : mapping
        Heights of horizontal lines, and places of vertical ones.
    strip : tuple of 2 float, optional
        Places between which it is shaded.
    quarters : bool
        Whether the vertical axis is marked at multiples of a quarter of pi.
    how : mapping
        What `Axes.set` takes besides.
    """

    y: str
    curves: Sequence[Curve]
    across: Mapping[str, float] = {}
    upright: Mapping[str, float] = {}
    strip: tuple[float, float] | None = None
    quarters: bool = False
    how: Mapping[str, Any] = {}


def look(index: int, **more: Any) -> dict[str, Any]:
    """How a curve is drawn that is told from others by colour and line style."""
    return {"color": COLOURS[index % 4], "linestyle": STYLES[index % 4], **more}


def panels(
    *shown: Panel, x: str, height: float = 4.2, columns: int = 4, legend: str = ""
) -> Figure:
    """Figure of panels below each other that share the horizontal axis.

    Parameters
    ----------
    *shown : Panel
    x : str
        What the horizontal axis shows, with the unit.
    height : float
        In inches.
    columns : int
        Of the legends, which stand above the panels.
    legend : str
        Where they stand else, in matplotlib's words.
    """
    figure, found = new_figure(len(shown), height=height)
    for panel, axes in zip(shown, np.atleast_1d(found), strict=True):
        for curve in panel.curves:
            draw = axes.errorbar if "yerr" in curve.how else axes.plot
            draw(curve.x, curve.y, label=curve.label, **curve.how)
        for lines, line in ((panel.across, axes.axhline), (panel.upright, axes.axvline)):
            for label, value in lines.items():
                line(value, color="#888888", linestyle=":", label=label.rstrip(), zorder=1)
        if panel.strip is not None:
            axes.axvspan(*panel.strip, color="#dddddd", zorder=0)
        if panel.quarters:
            angle_axis(axes)
        axes.set(ylabel=panel.y, **panel.how)
        if not axes.get_legend_handles_labels()[1]:
            continue
        if legend:
            axes.legend(loc=legend)
        else:
            legend_above(axes, columns=columns)
    axes.set(xlabel=x)
    return figure


def legend_above(axes: Axes, columns: int = 4, size: float | None = None) -> None:
    """Put the legend above the axes, where it hides nothing."""
    axes.legend(
        ncols=columns,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        borderaxespad=0.2,
        columnspacing=1.2,
        fontsize=size,
        frameon=False,
    )


def angle_axis(axes: Axes) -> None:
    """Mark the vertical axis at multiples of a quarter of pi."""
    axes.yaxis.set_major_locator(MultipleLocator(np.pi / 4))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: pi_label(value)))


def pi_label(value: float) -> str:
    """Label such as −π/2 for a multiple of a quarter of pi."""
    quarters = round(value / (np.pi / 4))
    if quarters == 0:
        return "0"
    sign = "−" if quarters < 0 else ""
    number = abs(quarters)
    for divisor in (4, 2, 1):
        if (number * divisor) % 4 == 0:
            top = number * divisor // 4
            denominator = "" if divisor == 1 else f"/{divisor}"
    return f"{sign}{'' if top == 1 else top}π{denominator}"


def comparison(runs: Sequence[tuple[str, StoredRun]], axes: Any = None) -> Any:
    """beta, gamma, spinning velocity and normal force of several labelled runs.

    With a spatial motion among them, which has no gamma where it lies flat, the height of the
    centre of gravity takes its place, and the vertical angular velocity that of the rate of alpha.

    Parameters
    ----------
    runs : sequence of (label, Trajectory or SpatialMotion)
    axes : sequence of 4 Axes, optional
    """
    axes = new_figure(4, height=8.5)[1] if axes is None else axes
    spatial = any(isinstance(run, SpatialMotion) for _, run in runs)
    for index, (label, run) in enumerate(runs):
        look = {
            "color": COLOURS[index % len(COLOURS)],
            "linestyle": STYLES[index % len(STYLES)],
            "linewidth": 2.2 - 0.4 * min(index, 3),
        }
        for ax, values in zip(axes, _compared(run, spatial=spatial), strict=True):
            ax.plot(run.times, values, label=label, **look)
    axes[0].set(ylabel="β in rad")
    if spatial:
        axes[1].set(ylabel="height of the COG in m")
        axes[2].set(ylabel="vertical angular\nvelocity in rad/s")
    else:
        angle_axis(axes[1])
        axes[1].set(ylabel="γ in rad")
        axes[2].set(ylabel="$\\dotα$ in rad/s")
    axes[3].set(ylabel="normal force in N", xlabel="time in s")
    legend_above(axes[0], columns=1 + (len(runs) > 1))
    return axes


def _compared(run: StoredRun, *, spatial: bool) -> tuple[Array, Array, Array, Array]:
    """The four curves of `comparison`, shape (n,) each."""
    if isinstance(run, SpatialMotion):
        return run.tilt, run.cog_height, run.spin, run.normal_force
    beta, spin = run.coordinate("beta"), run.rate("alpha")
    if spatial:
        spin = spin + np.cos(beta) * run.rate("gamma")
        return beta, run.cog_height, spin, run.normal_force
    return beta, run.coordinate("gamma"), spin, run.normal_force
