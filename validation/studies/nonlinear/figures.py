"""Figures of cycles and passages: in-house as lines, the engine as markers.

Functions draw into given axes. Rows of a study that have the names of a motion's attributes do as
well as the motion.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from analysis.data.checks import Array
from analysis.nonlinear.asymmetric import AsymmetricFamily
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import CycleFamily
from analysis.nonlinear.heteroclinic import Fall
from analysis.nonlinear.rotating import RotationFamily
from validation.kit import figures
from validation.studies.nonlinear.passage import LOST, Passage

_ENGINE: Mapping[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 6,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "zorder": 4,
}
_GREY = "#777777"
_STABLE, _UNSTABLE = 1, 2
"""Colours."""

_SPIN = "spinning speed Ω in rad/s"

_SHOWN = 1.0
"""Range of spins of rotating motions that is shown, in rad/s."""


def _values(motions: Sequence[Any], name: str) -> Array:
    return np.array([getattr(each, name) for each in motions], dtype=float)


def lines(
    axes: Any,
    motions: Sequence[Any],
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
    motions : sequence of motions
    values : ndarray, shape (n,)
    label : str
    colours : tuple of 2 ints
        Of stable and of unstable ones.
    first : tuple of 2 floats, optional
        Spin and value where they begin.
    """
    spins = _values(motions, "spin")
    stable = np.array([each.stable is None or bool(each.stable) for each in motions])
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


def _mark_connection(axes: Any, spin: float | None) -> None:
    if spin is not None:
        axes.axvline(spin, color=_GREY, linestyle="-.", label="heteroclinic", zorder=0)


def bifurcation_diagram(
    family: CycleFamily,
    *,
    connection: float | None = None,
    slow: Sequence[tuple[float, float]] = (),
    engine: Sequence[tuple[float, float]] = (),
    axes: Any = None,
) -> Any:
    """Amplitude over spin, with the stationary motions it leads between.

    Parameters
    ----------
    family : CycleFamily
    connection : float, optional
        Spin of the heteroclinic connection in rad/s.
    slow, engine : sequence of (spin, amplitude)
        Cycles on the slow manifold to leading order, and cycles of the engine.
    axes : Axes, optional
    """
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    hopf, spins = family.hopf.spin, _values(family.cycles, "spin")
    amplitudes = _values(family.cycles, "amplitude")
    lines(axes, family.cycles, amplitudes, "cycles", first=(hopf, 0.0))
    every = [hopf, *spins, *(() if connection is None else (connection,))]
    room = 0.15 * (max(every) - min(every))
    low, high = min(every) - room, max(every) + room
    axes.plot([hopf, high], [0.0, 0.0], color=figures.COLOURS[_STABLE])
    axes.plot([low, hopf], [0.0, 0.0], "--", color=figures.COLOURS[_UNSTABLE])
    axes.plot([low, high], [np.pi, np.pi], "--", color=figures.COLOURS[_UNSTABLE])
    axes.annotate("inverted spinning", (min(every) + 0.1 * room, 0.08))
    axes.annotate("noninverted spinning", (high, np.pi - 0.22), ha="right")
    axes.plot(hopf, 0.0, "D", color="black", label="Hopf point", zorder=5)
    if slow:
        axes.plot(*zip(*slow, strict=True), ":", color=figures.COLOURS[3], label="slow manifold")
    _mark_connection(axes, connection)
    if engine:
        axes.plot(*zip(*engine, strict=True), label="engine", **_ENGINE)
    axes.set(xlabel=_SPIN, ylabel="amplitude max |γ − π/2| in rad", xlim=(low, high))
    figures.angle_axis(axes)
    figures.legend_above(axes, columns=3)
    return axes


def period_diagram(
    family: CycleFamily, *, connection: float | None = None, axes: Any = None
) -> Any:
    """Period and multipliers over the spin.

    Parameters
    ----------
    family : CycleFamily
    connection : float, optional
        Spin of the heteroclinic connection in rad/s.
    axes : sequence of 3 Axes, optional
    """
    axes = figures.new_figure(3, height=8.0)[1] if axes is None else axes
    cycles, hopf = family.cycles, family.hopf
    born = (hopf.spin, 2.0 * np.pi / hopf.frequency)
    multipliers = _values(cycles, "multiplier")
    lines(axes[0], cycles, _values(cycles, "period"), "cycles", first=born)
    lines(axes[1], cycles, multipliers, "cycles", first=(hopf.spin, 1.0))
    lines(axes[2], cycles, _values(cycles, "log_strong") / np.log(10.0), "cycles")
    for each in axes:
        _mark_connection(each, connection)
    axes[0].set(ylabel="period in s")
    axes[1].set(ylabel="larger Floquet multiplier")
    axes[1].axhline(1.0, color=_GREY, linewidth=0.8, zorder=0)
    if np.max(multipliers) > 10.0:
        axes[1].set(yscale="log", ylabel="larger Floquet multiplier, logarithmic")
    axes[2].set(ylabel="log10 of the smaller one", xlabel=_SPIN)
    figures.legend_above(axes[0], columns=3)
    return axes


def rotation_diagram(family: RotationFamily, axes: Any = None) -> Any:
    """Largest and least tilt of rotating motions over the spin."""
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    spins, largest = (_values(family.rotations, name) for name in ("spin", "largest_tilt"))
    for name, label, colour in (("largest_tilt", "largest", 2), ("tilt", "noninverted", 1)):
        values = _values(family.rotations, name)
        lines(axes, family.rotations, values, label, colours=(colour, colour))
    _mark_connection(axes, family.connection.spin)
    # Where the disk is nearly flat the spin has no bounds.
    last = min(float(np.max(spins)), family.connection.spin + _SHOWN)
    axes.set(xlabel=_SPIN, ylabel="β − π/2 in rad", xlim=(np.min(spins) - 0.05 * _SHOWN, last))
    axes.set_ylim(0.0, 1.1 * np.max(largest[spins <= last]))
    figures.legend_above(axes, columns=2)
    return axes


