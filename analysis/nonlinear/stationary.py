"""All stationary motions of an eccentric disk: attitude and place constant in the turning frame.

While the spin is free nothing makes good what friction takes, so that a stationary motion has no
slip, hence no friction; its contact point then lies on the axis of turning, and so must its centre
of gravity, since nothing pushes it sideways: cos(gamma) = 0 and (r + e sin(gamma)) cos(beta) = 0.
With friction and a free spin an eccentric disk therefore has inverted and noninverted spinning,
and no tilted stationary motion. With held spin, where the constraint replaces what friction takes,
there are tilted ones: the disk slides on a circle, its centre of gravity between up and sideways.
A search from many starts finds them, and a continuation follows them through folds.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from analysis.data.checks import Array, number, positive, whole
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.mechanics import recorded
from analysis.mechanics.constraints import SLIPS, places, velocities
from analysis.mechanics.states import state_of
from analysis.stability.linear_reduced import ComplexArray
from analysis.stability.linear_stationary import stationary_eigenvalues
from analysis.stability.scope import require_spinning, spin_scale
from analysis.stability.spectra import matrices_over_spin

STARTS = 40
"""Attitudes and places from which a search begins."""

_ANYWHERE = (-1.0, -1.0, 0.1, -3.0), (1.0, 1.0, 3.0, 3.0)
_NEARLY_UPRIGHT = (-0.02, -0.02, 1.55, -3.0), (0.02, 0.02, 1.6, 3.0)
"""Least and largest x / r, y / r, beta and gamma of starts."""

_SMALL = 1e-10
_SLOPE_STEP = 1e-6
_SPIN_UNIT = 20.0
_STEP = 0.03
"""Spins along a branch are in these rad/s; length of its steps."""

_SAME = 1e-6
_FLAT = 0.02
"""Inclination from flat in rad below which the Euler angles end, and nothing is looked for."""


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
        `stationary_eigenvalues`.
    value : float
        Of the parameter that is continued: the spin, or another one.
    """

    spin: float
    x: float
    y: float
    beta: float
    gamma: float
    eigenvalues: ComplexArray
    value: float

    @property
    def growth(self) -> float:
        """Largest real part of its eigenvalues in 1/s."""
        return float(self.eigenvalues[0].real)

    @property
    def is_tilted(self) -> bool:
        """Whether the disk is not upright."""
        return abs(self.beta - np.pi / 2) > _SAME


def stationary_motions(
    scenario: Scenario, spin: float, starts: int = STARTS
) -> tuple[StationaryMotion, ...]:
    """Search for stationary motions of any constraints from random attitudes and places.

    Inverted and noninverted spinning are always among them; others may be missed.

    Parameters
    ----------
    scenario : Scenario
        With an eccentric disk on an ideal contact and a horizontal table.
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
    if scenario.disk.eccentricity == 0.0:
        raise ValueError("eccentricity must be positive: without it every gamma is stationary")
    if number("spin", spin) == 0.0:
        raise ValueError("spin must not be 0")
    starts = whole("starts", starts)
    random = np.random.default_rng(0)
    begins = [np.array((0.0, 0.0, np.pi / 2, gamma)) for gamma in (np.pi / 2, -np.pi / 2)]
    begins.extend(random.uniform(*_ANYWHERE, (starts - starts // 2, 4)))
    # Those that bifurcate from upright spinning are nearly upright, and draw few starts in.
    begins.extend(random.uniform(*_NEARLY_UPRIGHT, (starts // 2, 4)))
    found: list[Array] = []
    for begin in begins:
        place = _solved(scenario, spin, begin)
        if place is not None:
            # Its mirror image is one, too.
            mirror = np.array((0.0, 0.0, np.pi, np.pi)) + place * -1.0
            mirror[3] = np.angle(np.exp(1j * mirror[3]))
            found.extend(each for each in (place, mirror) if _is_new(each, found))
    found.sort(key=lambda place: -float(place[3]))
    return tuple(_motion(scenario, spin, place, spin) for place in found)


def _is_new(place: Array, found: list[Array]) -> bool:
    return all(np.max(np.abs(place - each)) > _SAME for each in found)


def _solved(scenario: Scenario, spin: float, begin: Array) -> Array | None:
    """A root as x / r, y / r, beta, gamma; None if the iteration ends elsewhere."""
    lowest, highest = (-3.0, -3.0, _FLAT, -10.0), (3.0, 3.0, np.pi - _FLAT, 10.0)
    found = least_squares(
        lambda place: _residual(scenario, spin, place),
        begin,
        bounds=(lowest, highest),
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    if np.max(np.abs(found.fun)) > _SMALL or np.any(found.active_mask):
        return None
    place = np.array(found.x)
    place[3] = np.angle(np.exp(1j * place[3]))
    return place


def _residual(scenario: Scenario, spin: float, place: Array) -> Array:
    disk, unit = scenario.disk, spin**2 + spin_scale(scenario) ** 2
    x, y, beta, gamma = disk.radius * place[0], disk.radius * place[1], place[2], place[3]
    coordinates = (x, y, disk.radius * np.sin(beta), 0.0, beta, gamma)
    state = np.array(state_of(disk, coordinates, (0.0, 0.0, 0.0, spin, 0.0, 0.0))).tolist()
    rates = np.array(recorded.solver(scenario)(*state)[6:12]) / unit
    held = scenario.constraints
    slips = tuple(each for each in SLIPS if each in held)
    return np.concatenate(
        (
            rates[:2] / disk.radius,
            rates[3:],
            np.array(velocities(slips, disk, state)) / (spin * disk.radius),
            np.array(places(held, disk, state)[1:]) / disk.radius,
        )
    )


def stationary_branch(
    scenario: Scenario,
    start: StationaryMotion,
    interval: tuple[float, float],
    parameter: Parameter | None = None,
    *,
    most: int = 2000,
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
    most : int
        Motions to find at most, each way.

    Returns
    -------
    tuple of StationaryMotion
        In order along the branch; where the value turns back, it folds. It ends where it meets
        inverted or noninverted spinning.

    Raises
    ------
    ValueError
        If the start is upright or lies outside of the interval, or `most` is below 1.
    ArithmeticError
        If an iteration fails, or more than `most` motions lie in the interval; the message names
        the last good one.
    """
    if not start.is_tilted:
        raise ValueError("start must be tilted: upright spinning exists at every spin")
    if most < 1:
        raise ValueError(f"most must be 1 or more, got {most}")
    value = start.spin if parameter is None else parameter.value
    if not interval[0] <= value <= interval[1] or (parameter is None and interval[0] <= 0.0):
        allowed = "positive spins" if parameter is None else "values"
        raise ValueError(f"interval must be one of {allowed} about {value:g}, got {interval}")
    line = _Line(scenario, start.spin, parameter)
    r = scenario.disk.radius
    point = np.array((start.x / r, start.y / r, start.beta, start.gamma, value / line.unit))
    ways = [_followed(line, point, sign, interval, most) for sign in (-1.0, 1.0)]
    return tuple(line.motion(p) for p in [*reversed(ways[0]), point, *ways[1]])


