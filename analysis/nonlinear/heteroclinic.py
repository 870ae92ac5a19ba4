"""The end of the cycles: a connection between noninverted spinning and itself, a turn further.

Noninverted spinning is a saddle with one growing direction. The motion that leaves it there with
growing gamma either turns back before gamma has made a whole turn, or goes on over it; in between
there is a spin at which it ends in the saddle again. Neither cycles nor boundary values are needed
to find it. Where friction is weak or smooth, the decaying directions are a complex pair (a
saddle-focus), about which the motion winds: whether it has turned back or gone over shows only
where it passes inverted spinning again.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analysis.mechanics import reduced
from analysis.nonlinear import flow
from analysis.nonlinear.continuation import WIDEST, nearest_root
from analysis.nonlinear.motions import PeriodicMotion
from analysis.problem.checks import Array, number, positive
from analysis.problem.scenario import Scenario
from analysis.stability.linearisation import ComplexArray
from analysis.stability.printed import critical_speed, reduced_matrices

Ending = Callable[[float, Array], float]

_DEPARTURE = 1e-6
"""Deviation of gamma in rad at which a motion leaves the saddle along its growing direction."""

_LONGEST = 60.0
"""End of a run in time constants of the growing direction; it takes 14 to leave."""

_TOLERANCE = 1e-11
"""Relative error of a step of a run."""

_BESIDE = 1e-9
"""Distance in rad/s from the connection at which a motion surely falls to its side."""

_STEEPEST = 1e5
"""Gradient of friction in s/m beyond which runs lose the digits of the spin."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fall:
    """The motion that leaves noninverted spinning with growing gamma.

    Parameters
    ----------
    states : ndarray, shape (n, 3)
        beta, gamma in rad and rate of beta in rad/s.
    miss : float
        Negative, gamma less 3 pi/2 where it turns back; or positive, beta less pi/2 (at most
        pi/2: the disk falls flat) where gamma reaches 3 pi/2. About a saddle-focus -1 or 1.
    """

    states: Array
    miss: float


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
    winding : float
        Imaginary part of the decaying pair of a saddle-focus in 1/s; 0 for two real ones.
    """

    spin: float
    below: float
    above: float
    growing: float
    slow: float
    strong: float
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
    NoConnectionError
        If it is no saddle with one growing direction.
    """
    spin = number("spin", spin)
    values, vectors = np.linalg.eig(reduced_matrices(scenario, [spin], "noninverted")[0])
    order = np.argsort(-values.real)
    values = values[order]
    if values[0].imag or not values[0].real > 0.0 > values[1].real:
        raise NoConnectionError(
            f"noninverted spinning at {spin:.9g} rad/s is no saddle with one growing and two "
            f"decaying directions: its eigenvalues are {', '.join(f'{v:.4g}' for v in values)} 1/s"
        )
    growing = vectors[:, order[0]].real
    return values.astype(complex), growing / growing[1]


def fall(scenario: Scenario, spin: float) -> Fall:
    """Follow the motion that leaves noninverted spinning until it turns back or goes over.

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
        If noninverted spinning is no saddle, or the run fails.
    """
    flow.require_cycles(scenario, _STEEPEST)
    spin = positive("spin", spin)
    values, growing = saddle(scenario, spin)

    rates = reduced.right_hand_side(scenario, spin)
    winds = values[1].imag != 0.0
    run = solve_ivp(
        rates,
        (0.0, _LONGEST / values[0].real),
        np.array((np.pi / 2, -np.pi / 2, 0.0)) + _DEPARTURE * growing,
        # The strong direction is stiff where friction is steep.
        method="LSODA",
        rtol=_TOLERANCE,
        atol=_TOLERANCE * 1e-2,
        events=_endings(winds=winds),
    )
    if not run.success:
        raise NoConnectionError(f"the motion at {spin:.9g} rad/s fails: {run.message}")
    has_turned, *has_passed = (times.size > 0 for times in run.t_events)
    # Closer than rounding to the saddle, it stays there.
    miss = 0.0
    if has_turned:
        miss = -1.0 if winds else float(run.y[1, -1]) - 1.5 * np.pi
    elif any(has_passed):
        miss = 1.0 if winds else float(run.y[0, -1]) - np.pi / 2
    return Fall(states=run.y.T, miss=miss)


def _endings(*, winds: bool) -> tuple[Ending, Ending, Ending]:
    """Events that end a run: it turns back, it goes over, the disk falls flat."""
    # Back at inverted spinning; or upright again, which it becomes where gamma is largest.
    place, over = (1, 2.5 * np.pi) if winds else (0, 1.5 * np.pi)
    events: tuple[Any, Any, Any] = (
        lambda _, x: float(x[place]) - np.pi / 2,
        lambda _, x: float(x[1]) - over,
        lambda _, x: np.pi - float(x[0]),
    )
    for event in events:
        event.terminal = True
    events[0].direction = -1.0
    return events


def heteroclinic_connection(scenario: Scenario) -> Connection:
    """Find the spin of the heteroclinic connection next to the critical speed.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.

    Returns
    -------
    Connection
        Found to 1e-11 rad/s. The runs add some 1e-9 to its error, 3e-8 for friction a hundred
        times as steep as the paper's.

    Raises
    ------
    ValueError
        If an argument is out of range or the scenario has no cycles.
    NoConnectionError
        If there is none within half the critical speed.
    """
    tried: dict[float, float] = {}

    def miss(spin: float) -> float:
        if spin not in tried:
            tried[spin] = fall(scenario, spin).miss
        return tried[spin]

    centre = critical_speed(scenario).spin
    found = nearest_root(miss, centre)
    if found is None:
        side = "turns back" if tried[centre] < 0.0 else "goes over"
        raise NoConnectionError(
            f"no heteroclinic connection between {centre * (1 - WIDEST):.6g} and "
            f"{centre * (1 + WIDEST):.6g} rad/s: the motion from noninverted spinning {side} at "
            "all spins tried"
        )
    growing, slow, strong = saddle(scenario, found)[0].tolist()
    # The nearest ones that are surely on either side.
    low, high = tried[min(tried)], tried[max(tried)]
    return Connection(
        spin=found,
        below=max((s for s, v in tried.items() if s <= found and v * low > 0.0), default=found),
        above=min((s for s, v in tried.items() if s >= found and v * high > 0.0), default=found),
        growing=growing.real,
        slow=slow.real,
        strong=strong.real,
        winding=abs(slow.imag),
    )


def last_amplitude(scenario: Scenario) -> float:
    """Amplitude in rad of the cycles next to the connection: pi, or more about a saddle-focus.

    Parameters
    ----------
    scenario : Scenario
        See `heteroclinic_connection`; so are the errors.
    """
    if not np.any(saddle(scenario, critical_speed(scenario).spin)[0].imag):
        return float(np.pi)
    found = heteroclinic_connection(scenario)
    sides = (fall(scenario, side) for side in (found.below - _BESIDE, found.above + _BESIDE))
    # The one that turns back is nearly the cycle's own way.
    overshoot = max(float(np.max(way.states[:, 1])) for way in sides if way.miss < 0.0)
    return max(float(np.pi), overshoot - np.pi / 2)


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
