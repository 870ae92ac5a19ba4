"""Figures of the way to rest."""

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis import CAUSES, Phases, SpatialMotion
from validation.kit import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SHADES = (
    "#0072b2", "#56b4e9", "#000000", "#d55e00", "#e69f00", "#f0e442", "#cc79a7", "#009e73"
)  # fmt: skip
"""Okabe and Ito's palette: kinetic, potential, then the causes."""


_DOT = 20
"""Every so many samples of the engine's tilt are drawn."""

_CROWDED = 0.05
"""Part of the time within which the names of two phases would lie on each other."""


def story(motion: SpatialMotion, tilt: Sequence[float], spacing: float) -> "Figure":
    """The whole story over time, with the tilt of the engine's run, sampled so often in s."""
    figure = draw_story(motion)
    dots = np.arange(0, len(tilt), _DOT)
    look: Any = {"color": figures.COLOURS[2], "linestyle": "", "marker": ".", "markersize": 4}
    panel = figure.axes[0]
    panel.plot(spacing * dots, np.degrees(tilt)[dots], label="engine", **look)
    panel.legend(loc="upper right", bbox_to_anchor=(1.0, 1.2), fontsize=8, frameon=False)
    return figure


def draw_story(motion: SpatialMotion) -> "Figure":
    """Draw tilt, COG height, spin, energies and contact force, one below the other."""
    figure, axes = figures.new_figure(5, height=11.0)
    times = motion.times
    lines = (np.degrees(motion.tilt), 1e3 * motion.cog_height, motion.spin, motion.normal_force)
    for row, values, width in zip((0, 1, 2, 4), lines, (1.5, 1.5, 1.5, 0.5), strict=True):
        axes[row].plot(times, values, color=figures.COLOURS[0], linewidth=width)
    # Room above for the names of the phases.
    axes[0].set(ylabel="tilt β in °", ylim=(0, 250), yticks=range(0, 181, 45))
    axes[1].set(ylabel="COG height in mm", ylim=(0, None))
    axes[2].set(ylabel="vertical spin in rad/s")
    axes[4].set(ylabel="contact force in N", xlabel="time in s", xlim=(times[0], times[-1]))
    potential = motion.energies[:, 1:].sum(axis=1)
    parts = np.column_stack((motion.energies[:, 0], potential, motion.dissipated))
    used = [i for i in range(parts.shape[1]) if i < 2 or parts[-1, i] > 1e-6 * parts[0].sum()]
    labels = ["kinetic", "potential", *(cause.replace("_", " ") for cause in CAUSES)]
    shades = [_SHADES[i] for i in used]
    axes[3].stackplot(times, parts[:, used].T, labels=[labels[i] for i in used], colors=shades)
    axes[3].set(ylabel="energy in J")
    figures.legend_above(axes[3], size=8)
    _mark_phases(motion.phases, axes, times[-1])
    return figure


def _mark_phases(phases: Phases, panels: Sequence[Any], end: float) -> None:
    """Draw dotted lines where phases begin, named in the first of the axes."""
    begins = {field.name: getattr(phases, field.name) for field in fields(phases)}
    known = {name: begin for name, begin in begins.items() if begin is not None}
    for name, begin in known.items():
        for panel in panels:
            panel.axvline(begin, color="#888888", linestyle=":", linewidth=1.0)
        # A name goes to the left of its line where another one follows closely.
        ahead = [each - begin for each in known.values() if each > begin]
        crowded = bool(ahead) and min(ahead) < _CROWDED * end
        panels[0].text(
            begin,
            0.98,
            name.replace("_", " "),
            ha="right" if crowded else "left",
            transform=panels[0].get_xaxis_transform(),
            rotation=90,
            va="top",
            fontsize=7,
        )
