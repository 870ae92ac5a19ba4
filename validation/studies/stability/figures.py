"""Figures 6, 10 and 11 of the paper, and the stability chart beyond it.

In-house eigenvalues are lines, those of the engine markers. Functions draw into given axes.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.colors import BoundaryNorm, ListedColormap

from analysis import MODELS, Motion, Scenario
from analysis.data.checks import Array
from analysis.stability import linear_reduced, spectra
from analysis.stability.chart import StabilityChart, static_gradient
from analysis.stability.corners import Corner
from analysis.stability.critical import critical_speeds
from analysis.stability.hopf_curves import HopfCurve
from validation.kit import figures
from validation.kit.figures import Picture

ComplexArray = npt.NDArray[np.complex128]

FULL, REDUCED = Scenario(constraints=MODELS[1]), Scenario(constraints=MODELS[4])

SPINS = np.linspace(0.0, 50.0, 501)
"""Spins of the lines in rad/s, those of the paper's figures."""

ENGINE_SPINS = np.linspace(0.0, 50.0, 26)
"""Spins of the engine's markers in rad/s."""

_COLOURS = ("#d55e00", "#009e73", "#0072b2", "#cc79a7")
"""Vermilion, green, blue and purple of the Okabe-Ito palette; red, green, blue as in the paper."""

_LOWEST = -60.0
"""Real part in 1/s below which an eigenvalue is one of sliding friction."""

_DASHED = "Dashed: the other one of a pair. Shaded: unstable, Re λ > 0. "

_UNSTABLE = {"color": "#d55e00", "alpha": 0.10, "linewidth": 0}


def branch_lines(
    axes: Sequence[Any], branches: spectra.Branches, columns: Sequence[tuple[int, int, str]]
) -> None:
    """Draw real and imaginary parts of some branches into two axes.

    Parameters
    ----------
    axes : sequence of 2 Axes
    branches : Branches
    columns : sequence of (column, colour index, label)
        An empty label keeps a branch out of the legend and draws it dashed.
    """
    for column, colour, label in columns:
        look = {"color": _COLOURS[colour], "linestyle": "-" if label else "--"}
        values = branches.values[:, column]
        axes[0].plot(branches.spins, values.real, label=label or None, **look)
        axes[1].plot(branches.spins, values.imag, **look)


def engine_markers(
    axes: Sequence[Any], spins: Array, values: ComplexArray, *, lowest: float = _LOWEST
) -> None:
    """Draw eigenvalues of the engine, shape (n, k), as markers into two axes.

    Those with a real part below `lowest`, in 1/s, are left out.
    """
    look = {
        "linestyle": "none",
        "marker": "o",
        "markersize": 3.5,
        "markerfacecolor": "white",
        "markeredgecolor": "black",
        "markeredgewidth": 0.8,
        "zorder": 3,
    }
    shown = np.where(values.real > lowest, values, complex(np.nan, np.nan))
    for index in range(shown.shape[1]):
        label = "engine" if index == 0 else None
        axes[0].plot(spins, shown[:, index].real, label=label, **look)
        axes[1].plot(spins, shown[:, index].imag, **look)


def full_columns(branches: spectra.Branches) -> list[tuple[int, int, str]]:
    """Columns of the full system in the paper's colours, without lambda_7 and lambda_8.

    Slow and fast pair are told apart by their frequency at the highest spin.
    """
    last = branches.values[-1]
    shown = [
        column
        for column in range(last.size)
        if column not in branches.drift and abs(last[column].imag) > 0.0
    ]
    shown.sort(key=lambda column: (abs(last[column].imag), -last[column].imag))
    result = [
        (column, 0 if index < 2 else 2, "" if index % 2 else label)
        for index, (column, label) in enumerate(
            zip(shown, ("$λ_{1,2}$", "", "$λ_{5,6}$", ""), strict=False)
        )
    ]
    drift = [(column, 1, "" if i else "$λ_{3,4}$") for i, column in enumerate(branches.drift)]
    return result[:2] + drift + result[2:]


def _label_axes(axes: Sequence[Any]) -> None:
    axes[0].set(ylabel="Re λ in 1/s")
    axes[1].set(ylabel="Im λ in 1/s", xlabel="spinning speed Ω in rad/s")
    axes[0].axhline(0.0, color="#999999", linewidth=0.8, zorder=0)


