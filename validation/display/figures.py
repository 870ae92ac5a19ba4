"""What figures share: colours and line styles that stay apart in grey and for the colour-blind.

Matplotlib, which takes half a second, is loaded when one is made.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from fractions import Fraction
from math import inf, nan
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis import CAUSES, Body, Phases, SpatialMotion, StoredRun, Trajectory
from analysis.motion.frames import poses
from analysis.problem.checks import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#000000", "#0072b2", "#d55e00", "#009e73")
"""Black, blue, vermilion and green of the Okabe-Ito palette, darkest first."""

STYLES = ("-", "--", "-.", ":")
MARKERS = ("o", "s", "^", "D")

LOOKS: Sequence[dict[str, Any]] = [
    {"color": COLOURS[n % 4], "linestyle": STYLES[(n + n // 4) % 4]} for n in range(16)
]
"""Of lines that are told apart, for `Axes.plot`;"""

MARKED = [look | {"marker": marker} for look, marker in zip(LOOKS, MARKERS, strict=False)]
"""with markers, too."""

ENGINE: Mapping[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 6,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "zorder": 4,
}
"""What the engine gives, beside lines of the in-house side."""

SPIN = "spinning speed Ω in rad/s"

WIDTH = 5.8
"""Of a figure in inches, such that its letters can be read on a telephone."""

_SHADES = (
    "#0072b2", "#56b4e9", "#000000", "#d55e00", "#e69f00", "#f0e442", "#cc79a7", "#009e73"
)  # fmt: skip
"""Okabe and Ito's palette: kinetic, potential, then the causes."""

_CROWDED = 0.05
"""Part of the time within which the names of two phases would lie on each other."""

_PARTS = 1e-6, 100.0
"""Of a limit, from the least to the largest that is drawn."""

_WIDEST = 55
"""Letters in a line of a legend."""

_SHORT_LABELS = -3, 6
"""Powers of ten beyond which, and at which, times have one in common: zeros would overlap."""

_RC: Any = {
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.constrained_layout.use": True,
    "font.size": 10,
    "grid.alpha": 0.3,
}


