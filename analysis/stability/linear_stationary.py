"""Any stationary motion linearised numerically, upright or tilted, sliding or not.

The matrices of `linear_numeric` are polynomials of the spin, which holds for upright spinning
alone, without slip. Here the same flow is differenced at one spin and one attitude.
"""

import numpy as np

from analysis.data.checks import Array
from analysis.data.scenario import Scenario
from analysis.models import constraints
from analysis.stability.linear_numeric import UnitlessFlow, complement, neutral_directions, slope
from analysis.stability.linear_reduced import ComplexArray

_NO_SLIP = 1e-9
_STEP = 1e-2
_SLIP_PART = 0.1
"""Slip in m/s that is none; largest step; part of slip and finest speed that it may slip."""


def stationary_eigenvalues(
    scenario: Scenario, spin: float, place: tuple[float, float, float, float]
) -> ComplexArray:
    """Eigenvalues of a stationary motion in 1/s, shape (k,), by falling real part.

    The neutral ones are left out: those of the direction in which the disk stands, of the
    neighbouring spin where it is free, and of the place on the table where that is free.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact and any constraints.
    spin : float
        In rad/s.
    place : tuple of 4 floats
        x and y of the geometric centre in the turning frame in m, beta and gamma in rad, of a
        motion in which they do not change.

    Raises
    ------
    ValueError
        If the table leans or the contact is compliant.
    ArithmeticError
        If the motion is not stationary.
    """
    flow = UnitlessFlow(scenario)
    radius = scenario.disk.radius
    x, y, beta, gamma = place
    z = np.array((x / radius, y / radius, np.sin(beta), 0.0, beta, gamma))
    speed = spin / flow.frequency
    state = np.concatenate((z, (0.0, 0.0, 0.0, speed, 0.0, 0.0)))
    change = float(np.max(np.abs(flow.rates(state)[6:]))) / (1.0 + speed**2)
    if change > 1e-6:
        raise ArithmeticError(
            f"a motion at {spin:.9g} rad/s with beta {beta:.6g} and gamma {gamma:.6g} rad is not "
            f"stationary: its accelerations are {change:.1e} of those of the spinning"
        )
    normals, jacobian = _jacobians(flow, state)
    neutral = neutral_directions(scenario.constraints, np.array([speed]), drift=False)
    basis = complement(normals[None], neutral)[0]
    values = np.linalg.eigvals(flow.frequency * (basis.T @ jacobian @ basis)).astype(complex)
    return values[np.lexsort((-values.imag, -values.real))]


def _jacobians(flow: UnitlessFlow, state: Array) -> tuple[Array, Array]:
    """Those of the constraints' residuals, shape (n, 12), and of the flow, (12, 12)."""
    scenario = flow.scenario
    z, u = state[:6] * flow.units, state[6:] * flow.units * flow.frequency
    sliding = constraints.directions(("no-slip-along", "no-slip-across"), scenario.disk, z) @ u
    slip, fine = float(np.hypot(*sliding)), scenario.friction.finest_speed
    # Differences must not reach the kink of the law at no slip, unless they are about it.
    room = fine if slip < _NO_SLIP else min(slip, fine)
    unit = scenario.disk.radius * flow.frequency * (1.0 + abs(float(state[9])))
    step = min(_STEP, _SLIP_PART * room / unit)

    def both(at: Array) -> Array:
        return np.concatenate((flow.residuals(at), flow.rates(at)))

    every = np.column_stack([slope(both, state, step * way) / step for way in np.eye(12)])
    return every[:-12], every[-12:]
