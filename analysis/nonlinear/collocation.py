"""Periodic motions by collocation, and their multipliers by the variational equations on its mesh.

What is given is a combination of amplitude or tilt, spin and duration: one of the first two, or
the place along a family, so that a fold is nothing special.
"""

from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.linalg import eigvals
from scipy.integrate import cumulative_trapezoid, solve_bvp

from analysis.mechanics.paper import critical_speed
from analysis.nonlinear import flow
from analysis.nonlinear.motions import INVERTED, PeriodicMotion
from analysis.problem.checks import Array
from analysis.problem.scenario import Scenario

_TOLERANCE = 1e-9
"""Relative residual of the collocation polynomials."""

_MOST_NODES = 15_000
_FIRST_NODES = 41
_RESTART_NODES = 400

STEEPEST = 1e4
"""Gradient of friction in s/m beyond which these nodes are too few."""

_BOUNDARY = 1e-11
"""Residual at the ends."""

_SMALL = 1e-6
"""Amplitude in rad at which a cycle is that of the linear system."""

_FURTHEST = 2.0
"""Factor by which an amplitude that is found may fall short of the one it is looked for at."""

VALUE: Array = np.array((1.0, 0.0, 0.0))
SPIN: Array = np.array((0.0, 1.0, 0.0))
"""What is held of a place: the amplitude or tilt, or the spin."""


class NoCycleError(ArithmeticError):
    """No periodic motion has been found: the iteration for it has not converged."""


def hopf_cycle(scenario: Scenario) -> PeriodicMotion:
    """The cycle of vanishing amplitude at the Hopf point, to begin with."""
    hopf = critical_speed(scenario)
    phases = np.linspace(0.0, np.pi, _FIRST_NODES)
    tilt = hopf.frequency / hopf.spin
    shape = (-tilt * np.sin(phases), np.cos(phases), -tilt * hopf.frequency * np.cos(phases))
    return PeriodicMotion(
        scenario=scenario,
        kind="symmetric",
        spin=hopf.spin,
        value=_SMALL,
        times=phases / hopf.frequency,
        states=INVERTED + _SMALL * np.transpose(shape),
    )


def slow_rotation(scenario: Scenario, tilt: float) -> PeriodicMotion:
    """The rotating motion without slip of a tilt in rad, to begin with; see `slow_manifold`."""
    disk, spin = scenario.disk, critical_speed(scenario).spin
    gamma = np.linspace(-np.pi / 2, 1.5 * np.pi, _FIRST_NODES)
    lever = disk.radius + disk.eccentricity * np.sin(gamma)
    # The height of the centre of gravity is conserved.
    beta = np.pi - np.arcsin(lever[0] * np.cos(tilt) / lever)
    rate = disk.eccentricity * spin * np.sin(beta) * np.cos(gamma) / lever
    times = cumulative_trapezoid(-1.0 / (spin * np.cos(beta)), gamma, initial=0.0)
    return PeriodicMotion(
        scenario=scenario,
        kind="rotating",
        spin=spin,
        value=tilt,
        times=times,
        states=np.column_stack((beta, gamma, rate)),
    )


def solve(
    start: PeriodicMotion, place: Array | None = None, held: Array = VALUE
) -> PeriodicMotion:
    """Find the periodic motion of the kind of another one at a place, or where it meets a plane.

    Parameters
    ----------
    start : PeriodicMotion
        To begin with, of the scenario that is looked at.
    place : ndarray, shape (3,), optional
        See `PeriodicMotion.place`; by default where the motion is to begin with.
    held : ndarray, shape (3,)
        Of the deviations from there, each over what it deviates from, the combination that is
        zero: `VALUE`, `SPIN`, or the direction in which a family is followed.

    Raises
    ------
    NoCycleError
        If the iteration does not converge, or to something else.
    """
    ends, place = start.ends, start.place if place is None else place
    found, unit = _collocated(start, place, held)
    speed, duration = found.p.tolist()
    times, states = duration * found.x, (unit[:, None] * found.y).T + INVERTED
    value = float(place[0])
    reached = float((states[0] - INVERTED)[ends.follows]) if np.any(held[1:]) else value
    residual = np.max(found.rms_residuals)
    why = f"the collocation ended with {found.x.size} nodes and a residual of {residual:.1e}"
    if found.status == 0 and np.min(found.p) > 0.0 and value < _FURTHEST * reached:
        motion = replace(start, spin=speed, value=reached, times=times, states=states)
        larger, strong = multipliers(motion)
        motion = replace(
            motion,
            larger=larger.real,
            imaginary=abs(larger.imag),
            log_strong=ends.parts * strong,
        )
        if motion.flaw is None:
            return motion
        why = motion.flaw
    raise NoCycleError(
        f"no {start.kind} motion of {value:.9g} rad found from that of {start.value:.9g} rad at "
        f"{start.spin:.9g} rad/s: {why}"
    )


