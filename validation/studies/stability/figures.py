"""Figures 6, 10 and 11 of the paper, and the stability chart beyond it.

In-house eigenvalues are lines, those of the engine circles, what the paper prints crosses.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from analysis import MODELS, Scenario
from analysis.mechanics.paper import closed_form
from analysis.stability import spectra
from analysis.stability.chart import stability_chart, static_gradient
from analysis.stability.linearisation import ComplexArray
from validation.display.figures import ENGINE, SPIN, legend_above, new_figure
from validation.studies.stability import measured

FULL, REDUCED = Scenario(constraints=MODELS[1]), Scenario(constraints=MODELS[4])

SPINS = np.linspace(0.0, 50.0, 501)
"""Spins of the lines in rad/s, those of the paper's figures."""

_COLOURS = ("#d55e00", "#009e73", "#0072b2")
"""Of each two branches: vermilion, green and blue, as in the paper."""

_LOWEST = -60.0
"""Real part in 1/s below which an eigenvalue is one of sliding friction."""

_CIRCLE = {**ENGINE, "markersize": 3.5, "markeredgewidth": 0.8, "zorder": 3}


def spectrum(
    branches: ComplexArray,
    engine: Any,
    labels: Mapping[int, str],
    *limits: tuple[str, float, float],
) -> tuple[Figure, Any]:
    """Draw parts of branches of eigenvalues, the second one of a pair dashed, and the engine's.

    Parameters
    ----------
    branches : ndarray, complex, shape (n, k)
        Over `SPINS`.
    engine : Series
        A row of `measured.compare`, here and below.
    labels : mapping
        From the first column of each pair to its label.
    *limits : tuples of str, float, float
        One for each panel: "real" or "imag", and lowest and highest value.
    """
    figure, axes = new_figure(len(limits), height=3.3 * len(limits), share=False)
    for each, (part, low, high) in zip(axes, limits, strict=True):
        for first, label in labels.items():
            look = {"color": _COLOURS[first // 2]}
            values = getattr(branches, part)
            each.plot(SPINS, values[:, first], label=label, **look)
            each.plot(SPINS, values[:, first + 1], "--", **look)
        shown = np.where(np.array(engine["real"]) > _LOWEST, engine[part], np.nan)
        each.plot(engine["spins"], shown, **_CIRCLE)[0].set_label("engine")
        each.set(xlim=SPINS[[0, -1]], ylim=(low, high))
        each.set_ylabel("Re λ in 1/s" if part == "real" else "Im λ in 1/s")
        if part == "real":
            each.axhspan(0.0, 60.0, color=_COLOURS[0], alpha=0.10, linewidth=0)
    axes[-1].set_xlabel(SPIN)
    return figure, axes


def mark(axes: Any, found: pd.DataFrame, places: Mapping[str, str], side: str = "left") -> None:
    """Mark what is found and what the paper prints; numbers above, on a side, and below.

    Parameters
    ----------
    axes : Axes
    found : DataFrame
        Rows of `measured.printed_numbers`, by their quantities.
    places : mapping
        From quantities that are spins to the part of the eigenvalue there, or "" for zero.
    side : {"left", "right"}
    """
    other = "right" if side == "left" else "left"
    printed = found["printed"].str.split().str[0].astype(float)
    for values, marker, label, at, up, digits, colour in (
        (found[measured.HERE], "D", "found here", side, 10, ".2f", "black"),
        (printed, "X", "in the paper", other, -16, "g", "#a0208c"),
    ):
        spins, parts = values[[*places]], [values.get(part, 0.0) for part in places.values()]
        look = {"color": colour, "markersize": 7, "markeredgecolor": "white", "zorder": 4}
        axes.plot(spins, parts, marker, label=label, **look)
        for spin, part in zip(spins, parts, strict=True):
            axes.annotate(
                format(part or spin, digits),
                (spin, part),
                xytext=(3 if at == "right" else -3, up),
                textcoords="offset points",
                ha="left" if at == "right" else "right",
                color=colour,
                bbox={"facecolor": "white", "alpha": 0.7, "pad": 0.5, "linewidth": 0.0},
            )


def figure_6(engine: Any, found: pd.DataFrame) -> Figure:
    """Inverted spinning of the full system, with its crossings magnified; see `mark`."""
    labels = {0: "$λ_{1,2}$", 2: "$λ_{3,4}$", 4: "$λ_{5,6}$"}
    limits = ("real", -12.0, 17.0), ("imag", -55.0, 55.0), ("real", -0.25, 0.4)
    figure, axes = spectrum(spectra.branches(FULL, SPINS), engine, labels, *limits)
    mark(axes[2], found, dict.fromkeys(measured.HOPF, ""))
    axes[2].set(xlim=(25.0, 32.0), ylabel="Re λ in 1/s, magnified")
    legend_above(axes[0])
    axes[2].legend(*(each[-2:] for each in axes[2].get_legend_handles_labels()), loc="lower left")
    return figure


def figure_10(engine: Any, found: pd.DataFrame) -> Figure:
    """Inverted spinning of the reduced system, with the closed form dotted; see `mark`."""
    closed = closed_form(REDUCED, SPINS)[:, :2]
    limits = ("real", -5.0, 8.0), ("imag", -3.0, 12.0)
    branches = spectra.branches(REDUCED, SPINS)
    figure, axes = spectrum(branches, engine, {0: "$λ_{1,2}$"}, *limits)
    for each, values in zip(axes, (closed.real, closed.imag), strict=True):
        dotted = each.plot(SPINS, values, ":", color="black", linewidth=0.9)
        dotted[0].set_label("closed form")
    mark(axes[0], found, {measured.CLOSED: ""}, side="right")
    mark(axes[1], found, {measured.BORN: "", measured.CLOSED: measured.FREQUENCY})
    legend_above(axes[0], columns=3)
    return figure


def figure_11(engine: Any) -> Figure:
    """Noninverted spinning of the full system."""
    labels = {0: "real", 4: "pair", 2: "±iΩ"}
    limits = ("real", -20.0, 22.0), ("imag", -55.0, 55.0)
    branches = spectra.branches(FULL, SPINS, motion="noninverted")
    figure, axes = spectrum(branches, engine, labels, *limits)
    legend_above(axes[0])
    return figure


def chart(region: pd.DataFrame) -> Figure:
    """Number of unstable eigenvalues over spin and friction gradient, with its boundaries.

    Parameters
    ----------
    region : DataFrame
        Rows of `measured.stable_region`.
    """
    shown_spins, shown_gradients = np.linspace(0.0, 80.0, 200), np.geomspace(0.3, 30.0, 200)
    figure, axes = new_figure(height=5.6)
    colours = ListedColormap(["#ffffff", "#f6e3c5", "#e7b46a", "#c07a2c", "#7d4a12"])
    shades = axes.pcolormesh(
        shown_spins,
        shown_gradients,
        stability_chart(FULL, shown_spins, shown_gradients),
        cmap=colours,
        norm=BoundaryNorm(np.arange(-0.5, 5.0), colours.N),
        shading="nearest",
        rasterized=True,
    )
    curves, corners, points = (
        region[region.kind == kind] for kind in ("curve", "corner", "point")
    )
    for index, (spins, gradients) in enumerate(zip(curves.spins, curves.gradients, strict=True)):
        label = "a slow pair crosses" if index == 0 else "a fast pair crosses"
        axes.plot(spins, gradients, ("-", "--", "-.")[index % 3], color="#0072b2", label=label)
    static = static_gradient(FULL, shown_spins)
    axes.plot(shown_spins, static, ":", color="black", label="a real eigenvalue is zero")
    axes.plot(corners.spin, corners.gradient, "o", color="black", markersize=5, label="corners")
    axes.plot(points.spin, points.gradient, **{**_CIRCLE, "marker": "s"}, label="engine asked")
    axes.axhline(measured.PAPER_GRADIENT, color="#777777", linewidth=0.8)
    axes.annotate(
        f"the paper: {measured.PAPER_GRADIENT:g} s/m", (1.0, measured.PAPER_GRADIENT), va="bottom"
    )
    axes.set(xlabel=SPIN, ylabel="friction gradient μ/ε in s/m, logarithmic", yscale="log")
    ticks = [0.3, 1.0, 3.0, 10.0, 30.0]
    axes.set_yticks(ticks, [f"{each:g}" for each in ticks])
    axes.set(xlim=shown_spins[[0, -1]], ylim=shown_gradients[[0, -1]])
    figure.colorbar(shades, ax=axes, ticks=range(5), label="number of unstable eigenvalues")
    legend_above(axes, columns=2, size=9)
    return figure
