"""The slow manifold of the reduced system for steep friction, and the motions on it.

Steep friction leaves no lateral slip: to leading order beta' = e Omega sin(beta) cos(gamma) /
(r + e sin(gamma)). On this surface the height of the centre of gravity, H = (r + e sin(gamma))
sin(beta), is conserved, since H' = slip cot(beta) whatever the friction. All orbits on it are
known in closed form and closed, or lead from saddle to saddle, at every spin. Which of them
survive is decided by the next order: the slip whose friction makes beta'' that of the surface.
Spins at which the height regains its value over an orbit are those of the cycles and of their end
(Melnikov's integral, the slip over sin(beta) integrated over gamma).
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from analysis.data.checks import Array, positive, real_array
from analysis.data.scenario import Scenario
from analysis.mechanics.reduced import acceleration_from, right_hand_side
from analysis.nonlinear import flow
from analysis.stability.continuation import nearest_root
from analysis.stability.printed import critical_speed, reduced_matrices

_NODES = 200
"""Points of the quadratures; they change spins by less than 1e-12 beyond 80."""

_LARGEST_SLIP = 1e6
_STEP, _WIDEST = 0.02, 0.48
"""Steps and range of the search about the critical speed, in parts of it."""


class NoManifoldError(ArithmeticError):
    """Friction cannot hold the disk on the slow manifold, or no orbit on it survives."""


def needed_friction(scenario: Scenario, spin: float, beta: Array, gamma: Array) -> Array:
    """Friction coefficient that keeps the disk on the surface without slip, with its sign.

    Parameters
    ----------
    scenario : Scenario
        Of the reduced system.
    spin : float
        In rad/s.
    beta, gamma : ndarray, shape (n,)
        In rad, beta between 0 and pi.

    Returns
    -------
    ndarray, shape (n,)
        Friction force over the weight.
    """
    disk = scenario.disk
    r, e, Omega = disk.radius, disk.eccentricity, spin
    sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
    rho = r + e * sg
    rate = e * Omega * sb * cg / rho
    by_gamma = -e * Omega * sb * (sg * rho + e * cg**2) / rho**2
    bend = e * Omega * cb * cg / rho * rate - by_gamma * Omega * cb
    none, unit = (
        acceleration_from(scenario, spin, (sb, cb, sg, cg), rate, lambda _, f=force: f)
        for force in (0.0, 1.0)
    )
    result: Array = (none - bend) / (none - unit)
    return result


def slip_on(scenario: Scenario, spin: float, beta: Array, gamma: Array) -> Array:
    """Lateral slip in m/s on the slow manifold to first order, shape (n,).

    Raises
    ------
    NoManifoldError
        If the friction law cannot give the force that is needed somewhere.
    """
    needed = needed_friction(scenario, spin, beta, gamma)
    slips = np.sign(needed) * np.array([_slip(scenario, float(f)) for f in np.abs(needed)])
    return real_array("slips", slips)


def _slip(scenario: Scenario, needed: float) -> float:
    """The smallest slip at which friction has a given size, from its law alone."""
    law = scenario.friction
    if needed == 0.0:
        return 0.0
    slip = needed / law.gradient
    for _ in range(60):
        miss = law.per_speed(slip) * slip - needed
        slope = law.per_speed(slip) + law.per_speed_slope(slip) * slip
        if slope <= 0.0 or slip > _LARGEST_SLIP:
            break
        step = miss / slope
        slip -= step
        if abs(step) <= 1e-14 * slip:
            return slip
    raise NoManifoldError(
        f"the friction law cannot give {needed:.4g} of the weight, which it takes to keep the "
        "disk near the slow manifold"
    )


def slow_rates(scenario: Scenario, spin: float, x: Array, order: Literal[0, 1] = 1) -> Array:
    """Rates of beta and gamma in rad/s on the slow manifold.

    Parameters
    ----------
    scenario : Scenario
        Of the reduced system.
    spin : float
        In rad/s.
    x : ndarray, shape (2, n)
        beta and gamma in rad, beta between 0 and pi.
    order : {0, 1}
        In the reciprocal gradient of friction.

    Returns
    -------
    ndarray, shape (2, n)

    Raises
    ------
    NoManifoldError
        See `slip_on`.
    """
    disk = scenario.disk
    beta, gamma = x
    sb, rho = np.sin(beta), disk.radius + disk.eccentricity * np.sin(gamma)
    slip = 0.0 if order == 0 else slip_on(scenario, spin, beta, gamma)
    rate = (slip + disk.eccentricity * spin * sb**2 * np.cos(gamma)) / (rho * sb)
    return np.array((rate, -spin * np.cos(beta)))


class SlowOrbit(NamedTuple):
    """An orbit on the slow manifold that survives to first order.

    Parameters
    ----------
    amplitude : float
        Largest deviation of gamma from pi/2 in rad; pi for the heteroclinic connection.
    spin : float
        In rad/s.
    period : float
        In s; infinite for the heteroclinic connection.
    friction : float
        Largest part of the weight that friction takes on it.
    """

    amplitude: float
    spin: float
    period: float
    friction: float


def slow_cycle(scenario: Scenario, amplitude: float) -> SlowOrbit:
    """The cycle of an amplitude to leading order.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.
    amplitude : float
        In rad, between 0 and pi.

    Raises
    ------
    ValueError
        If an argument is out of range or the scenario has no cycles.
    NoManifoldError
        If friction cannot hold the disk there, or no spin near the critical one is found.
    """
    return _surviving(scenario, flow.open_amplitude(amplitude))


def slow_connection(scenario: Scenario) -> SlowOrbit:
    """The heteroclinic connection to leading order; see `slow_cycle`."""
    return _surviving(scenario, float(np.pi))


def _surviving(scenario: Scenario, amplitude: float) -> SlowOrbit:
    flow.require_cycles(scenario)
    disk = scenario.disk
    # sin removes the square roots at the turning points.
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    theta = nodes * np.pi / 2
    turn = amplitude * np.sin(theta)
    steps = amplitude * np.cos(theta) * np.pi / 2 * weights
    # cos(turn) - cos(amplitude) without loss of digits.
    half, other = (amplitude - turn) / 2, (amplitude + turn) / 2
    excess = 2.0 * disk.eccentricity * np.sin(half) * np.sin(other)
    height = disk.radius + disk.eccentricity * np.cos(amplitude)
    rho = height + excess
    cos_beta = np.sqrt(excess * (height + rho)) / rho
    beta, gamma = np.pi - np.arcsin(height / rho), np.pi / 2 + turn

    def gain(spin: float) -> float:
        return float(steps @ (slip_on(scenario, spin, beta, gamma) * rho / height))

    centre = critical_speed(scenario).spin
    spin = nearest_root(gain, centre, part=_STEP, widest=_WIDEST, accuracy=1e-12)
    if spin is None:
        raise NoManifoldError(
            f"no spin within half the critical one keeps the orbit of {amplitude:.6g} rad on the "
            "slow manifold"
        )
    needed = needed_friction(scenario, spin, beta, gamma)
    period = 2.0 / spin * float(steps @ (1.0 / cos_beta)) if amplitude < np.pi else np.inf
    return SlowOrbit(
        amplitude=amplitude, spin=spin, period=period, friction=float(np.max(np.abs(needed)))
    )


def separation(scenario: Scenario, spin: float) -> float:
    """How much faster a motion is drawn to the slow manifold than it goes there.

    The size of the real eigenvalue of inverted spinning over that of the complex pair (paper:
    lambda_3, and lambda_1 and lambda_2).

    Raises
    ------
    ValueError
        If the spin is not positive, the scenario has no cycles, or there is no complex pair
        beside a real eigenvalue at this spin.
    """
    flow.require_cycles(scenario)
    spin = positive("spin", spin)
    values = np.linalg.eigvals(reduced_matrices(scenario, [spin])[0])
    pair, real = values[values.imag > 0.0], values[values.imag == 0.0]
    if pair.size != 1:
        raise ValueError(
            "spin must be one with a complex pair beside a real eigenvalue, got "
            f"{spin:g}, with {', '.join(f'{v:.4g}' for v in values)} 1/s"
        )
    return float(abs(real[0]) / abs(pair[0]))


def distances(scenarios: Sequence[Scenario], spin: float) -> Array:
    """Measure with which power of epsilon / mu motions keep away from the slow manifold.

    Motions of the whole reduced system start upright and 1 rad from inverted spinning; the first
    half second, in which they are drawn to the manifold, is left out.

    Parameters
    ----------
    scenarios : sequence of Scenario
        That differ in the gradient of friction.
    spin : float
        In rad/s.

    Returns
    -------
    ndarray, shape (2,)
        Powers of the reciprocal gradient with which the largest difference of beta' from its value
        on the surface goes, to leading order and with the first correction, by least squares.

    Raises
    ------
    ValueError
        If there are less than two, the spin is not positive, or one has no cycles.
    NoManifoldError
        If friction cannot hold the disk there, or a run fails.
    """
    spin = positive("spin", spin)
    if len(scenarios) < 2:
        raise ValueError(f"scenarios must be 2 or more, got {len(scenarios)}")
    away = np.log([_distance(scenario, spin) for scenario in scenarios])
    ratios = -np.log([scenario.friction.gradient for scenario in scenarios])
    return real_array("slopes", np.polyfit(ratios, away, 1)[0])


def _distance(scenario: Scenario, spin: float) -> tuple[float, float]:
    flow.require_cycles(scenario)
    start = np.array((np.pi / 2, np.pi / 2 + 1.0))
    begin = np.append(start, slow_rates(scenario, spin, start[:, None])[0])
    run = solve_ivp(
        right_hand_side(scenario, spin),
        (0.0, 2.0),
        begin,
        method="LSODA",
        t_eval=np.linspace(0.5, 2.0, 301),
        rtol=1e-11,
        atol=1e-12,
    )
    if not run.success:
        raise NoManifoldError(f"the motion at {spin:.9g} rad/s fails: {run.message}")
    surface, corrected = (
        float(np.max(np.abs(run.y[2] - slow_rates(scenario, spin, run.y[:2], order)[0])))
        for order in (0, 1)
    )
    return surface, corrected