@dataclass(frozen=True)
class _Line:
    """What is continued: points are x / r, y / r, beta, gamma and the value over its unit."""

    scenario: Scenario
    spin: float
    parameter: Parameter | None

    @property
    def unit(self) -> float:
        return _SPIN_UNIT if self.parameter is None else self.parameter.unit

    def at(self, point: Array) -> tuple[Scenario, float]:
        """Scenario and spin of a point."""
        value = self.unit * float(point[4])
        if self.parameter is None:
            return self.scenario, value
        return self.parameter.change(value), self.spin

    def residual(self, point: Array) -> Array:
        return _residual(*self.at(point), point[:4])

    def slopes(self, point: Array) -> Array:
        steps = _SLOPE_STEP * np.eye(5)
        pairs = ((self.residual(point + way), self.residual(point - way)) for way in steps)
        return np.column_stack([(a - b) / (2.0 * _SLOPE_STEP) for a, b in pairs])

    def ends(self, how: str, point: Array) -> ArithmeticError:
        """Error that says how the branch ends, and its last good motion."""
        return ArithmeticError(
            f"the branch of stationary motions {how} beyond {self.unit * point[4]:.9g} with beta "
            f"{point[2]:.6g} and gamma {point[3]:.6g} rad"
        )

    def motion(self, point: Array) -> StationaryMotion:
        return _motion(*self.at(point), point[:4], self.unit * float(point[4]))


def _followed(
    line: _Line, point: Array, sign: float, interval: tuple[float, float], most: int
) -> list[Array]:
    found: list[Array] = []
    along, step = np.array((0.0, 0.0, 0.0, 0.0, sign)), _STEP
    while True:
        # The direction in which nothing changes to first order, the same way on as before.
        tangent = np.linalg.svd(line.slopes(point))[2][-1]
        tangent = tangent * np.sign(tangent @ along) if found or tangent @ along else tangent
        following = _corrected(line, point + step * tangent, tangent)
        if following is None:
            step /= 2.0
            if step < _STEP / 64:
                raise line.ends("fails", point)
            continue
        point, along, step = following, tangent, min(_STEP, 1.5 * step)
        if not interval[0] <= line.unit * point[4] <= interval[1] or _is_upright(point):
            return found
        if len(found) == most:
            raise line.ends(f"has more than {most} motions one way, and goes on", found[-1])
        found.append(point)


def _corrected(line: _Line, guess: Array, tangent: Array) -> Array | None:
    point = guess.copy()
    for _ in range(8):
        residual = np.append(line.residual(point), tangent @ (point - guess))
        if np.max(np.abs(residual)) < _SMALL:
            return point
        matrix = np.vstack((line.slopes(point), tangent))
        point = point - np.linalg.lstsq(matrix, residual, rcond=None)[0]
    return None


def _is_upright(place: Array) -> bool:
    return bool(abs(place[2] - np.pi / 2) < _SAME and abs(abs(place[3]) - np.pi / 2) < _SAME)


def _motion(scenario: Scenario, spin: float, place: Array, value: float) -> StationaryMotion:
    r = scenario.disk.radius
    x, y, beta, gamma = r * float(place[0]), r * float(place[1]), float(place[2]), float(place[3])
    if _is_upright(place):
        upright: Motion = "inverted" if gamma > 0.0 else "noninverted"
        matrix = matrices_over_spin(scenario, None, upright)(np.array([spin]))[0]
        found = np.linalg.eigvals(matrix).astype(complex)
        values = found[np.lexsort((-found.imag, -found.real))]
    else:
        values = stationary_eigenvalues(scenario, spin, (x, y, beta, gamma))
    return StationaryMotion(
        spin=spin, x=x, y=y, beta=beta, gamma=gamma, eigenvalues=values, value=value
    )
