"""Figures of the study alone: bifurcation diagram, plane of spin and smoothing, law of delay."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from analysis.data.checks import Array
from analysis.stability.printed import CriticalSpeed
from validation.kit import figures
from validation.nonlinear.figures import ENGINE, GREY, SPIN, STABLE, UNSTABLE, lines
from validation.nonlinear.tables import Motion


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
    axes.plot([], [], "D", color=GREY, label="predicted for ε → 0")
    axes.set(xlabel=SPIN, ylabel="smoothing speed ε in m/s")
    axes.set_ylim(bottom=-0.002)
    figures.legend_above(axes, columns=2)
    return figure


def bifurcation_diagram(
    motions: Sequence[Motion],
    hopf: CriticalSpeed,
    *,
    connection: float,
    slow: Sequence[tuple[float, float]],
    engine: Sequence[tuple[float, float]],
) -> Figure:
    """Amplitude over spin, with the stationary motions it leads between.

    Parameters
    ----------
    motions : sequence of Motion
        Symmetric cycles.
    hopf : CriticalSpeed
    connection : float
        Spin of the heteroclinic connection in rad/s.
    slow, engine : sequence of (spin, amplitude)
        Cycles on the slow manifold to leading order, and cycles of the engine.
    """
    figure, axes = figures.new_figure(height=4.6)
    amplitudes = np.array([each["amplitude"] for each in motions])
    lines(axes, motions, amplitudes, first=(hopf.spin, 0.0))
    every = [hopf.spin, connection, *(each["spin"] for each in motions)]
    room = 0.15 * (max(every) - min(every))
    low, high = min(every) - room, max(every) + room
    axes.plot([hopf.spin, high], [0.0, 0.0], color=figures.COLOURS[STABLE])
    for value, end in ((0.0, hopf.spin), (np.pi, high)):
        axes.plot([low, end], [value, value], "--", color=figures.COLOURS[UNSTABLE])
    axes.annotate("inverted spinning", (min(every) + 0.1 * room, 0.08))
    axes.annotate("noninverted spinning", (high, np.pi - 0.22), ha="right")
    axes.plot(hopf.spin, 0.0, "D", color="black", label="Hopf point", zorder=5)
    axes.plot(*zip(*slow, strict=True), ":", color=figures.COLOURS[3], label="slow manifold")
    axes.axvline(connection, color=GREY, linestyle="-.", label="heteroclinic", zorder=0)
    axes.plot(*zip(*engine, strict=True), label="engine", **ENGINE)
    axes.set(xlabel=SPIN, ylabel="amplitude max |γ − π/2| in rad", xlim=(low, high))
    figures.angle_axis(axes)
    figures.legend_above(axes, columns=3)
    return figure


def delay_diagram(rates: Array, delays: Array) -> Figure:
    """Delay of the loss of inversion over the rate of decay, with the law's root.

    Parameters
    ----------
    rates, delays : ndarray, shape (n,)
        In rad/s² and rad/s.
    """
    figure, axes = figures.new_figure()
    axes.loglog(rates, delays, label="measured", **ENGINE)
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
