"""The end of the cycles: a connection between noninverted spinning and itself, a turn further.

It is heteroclinic in the unwrapped gamma, and homoclinic on the cylinder. Noninverted spinning is
a saddle with one growing direction. The motion that leaves it there with growing gamma either
turns back before gamma has made a whole turn, or goes on over it; in between there is a spin at
which it ends in the saddle again. Neither cycles nor boundary values are needed to find it. Which
it does shows only where it passes inverted spinning again: by the saddle it may swing through the
saddle's gamma and upright, or wind about them (a saddle-focus, where friction is weak or smooth).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import sin
from operator import attrgetter
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from analysis.mechanics import reduced
from analysis.mechanics.paper import critical_speed, reduced_matrices
from analysis.nonlinear import flow
from analysis.nonlinear.motions import PeriodicMotion
from analysis.problem.checks import Array, instance, turn_rate
from analysis.problem.scenario import Scenario
from analysis.problem.user_modules import reads
from analysis.solve.continuation import WIDEST, roots_around
from analysis.stability.linearisation import ComplexArray, eigenvectors

_DEPARTURE = 1e-6
"""Deviation of gamma in rad at which a motion leaves the saddle along its growing direction."""

_LONGEST = 1000.0
"""End of a run in time constants of the growing direction; it takes 14 to leave, and some 100
near the critical speed, where a motion about inverted spinning hardly grows or decays."""

_SETTLED = 1e-3
"""Distance in rad from inverted spinning at which a motion that has lasted so long has settled."""

_ALIKE = 0.1
"""Difference of gamma in rad up to which motions end alike, on either side of no connection: those
beside one leave the saddle to different sides."""

_TOLERANCE, _STIFF_TOLERANCE = 1e-12, 3e-11
"""Relative error of a step of a run, and of a stiff one, whose method makes smaller errors."""

_STIFF = 500.0
"""Gradient of friction in s/m from which LSODA, a tenth as long under way otherwise, is less
accurate than it is told to be, and may take the stiff motion for none and a hundred times the
steps."""

_STEEPEST = 1e5
"""Gradient of friction in s/m beyond which runs lose the digits of the spin."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fall:
    """The motion that leaves noninverted spinning with growing gamma.

    Parameters
    ----------
    states : ndarray, shape (n, 3)
        beta, gamma in rad and rate of beta in rad/s.
    side : float
        -1 where it turns back or settles in inverted spinning, 1 where it goes over it. A disk
        that falls flat has gone over if gamma has passed the saddle.
    distances : ndarray, shape (n,)
        In rad, from the saddle, a turn further, of beta, gamma, and the rate of beta over that at
        which the growing direction grows.
    swing : float
        Largest deviation of gamma from pi/2 in rad.
    tilt : float
        With which it first passes the saddle's gamma, in rad; 0 if it never does.
    """

    states: Array
    side: float
    distances: Array
    swing: float
    tilt: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Connection:
    """The heteroclinic connection.

    Parameters
    ----------
    spin : float
        In rad/s.
    below, above : float
        Spins in rad/s next to it on which the motion falls to different sides.
    growing, slow, strong : float
        Eigenvalues of the saddle in 1/s: the positive one, and the negative ones; of a complex
        pair, its real part twice.
    last_amplitude : float
        Of the cycles next to it in rad: the largest deviation of gamma from pi/2 of the motion
        that turns back. It is pi where a motion ends in the saddle with rising gamma, and more
        where it has swung beyond: about a saddle-focus, and with the paper's friction where the
        eccentricity is above a fifth to a quarter of the radius.
    least_tilt : float
        Of the rotating motions next to it in rad: zero where `last_amplitude` is pi. Where a
        motion swings beyond noninverted spinning, it passes with a tilt before it comes back.
    winding : float
        Imaginary part of the decaying pair of a saddle-focus in 1/s; 0 for two real ones.
    """

    spin: float
    below: float
    above: float
    growing: float
    slow: float
    strong: float
    last_amplitude: float = np.pi
    least_tilt: float = 0.0
    winding: float = 0.0

    @property
    def saddle_index(self) -> float:
        """Slow decay over growth; cycles near the connection are stable where it exceeds 1."""
        return -self.slow / self.growing


