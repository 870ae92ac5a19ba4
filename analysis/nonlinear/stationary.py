"""All stationary motions of a body: attitude and place constant in the turning frame.

While the spin is free nothing makes good what friction takes, so that a stationary motion has no
slip, hence no friction; its contact point then lies on the axis of turning, and so must its centre
of gravity, since nothing pushes it sideways: cos(gamma) = 0 and (r + e sin(gamma)) cos(beta) = 0.
With friction and a free spin an eccentric disk therefore has inverted and noninverted spinning,
and no tilted stationary motion, unless a constraint against slip pushes it sideways. With held
spin, where the constraint replaces what friction takes, there are tilted ones: the disk slides on
a circle, its centre of gravity between up and sideways.
Without friction, any body may turn about the vertical through its centre of gravity with its
contact point on a circle. A search from many starts finds them, and a continuation follows them
through folds.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.optimize import least_squares

from analysis.mechanics.constraints import SLIPS, position_residuals, velocity_residuals
from analysis.problem.checks import (
    Array,
    function,
    instance,
    number,
    numbers,
    optional,
    positive,
    turn_rate,
    whole,
)
from analysis.problem.limits import MOST_STARTS
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.solve.continuation import Curve
from analysis.stability.linearisation import (
    ComplexArray,
    imbalance,
    require_spinning,
    spin_scale,
    stationary_eigenvalues,
    turning_state,
)

STARTS = 40
"""Attitudes and places from which a search begins."""

_ANYWHERE = (-1.0, -1.0, 0.1, -3.0), (1.0, 1.0, 3.0, 3.0)
_NEARLY_UPRIGHT = (-0.02, -0.02, 1.55, -3.0), (0.02, 0.02, 1.6, 3.0)
"""Least and largest x / r, y / r, beta and gamma of starts."""

_SMALL = 1e-10
"""Largest change in a stationary motion, see `_residual`."""

_STEP = 0.03
"""Length of the steps along a branch, with spins in parts of sqrt(g / r)."""

_BESIDE = 1e-3
"""Distance in rad from upright spinning at which a branch that comes to it ends: nearer, their
directions cannot be told apart."""

_SAME = 1e-6
_FLAT = 0.02
"""Inclination from flat in rad below which the Euler angles end, and nothing is looked for."""

_MIRROR: Array = np.array((0.0, 0.0, np.pi, np.pi))
"""A place and its mirror image, which most bodies have, add up to this."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """What a branch of stationary motions is continued in, besides the spin.

    Parameters
    ----------
    change : callable
        From a value to the scenario that has it.
    value : float
        Where the continuation starts.
    unit : float
        A change that counts as much as one of the attitude by 1 rad; positive.
    """

    change: Callable[[float], Scenario]
    value: float
    unit: float

    def __post_init__(self) -> None:
        function("change", self.change)
        number("value", self.value)
        positive("unit", self.unit)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StationaryMotion:
    """A stationary motion at a spin.

    Parameters
    ----------
    spin : float
        In rad/s.
    x, y : float
        Place of the geometric centre in the turning frame in m.
    beta, gamma : float
        In rad; gamma between -pi and pi.
    eigenvalues : ndarray, complex, shape (k,)
        In 1/s, by falling real part, but for the neutral ones of its neighbours; see
        `stationary_eigenvalues`. None, k = 0, where its neighbours have no such.
    value : float
        Of the parameter that is continued: the spin, or another one.
    reason : str or None
        Why there are no eigenvalues, if there are none.
    """

    spin: float
    x: float
    y: float
    beta: float
    gamma: float
    eigenvalues: ComplexArray
    value: float
    reason: str | None = None

    @property
    def growth(self) -> float:
        """Largest real part of its eigenvalues in 1/s, nan if there are none."""
        return float(self.eigenvalues[0].real) if self.eigenvalues.size else np.nan

    @property
    def is_tilted(self) -> bool:
        """Whether it is neither inverted nor noninverted spinning."""
        return bool(np.max(np.abs(np.cos((self.beta, self.gamma)))) > _SAME)

    @classmethod
    def at(
        cls, scenario: Scenario, spin: float, place: Array, value: float | None = None
    ) -> "StationaryMotion":
        """That of a place, x / r, y / r, beta and gamma; the parameter is the spin by default."""
        r = scenario.disk.radius
        x, y, beta, gamma = (place * (r, r, 1.0, 1.0)).tolist()
        eigenvalues, reason = np.empty(0, dtype=complex), None
        try:
            eigenvalues = stationary_eigenvalues(scenario, spin, (x, y, beta, gamma))
        except ArithmeticError as error:
            reason = str(error)
        return cls(
            spin=spin,
            x=x,
            y=y,
            beta=beta,
            gamma=gamma,
            eigenvalues=eigenvalues,
            value=spin if value is None else value,
            reason=reason,
        )


def stationary_motions(
    scenario: Scenario, spin: float, starts: int = STARTS
) -> tuple[StationaryMotion, ...]:
    """Search for stationary motions of any body and constraints, from random attitudes and places.

    Inverted and noninverted spinning are among them if the body can spin like that; others may be
    missed. Of those that are not isolated, there are some.

    Parameters
    ----------
    scenario : Scenario
        On an ideal contact and a horizontal table; a round disk must be eccentric, and the more so
        the steeper friction is.
    spin : float
        In rad/s, not zero.
    starts : int
        How many, 1 or more; always the same ones.

    Returns
    -------
    tuple of StationaryMotion
        By falling gamma.

    Raises
    ------
    ValueError
        If an argument is out of range or the scenario another one.
    """
    require_spinning(scenario, "the search for stationary motions")
    if turn_rate("spin", spin) == 0.0:
        raise ArgumentError("spin", f"must not be 0, got {spin!r}")
    # What friction takes goes with the square of the slip, which steep friction keeps small.
    disk, fastest = scenario.disk, max(abs(spin), spin_scale(scenario))
    least = sqrt(_SMALL * max(1.0, scenario.rubs * scenario.slip_decay / fastest)) * disk.radius
    if disk.is_round_disk and disk.eccentricity < least:
        fault = f"must be {least:g} m or more here, got {disk.eccentricity:g}: with less,"
        raise ArgumentError("eccentricity", f"{fault} every gamma is stationary but for rounding")
    starts = whole("starts", starts, most=MOST_STARTS)
    random = np.random.default_rng(0)
    begins = [np.array((0.0, 0.0, np.pi / 2, gamma)) for gamma in (np.pi / 2, -np.pi / 2)]
    begins.extend(random.uniform(*_ANYWHERE, (starts - starts // 2, 4)))
    # Those that bifurcate from upright spinning are nearly upright, and draw few starts in.
    begins.extend(random.uniform(*_NEARLY_UPRIGHT, (starts // 2, 4)))
    found: list[Array] = []
    for begin in begins:
        place = _solved(scenario, spin, begin)
        # Of one that is known, so is the mirror image.
        if place is not None and _new(place, found):
            both = place, _solved(scenario, spin, _MIRROR - place)
            found.extend(each for each in both if each is not None and _new(each, found))
    found.sort(key=lambda place: -float(place[3]))
    return tuple(StationaryMotion.at(scenario, spin, place) for place in found)


def _new(place: Array, found: list[Array]) -> bool:
    return all(np.max(np.abs(place - each)) > _SAME for each in found)


def _solved(scenario: Scenario, spin: float, begin: Array) -> Array | None:
    """A root as x / r, y / r, beta, gamma from -pi to pi; None if the iteration ends elsewhere."""
    far = np.inf
    try:
        found = least_squares(
            lambda place: _residual(scenario, spin, place),
            begin,
            jac="3-point",
            bounds=((-far, -far, _FLAT, -far), (far, far, np.pi - _FLAT, far)),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
    except ArithmeticError:
        # In some attitudes the contact may jam.
        return None
    if np.max(np.abs(found.fun)) > _SMALL or np.any(found.active_mask):
        return None
    return np.append(found.x[:3], np.angle(np.exp(1j * found.x[3])))


def _residual(scenario: Scenario, spin: float, place: Array) -> Array:
    """What is zero in a stationary motion, without units, shape (k,).

    All but the vertical acceleration, which the contact holds; what else is held, too.

    Parameters
    ----------
    scenario : Scenario
    spin : float
        In rad/s.
    place : ndarray, shape (4,)
        x / r, y / r, beta and gamma.
    """
    disk, constraints = scenario.disk, scenario.constraints
    r, (x, y, beta, gamma) = disk.radius, place.tolist()
    state = turning_state(scenario, (r * x, r * y, beta, gamma), spin)
    found = imbalance(scenario, state)
    no_slips = tuple(each for each in SLIPS if each in constraints)
    slips = np.divide(velocity_residuals(no_slips, disk, state), spin * r)
    # The height is that of the contact.
    away = np.divide(position_residuals(constraints, disk, state)[1:], r)
    return np.concatenate((found[:2], found[3:], slips, away))


def stationary_branch(
    scenario: Scenario,
    start: StationaryMotion,
    interval: tuple[float, float],
    parameter: Parameter | None = None,
) -> tuple[StationaryMotion, ...]:
    """Follow stationary motions by pseudo-arclength, both ways from one of them.

    Parameters
    ----------
    scenario : Scenario
        See `stationary_motions`.
    start : StationaryMotion
        One of this scenario.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s, positive, or value of the parameter, at which the branch
        is left.
    parameter : Parameter, optional
        What to continue in, at the spin of the start; the spin by default.

    Returns
    -------
    tuple of StationaryMotion
        In order along the branch; where the value turns back, it folds. It ends where it meets
        inverted or noninverted spinning.

    Raises
    ------
    ValueError
        If the start is upright or lies outside of the interval.
    ArithmeticError
        If an iteration fails, or too many motions lie in the interval; the message names
        the last good one.
    """
    require_spinning(scenario, "the continuation of stationary motions")
    if not instance("start", start, StationaryMotion).is_tilted:
        raise ValueError("start must be tilted: upright spinning exists at every spin")
    low, high = numbers("interval", interval, ("lowest", "highest value"))
    optional(instance, "parameter", parameter, Parameter)
    spins = Parameter(change=lambda _: scenario, value=start.spin, unit=spin_scale(scenario))
    followed = parameter or spins
    value, unit = followed.value, followed.unit
    if not low <= value <= high or (parameter is None and low <= 0.0):
        allowed = "positive spins" if parameter is None else "values"
        raise ValueError(f"interval must be one of {allowed} about {value:g}, got {interval}")

    def at(point: Array) -> tuple[Scenario, float]:
        """Scenario and spin of a point: a place and the value over its unit."""
        found = unit * float(point[4])
        changed = instance("change", followed.change(found), Scenario)
        return changed, found if parameter is None else start.spin

    def equations(points: Array) -> Array:
        return np.array([_residual(*at(each), each[:4]) for each in points])

    r = scenario.disk.radius
    point = np.array((start.x / r, start.y / r, start.beta, start.gamma, value / unit))

    def where(point: Array) -> str:
        value, beta, gamma = unit * point[4], point[2], point[3]
        return f"beyond {value:.9g} with beta {beta:.6g} and gamma {gamma:.6g} rad"

    def meets_upright(point: Array) -> bool:
        """Whether the branch meets upright spinning, or has gone past it."""
        begin, here = np.cos((start.beta, start.gamma)), np.cos(point[2:4])
        return bool(np.max(np.abs(here)) < _BESIDE or np.all(begin * here < 0.0))

    bounds = np.outer((-1.0, 1.0), np.full(5, np.inf))
    bounds[:, 4] = low / unit, high / unit
    points = Curve(equations, (*bounds,), _STEP, where, meets_upright).through(point)
    return tuple(
        StationaryMotion.at(*at(each), each[:4], unit * float(each[4])) for each in points
    )