def figure_6(engine: ComplexArray) -> Picture:
    """Inverted spinning, full system, with the magnified crossings.

    Parameters
    ----------
    engine : ndarray, complex, shape (26, 8)
        Eigenvalues of the engine's Model 1 at `ENGINE_SPINS`.
    """
    branches = spectra.branches(FULL, SPINS)
    columns = full_columns(branches)
    figure, axes = figures.new_figure(4, height=10.5, share=False)
    branch_lines(axes, branches, columns)
    engine_markers(axes, ENGINE_SPINS, engine)
    axes[0].set(ylim=(-12.0, 17.0))
    axes[1].set(ylim=(-55.0, 55.0))
    _label_axes(axes[:2])
    _friction_panel(axes[3], branches, engine)
    for each in (axes[0], axes[1], axes[3]):
        each.set_xlim(0.0, 50.0)
    axes[0].axhspan(0.0, 60.0, **_UNSTABLE)
    axes[2].axhspan(0.0, 1.0, **_UNSTABLE)
    branch_lines((axes[2], _Nothing()), branches, columns)
    engine_markers((axes[2], _Nothing()), ENGINE_SPINS, engine)
    # Labels lie where no branch runs: below the lower crossing, above the upper one.
    for crossing, shift in zip(
        critical_speeds(FULL, (0.0, 50.0)).hopf, ((4, -14), (10, 6)), strict=True
    ):
        axes[2].plot(crossing.spin, 0.0, "D", color="black", markersize=5, zorder=4)
        axes[2].annotate(
            f"{crossing.spin:.2f} rad/s",
            (crossing.spin, 0.0),
            xytext=shift,
            textcoords="offset points",
        )
    axes[2].set(ylim=(-0.35, 0.6), ylabel="Re λ in 1/s,\nmagnified")
    axes[2].set(xlabel="spinning speed Ω in rad/s", xlim=(22.0, 38.0))
    figures.legend_above(axes[0])
    return figures.render(
        figure,
        name="paper-fig-6",
        paper="Fig. 6",
        title="Eigenvalues of inverted spinning, full system",
        caption="Lines: Eq. (55); markers: the engine's Model 1. "
        + _DASHED
        + "Diamonds: crossings. λ₃,₄ are ±iΩ exactly: a place on the table, seen from the turning "
        "frame. λ₇ and λ₈, which belong to sliding friction, are real and have a panel of their "
        "own. At every spin from 0 to 50 rad/s a pair has a positive real part.",
    )


def _friction_panel(axes: Any, branches: spectra.Branches, engine: ComplexArray) -> None:
    """Draw the real and fast lambda_7 and lambda_8."""
    fast = [
        column
        for column in range(branches.values.shape[1])
        if branches.values[0, column].real < _LOWEST
    ]
    branch_lines((axes, _Nothing()), branches, [(column, 3, "$λ_{7,8}$") for column in fast])
    values = np.where(engine.real < _LOWEST, engine, complex(np.nan, np.nan))
    engine_markers((axes, _Nothing()), ENGINE_SPINS, values, lowest=-np.inf)
    axes.set(ylabel="Re $λ_{7,8}$ in 1/s", xlabel="spinning speed Ω in rad/s")


class _Nothing:
    """Axes that draw nothing."""

    def plot(self, *_arguments: Any, **_look: Any) -> None:
        """Draw nothing."""


def figure_10(engine: ComplexArray) -> Picture:
    """Inverted spinning, reduced system, with the closed form in black.

    Parameters
    ----------
    engine : ndarray, complex, shape (26, 3)
        Eigenvalues of the engine's Model 4 at `ENGINE_SPINS`.
    """
    branches = spectra.branches(REDUCED, SPINS)
    pair = np.flatnonzero(branches.values[-1].imag)
    columns = [(int(pair[0]), 0, "$λ_{1,2}$"), (int(pair[1]), 0, "")]
    critical = linear_reduced.critical_speed(REDUCED).spin
    figure, axes = figures.new_figure(2, height=6.5)
    axes[0].axhspan(0.0, 60.0, **_UNSTABLE)
    branch_lines(axes, branches, columns)
    closed = linear_reduced.closed_form(REDUCED, SPINS).eigenvalues
    for index in range(2):
        look = {"color": "black", "linewidth": 0.9, "linestyle": ":"}
        label = "closed form" if index == 0 else None
        axes[0].plot(SPINS, closed[:, index].real, label=label, **look)
        axes[1].plot(SPINS, closed[:, index].imag, **look)
    engine_markers(axes, ENGINE_SPINS, engine)
    axes[0].plot(critical, 0.0, "D", color="black", markersize=5, zorder=4)
    axes[0].annotate(
        f"{critical:.2f} rad/s", (critical, 0.0), xytext=(6, 6), textcoords="offset points"
    )
    axes[0].set(ylim=(-5.0, 8.0))
    axes[1].set(xlim=(0.0, 50.0), ylim=(-13.0, 13.0))
    _label_axes(axes)
    figures.legend_above(axes[0])
    return figures.render(
        figure,
        name="paper-fig-10",
        paper="Fig. 10",
        title="Eigenvalues of inverted spinning, reduced system",
        caption="Lines: Eq. (111); dotted: the closed form (119)-(123) for small smoothing; "
        "markers: the engine's Model 4. "
        + _DASHED
        + "λ₃ (about −129 1/s) lies below the picture.",
    )


