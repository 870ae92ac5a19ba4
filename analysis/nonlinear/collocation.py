"""Cycles as solutions of a boundary value problem by collocation.

Half a cycle leads from (0, a, b), where the deviation of gamma is extreme and the disk upright, to
its mirror image (0, -a, -b). The amplitude a is given, b, the spin and half the period are found.
As a parameter the amplitude passes folds of the spin. Multipliers come from the variational
equations, collocated on the same mesh.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.nonlinear import flow
from analysis.nonlinear.cycle import INVERTED, Cycle, multipliers
from analysis.stability.linear_reduced import critical_speed

TOLERANCE = 1e-9
"""Relative residual of the collocation polynomials."""

MOST_NODES = 40_000
_BOUNDARY = 1e-11
_FIRST_NODES = 41
_RESTART_NODES = 400


class NoCycleError(ArithmeticError):
    """The iteration for a periodic motion has not converged."""


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
        scale = cycle.amplitude * np.array((1.0, 1.0, critical_speed(cycle.scenario).frequency))
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
    scale = amplitude * np.array((1.0, 1.0, critical_speed(scenario).frequency))[:, None]

    def rates(_: Array, y: Array, p: Array) -> Any:
        return p[1] * flow.right_hand_side(scenario, p[0], scale * y) / scale

    def slopes(_: Array, y: Array, p: Array) -> tuple[Array, Array]:
        right, jacobian, by_spin = flow.derivatives(scenario, p[0], scale * y)
        by_state = p[1] * jacobian.transpose(1, 2, 0) / scale[:, None] * scale[None, :]
        return by_state, np.stack((p[1] * by_spin, right), axis=1) / scale[:, None]

    def ends(first: Array, last: Array, _: Array) -> Array:
        return np.array((first[0], first[1] - 1.0, last[0], last[1] + 1.0, last[2] + first[2]))

    guess = start.thinned()
    with np.errstate(all="ignore"):
        found = solve_bvp(
            rates,
            ends,
            guess.nodes,
            guess.values,
            guess.unknowns,
            fun_jac=slopes,
            tol=tolerance,
            bc_tol=_BOUNDARY,
            max_nodes=MOST_NODES,
        )
    if found.status != 0 or np.min(found.p) <= 0.0 or np.max(np.abs(found.y[1])) > 1.0 + 1e-6:
        raise NoCycleError(
            f"no periodic motion found at an amplitude of {amplitude:.9g} rad: the collocation "
            f"ended with {found.x.size} nodes and a residual of "
            f"{np.max(found.rms_residuals):.1e}"
        )
    mesh = Mesh(amplitude=amplitude, nodes=found.x, values=found.y, unknowns=found.p)
    return _cycle(scenario, mesh, scale * found.y, scale * found.sol(_middles(found.x)))


def _middles(nodes: Array) -> Array:
    middles: Array = (nodes[1:] + nodes[:-1]) / 2.0
    return middles


def _cycle(scenario: Scenario, mesh: Mesh, x: Array, middle: Array) -> Cycle:
    spin, half = (float(value) for value in mesh.unknowns)
    rates, J, _ = flow.derivatives(scenario, spin, x)
    J *= half
    J_middle = half * flow.derivatives(scenario, spin, middle)[1]
    steps = np.diff(mesh.nodes)
    traces = np.trace(J, axis1=1, axis2=2)
    average = (traces[1:] + traces[:-1] + 4.0 * np.trace(J_middle, axis1=1, axis2=2)) / 6.0
    larger, strong = multipliers(_transfers(steps, J, J_middle), rates.T, float(steps @ average))
    return Cycle(
        scenario=scenario,
        spin=spin,
        amplitude=mesh.amplitude,
        period=2.0 * half,
        times=half * mesh.nodes,
        states=x.T + INVERTED,
        half_multiplier=larger,
        log_strong=strong,
        method="collocation",
    )


def _transfers(steps: Array, J: Array, J_middle: Array) -> Array:
    """Solutions of the variational equations by the collocation that made the cycle, (n, 3, 3)."""
    unit, h = np.eye(3), steps[:, None, None]
    before, after = J[:-1], J[1:]
    left = unit - h / 6 * after - 2 * h / 3 * J_middle @ (unit / 2 - h / 8 * after)
    right = unit + h / 6 * before + 2 * h / 3 * J_middle @ (unit / 2 + h / 8 * before)
    return np.asarray(np.linalg.solve(left, right), dtype=float)
