"""The slow manifold of the reduced system for steep friction, and the motions on it.

Steep friction leaves no lateral slip: to leading order beta' = e Omega sin(beta) cos(gamma) /
(r + e sin(gamma)). On this surface the height of the centre of gravity, H = (r + e sin(gamma))
sin(beta), is conserved, since H' = slip cot(beta) whatever the friction. All orbits on it are
known in closed form and closed, or lead from saddle to saddle, at every spin. Which of them
survive is decided by the next order: the slip whose friction makes beta'' that of the surface.
Spins at which the height regains its value over an orbit are those of the cycles and of their end
(Melnikov's integral, the slip over sin(beta) integrated over gamma).
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.integrate import fixed_quad, tanhsinh
from scipy.optimize import brentq

from analysis.mechanics.dual import per_speed_and_slope
from analysis.mechanics.paper import critical_speed
from analysis.mechanics.reduced import acceleration_from
from analysis.nonlinear import flow
from analysis.problem.checks import Array
from analysis.problem.scenario import Scenario
from analysis.solve.continuation import roots_around

_NODES, _PRECISION = 80, 1e-13
"""Points of a quadrature, of which half would do, and relative error of one with peaks."""

_GRID: Array = np.linspace(-np.pi / 2, np.pi / 2, 201)
"""Places at which friction is looked at: it is largest in the middle, at upright spinning."""

_LEAST_FRICTION, _LARGEST_SLIP = 1e-30, 1e6
"""Part of the weight that is none, and slip in m/s beyond which none is looked for."""


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
        acceleration_from(scenario, spin, (sb, cb, sg, cg), rate, force) for force in (0.0, 1.0)
    )
    return (none - bend) / (none - unit)


def _slips(scenario: Scenario, needed: Array) -> Array:
    """The smallest slips in m/s at which friction has given sizes, shape (n,), from its law alone.

    They keep the disk on the slow manifold to first order.

    Raises
    ------
    NoManifoldError
        If the friction law cannot give the force that is needed.
    """
    law = scenario.friction
    sizes = np.maximum(np.abs(needed), _LEAST_FRICTION)
    slips = sizes / law.gradient
    for _ in range(60):
        per_speed, change = per_speed_and_slope(law, slips)
        slopes = per_speed + change * slips
        if np.min(slopes) <= 0.0 or np.max(slips) > _LARGEST_SLIP:
            break
        missed = per_speed * slips - sizes
        slips = slips - missed / slopes
        # Near the most that friction can give, slips have fewer digits than forces.
        if np.all(np.abs(missed) <= 1e-15 * sizes):
            return np.copysign(slips, needed)
    raise NoManifoldError(
        f"the friction law cannot give {np.max(sizes):.4g} of the weight, which it takes to keep "
        "the disk near the slow manifold"
    )


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


class _Orbit(NamedTuple):
    """All orbits of an amplitude in rad: their places are the same at every spin.

    Along one goes theta, from -pi/2 to pi/2. Gamma deviates by the part sin(theta) of the
    amplitude, which removes the square roots at the turning points.
    """

    scenario: Scenario
    amplitude: float

    def place(self, theta: Array) -> tuple[Array, Array, Array]:
        """Lever r + e sin(gamma) in m, cosine of beta, and gamma."""
        disk, turn = self.scenario.disk, self.amplitude * np.sin(theta)
        height = disk.radius + disk.eccentricity * np.cos(self.amplitude)
        # cos(turn) - cos(amplitude) without loss of digits.
        half, other = (self.amplitude - turn) / 2, (self.amplitude + turn) / 2
        excess = 2.0 * disk.eccentricity * np.sin(half) * np.sin(other)
        rho = height + excess
        return rho, -np.sqrt(excess * (height + rho)) / rho, np.pi / 2 + turn

    def needed(self, theta: npt.ArrayLike, spin: float) -> Array:
        """See `needed_friction`."""
        _, cos_beta, gamma = self.place(np.asarray(theta))
        return needed_friction(self.scenario, spin, np.arccos(cos_beta), gamma)

    def gain(self, spin: float) -> float:
        """Melnikov's integral but for a factor, in m²/s.

        Raises
        ------
        NoManifoldError
            If the friction law cannot give the force that is needed.
        """
        asked = self.needed(_GRID, spin)
        _slips(self.scenario, asked)
        signs = np.sign(asked)
        # Where friction changes its sign, the slip that it takes has a kink; in the middle, it
        # has a peak where friction is hardly strong enough.
        kinks = [
            brentq(self.needed, *_GRID[each : each + 2], args=(spin,))
            for each in np.flatnonzero(signs[1:] * signs[:-1] < 0.0).tolist()
        ]

        def gained(theta: Array) -> Array:
            slips = _slips(self.scenario, self.needed(theta, spin))
            return np.cos(theta) * slips * self.place(theta)[0]

        ends = np.sort([-np.pi / 2, 0.0, *kinks, np.pi / 2])
        return float(np.sum(tanhsinh(gained, ends[:-1], ends[1:], rtol=_PRECISION).integral))

    def bounded_gain(self, spin: float) -> float:
        """The same between -1 and 1, where it is infinite as friction cannot give more."""
        try:
            gained = self.gain(spin)
        except NoManifoldError:
            asked = self.needed(_GRID, spin)
            return float(np.sign(asked[np.argmax(np.abs(asked))]))
        scenario = self.scenario
        return gained / (abs(gained) + scenario.disk.radius / scenario.friction.gradient)


def _surviving(scenario: Scenario, amplitude: float) -> SlowOrbit:
    flow.require_cycles(scenario)
    orbit, critical = _Orbit(scenario, amplitude), critical_speed(scenario).spin
    spin = next(roots_around(orbit.bounded_gain, critical), None)
    # Either may be where friction cannot hold the disk, and then says so.
    orbit.gain(critical if spin is None else spin)
    if spin is None:
        raise NoManifoldError(
            f"no spin within half the critical one keeps the orbit of {amplitude:.6g} rad on the "
            "slow manifold"
        )
    period = np.inf
    if amplitude < np.pi:
        ends = -np.pi / 2, np.pi / 2
        slowness, _ = fixed_quad(
            lambda theta: np.cos(theta) / orbit.place(theta)[1], *ends, n=_NODES
        )
        period = float(-2.0 / spin * amplitude * slowness)
    friction = float(np.max(np.abs(orbit.needed(_GRID, spin))))
    return SlowOrbit(amplitude=amplitude, spin=spin, period=period, friction=friction)