def asymmetric_diagram(family: AsymmetricFamily, symmetric: CycleFamily) -> Any:
    """Largest deviations to either side of cycles without symmetry over the spin."""
    axes = figures.new_figure(height=4.6)[1]
    largest, least = (_values(family.cycles, name) for name in ("amplitude", "lowest"))
    near = [each for each in symmetric.cycles if each.amplitude <= np.max(largest)]
    look = {"color": _GREY, "linestyle": ":", "label": "symmetric"}
    axes.plot(_values(near, "spin"), _values(near, "amplitude"), **look)
    lines(axes, family.cycles, largest, "to one side", colours=(2, 2))
    lines(axes, family.cycles, -least, "to the other", colours=(1, 1))
    born = family.bifurcation.cycle
    axes.plot(born.spin, born.amplitude, "D", color="black", label="symmetry breaks", zorder=5)
    axes.set(xlabel=_SPIN, ylabel="largest deviation of γ in rad")
    figures.legend_above(axes, columns=2)
    return axes


def cycle_portrait(cycles: Sequence[Cycle]) -> Any:
    """Cycles in the plane of gamma and beta."""
    named = [(f"{cycle.spin:.6g} rad/s", cycle.full[1]) for cycle in cycles]
    return _plane_curves(named)


def connection_portrait(ways: Sequence[Fall], names: Sequence[str]) -> Any:
    """Motions that leave noninverted spinning, near the connection, in gamma and beta."""
    axes = _plane_curves([(name, way.states) for name, way in zip(names, ways, strict=True)])
    axes.plot((-np.pi / 2, 1.5 * np.pi), (np.pi / 2,) * 2, "s", color="black")
    return axes


def _plane_curves(named: Sequence[tuple[str, Array]]) -> Any:
    """Named states, shape (n, 3) each, in gamma and beta."""
    axes = figures.new_figure(height=4.6)[1]
    for index, (name, states) in enumerate(named):
        look = {"color": figures.COLOURS[index % 4], "linestyle": figures.STYLES[index // 4 % 4]}
        axes.plot(states[:, 1], states[:, 0], label=name, **look)
    axes.set(xlabel="γ in rad", ylabel="β in rad")
    figures.legend_above(axes)
    return axes


def passage_diagram(named: Sequence[tuple[str, Passage]]) -> Any:
    """Mean spin and slow deviation over time, with what the eigenvalues predict.

    Parameters
    ----------
    named : sequence of (name, Passage)
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
    axes[0].axhline(hopf, color=_GREY, linewidth=0.8, label=f"Hopf point, {hopf:.2f} rad/s")
    axes[1].axhline(LOST, color=_GREY, linewidth=0.8)
    axes[0].set(ylabel="mean spin in rad/s")
    axes[1].set(xlabel="time in s", yscale="log")
    axes[1].set_ylabel("slow deviation of γ in rad, logarithmic")
    axes[1].plot([], [], color="black", linewidth=0.8, label="by the eigenvalues alone")
    axes[1].plot([], [], "D", color="black", markerfacecolor="white", label="loss predicted")
    axes[0].plot([], [], "s", color="black", label="inversion lost")
    for each in axes:
        figures.legend_above(each, columns=2)
    return axes


def delay_diagram(rates: Array, delays: Array) -> Figure:
    """Delay of the loss of inversion over the rate of decay, with the law's root.

    Parameters
    ----------
    rates, delays : ndarray, shape (n,)
        In rad/s² and rad/s.
    """
    figure, axes = figures.new_figure()
    axes.loglog(rates, delays, label="measured", **_ENGINE)
    root = np.sqrt(rates) * np.exp(np.mean(np.log(delays / np.sqrt(rates))))
    axes.loglog(rates, root, color=figures.COLOURS[1], label="root of the rate")
    axes.set(xlabel="rate of decay in rad/s², logarithmic")
    axes.set(ylabel="Hopf point less lowest spin in rad/s, logarithmic")
    # Both go over a decade at most, in which powers of ten say little.
    axes.set_xticks(rates, [f"{each:.2g}" for each in rates])
    axes.set_yticks(delays, [f"{each:.2g}" for each in delays])
    axes.minorticks_off()
    figures.legend_above(axes)
    return figure


def plane(hopf: float, curves: Mapping[float, Any]) -> Figure:
    """Hopf and heteroclinic curves in the plane of spin and smoothing.

    Parameters
    ----------
    hopf : float
        Spin of the Hopf point in rad/s, the same for all friction.
    curves : mapping
        From the friction coefficient to smoothing speeds in m/s, rising, spins of the connection
        in rad/s, and the spin for vanishing smoothing.
    """
    figure, axes = figures.new_figure()
    highest = max(max(smoothing) for smoothing, _, _ in curves.values())
    axes.plot((hopf, hopf), (0.0, highest), color="black", label="Hopf")
    for index, (mu, (smoothing, spins, limit)) in enumerate(curves.items(), 1):
        look = {"color": figures.COLOURS[index % 4], "linestyle": figures.STYLES[index % 4]}
        axes.plot(spins, smoothing, marker=".", label=f"heteroclinic, μ = {mu:g}", **look)
        axes.plot(limit, 0.0, "D", color=look["color"])
    axes.plot([], [], "D", color=_GREY, label="predicted for ε → 0")
    axes.set(xlabel=_SPIN, ylabel="smoothing speed ε in m/s")
    axes.set_ylim(bottom=-0.002)
    figures.legend_above(axes, columns=2)
    return figure
