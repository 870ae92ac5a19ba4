"""Cycles by shooting: Newton's method on half a period, with variational equations.

Runs go forwards only: backwards, the strongly attracting direction would explode.
"""

import numpy as np
from scipy.integrate import solve_ivp

from analysis.data.checks import Array, number
from analysis.data.scenario import Scenario
from analysis.nonlinear import flow
from analysis.nonlinear.collocation import NoCycleError
from analysis.nonlinear.cycle import INVERTED, Cycle, multipliers

_LOCAL = 1e-12
"""Tolerance of a step; relative to the state, and to the unit matrix for the variations."""

_PARTS = 12
"""Parts of half a period; variations begin anew in each, so that none grows beyond digits."""

_ITERATIONS = 12
_CONVERGED = 1e-11
_ROUNDING = 1e-9
"""Steps of Newton's method, over the unknowns: small enough; and no longer shrinking."""


def shoot(scenario: Scenario, amplitude: float, start: tuple[float, float, float]) -> Cycle:
    """Find the cycle of an amplitude.

    Parameters
    ----------
    scenario : Scenario
        Of the reduced system.
    amplitude : float
        Largest deviation of gamma from pi/2 in rad, between 0 and 3 pi/2.
    start : tuple of 3 floats
        Spin in rad/s, period in s, and rate of beta in rad/s where gamma is largest, to iterate
        from.

    Raises
    ------
    ValueError
        If the amplitude is out of range or the scenario has no cycles.
    NoCycleError
        If Newton's method does not converge.
    """
    flow.require_cycles(scenario)
    amplitude = open_amplitude(amplitude, 1.5 * np.pi)
    spin, half, rate = start[0], start[1] / 2.0, start[2]
    size = np.array((1.0, 1.0, np.pi / half)) * amplitude
    last = np.inf
    for _ in range(_ITERATIONS):
        first = np.array((0.0, amplitude, rate))
        x, transfers, by_spin, log_determinant = _run(scenario, spin, half, first)
        rates = flow.right_hand_side(scenario, spin, x.T)
        residual = x[-1] + first
        matrix = np.column_stack(
            (by_spin, rates[:, -1], _product(transfers)[:, 2] + np.array((0.0, 0.0, 1.0)))
        )
        step = np.linalg.solve(matrix, -residual)
        relative = float(np.max(np.abs(step / (spin, half, size[2]))))
        if relative > 0.5:
            break
        spin, half, rate = np.array((spin, half, rate)) + step
        if relative < _CONVERGED or (relative < _ROUNDING and relative >= 0.3 * last):
            larger, strong = multipliers(transfers, rates.T, log_determinant)
            return Cycle(
                scenario=scenario,
                spin=spin,
                amplitude=amplitude,
                period=2.0 * half,
                times=np.linspace(0.0, half, _PARTS + 1),
                states=x + INVERTED,
                half_multiplier=larger,
                log_strong=2.0 * strong,
                method="shooting",
            )
        last = relative
    raise NoCycleError(
        f"shooting does not converge at an amplitude of {amplitude:.9g} rad: the last step of "
        f"Newton's method was {relative:.1e} of the unknowns"
    )


def open_amplitude(value: float, largest: float = np.pi) -> float:
    """Return an amplitude; `ValueError` unless it lies between 0 and the largest, both excluded.

    Only about a saddle-focus do cycles swing beyond pi; none goes half a turn further.
    """
    result = number("amplitude", value)
    if not 0.0 < result < largest:
        raise ValueError(f"amplitude must lie between 0 and {largest:.6g} rad, got {result:g}")
    return result


def _product(transfers: Array) -> Array:
    result: Array = np.eye(3)
    for part in transfers:
        result = part @ result
    return result


def _run(
    scenario: Scenario, spin: float, half: float, first: Array
) -> tuple[Array, Array, Array, float]:
    """States (k + 1, 3), variations over each part (k, 3, 3), by spin (3,), log determinant."""

    def rates(_: float, values: Array) -> Array:
        right, jacobian, by_spin = flow.derivatives(scenario, spin, values[:3, None])
        columns = values[3:15].reshape(3, 4)
        change = jacobian[0] @ columns
        change[:, 3] += by_spin[:, 0]
        return np.concatenate((right[:, 0], change.ravel(), jacobian[0, 2, 2:]))

    states, transfers = [first], []
    by_spin, log_determinant = np.zeros(3), 0.0
    begin = np.column_stack((np.eye(3), np.zeros(3))).ravel()
    for _ in range(_PARTS):
        run = solve_ivp(
            rates,
            (0.0, half / _PARTS),
            np.concatenate((states[-1], begin, (0.0,))),
            method="DOP853",
            rtol=_LOCAL,
            atol=_LOCAL * max(1e-3, abs(first[1])),
        )
        if not run.success:
            raise NoCycleError(f"shooting fails at a spin of {spin:.9g} rad/s: {run.message}")
        end = run.y[:, -1]
        columns = end[3:15].reshape(3, 4)
        states.append(end[:3])
        transfers.append(columns[:, :3])
        by_spin = columns[:, :3] @ by_spin + columns[:, 3]
        log_determinant += float(end[15])
    return np.array(states), np.array(transfers), by_spin, log_determinant
