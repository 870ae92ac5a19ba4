"""The bifurcation diagram of the study."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from analysis.stability.printed import CriticalSpeed
from validation.kit import figures
from validation.nonlinear.figures import ENGINE, GREY, SPIN, STABLE, UNSTABLE, lines
from validation.nonlinear.tables import Motion


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