class NoConnectionError(ArithmeticError):
    """No heteroclinic connection has been found."""


def saddle(scenario: Scenario, spin: float) -> tuple[ComplexArray, Array]:
    """Eigenvalues of noninverted spinning, falling, shape (3,), and growing direction, (3,).

    The first is real; the others decay, and may be a complex pair.

    Raises
    ------
    ValueError
        If the spin is out of range or the scenario has no cycles.
    NoConnectionError
        If it is no saddle with one growing direction.
    """
    flow.require_cycles(scenario)
    (matrix,) = reduced_matrices(scenario, turn_rate("spin", spin), "noninverted")
    values = np.linalg.eigvals(matrix)
    values = values[np.argsort(-values.real)]
    if values[0].imag or not values[0].real > 0.0 > values[1].real:
        raise NoConnectionError(
            f"noninverted spinning at {spin:.9g} rad/s is no saddle with one growing and two "
            f"decaying directions: its eigenvalues are {', '.join(f'{v:.4g}' for v in values)} 1/s"
        )
    _, growing = eigenvectors(matrix, values[0].real)
    return values.astype(complex), growing / growing[1]


def fall(scenario: Scenario, spin: float) -> Fall:
    """Follow the motion that leaves noninverted spinning until it turns back or goes over.

    That takes the longer the faster the spin: a tenth of a second at ten times the paper's
    critical speed, some seconds at thirty times.

    Parameters
    ----------
    scenario : Scenario
        Of the reduced system.
    spin : float
        In rad/s, positive.

    Raises
    ------
    ValueError
        If an argument is out of range or the scenario has no cycles.
    NoConnectionError
        If noninverted spinning is no saddle, the run fails, or it comes to neither.
    """
    flow.require_cycles(scenario, _STEEPEST)
    spin = turn_rate("spin", spin, is_above=True)
    values, growing = saddle(scenario, spin)
    growth = values[0].real
    how: dict[str, Any] = {"method": "LSODA", "rtol": _TOLERANCE, "atol": _TOLERANCE * 1e-2}
    if scenario.friction.gradient > _STIFF:
        jacobian = reduced.jacobian(scenario, spin)
        how = {"method": "Radau", "rtol": _STIFF_TOLERANCE, "atol": _STIFF_TOLERANCE}
        how["jac"] = lambda _, state: jacobian(state)
    run = solve_ivp(
        reduced.right_hand_side(scenario, spin),
        (0.0, _LONGEST / growth),
        np.array((np.pi / 2, -np.pi / 2, 0.0)) + _DEPARTURE * growing,
        events=_ENDINGS,
        **how,
    )

    def distances(turns: float) -> Array:
        """From spinning upright with this gamma, over pi."""
        away = (run.y.T - np.array((np.pi / 2, turns * np.pi, 0.0))) / (1.0, 1.0, growth)
        return np.linalg.norm(away, axis=1)

    has_turned, has_passed, is_flat = (times.size > 0 for times in run.t_events)
    has_settled = run.success and distances(0.5)[-1] < _SETTLED
    if not (has_turned or has_passed or is_flat or has_settled):
        raise NoConnectionError(
            f"the motion from noninverted spinning at {spin:.9g} rad/s neither turns back nor "
            f"goes over within {run.t[-1]:.3g} s: {run.message}"
        )
    # A run may end where its last step has begun.
    times, kept = np.unique(run.t, return_index=True)
    beta, gamma, beta_rate = run.y[:, kept]
    goes_over = has_passed or (is_flat and gamma[-1] > 1.5 * np.pi)
    # Between steps by the rates, of which that of gamma is known.
    turning = CubicHermiteSpline(times, gamma, -spin * np.cos(beta))
    turns = turning.derivative().roots(extrapolate=False)
    passes = turning.solve(1.5 * np.pi, extrapolate=False)[:1]
    tilts = CubicHermiteSpline(times, beta, beta_rate)(passes) - np.pi / 2
    return Fall(
        states=run.y.T,
        side=1.0 if goes_over else -1.0,
        distances=distances(1.5),
        swing=float(np.nanmax(turning([*turns, times[-1]]))) - np.pi / 2,
        tilt=float(tilts.sum()),
    )


