"""Figures of periodic motions and passages: in-house as lines, the engine as markers.

Motions are rows as in `tables`.
"""

from collections.abc import Mapping, Sequence
from itertools import cycle, pairwise, takewhile
from typing import Any

import numpy as np

from analysis.problem.checks import Array
from validation.display import figures
from validation.nonlinear.passage import LOST, Passage
from validation.nonlinear.tables import HEADS, Motion

GREY = "#777777"

STABLE, UNSTABLE = 1, 2
"""Colours."""

_SHOWN = 1.0
"""In rad/s."""

_TICKS = 8
"""Of a logarithmic axis at most, so that their numbers stay apart."""


def _values(motions: Sequence[Motion], name: str) -> Array:
    return np.array([each[name] for each in motions], dtype=float)


def lines(axes: Any, motions: Sequence[Motion], values: Array, parameter: str = "spin") -> None:
    """Draw values of motions over their spins, solid where stable and dashed where not.

    Parameters
    ----------
    axes : Axes
    motions : sequence of Motion
    values : ndarray, shape (n,)
    parameter : str
        Name of what they are drawn over.
    """
    places = _values(motions, parameter)
    told = [each["stable"] for each in motions]
    # A piece takes the kind of its farther end, if that has one, so that the curve has no gaps.
    pieces = [first if last is None else last for first, last in pairwise(told)] or told
    stable = np.array([piece is None or bool(piece) for piece in pieces])
    for wanted, style, word in ((True, "-", "stable"), (False, "--", "unstable")):
        shown = stable == wanted
        if len(told) > 1:
            shown = np.append(shown, False) | np.append(False, shown)
        if np.any(shown):
            axes.plot(
                np.where(shown, places, np.nan),
                np.where(shown, values, np.nan),
                style,
                marker="o" if len(told) == 1 else None,
                color=figures.COLOURS[STABLE if wanted else UNSTABLE],
                label=word,
            )


def near(motions: Sequence[Motion], spin: float) -> list[Motion]:
    """Rotating motions up to a spin in rad/s not far beyond this, where a disk is nearly flat."""
    return list(takewhile(lambda each: each["spin"] < spin + _SHOWN, motions))


def diagram(
    motions: Sequence[Motion],
    names: Sequence[str],
    *,
    parameter: tuple[str, str] = ("spin", figures.SPIN),
    log: bool = False,
    marks: Mapping[str, float] | None = None,
) -> Any:
    """What is told of motions over their spin or another number, one below the other.

    Parameters
    ----------
    motions : sequence of Motion
    names : sequence of str
        Of `HEADS`.
    parameter : tuple of 2 str
        Name and heading of what they are drawn over.
    log : bool
        Whether that has a logarithmic axis.
    marks : mapping, optional
        From labels to what is marked on the horizontal axis.
    """
    figure, axes = figures.new_figure(len(names), height=1.2 + 2.4 * len(names))
    panels = np.atleast_1d(axes)
    for each, name in zip(panels, names, strict=True):
        values = _values(motions, name)
        lines(each, motions, values, parameter[0])
        for label, place in (marks or {}).items():
            each.axvline(place, color=GREY, linestyle="-.", label=label, zorder=0)
        each.set(ylabel=HEADS[name])
        if name == "multiplier":
            bounds = (1.0, -1.0) if np.min(values) < -1.0 else (1.0,)
            for bound in bounds:
                each.axhline(bound, color=GREY, linewidth=0.8, zorder=0)
            if np.max(np.abs(values)) > 10.0:
                # Between -1 and 1 it is linear where some are negative.
                if np.min(values) > 0.0:
                    each.set_yscale("log")
                else:
                    each.set_yscale("symlog", linscale=2.0)
                each.set(ylabel=f"{HEADS[name]}, logarithmic")
                each.yaxis.get_major_locator().set_params(numticks=_TICKS)
    panels[-1].set(xlabel=parameter[1], xscale="log" if log else "linear")
    figures.legend_above(panels[0], columns=3)
    return figure


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
    for (name, states), look in zip(named, cycle(figures.LOOKS), strict=False):
        axes.plot(states[:, 1], states[:, 0], label=name, **look)
    if saddles:
        upright = [np.pi / 2] * len(saddles)
        axes.plot(saddles, upright, "s", color="black", label="noninverted spinning")
    axes.set(xlabel="γ in rad", ylabel="β in rad")
    figures.legend_above(axes)
    return axes.figure


def passage_diagram(named: Sequence[tuple[str, Passage]]) -> Any:
    """Mean spin and slow deviation over time, with what the eigenvalues predict.

    Parameters
    ----------
    named : sequence of (name, Passage)
    """
    axes = figures.new_figure(2, height=6.5)[1]
    marks: dict[str, tuple[Any, dict[str, Any]]] = {}
    for index, (name, passage) in enumerate(named):
        look = {"color": figures.COLOURS[index % 4]}
        style, times = figures.STYLES[index % 4], passage["times"]
        axes[0].plot(times, passage["spins"], style, label=name, **look)
        axes[0].axhline(passage["hopf"], linewidth=0.8, **look)
        axes[1].plot(times, passage["deviations"], style, **look)
        axes[1].plot(times, passage["linear"], linewidth=0.8, **look)
        predicted, hopf, last = passage["predicted"], passage["hopf"], passage["spins"][-1]
        for label, panel, place, marker in (
            ("Hopf point passed", axes[0], (passage["crossing"], hopf), {"marker": "o"}),
            ("inversion lost", axes[0], (passage["lost"], last), {"marker": "s"}),
            ("loss predicted", axes[1], (predicted, LOST), {"marker": "D", "mfc": "white"}),
        ):
            if place[0] is not None:
                panel.plot(*place, linestyle="none", **marker, **look)
                marks[label] = (panel, marker)
        if predicted is not None and predicted > times[-1]:
            onward = (times[-1], predicted), (passage["linear"][-1], LOST)
            axes[1].plot(*onward, ":", linewidth=0.8, **look)
    axes[0].plot([], [], color="black", linewidth=0.8, label="Hopf point of each")
    axes[1].axhline(LOST, color=GREY, linewidth=0.8, label="γ off by π/2")
    axes[0].set(ylabel="mean spin in rad/s")
    axes[1].set(xlabel="time in s", yscale="log")
    axes[1].set_ylabel("slow deviation of γ in rad, logarithmic")
    axes[1].plot([], [], color="black", linewidth=0.8, label="by the eigenvalues alone")
    for label, (panel, marker) in marks.items():
        panel.plot([], [], color="black", linestyle="none", label=label, **marker)
    for each in axes:
        figures.legend_above(each, columns=2)
    return axes[0].figure
