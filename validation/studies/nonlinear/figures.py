"""Pictures of cycles: in-house as lines, the engine as markers. Functions draw into given axes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analysis import Scenario
from analysis.data.checks import Array
from analysis.data.files import AnyArray
from analysis.nonlinear.asymmetric import AsymmetricFamily
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import CycleFamily
from analysis.nonlinear.heteroclinic import Fall
from analysis.nonlinear.rotating import RotationFamily
from validation.kit import figures
from validation.studies.nonlinear.passage import LOST, DelayLaw, Passage
from validation.studies.nonlinear.tables import prediction

_ENGINE = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 6,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "zorder": 4,
}

_GREY = "#777777"

_SHOWN = 1.0
"""Range of spins of rotating motions that is shown, in rad/s."""


def family_lines(
    axes: Any,
    family: CycleFamily,
    values: Array,
    first: float | None = None,
    label: str = "cycles",
) -> None:
    """Draw a quantity of a family over the spin, solid where stable and dashed where not.

    Parameters
    ----------
    axes : Axes
    family : CycleFamily
    values : ndarray, shape (n,)
        One for each cycle.
    first : float, optional
        Its value at the Hopf point.
    label : str
    """
    spins = family.values("spin")
    stable = np.array([cycle.stable is not False for cycle in family.cycles])
    if first is not None:
        spins, values = np.append(family.hopf.spin, spins), np.append(first, values)
        stable = np.append(stable[0], stable)
    _lines(axes, spins, values, stable, label=label)


def _lines(
    axes: Any,
    spins: Array,
    values: Array,
    stable: AnyArray,
    *,
    label: str,
    colours: tuple[int, int] = (1, 2),
) -> None:
    """Draw values over spins, shape (n,), in the colours of stable ones and of others."""
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
    family_lines(axes, family, family.values("amplitude"), 0.0)
    hopf, spins = family.hopf.spin, family.values("spin")
    ends = [min(hopf, *spins), max(hopf, *spins)]
    if connection is not None:
        ends = [min(ends[0], connection), max(ends[1], connection)]
    room = 0.15 * (ends[1] - ends[0])
    low, high = ends[0] - room, ends[1] + room
    axes.plot([hopf, high], [0.0, 0.0], color=figures.COLOURS[1])
    axes.plot([low, hopf], [0.0, 0.0], "--", color=figures.COLOURS[2])
    axes.plot([low, high], [np.pi, np.pi], "--", color=figures.COLOURS[2])
    axes.annotate("inverted spinning", (low, 0.0), (low + 2.0 * room, 0.12))
    axes.annotate("noninverted spinning", (high, np.pi), (high - room, np.pi - 0.25), ha="right")
    axes.plot(hopf, 0.0, "D", color="black", label="Hopf point", zorder=5)
    if slow:
        axes.plot(*zip(*slow, strict=True), ":", color=figures.COLOURS[3], label="slow manifold")
    if connection is not None:
        axes.axvline(connection, color=_GREY, linestyle="-.", label="heteroclinic", zorder=0)
    if engine:
        axes.plot(*zip(*engine, strict=True), label="engine", **_ENGINE)
    axes.set(
        xlabel="spinning speed Ω in rad/s",
        ylabel="amplitude max |γ − π/2| in rad",
        xlim=(low, high),
    )
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
    hopf = family.hopf
    family_lines(axes[0], family, family.values("period"), 2.0 * np.pi / hopf.frequency)
    family_lines(axes[1], family, family.values("multiplier"), 1.0)
    family_lines(axes[2], family, family.values("log_strong") / np.log(10.0))
    for each in axes:
        if connection is not None:
            each.axvline(connection, color=_GREY, linestyle="-.", label="heteroclinic", zorder=0)
    axes[0].set(ylabel="period in s")
    axes[1].set(ylabel="larger Floquet multiplier")
    axes[1].axhline(1.0, color=_GREY, linewidth=0.8, zorder=0)
    if np.max(family.values("multiplier")) > 10.0:
        axes[1].set_yscale("log")
    axes[2].set(ylabel="log10 of the smaller one", xlabel="spinning speed Ω in rad/s")
    figures.legend_above(axes[0], columns=3)
    return axes


def rotation_diagram(family: RotationFamily, axes: Any = None) -> Any:
    """Largest and least tilt of rotating motions over the spin."""
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    spins = family.values("spin")
    stable = np.array([each.stable is not False for each in family.rotations])
    for name, label, colour in (("largest_tilt", "largest", 2), ("tilt", "noninverted", 1)):
        _lines(axes, spins, family.values(name), stable, label=label, colours=(colour, colour))
    axes.axvline(
        family.connection.spin, color=_GREY, linestyle="-.", label="heteroclinic", zorder=0
    )
    axes.set(xlabel="spinning speed Ω in rad/s", ylabel="β − π/2 in rad")
    # Where the disk is nearly flat the spin has no bounds.
    last = min(float(np.max(spins)), family.connection.spin + _SHOWN)
    axes.set_xlim(np.min(spins) - 0.05 * _SHOWN, last)
    axes.set_ylim(0.0, 1.1 * np.max(family.values("largest_tilt")[spins <= last]))
    figures.legend_above(axes, columns=2)
    return axes


def asymmetric_diagram(family: AsymmetricFamily, symmetric: CycleFamily) -> Any:
    """Largest deviations to either side of cycles without symmetry over the spin."""
    axes = figures.new_figure(height=4.6)[1]
    spins = np.array([each.spin for each in family.cycles])
    stable = np.array([each.stable for each in family.cycles])
    largest = np.array([each.amplitude for each in family.cycles])
    least = np.array([each.lowest for each in family.cycles])
    born = family.bifurcation.cycle
    near = symmetric.values("amplitude") <= np.max(largest)
    axes.plot(
        symmetric.values("spin")[near],
        symmetric.values("amplitude")[near],
        ":",
        color=_GREY,
        label="symmetric",
    )
    _lines(axes, spins, largest, stable, label="to one side", colours=(2, 2))
    _lines(axes, spins, -least, stable, label="to the other", colours=(1, 1))
    axes.plot(born.spin, born.amplitude, "D", color="black", label="symmetry breaks", zorder=5)
    axes.set(xlabel="spinning speed Ω in rad/s", ylabel="largest deviation of γ in rad")
    figures.legend_above(axes, columns=2)
    return axes


def cycle_portrait(cycles: Sequence[Cycle], axes: Any = None) -> Any:
    """Cycles in the plane of gamma and beta."""
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    for index, cycle in enumerate(cycles):
        states = cycle.full[1]
        axes.plot(
            states[:, 1],
            states[:, 0],
            color=figures.COLOURS[index % 4],
            linestyle=figures.STYLES[index // 4 % 4],
            label=f"{cycle.spin:.6g} rad/s",
        )
    axes.set(xlabel="γ in rad", ylabel="β in rad")
    figures.legend_above(axes)
    return axes


def connection_portrait(ways: Sequence[Fall], names: Sequence[str], axes: Any = None) -> Any:
    """Motions that leave noninverted spinning, near the connection, in gamma and beta."""
    axes = figures.new_figure(height=4.6)[1] if axes is None else axes
    for index, (way, name) in enumerate(zip(ways, names, strict=True)):
        axes.plot(
            way.states[:, 1],
            way.states[:, 0],
            color=figures.COLOURS[index % 4],
            linestyle=figures.STYLES[index % 4],
            label=name,
        )
    for place in (-np.pi / 2, 3 * np.pi / 2):
        axes.plot(place, np.pi / 2, "s", color="black")
    axes.set(xlabel="γ in rad", ylabel="β in rad")
    figures.legend_above(axes)
    return axes


def passage_diagram(named: Sequence[tuple[str, Passage]], axes: Any = None) -> Any:
    """Mean spin and slow deviation over time, with what the eigenvalues predict.

    Parameters
    ----------
    named : sequence of (name, Passage)
    axes : sequence of 2 Axes, optional
    """
    axes = figures.new_figure(2, height=6.5)[1] if axes is None else axes
    for index, (name, passage) in enumerate(named):
        look = {"color": figures.COLOURS[index % 4]}
        style = figures.STYLES[index % 4]
        axes[0].plot(passage.times, passage.spins, style, label=name, **look)
        axes[1].plot(passage.times, passage.deviations, style, label=name, **look)
        axes[1].plot(passage.times, passage.linear, linewidth=0.8, **look)
        if passage.crossing is not None:
            axes[0].plot(passage.crossing, passage.pair.spin, "o", **look)
        if passage.lost is not None:
            axes[0].plot(passage.lost, passage.spins[-1], "s", **look)
        if passage.predicted is not None:
            axes[1].plot(passage.predicted, LOST, "D", markerfacecolor="white", **look)
    hopf = named[0][1].pair.spin
    axes[0].axhline(hopf, color=_GREY, linewidth=0.8, label=f"Hopf point, {hopf:.2f} rad/s")
    axes[1].axhline(LOST, color=_GREY, linewidth=0.8)
    axes[0].set(ylabel="mean spin in rad/s")
    axes[1].set(ylabel="slow deviation of γ in rad", xlabel="time in s", yscale="log")
    axes[1].plot([], [], color="black", linewidth=0.8, label="by the eigenvalues alone")
    axes[1].plot([], [], "D", color="black", markerfacecolor="white", label="loss predicted")
    axes[0].plot([], [], "s", color="black", label="inversion lost")
    for each in axes:
        figures.legend_above(each, columns=2)
    return axes


def delay_diagram(law: DelayLaw, axes: Any = None) -> Any:
    """Delay of the loss of inversion over the rate of decay, with the law's root."""
    axes = figures.new_figure()[1] if axes is None else axes
    axes.loglog(law.rates, law.delays, label="measured", **_ENGINE)
    root = np.sqrt(law.rates) * np.exp(np.mean(np.log(law.delays / np.sqrt(law.rates))))
    axes.loglog(law.rates, root, color=figures.COLOURS[1], label="root of the rate")
    axes.set(xlabel="rate of decay in rad/s²", ylabel="Hopf point less lowest spin in rad/s")
    # Both go over a decade at most, in which powers of ten say little.
    axes.set_xticks(law.rates, [f"{each:.2g}" for each in law.rates])
    axes.set_yticks(law.delays, [f"{each:.2g}" for each in law.delays])
    axes.minorticks_off()
    figures.legend_above(axes)
    return axes


