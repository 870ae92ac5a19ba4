"""Phase portraits of the reduced system in gamma and beta, with the manifolds of the saddle.

Motions are followed forwards in the whole reduced system. The stable manifold of noninverted
spinning would take runs backwards, in which the fast direction explodes; it is followed on the
slow manifold instead, to first order.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from analysis import MODELS, Scenario
from analysis.data.checks import Array
from analysis.mechanics import reduced
from analysis.nonlinear.families import cycle_at
from analysis.nonlinear.heteroclinic import heteroclinic_connection, saddle
from analysis.nonlinear.motions import INVERTED
from analysis.nonlinear.slow_manifold import slow_rates
from validation.kit import figures
from validation.study import Row, Study

_NONINVERTED = np.array((np.pi / 2, -np.pi / 2, 0.0))
_AWAY = 1e-3
_FLAT = 0.5
"""Inclination in rad from flat at which curves end."""

_SAMPLES = 500
_LONG, _BACK = 5.0, 1.6
"""Time in s over which curves are followed forwards and backwards."""

_LOOKS: dict[str, Any] = {
    "motion": {"color": "#bbbbbb"},
    "stable manifold": {"color": figures.COLOURS[3], "linestyle": "--"},
    "unstable manifold": {"color": figures.COLOURS[2]},
    "cycle": {"color": figures.COLOURS[1], "linewidth": 2.2},
}


def cases() -> dict[str, tuple[float | None, bool]]:
    """Spins in rad/s, None for that of the connection, and whether the cycle is drawn."""
    return {
        "below the connection": (29.6, False),
        "on the connection": (None, False),
        "a large cycle": (30.5, True),
        "a small cycle": (30.85, True),
        "above the Hopf point": (33.0, False),
    }


def portrait(case: tuple[float | None, bool]) -> list[Row]:
    """Curves in gamma and beta at one spin."""
    scenario = Scenario(constraints=MODELS[4])
    spin, has_cycle = case
    spin = heteroclinic_connection(scenario).spin if spin is None else spin
    values, growing = saddle(scenario, spin)
    slow = np.array((values[1].real, spin)) / spin
    leaving = _forwards(scenario, spin, _NONINVERTED + _AWAY * growing)
    arriving = _backwards(scenario, spin, _NONINVERTED[:2] + _AWAY * slow)
    curves = [("unstable manifold", each) for each in (leaving, _mirror_image(leaving))]
    curves += [("stable manifold", each) for each in (arriving, _mirror_image(arriving))]
    for part in (0.6, 1.4, 2.2):
        start = _on_slow_manifold(scenario, spin, np.pi / 2 + part)
        curves.append(("motion", _forwards(scenario, spin, start)))
    if has_cycle:
        curves.append(("cycle", cycle_at(scenario, spin).whole[1][:, 1::-1]))
    return [
        {"number": number, "kind": kind, "spin": spin, "gamma": curve[:, 0], "beta": curve[:, 1]}
        for number, (kind, curve) in enumerate(curves)
    ]


STUDY = Study(name="portraits", cases=cases, measure=portrait, keys=("number",))


def _on_slow_manifold(scenario: Scenario, spin: float, gamma: float) -> Array:
    place = np.array((np.pi / 2, gamma))
    return np.append(place, slow_rates(scenario, spin, place[:, None])[0])


def _forwards(scenario: Scenario, spin: float, begin: Array) -> Array:
    return _curve(reduced.right_hand_side(scenario, spin), begin, _LONG, "LSODA")


def _backwards(scenario: Scenario, spin: float, begin: Array) -> Array:
    return _curve(lambda _, x: -slow_rates(scenario, spin, x[:, None])[:, 0], begin, _BACK, "RK45")


def _curve(rates: Callable[[float, Array], Any], begin: Array, end: float, method: str) -> Array:
    """Gamma and beta along a motion until the disk is nearly flat, shape (n, 2)."""

    def flat(_: float, x: Array) -> float:
        return float(np.sin(x[0]) - np.sin(_FLAT))

    flat.terminal = True  # type: ignore[attr-defined]
    times = np.linspace(0.0, end, _SAMPLES)
    how: dict[str, Any] = {"method": method, "events": flat, "rtol": 1e-7, "atol": 1e-9}
    run = solve_ivp(rates, (0.0, end), begin, t_eval=times, **how)
    if not run.success:
        raise ArithmeticError(f"a curve of the portrait ends at {run.t[-1]:g} s: {run.message}")
    return np.array(run.y[1::-1].T)


def _mirror_image(curve: Array) -> Array:
    return 2.0 * INVERTED[1::-1] - curve


def draw(curves: pd.DataFrame) -> Figure:
    """Draw portraits side by side; gamma from one noninverted spinning to the same one again.

    Parameters
    ----------
    curves : DataFrame
        Rows of `portrait`, of 5 cases at most.
    """
    figure, axes = figures.new_figure(3, columns=2, width=9.0, height=10.0, share=False)
    *panels, last = axes.ravel()
    points: tuple[tuple[Any, Any, str, str], ...] = (
        (np.pi / 2, np.pi / 2, "o", "inverted spinning"),
        ((-np.pi / 2, 1.5 * np.pi), (np.pi / 2,) * 2, "s", "noninverted spinning"),
    )
    for each, (title, found) in zip(panels, curves.groupby("case", sort=False), strict=False):
        for kind, look in _LOOKS.items():
            for curve in found[found.kind == kind].itertuples():
                each.plot(*wrapped(np.array(curve.gamma), np.array(curve.beta)), **look)
        for gamma, beta, marker, _ in points:
            each.plot(gamma, beta, marker, color="black", markersize=4.5)
        each.set(xlim=(-np.pi / 2 - 0.1, 1.5 * np.pi + 0.1), ylim=(0.5, np.pi - 0.5))
        each.set(xlabel="γ in rad", ylabel="β in rad")
        each.set_title(f"{found.spin.iloc[0]:.6g} rad/s: {title}", fontsize=10)
    for kind, look in _LOOKS.items():
        last.plot([], [], label=kind, **look)
    for _, _, marker, label in points:
        last.plot([], [], marker, color="black", label=label)
    last.set_axis_off()
    last.legend(loc="center", frameon=False)
    return figure


def wrapped(gamma: Array, beta: Array) -> tuple[Array, Array]:
    """The curve on the cylinder, broken where it goes over the edge."""
    turns = np.floor((gamma + np.pi / 2) / (2.0 * np.pi))
    breaks = np.flatnonzero(np.diff(turns)) + 1
    return np.insert(gamma - 2.0 * np.pi * turns, breaks, np.nan), np.insert(beta, breaks, np.nan)