_ENDINGS: tuple[Any, ...] = (
    lambda _, state: float(state[1]) - 0.5 * np.pi,
    lambda _, state: float(state[1]) - 2.5 * np.pi,
    lambda _, state: sin(state[0]),
)
"""Events that end a run: back at inverted spinning, a turn further, and flat."""

for _event, _direction in zip(_ENDINGS, (-1.0, 1.0, -1.0), strict=True):
    _event.terminal, _event.direction = True, _direction


def heteroclinic_connection(scenario: Scenario) -> Connection:
    """Find the spin of the heteroclinic connection next to the critical speed.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.

    Returns
    -------
    Connection
        Found to 1e-11 rad/s. The runs add some 1e-10 to its error, and some 1e-8 for friction
        that is more than a hundred times as steep as the paper's.

    Raises
    ------
    ValueError
        If an argument is out of range or the scenario has no cycles.
    NoConnectionError
        If there is none within half the critical speed, or a run comes to neither side.
    """
    law = type(instance("scenario", scenario, Scenario).friction)
    return _connection(scenario, reads(law.per_speed, law))


# It takes seconds, and families of cycles and of rotating motions ask for it each.
@lru_cache(maxsize=64)
def _connection(scenario: Scenario, _read: tuple[Any, ...]) -> Connection:
    tried: dict[float, Fall] = {}

    def missed(spin: float) -> float:
        """By what a motion misses the saddle, to its side: that grows about with the spin."""
        if spin not in tried:
            tried[spin] = fall(scenario, spin)
        return tried[spin].side * float(tried[spin].distances.min()) ** 2

    centre = critical_speed(scenario).spin
    for found in roots_around(missed, centre):
        # The nearest ones on either side.
        below, above = min(
            (pair for pair in pairwise(sorted(tried)) if pair[0] <= found <= pair[1]),
            key=lambda pair: tried[pair[0]].side * tried[pair[1]].side,
        )
        turning, going = sorted((tried[below], tried[above]), key=attrgetter("side"))
        if abs(going.states[-1, 1] - turning.states[-1, 1]) > _ALIKE:
            break
    else:
        does = "turns back" if tried[centre].side < 0.0 else "goes over"
        but = "" if len({each.side for each in tried.values()}) == 1 else ", or falls flat,"
        raise NoConnectionError(
            f"no heteroclinic connection between {centre * (1 - WIDEST):.6g} and "
            f"{centre * (1 + WIDEST):.6g} rad/s: the motion from noninverted spinning {does}{but} "
            "at all spins tried"
        )
    growing, slow, strong = saddle(scenario, found)[0].tolist()
    return Connection(
        spin=found,
        below=below,
        above=above,
        growing=growing.real,
        slow=slow.real,
        strong=strong.real,
        last_amplitude=max(np.pi, turning.swing),
        least_tilt=going.tilt if turning.swing > np.pi else 0.0,
        winding=abs(slow.imag),
    )


def period_growth(cycles: Sequence[PeriodicMotion], connection: Connection) -> dict[str, float]:
    """How the period of the last cycles of a family grows towards the connection, fitted.

    Parameters
    ----------
    cycles : sequence of PeriodicMotion
        Of the connection's scenario. Those are used that lack 0.01 to 3e-5 rad to an amplitude
        of pi; nearer ones are closer to its spin than that is known.
    connection : Connection

    Returns
    -------
    dict
        "by_amplitude": the period over the logarithm of what the amplitude lacks to pi, in s; and
        what is predicted of it: -2 (1 / growth + 1 / slow decay).

    Raises
    ------
    ValueError
        If there are less than 4 of them.
    """
    lacking = np.array([np.pi - cycle.value for cycle in cycles])
    used = (lacking < 1e-2) & (lacking > 3e-5)
    if np.sum(used) < 4:
        raise ValueError(f"cycles must hold 4 with 0.01 to 3e-5 rad to pi, got {np.sum(used)}")
    periods = np.array([cycle.period for cycle in cycles])[used]
    return {
        "by_amplitude": float(np.polyfit(np.log(lacking[used]), periods, 1)[0]),
        "predicted_by_amplitude": -2.0 * (1.0 / connection.growing - 1.0 / connection.slow),
    }