def limit(scenario: Scenario) -> float | None:
    """Spin of the connection for vanishing smoothing in rad/s, if friction can hold the disk."""
    slow = prediction(scenario)
    return None if slow is None else slow.spin


def plane(
    hopf: float,
    curves: Mapping[float, Sequence[tuple[float, float]]],
    limits: Mapping[float, float | None],
    axes: Any = None,
) -> Any:
    """Hopf and heteroclinic curves in the plane of spin and smoothing.

    Parameters
    ----------
    hopf : float
        Spin of the Hopf point in rad/s, the same for all friction.
    curves : mapping
        From the friction coefficient to (smoothing in m/s, spin in rad/s) of the connection.
    limits : mapping
        From the friction coefficient to the spin of vanishing smoothing.
    axes : Axes, optional
    """
    axes = figures.new_figure()[1] if axes is None else axes
    highest = max(eps for curve in curves.values() for eps, _ in curve)
    axes.plot((hopf, hopf), (0.0, highest), color=figures.COLOURS[0], label="Hopf")
    for index, (mu, curve) in enumerate(curves.items(), 1):
        look = {"color": figures.COLOURS[index % 4]}
        eps, spins = zip(*curve, strict=True)
        style = figures.STYLES[index % 4]
        axes.plot(spins, eps, style, marker=".", label=f"heteroclinic, μ = {mu:g}", **look)
        if limits[mu] is not None:
            axes.plot(limits[mu], 0.0, "D", **look)
    axes.set(xlabel="spinning speed Ω in rad/s", ylabel="smoothing speed ε in m/s")
    axes.set_ylim(bottom=-0.002)
    figures.legend_above(axes)
    return axes