def figure_11(engine: ComplexArray) -> Picture:
    """Noninverted spinning, full system.

    Parameters
    ----------
    engine : ndarray, complex, shape (26, 8)
        Eigenvalues of the engine's Model 1 at `ENGINE_SPINS`.
    """
    motion: Motion = "noninverted"
    branches = spectra.branches(FULL, SPINS, motion=motion)
    slow = [
        column
        for column in range(branches.values.shape[1])
        if branches.values[0, column].real > _LOWEST and column not in branches.drift
    ]
    real = [column for column in slow if abs(branches.values[-1, column].imag) == 0.0]
    pair = [column for column in slow if column not in real]
    columns = [(column, 0, "" if i else "real") for i, column in enumerate(real)]
    columns += [(column, 2, "" if i else "pair") for i, column in enumerate(pair)]
    columns += [(column, 1, "" if i else "±iΩ") for i, column in enumerate(branches.drift)]
    figure, axes = figures.new_figure(2, height=6.5)
    axes[0].axhspan(0.0, 60.0, **_UNSTABLE)
    branch_lines(axes, branches, columns)
    engine_markers(axes, ENGINE_SPINS, engine)
    axes[0].set(ylim=(-20.0, 22.0))
    axes[1].set(xlim=(0.0, 50.0), ylim=(-55.0, 55.0))
    _label_axes(axes)
    figures.legend_above(axes[0])
    return figures.render(
        figure,
        name="paper-fig-11",
        paper="Fig. 11",
        title="Eigenvalues of noninverted spinning, full system",
        caption="Lines: Eq. (55) with the eccentricity reversed; markers: the engine's Model 1. "
        + _DASHED
        + "A real eigenvalue is positive at every spin: noninverted spinning is unstable.",
    )


def chart(grid: StabilityChart, curves: Sequence[HopfCurve], corners: Sequence[Corner]) -> Picture:
    """Number of unstable eigenvalues over spin and friction gradient, with its boundaries."""
    figure, axes = figures.new_figure(height=5.6)
    levels = np.arange(-0.5, 5.0)
    colours = ListedColormap(["#ffffff", "#f6e3c5", "#e7b46a", "#c07a2c", "#7d4a12"])
    shades = axes.pcolormesh(
        grid.spins,
        grid.gradients,
        grid.unstable,
        cmap=colours,
        norm=BoundaryNorm(levels, colours.N),
        shading="nearest",
        rasterized=True,
    )
    for index, curve in enumerate(curves):
        axes.plot(
            curve.spins,
            curve.gradients,
            color="#0072b2",
            linestyle=("-", "--", "-.")[index % 3],
            label="a slow pair crosses" if index == 0 else "a fast pair crosses",
        )
    static = static_gradient(FULL, grid.spins, grid.motion)
    axes.plot(grid.spins, static, color="black", linestyle=":", label="a real eigenvalue is zero")
    for corner in corners:
        axes.plot(corner.spin, corner.gradient, "o", color="black", markersize=5)
    axes.axhline(3.0, color="#999999", linewidth=0.8)
    axes.annotate("the paper: 3 s/m", (1.0, 3.0), va="bottom", fontsize=9)
    inside = max(corners, key=lambda corner: corner.gradient, default=None)
    if inside is not None:
        axes.annotate(
            "stable",
            (inside.spin + 1.0, 0.75 * inside.gradient),
            xytext=(30, 45),
            textcoords="offset points",
            arrowprops={"arrowstyle": "-", "color": "black"},
        )
    axes.set_yscale("log")
    axes.set(
        xlim=(grid.spins[0], grid.spins[-1]),
        ylim=(grid.gradients[0], grid.gradients[-1]),
        xlabel="spinning speed Ω in rad/s",
        ylabel="friction gradient μ/ε in s/m",
    )
    figure.colorbar(shades, ax=axes, ticks=range(5), label="number of unstable eigenvalues")
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    return figures.render(
        figure,
        name="stability-chart",
        title="Where inverted spinning is stable in the full system",
        caption="White: stable. Curves: Hopf points by continuation, and where a real eigenvalue "
        "is zero (closed form). Dots: where the boundaries meet.",
    )
