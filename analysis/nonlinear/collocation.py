"""Cycles as solutions of a boundary value problem by collocation.

Half a cycle leads from (0, a, b), where the deviation of gamma is extreme and the disk upright, to
its mirror image (0, -a, -b). The amplitude a is given, b, the spin and half the period are found.
As a parameter the amplitude passes folds of the spin. Multipliers come from the variational
equations, collocated on the same mesh.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.nonlinear import flow
from analysis.nonlinear.cycle import INVERTED, Cycle, WholePeriod, multipliers
from analysis.stability.linear_reduced import critical_speed

TOLERANCE = 1e-9
"""Relative residual of the collocation polynomials."""

Ends = Callable[[Array, Array, Array], Array]

MOST_NODES = 40_000

_STEEPEST = 1e4
"""Gradient of friction in s/m beyond which these nodes are too few."""

_BOUNDARY = 1e-11
_FIRST_NODES = 41
_RESTART_NODES = 400


class NoCycleError(ArithmeticError):
    """The iteration for a periodic motion has not converged."""


def require_collocation(scenario: Scenario) -> None:
    """Raise `ValueError` unless a scenario can have cycles and they can be collocated."""
    flow.require_cycles(scenario)
    flow.require_steepness(scenario, _STEEPEST)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Half a cycle on its mesh, to start a next one from.

    Parameters
    ----------
    amplitude : float
        In rad.
    nodes : ndarray, shape (n,)
        Parts of half the period.
    values : ndarray, shape (3, n)
        Deviations over the amplitude; the rate over the Hopf frequency, too.
    unknowns : ndarray, shape (2,)
        Spin and half the period.
    """

    amplitude: float
    nodes: Array
    values: Array
    unknowns: Array

    @classmethod
    def of(cls, cycle: Cycle) -> "Mesh":
        """That of a cycle which has been found."""
        scale = cycle.amplitude * _unit_scale(cycle.scenario)
        half = cycle.period / 2.0
        return cls(
            amplitude=cycle.amplitude,
            nodes=cycle.times / half,
            values=((cycle.states - INVERTED) / scale).T,
            unknowns=np.array((cycle.spin, half)),
        )

    def thinned(self) -> "Mesh":
        """The same on fewer nodes, both ends among them."""
        every = max(1, self.nodes.size // _RESTART_NODES)
        kept = np.unique(np.append(np.arange(0, self.nodes.size, every), self.nodes.size - 1))
        return Mesh(
            amplitude=self.amplitude,
            nodes=self.nodes[kept],
            values=self.values[:, kept],
            unknowns=self.unknowns,
        )


def hopf_mesh(scenario: Scenario) -> Mesh:
    """The cycle of vanishing amplitude at the Hopf point."""
    hopf = critical_speed(scenario)
    nodes = np.linspace(0.0, 1.0, _FIRST_NODES)
    part, sine, cosine = hopf.frequency / hopf.spin, np.sin(np.pi * nodes), np.cos(np.pi * nodes)
    return Mesh(
        amplitude=0.0,
        nodes=nodes,
        values=np.array((-part * sine, cosine, -part * cosine)),
        unknowns=np.array((hopf.spin, np.pi / hopf.frequency)),
    )


def solve(
    scenario: Scenario, amplitude: float, start: Mesh, tolerance: float = TOLERANCE
) -> Cycle:
    """Find the cycle of an amplitude.

    Parameters
    ----------
    scenario : Scenario
        Of the reduced system.
    amplitude : float
        In rad, between 0 and pi.
    start : Mesh
        A cycle near it.
    tolerance : float
        Relative residual.

    Raises
    ------
    NoCycleError
        If the iteration does not converge.
    """
    scale = amplitude * _unit_scale(scenario)

    def ends(first: Array, last: Array, _: Array) -> Array:
        return np.array((first[0], first[1] - 1.0, last[0], last[1] + 1.0, last[2] + first[2]))

    found = collocated(scenario, scale, ends, start.thinned(), tolerance)
    if found.status != 0 or np.min(found.p) <= 0.0 or np.max(np.abs(found.y[1])) > 1.0 + 1e-6:
        raise NoCycleError(
            f"no periodic motion found at an amplitude of {amplitude:.9g} rad: the collocation "
            f"ended with {found.x.size} nodes and a residual of "
            f"{np.max(found.rms_residuals):.1e}"
        )
    spin, half = found.p.tolist()
    larger, strong = floquet(scenario, scale, found, mirrored=True)
    return Cycle(
        scenario=scenario,
        spin=spin,
        amplitude=amplitude,
        period=2.0 * half,
        times=half * found.x,
        states=(scale[:, None] * found.y).T + INVERTED,
        half_multiplier=larger,
        log_strong=2.0 * strong,
        method="collocation",
    )


def collocated(scenario: Scenario, scale: Array, ends: Ends, start: Mesh, tolerance: float) -> Any:
    """Solve for a part of a periodic motion, its spin and duration; the result of `solve_bvp`.

    Parameters
    ----------
    scenario : Scenario
        Of the reduced system.
    scale : ndarray, shape (3,)
        Units of the deviations from inverted spinning.
    ends : callable
        From the first and the last values, in these units, and the unknowns to 5 residuals.
    start : Mesh
        Where to begin.
    tolerance : float
        Relative residual.

    Raises
    ------
    NoCycleError
        If a friction force overflows on the way.
    """
    unit = scale[:, None]

    def rates(_: Array, y: Array, p: Array) -> Any:
        return p[1] * flow.right_hand_side(scenario, p[0], unit * y) / unit

    def slopes(_: Array, y: Array, p: Array) -> tuple[Array, Array]:
        right, jacobian, by_spin = flow.derivatives(scenario, p[0], unit * y)
        by_state = p[1] * jacobian.transpose(1, 2, 0) / unit[:, None] * unit[None, :]
        return by_state, np.stack((p[1] * by_spin, right), axis=1) / unit[:, None]

    with np.errstate(all="ignore"):
        try:
            return solve_bvp(
                rates,
                ends,
                start.nodes,
                start.values,
                start.unknowns,
                fun_jac=slopes,
                tol=tolerance,
                bc_tol=_BOUNDARY,
                max_nodes=MOST_NODES,
            )
        except OverflowError as error:
            raise NoCycleError("no periodic motion found: the collocation diverges") from error


def collocated_period(start: WholePeriod, ends: Ends) -> Any:
    """Solve for a whole period near a motion; the result of `solve_bvp`.

    Parameters
    ----------
    start : WholePeriod
    ends : callable
        As in `collocated`, in units of rad and of the Hopf frequency.

    Raises
    ------
    NoCycleError
        If a friction force overflows on the way.
    """
    scale = _unit_scale(start.scenario)
    mesh = Mesh(
        amplitude=1.0,
        nodes=start.times / start.period,
        values=((start.states - INVERTED) / scale).T,
        unknowns=np.array((start.spin, start.period)),
    )
    return collocated(start.scenario, scale, ends, mesh.thinned(), TOLERANCE)


def period_values(scenario: Scenario, found: Any) -> dict[str, Any]:
    """Values of the `WholePeriod` that `collocated_period` has found, by their names."""
    scale = _unit_scale(scenario)
    larger, strong = floquet(scenario, scale, found, mirrored=False)
    spin, period = found.p.tolist()
    return {
        "scenario": scenario,
        "spin": spin,
        "period": period,
        "times": period * found.x,
        "states": (scale[:, None] * found.y).T + INVERTED,
        "multiplier": larger,
        "log_strong": strong,
    }


def _unit_scale(scenario: Scenario) -> Array:
    """Deviations of 1 rad, and the rate that they have at the Hopf frequency."""
    return np.array((1.0, 1.0, critical_speed(scenario).frequency))


def floquet(
    scenario: Scenario, scale: Array, found: Any, *, mirrored: bool
) -> tuple[float, float]:
    """`multipliers` of what `collocated` has found, by the collocation that has found it."""
    spin, duration = found.p
    middles = (found.x[1:] + found.x[:-1]) / 2.0
    rates, J, _ = flow.derivatives(scenario, spin, scale[:, None] * found.y)
    J *= duration
    J_middle = duration * flow.derivatives(scenario, spin, scale[:, None] * found.sol(middles))[1]
    steps = np.diff(found.x)
    traces = np.trace(J, axis1=1, axis2=2)
    average = (traces[1:] + traces[:-1] + 4.0 * np.trace(J_middle, axis1=1, axis2=2)) / 6.0
    transfers = _transfers(steps, J, J_middle)
    return multipliers(transfers, rates.T, float(steps @ average), mirrored=mirrored)


def _transfers(steps: Array, J: Array, J_middle: Array) -> Array:
    """Solutions of the variational equations by the collocation that made the cycle, (n, 3, 3)."""
    unit, h = np.eye(3), steps[:, None, None]
    before, after = J[:-1], J[1:]
    left = unit - h / 6 * after - 2 * h / 3 * J_middle @ (unit / 2 - h / 8 * after)
    right = unit + h / 6 * before + 2 * h / 3 * J_middle @ (unit / 2 + h / 8 * before)
    return np.asarray(np.linalg.solve(left, right), dtype=float)
