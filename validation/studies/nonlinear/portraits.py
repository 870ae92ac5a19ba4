"""Phase portraits of the reduced system in gamma and beta, with the manifolds of the saddle.

Motions are followed forwards in the whole reduced system. The stable manifold of noninverted
spinning would take runs backwards, in which the fast direction explodes; it is followed on the
slow manifold instead, to first order.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analysis import Scenario
from analysis.data.checks import Array
from analysis.mechanics import reduced
from analysis.nonlinear.cycle import INVERTED
from analysis.nonlinear.family import cycle_at
from analysis.nonlinear.heteroclinic import saddle
from analysis.nonlinear.slow_manifold import slow_rates
from validation.kit import figures

SPINS = (29.6, 30.120961805, 30.5, 30.85, 33.0)
"""Spins in rad/s: below the connection, on it, two with a cycle, and above the Hopf point."""

TITLES = (
    "below the connection",
    "on the connection",
    "a large cycle",
    "a small cycle",
    "above the Hopf point",
)

WITH_CYCLE = (30.5, 30.85)
"""Those at which the cycle is drawn; on the connection the unstable manifold is its limit."""

_NONINVERTED = np.array((np.pi / 2, -np.pi / 2, 0.0))
_AWAY = 1e-3
_FLAT = 0.5
"""Inclination in rad from flat at which curves end."""

_SAMPLES = 1000
_LONG, _BACK = 5.0, 1.6
"""Time in s over which curves are followed forwards and backwards."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Portrait:
    """Curves in gamma and beta at one spin, each of shape (n, 2).

    Parameters
    ----------
    spin : float
        In rad/s.
    unstable, stable : tuple of ndarray
        The manifolds of noninverted spinning.
    motions : tuple of ndarray
        Others, that begin on the slow manifold.
    cycle : ndarray or None
    """

    spin: float
    unstable: tuple[Array, ...]
    stable: tuple[Array, ...]
    motions: tuple[Array, ...]
    cycle: Array | None


def portrait(scenario: Scenario, spin: float) -> Portrait:
    """Compute a portrait of a scenario of Model 4 at a spin in rad/s."""
    values, growing = saddle(scenario, spin)
    slow = np.array((values[1].real, spin))
    slow = slow / slow[1]
    leaving = _forwards(scenario, spin, _NONINVERTED + _AWAY * growing)
    arriving = _backwards(scenario, spin, _NONINVERTED[:2] + _AWAY * slow)
    motions = [
        _forwards(scenario, spin, _on_slow_manifold(scenario, spin, np.pi / 2 + part))
        for part in (0.6, 1.4, 2.2)
    ]
    cycle = cycle_at(scenario, spin).full[1][:, 1::-1] if spin in WITH_CYCLE else None
    return Portrait(
        spin=spin,
        unstable=(leaving, _mirrored(leaving)),
        stable=(arriving, _mirrored(arriving)),
        motions=tuple(motions),
        cycle=cycle,
    )


def _on_slow_manifold(scenario: Scenario, spin: float, gamma: float) -> Array:
    place = np.array((np.pi / 2, gamma))
    return np.append(place, slow_rates(scenario, spin, place[:, None])[0])


def _forwards(scenario: Scenario, spin: float, begin: Array) -> Array:
    return _curve(reduced.right_hand_side(scenario, spin), begin, _LONG, "LSODA")


def _backwards(scenario: Scenario, spin: float, begin: Array) -> Array:
    return _curve(lambda _, x: -slow_rates(scenario, spin, x[:, None])[:, 0], begin, _BACK, "RK45")


def _curve(rates: Callable[[float, Array], Any], begin: Array, end: float, method: str) -> Array:
    """Gamma and beta along a motion until the disk is nearly flat."""

    def flat(_: float, x: Array) -> float:
        return float(np.sin(x[0]) - np.sin(_FLAT))

    flat.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(
        rates,
        (0.0, end),
        begin,
        method=method,
        events=flat,
        rtol=1e-7,
        atol=1e-9,
        t_eval=np.linspace(0.0, end, _SAMPLES),
    )
    return np.array(run.y[1::-1].T)


def _mirrored(curve: Array) -> Array:
    return 2.0 * INVERTED[1::-1] - curve


def draw(portraits: Sequence[Portrait], axes: Any = None) -> Any:
    """Draw portraits side by side; gamma from one noninverted spinning to the same one again.

    Parameters
    ----------
    portraits : sequence of 5 Portrait
    axes : sequence of 6 Axes, optional
        The last one takes the legend.
    """
    if axes is None:
        axes = figures.new_figure(3, columns=2, width=9.0, height=10.0, share=False)[1].ravel()
    kinds = (
        ("motions", "#bbbbbb", "-", "motions"),
        ("stable", figures.COLOURS[3], "--", "stable manifold"),
        ("unstable", figures.COLOURS[2], "-", "unstable manifold"),
    )
    for each, found, title in zip(axes, portraits, TITLES, strict=False):
        for name, colour, style, _ in kinds:
            for curve in getattr(found, name):
                each.plot(*_wrapped(curve).T, style, color=colour, linewidth=1.2)
        if found.cycle is not None:
            each.plot(*_wrapped(found.cycle).T, color=figures.COLOURS[1], linewidth=2.2)
        each.plot(np.pi / 2, np.pi / 2, "o", color="black", markersize=4)
        each.plot((-np.pi / 2, 1.5 * np.pi), (np.pi / 2,) * 2, "s", color="black", markersize=5)
        each.set(xlim=(-np.pi / 2 - 0.1, 1.5 * np.pi + 0.1), ylim=(0.5, np.pi - 0.5))
        each.set(xlabel="γ in rad", ylabel="β in rad")
        each.set_title(f"{found.spin:.6g} rad/s: {title}", fontsize=10)
    last = axes[-1]
    for _, colour, style, label in kinds:
        last.plot([], [], style, color=colour, label=label)
    last.plot([], [], color=figures.COLOURS[1], linewidth=2.2, label="cycle")
    last.plot([], [], "o", color="black", markersize=4, label="inverted spinning")
    last.plot([], [], "s", color="black", markersize=5, label="noninverted spinning")
    last.set_axis_off()
    last.legend(loc="center", frameon=False)
    return axes


def _wrapped(curve: Array) -> Array:
    """The curve on the cylinder, broken where it goes over the edge."""
    turns = np.floor((curve[:, 0] + np.pi / 2) / (2.0 * np.pi))
    result = curve - np.column_stack((2.0 * np.pi * turns, np.zeros_like(turns)))
    return np.insert(result, np.flatnonzero(np.diff(turns)) + 1, np.nan, axis=0)