def new_figure(
    rows: int = 1,
    *,
    columns: int = 1,
    width: float = WIDTH,
    height: float = 4.2,
    share: bool = True,
) -> tuple["Figure", Any]:
    """Figure without a window, and its axes, which may share the horizontal one in a column."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_RC):
        figure = Figure(figsize=(width, height))
        axes = figure.subplots(rows, columns, sharex="col" if share else False)
    return figure, axes


def legend_above(axes: "Axes", columns: int = 4, size: float | None = None) -> None:
    """Put the legend above the axes, where it hides nothing, in at most so many columns."""
    # A power of ten by which labels are to be multiplied stands beside it.
    axes.yaxis.get_offset_text().set_horizontalalignment("right")
    room = (1.0 - axes.get_position().x0) * axes.figure.bbox.width
    for ncols in range(columns, 0, -1):
        legend = axes.legend(
            ncols=ncols,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.2,
            columnspacing=1.2,
            fontsize=size,
            frameon=False,
        )
        if legend.get_window_extent().width < room:
            break


def draw_still(axes: "Axes", disk: Body, coordinates: Array, scale: float = 1.0) -> None:
    """Draw a body on the table from a quarter to the side, so that it shows its face.

    Parameters
    ----------
    axes : Axes
    disk : Body
    coordinates : ndarray, shape (6,)
    scale : float
        Of lines and marks.
    """
    from validation.animation.picture import Camera, draw

    place, rotation = (each[0] for each in poses(coordinates[None]))
    target = Camera.aim(place[:2], place[2], disk.radius)
    camera = Camera(target, coordinates[3] - np.pi / 2 + 0.35, disk.radius, scale)
    draw(axes, disk, (place, rotation), camera)


def against_limits(found: Sequence[tuple[str, object, object, bool | None]]) -> "Figure":
    """Numbers as parts of what they may be at most, logarithmically, a row for each name.

    Parameters
    ----------
    found : sequence of (name, number, limit, holds)
        Of what has to be equal to something, or is no number, those are drawn that fail; nothing
        of what is not defined, for which holds is None.
    """
    places = {name: -row for row, name in enumerate(dict.fromkeys(name for name, *_ in found))}
    figure, axes = new_figure(width=8.5, height=1.4 + 0.26 * len(places))
    for wanted, look in (
        (True, {"marker": "o", "color": COLOURS[1], "alpha": 0.5, "label": "holds"}),
        (False, {"marker": "X", "color": COLOURS[2], "markersize": 9, "label": "fails"}),
    ):
        shown = [
            (_part(number, limit, holds), places[name])
            for name, number, limit, holds in found
            if holds is wanted
        ]
        if shown:
            axes.plot(*zip(*shown, strict=True), linestyle="none", zorder=3, **look)
    axes.axvline(1.0, color=COLOURS[0], label="limit")
    least, most = _PARTS
    axes.set(xscale="log", xlim=(0.5 * least, 2.0 * most), ylim=(0.6 - max(1, len(places)), 0.6))
    axes.set(yticks=list(places.values()), yticklabels=list(places))
    axes.set_xlabel(f"part of what is allowed, from {least:g} or less to {most:g} or more")
    legend_above(axes)
    return figure


def _part(number: object, limit: object, holds: bool) -> float:
    """A number as a part of its limit, where it is drawn; nan for what is not."""
    if not isinstance(limit, float) or not 0.0 < limit < inf or number == limit:
        return nan if holds else _PARTS[1]
    part = number / limit if isinstance(number, int | float) else inf
    # Not a number is not less than anything.
    return max(part, _PARTS[0]) if part < _PARTS[1] else _PARTS[1]


def angle_axis(axes: "Axes") -> None:
    """Mark the vertical axis, on which all is drawn, at multiples of a quarter of pi.

    A disk that falls turns round many times, and one that does not hardly moves: then the marks
    lie farther apart, or are the usual ones.
    """
    from matplotlib.ticker import FuncFormatter, MultipleLocator

    low, high = axes.get_ylim()
    quarters = (high - low) / (np.pi / 4)
    if quarters < 2.0:
        return
    spacing = 2.0 ** max(0.0, np.ceil(np.log2(quarters / 8.0)))
    axes.yaxis.set_major_locator(MultipleLocator(spacing * np.pi / 4))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: pi_label(value)))


def pi_label(value: float) -> str:
    """Label such as −π/2 for a multiple of a quarter of pi."""
    part = Fraction(round(4.0 * value / np.pi), 4)
    count = abs(part.numerator)
    top = f"{'' if count == 1 else count}π" if count else "0"
    under = f"/{part.denominator}" if part.denominator > 1 else ""
    return f"{'−' if part < 0 else ''}{top}{under}"


def comparison(runs: Sequence[tuple[str, StoredRun]], axes: Any = None) -> "Figure":
    """beta, gamma, spinning velocity and normal force of several labelled runs.

    With a spatial motion among them, which has no gamma where it lies flat, the height of the
    centre of gravity takes its place, and the vertical angular velocity that of the rate of alpha.

    Parameters
    ----------
    runs : sequence of (label, Trajectory or SpatialMotion)
    axes : sequence of 4 Axes, optional
        By default those of a new figure.
    """
    if axes is None:
        axes = new_figure(4, height=8.5)[1]
    spatial = any(isinstance(run, SpatialMotion) for _, run in runs)
    for index, (label, run) in enumerate(runs):
        look = LOOKS[index % len(LOOKS)] | {"linewidth": 2.2 - 0.4 * min(index, 3)}
        # Between two dollars there would be a formula.
        told = fill(label, _WIDEST, break_on_hyphens=False).replace("$", r"\$")
        for ax, values in zip(axes, _compared(run, spatial=spatial), strict=True):
            ax.plot(run.times, values, label=told, **look)
    axes[0].set(ylabel="β in rad")
    if spatial:
        axes[1].set(ylabel="height of the COG in m")
        axes[2].set(ylabel="vertical angular\nvelocity in rad/s")
    else:
        angle_axis(axes[1])
        axes[1].set(ylabel="γ in rad")
        axes[2].set(ylabel="$\\dotα$ in rad/s")
    axes[3].set(ylabel="normal force in N", xlabel="time in s")
    axes[3].ticklabel_format(axis="x", scilimits=_SHORT_LABELS)
    legend_above(axes[0], columns=1 + (len(runs) > 1))
    return axes[0].figure


def _compared(run: StoredRun, *, spatial: bool) -> tuple[Array, Array, Array, Array]:
    """The four curves of `comparison`, shape (n,) each."""
    if spatial:
        return run.tilt, run.cog_height, run.poses.angular_velocities[:, 2], run.normal_force
    assert isinstance(run, Trajectory)
    return run.coordinate("beta"), run.coordinate("gamma"), run.spin, run.normal_force


def draw_story(motion: SpatialMotion) -> "Figure":
    """Draw tilt, COG height, spin, energies and contact force, one below the other."""
    figure, axes = new_figure(5, height=11.0)
    times = motion.times
    lines = (motion.tilt, 1e3 * motion.cog_height, motion.spin, motion.normal_force)
    for row, values, width in zip((0, 1, 2, 4), lines, (1.5, 1.5, 1.5, 0.5), strict=True):
        axes[row].plot(times, values, color=COLOURS[0], linewidth=width)
    # Room above for the names of the phases.
    axes[0].set(ylabel="tilt β in rad", ylim=(0.0, 1.4 * np.pi))
    quarters = np.linspace(0.0, np.pi, 5).tolist()
    axes[0].set_yticks(quarters, labels=[pi_label(each) for each in quarters])
    axes[1].set(ylabel="COG height in mm", ylim=(0, None))
    axes[2].set(ylabel="vertical angular\nvelocity in rad/s")
    axes[4].set(ylabel="contact force in N", xlabel="time in s", xlim=(times[0], times[-1]))
    axes[4].ticklabel_format(axis="x", scilimits=_SHORT_LABELS)
    potential = motion.energies[:, 1:].sum(axis=1)
    # Areas below zero would cover others; on a table that leans, the disk goes down.
    potential -= min(0.0, float(potential.min()))
    parts = np.column_stack((motion.energies[:, 0], potential, motion.dissipated))
    used = [i for i in range(parts.shape[1]) if i < 2 or parts[-1, i] > 1e-3 * parts[0].sum()]
    labels = ["kinetic", "potential", *(cause.replace("_", " ") for cause in CAUSES)]
    shades = [_SHADES[i] for i in used]
    axes[3].stackplot(times, parts[:, used].T, labels=[labels[i] for i in used], colors=shades)
    axes[3].set(ylabel="energy in J")
    legend_above(axes[3], size=8)
    _mark_phases(motion.phases, axes, times[-1])
    return figure


def _mark_phases(phases: Phases, panels: Sequence[Any], end: float) -> None:
    """Draw dotted lines where phases begin, named in the first of the axes."""
    known: dict[float, list[str]] = {}
    for name, begin in asdict(phases).items():
        if begin is not None:
            known.setdefault(begin, []).append(name.replace("_", " "))
    for begin, names in known.items():
        for panel in panels:
            panel.axvline(begin, color="#888888", linestyle=":", linewidth=1.0)
        # A name goes to the left of its line where another one follows closely.
        crowded = any(0.0 < each - begin < _CROWDED * end for each in known)
        panels[0].text(
            begin,
            0.98,
            ", ".join(names),
            ha="right" if crowded else "left",
            transform=panels[0].get_xaxis_transform(),
            rotation=90,
            va="top",
            fontsize=7,
        )