def _collocated(start: PeriodicMotion, place: Array, held: Array) -> tuple[Any, Array]:
    """Result of `solve_bvp`, and the units of its deviations, shape (3,)."""
    scenario, ends = start.scenario, start.ends
    every = max(1, start.times.size // _RESTART_NODES)
    kept = np.unique(np.append(np.arange(0, start.times.size, every), start.times.size - 1))
    unit = np.array((1.0, 1.0, critical_speed(scenario).frequency))
    values = ((start.states[kept] - INVERTED) / unit).T
    if not ends.turn:
        # Small cycles are known to the same part of their amplitude as large ones.
        unit, values = place[0] * unit, values / start.value
    column = unit[:, None]

    def rates(_: float, y: Array, p: Array) -> Any:
        return p[1] * flow.right_hand_side(scenario, p[0], column * y) / column

    def jacobians(_: float, y: Array, p: Array) -> tuple[Array, Array]:
        """By states and by both parameters; differences would not do where friction is steep."""
        by_each = p[1] * flow.jacobian(scenario, p[0], column * y).transpose(1, 2, 0)
        by_parameters = by_each[:, 3] / column, rates(_, y, p) / p[1]
        return by_each[:, :3] * column / column[..., None], np.stack(by_parameters, axis=1)

    def residual(first: Array, last: Array, p: Array) -> Array:
        value = first[ends.follows] * unit[1]
        given = held @ (np.array((value, *p)) / place - 1.0)
        return np.append(given, ends.residual(first, last))

    duration = float(start.times[-1])
    with np.errstate(all="ignore"):
        try:
            found = solve_bvp(
                rates,
                residual,
                start.times[kept] / duration,
                values,
                (place[1], duration),
                tol=_TOLERANCE,
                bc_tol=_BOUNDARY,
                max_nodes=_MOST_NODES,
                fun_jac=jacobians,
            )
        except OverflowError as error:
            raise NoCycleError("no periodic motion found: the collocation diverges") from error
    return found, unit


def multipliers(motion: PeriodicMotion) -> tuple[complex, float]:
    """Larger multiplier over the stretch of a motion, and logarithm of the other's size.

    The variational equations are solved by the collocation that has made the motion, one step of
    its mesh after the other. Deviations along the motion are left out (the linear Poincaré flow),
    since their trivial multiplier would hide a small one behind rounding. The strong multiplier is
    below rounding there, but not in the integral of the trace of the Jacobian (Liouville).

    Over half a period a deviation is carried on and mirrored, so that the whole monodromy matrix
    is a square.
    """
    scenario, spin, ends = motion.scenario, motion.spin, motion.ends
    x, h = (motion.states - INVERTED).T, np.diff(motion.times)[:, None, None]
    rates = flow.right_hand_side(scenario, spin, x)
    jacobians = flow.jacobian(scenario, spin, x)[..., :3]
    before, after, unit = jacobians[:-1], jacobians[1:], np.eye(3)
    # The polynomials of the collocation are cubic.
    middles = (x[:, 1:] + x[:, :-1]) / 2.0 - h[:, 0, 0] / 8.0 * np.diff(rates)
    middle = flow.jacobian(scenario, spin, middles)[..., :3]
    left = unit - h / 6 * after - 2 * h / 3 * middle @ (unit / 2 - h / 8 * after)
    right = unit + h / 6 * before + 2 * h / 3 * middle @ (unit / 2 + h / 8 * before)
    frames = np.linalg.qr(rates.T[:, :, None], mode="complete")[0]
    # The motion ends in the direction in which it began, or in the opposite one.
    frames[-1] = frames[0]
    across = frames[:, :, 1:]
    transfers = across[1:].transpose(0, 2, 1) @ np.linalg.solve(left, right) @ across[:-1]
    average = np.trace(before + 4.0 * middle + after, axis1=1, axis2=2) / 6.0
    product = reduce(lambda done, transfer: transfer @ done, transfers, np.eye(2))
    values = eigvals(-product if ends.mirrored else product)
    larger = complex(values[np.argmax(np.abs(values))])
    return larger, float(h[:, 0, 0] @ average) - float(np.log(abs(larger)))
