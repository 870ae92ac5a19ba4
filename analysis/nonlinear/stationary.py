"""All stationary motions of an eccentric disk: attitude and place constant in the turning frame.

While the spin is free nothing makes good what friction takes, so that a stationary motion has no
slip, hence no friction; its contact point then lies on the axis of turning, and so must its centre
of gravity, since nothing pushes it sideways: cos(gamma) = 0 and (r + e sin(gamma)) cos(beta) = 0.
With friction and a free spin an eccentric disk therefore has inverted and noninverted spinning,
and no tilted stationary motion. With held spin, where the constraint replaces what friction takes,
there are tilted ones: the disk slides on a circle, its centre of gravity between up and sideways.
A search from many starts finds them, and a continuation follows them through folds.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from analysis.data.checks import Array, number
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.models import index1
from analysis.models.equations import tangential_directions
from analysis.stability.scope import require_spinning, spin_scale
from analysis.stability.spectra import matrices_over_spin

STARTS = 40
"""Attitudes and places from which a search begins."""

_SMALL = 1e-10
_SPIN_UNIT = 20.0
_STEP, _MOST = 0.03, 2000
"""Spins along a branch are in these rad/s; length of its steps, and how many are made at most."""

_SAME = 1e-6
_FLAT = 0.02
"""Inclination from flat in rad below which the Euler angles end, and nothing is looked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
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
    growth : float or None
        Largest real part of its eigenvalues in 1/s, but for the neutral ones of the place on the
        table; None for others than inverted and noninverted spinning.
    """

    spin: float
    x: float
    y: float
    beta: float
    gamma: float
    growth: float | None

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
    if starts < 1:
        raise ValueError(f"starts must be 1 or more, got {starts}")
    random = np.random.default_rng(0)
    begins = [np.array((0.0, 0.0, np.pi / 2, gamma)) for gamma in (np.pi / 2, -np.pi / 2)]
    lowest, highest = (-1.0, -1.0, 0.1, -3.0), (1.0, 1.0, 3.0, 3.0)
    begins.extend(random.uniform(lowest, highest, (starts, 4)))
    found: list[Array] = []
    for begin in begins:
        place = _solved(scenario, spin, begin)
        if place is not None:
            # Its mirror image is one, too.
            mirror = np.array((0.0, 0.0, np.pi, np.pi)) + place * -1.0
            mirror[3] = np.angle(np.exp(1j * mirror[3]))
            found.extend(each for each in (place, mirror) if _is_new(each, found))
    found.sort(key=lambda place: -float(place[3]))
    return tuple(_motion(scenario, spin, place) for place in found)


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
    z = np.array((x, y, disk.radius * np.sin(beta), 0.0, beta, gamma))
    u = np.array((0.0, 0.0, 0.0, spin, 0.0, 0.0))
    rates = index1.accelerations(scenario, z, u)[0] / unit
    slip = tangential_directions(disk, z).T @ u / (spin * disk.radius)
    e = disk.eccentricity
    cog = np.array((x + e * np.cos(gamma), y + e * np.cos(beta) * np.sin(gamma)))
    held = scenario.constraints
    return np.concatenate(
        (
            rates[:2] / disk.radius,
            rates[3:],
            slip[:1] if "no-slip-along" in held else [],
            slip[1:] if "no-slip-across" in held else [],
            cog / disk.radius if "fixed-cog" in held else [],
        )
    )


def stationary_branch(
    scenario: Scenario, start: StationaryMotion, spins: tuple[float, float]
) -> tuple[StationaryMotion, ...]:
    """Follow stationary motions over the spin, by pseudo-arclength, both ways from one of them.

    Parameters
    ----------
    scenario : Scenario
        See `stationary_motions`.
    start : StationaryMotion
        One of this scenario.
    spins : tuple of 2 floats
        Lowest and highest spin in rad/s, positive, at which the branch is left.

    Returns
    -------
    tuple of StationaryMotion
        In order along the branch; where the spin turns back, it folds. It ends where it meets
        inverted or noninverted spinning.

    Raises
    ------
    ValueError
        If the start is upright or lies outside of the spins.
    ArithmeticError
        If an iteration fails; the message names the last good motion.
    """
    if not start.is_tilted:
        raise ValueError("start must be tilted: upright spinning exists at every spin")
    if not 0.0 < spins[0] <= start.spin <= spins[1]:
        raise ValueError(
            f"spins must be an interval of positive ones about {start.spin:g} rad/s, got {spins}"
        )
    r = scenario.disk.radius
    point = np.array((start.x / r, start.y / r, start.beta, start.gamma, start.spin / _SPIN_UNIT))
    ways = [_followed(scenario, point, sign, spins) for sign in (-1.0, 1.0)]
    points = [*reversed(ways[0]), point, *ways[1]]
    return tuple(_motion(scenario, _SPIN_UNIT * float(p[4]), p[:4]) for p in points)


def _followed(
    scenario: Scenario, point: Array, sign: float, spins: tuple[float, float]
) -> list[Array]:
    found: list[Array] = []
    along, step = np.array((0.0, 0.0, 0.0, 0.0, sign)), _STEP
    while len(found) < _MOST:
        # The direction in which nothing changes to first order, the same way on as before.
        tangent = np.linalg.svd(_slopes(scenario, point))[2][-1]
        tangent = tangent * np.sign(tangent @ along) if found or tangent @ along else tangent
        following = _corrected(scenario, point + step * tangent, tangent)
        if following is None:
            step /= 2.0
            if step < _STEP / 64:
                raise ArithmeticError(
                    f"the branch of stationary motions fails beyond {_SPIN_UNIT * point[4]:.9g} "
                    f"rad/s with beta {point[2]:.6g} and gamma {point[3]:.6g} rad"
                )
            continue
        point, along, step = following, tangent, min(_STEP, 1.5 * step)
        if not spins[0] <= _SPIN_UNIT * point[4] <= spins[1] or _is_upright(point):
            break
        found.append(point)
    return found


def _corrected(scenario: Scenario, guess: Array, tangent: Array) -> Array | None:
    point = guess.copy()
    for _ in range(8):
        residual = np.append(_residual(scenario, _SPIN_UNIT * point[4], point[:4]), 0.0)
        residual[-1] = tangent @ (point - guess)
        if np.max(np.abs(residual)) < _SMALL:
            return point
        matrix = np.vstack((_slopes(scenario, point), tangent))
        point = point - np.linalg.lstsq(matrix, residual, rcond=None)[0]
    return None


def _slopes(scenario: Scenario, point: Array) -> Array:
    step = 1e-6
    columns = []
    for way in step * np.eye(5):
        ahead, behind = (
            _residual(scenario, _SPIN_UNIT * each[4], each[:4])
            for each in (point + way, point - way)
        )
        columns.append((ahead - behind) / (2.0 * step))
    return np.column_stack(columns)


def _is_upright(place: Array) -> bool:
    return bool(abs(place[2] - np.pi / 2) < _SAME and abs(abs(place[3]) - np.pi / 2) < _SAME)


def _motion(scenario: Scenario, spin: float, place: Array) -> StationaryMotion:
    growth = None
    if _is_upright(place):
        motion: Motion = "inverted" if place[3] > 0.0 else "noninverted"
        matrix = matrices_over_spin(scenario, None, motion)(np.array([spin]))[0]
        growth = float(np.max(np.linalg.eigvals(matrix).real))
    r = scenario.disk.radius
    return StationaryMotion(
        spin=spin,
        x=r * float(place[0]),
        y=r * float(place[1]),
        beta=float(place[2]),
        gamma=float(place[3]),
        growth=growth,
    )
