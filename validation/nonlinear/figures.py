"""Figures of periodic motions and passages: in-house as lines, the engine as markers.

Motions are rows as in `tables`.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analysis.data.checks import Array
from analysis.stability.printed import CriticalSpeed
from validation.kit import figures
from validation.nonlinear.passage import LOST, Passage
from validation.nonlinear.tables import Motion

ENGINE: Mapping[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 6,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "zorder": 4,
}
GREY = "#777777"
SPIN = "spinning speed Ω in rad/s"

_STABLE, _UNSTABLE = 1, 2
"""Colours."""

_SHOWN = 1.0
"""Range of spins of rotating motions that is shown, in rad/s."""


def _values(motions: Sequence[Motion], name: str) -> Array:
    return np.array([each[name] for each in motions], dtype=float)


def lines(
    axes: Any,
    motions: Sequence[Motion],
    values: Array,
    label: str,
    *,
    colours: tuple[int, int] = (_STABLE, _UNSTABLE),
    first: tuple[float, float] | None = None,
) -> None:
    """Draw values of motions over their spins, solid where stable and dashed where not.

    Parameters
    ----------
    axes : Axes
    motions : sequence of Motion
    values : ndarray, shape (n,)
    label : str
    colours : tuple of 2 ints
        Of stable and of unstable ones.
    first : tuple of 2 floats, optional
        Spin and value where they begin.
    """
    spins = _values(motions, "spin")
    stable = np.array([each["stable"] is None or bool(each["stable"]) for each in motions])
    if first is not None:
        spins, values = np.append(first[0], spins), np.append(first[1], values)
        stable = np.append(stable[0], stable)
    for wanted, style, word in ((True, "-", "stable"), (False, "--", "unstable")):
        # A piece takes the kind of its farther end, so that the curve has no gaps.
        shown = np.append(stable[1:] == wanted, False) | np.append(False, stable[1:] == wanted)
        if np.any(shown):
            axes.plot(
                np.where(shown, spins, np.nan),
                np.where(shown, values, np.nan),
                style,
                color=figures.COLOURS[colours[0 if wanted else 1]],
                label=f"{label}, {word}",
            )


def _mark(axes: Any, spin: float | None, label: str = "heteroclinic") -> None:
    if spin is not None:
        axes.axvline(spin, color=GREY, linestyle="-.", label=label, zorder=0)


def bifurcation_diagram(
    motions: Sequence[Motion],
    hopf: CriticalSpeed,
    *,
    connection: float | None = None,
    slow: Sequence[tuple[float, float]] = (),
    engine: Sequence[tuple[float, float]] = (),
    axes: Any = None,
) -> Any:
    """Amplitude over spin, with the stationary motions it leads between.

    Parameters
    ----------
    motions : sequence of Motion
        Symmetric cycles.
    hopf : CriticalSpeed
    connection : float, optional
        Spin of the heteroclinic connection in rad/s.
    slow, engine : sequence of (spin, amplitude)
        Cycles on the slow manifold to leading order, and cycles of the engine.
    axes : Axes, optional
    """
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    spins = _values(motions, "spin")
    lines(axes, motions, _values(motions, "amplitude"), "cycles", first=(hopf.spin, 0.0))
    every = [hopf.spin, *spins, *(() if connection is None else (connection,))]
    room = 0.15 * (max(every) - min(every))
    low, high = min(every) - room, max(every) + room
    axes.plot([hopf.spin, high], [0.0, 0.0], color=figures.COLOURS[_STABLE])
    for value, end in ((0.0, hopf.spin), (np.pi, high)):
        axes.plot([low, end], [value, value], "--", color=figures.COLOURS[_UNSTABLE])
    axes.annotate("inverted spinning", (min(every) + 0.1 * room, 0.08))
    axes.annotate("noninverted spinning", (high, np.pi - 0.22), ha="right")
    axes.plot(hopf.spin, 0.0, "D", color="black", label="Hopf point", zorder=5)
    if slow:
        axes.plot(*zip(*slow, strict=True), ":", color=figures.COLOURS[3], label="slow manifold")
    _mark(axes, connection)
    if engine:
        axes.plot(*zip(*engine, strict=True), label="engine", **ENGINE)
    axes.set(xlabel=SPIN, ylabel="amplitude max |γ − π/2| in rad", xlim=(low, high))
    figures.angle_axis(axes)
    figures.legend_above(axes, columns=3)
    return axes.figure


def period_diagram(
    motions: Sequence[Motion],
    hopf: CriticalSpeed,
    *,
    connection: float | None = None,
    axes: Any = None,
) -> Any:
    """Period and multipliers over the spin, in 3 axes; see `bifurcation_diagram`."""
    axes = figures.new_figure(3, height=8.0)[1] if axes is None else axes
    born = (hopf.spin, 2.0 * np.pi / hopf.frequency)
    multipliers = _values(motions, "multiplier")
    lines(axes[0], motions, _values(motions, "period"), "cycles", first=born)
    lines(axes[1], motions, multipliers, "cycles", first=(hopf.spin, 1.0))
    lines(axes[2], motions, _values(motions, "log_strong") / np.log(10.0), "cycles")
    for each in axes:
        _mark(each, connection)
    axes[0].set(ylabel="period in s")
    axes[1].set(ylabel="larger Floquet multiplier")
    axes[1].axhline(1.0, color=GREY, linewidth=0.8, zorder=0)
    if np.max(multipliers) > 10.0:
        axes[1].set(yscale="log", ylabel="larger Floquet multiplier, logarithmic")
    axes[2].set(ylabel="log10 of the smaller one", xlabel=SPIN)
    figures.legend_above(axes[0], columns=3)
    return axes[0].figure


def rotation_diagram(motions: Sequence[Motion], connection: float) -> Any:
    """Largest and least tilt of rotating motions over the spin, beside that of the connection."""
    axes = figures.new_figure(height=4.6)[1]
    for name, label, colour in (("largest_tilt", "largest", 2), ("tilt", "noninverted", 1)):
        lines(axes, motions, _values(motions, name), label, colours=(colour, colour))
    _mark(axes, connection)
    spins, largest = (_values(motions, name) for name in ("spin", "largest_tilt"))
    # Where the disk is nearly flat the spin has no bounds.
    last = min(float(np.max(spins)), connection + _SHOWN)
    axes.set(xlabel=SPIN, ylabel="β − π/2 in rad", xlim=(np.min(spins) - 0.05 * _SHOWN, last))
    axes.set_ylim(0.0, 1.1 * np.max(largest[spins <= last]))
    figures.legend_above(axes, columns=2)
    return axes.figure


def asymmetric_diagram(
    motions: Sequence[Motion], symmetric: Sequence[Motion], begins: float
) -> Any:
    """Largest deviations to either side of cycles without symmetry over the spin."""
    axes = figures.new_figure(height=4.6)[1]
    largest, least = (_values(motions, name) for name in ("amplitude", "lowest"))
    near = [each for each in symmetric if each["amplitude"] <= np.max(largest)]
    look = {"color": GREY, "linestyle": ":", "label": "symmetric"}
    axes.plot(_values(near, "spin"), _values(near, "amplitude"), **look)
    lines(axes, motions, largest, "to one side", colours=(2, 2))
    lines(axes, motions, -least, "to the other", colours=(1, 1))
    _mark(axes, begins, "symmetry breaks")
    axes.set(xlabel=SPIN, ylabel="largest deviation of γ in rad")
    figures.legend_above(axes, columns=2)
    return axes.figure


def portrait(named: Sequence[tuple[str, Array]], saddles: Sequence[float] = ()) -> Any:
    """Motions in the plane of gamma and beta.

    Parameters
    ----------
    named : sequence of (name, states)
        States of shape (n, 3) each.
    saddles : sequence of float
        Values of gamma in rad of noninverted spinning to mark.
    """
    axes = figures.new_figure(height=4.6)[1]
    for index, (name, states) in enumerate(named):
        look = {"color": figures.COLOURS[index % 4], "linestyle": figures.STYLES[index // 4 % 4]}
        axes.plot(states[:, 1], states[:, 0], label=name, **look)
    axes.set(xlabel="γ in rad", ylabel="β in rad")
    figures.legend_above(axes)
    axes.plot(saddles, [np.pi / 2] * len(saddles), "s", color="black")
    return axes.figure


def passage_diagram(named: Sequence[tuple[str, Passage]]) -> Any:
    """Mean spin and slow deviation over time, with what the eigenvalues predict.

    Parameters
    ----------
    named : sequence of (name, Passage)
        Or rows of a study that have its attributes.
    """
    axes = figures.new_figure(2, height=6.5)[1]
    for index, (name, passage) in enumerate(named):
        look = {"color": figures.COLOURS[index % 4]}
        style = figures.STYLES[index % 4]
        axes[0].plot(passage.times, passage.spins, style, label=name, **look)
        axes[1].plot(passage.times, passage.deviations, style, **look)
        axes[1].plot(passage.times, passage.linear, linewidth=0.8, **look)
        if passage.crossing is not None:
            axes[0].plot(passage.crossing, passage.hopf, "o", **look)
        if passage.lost is not None:
            axes[0].plot(passage.lost, passage.spins[-1], "s", **look)
        if passage.predicted is not None:
            axes[1].plot(passage.predicted, LOST, "D", markerfacecolor="white", **look)
    hopf = named[0][1].hopf
    axes[0].axhline(hopf, color=GREY, linewidth=0.8, label=f"Hopf point, {hopf:.2f} rad/s")
    axes[1].axhline(LOST, color=GREY, linewidth=0.8)
    axes[0].set(ylabel="mean spin in rad/s")
    axes[1].set(xlabel="time in s", yscale="log")
    axes[1].set_ylabel("slow deviation of γ in rad, logarithmic")
    axes[1].plot([], [], color="black", linewidth=0.8, label="by the eigenvalues alone")
    axes[1].plot([], [], "D", color="black", markerfacecolor="white", label="loss predicted")
    axes[0].plot([], [], "s", color="black", label="inversion lost")
    for each in axes:
        figures.legend_above(each, columns=2)
    return axes[0].figure
