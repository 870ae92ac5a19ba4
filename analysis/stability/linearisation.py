"""Any scenario linearised about a stationary motion, along its constraint manifold.

Independent of the paper's matrices in `mechanics.paper`: the nonlinear index-1
system s' = F(s) in the states of `mechanics.attitude` is differentiated by dual numbers along the
tangent space T of the states that meet every constraint on position and velocity level. Its
Jacobian maps T into itself, so that it is told by the numbers of a state that are free in T.

Some directions of T are neutral. They, too, are mapped into themselves (which is checked), so
that leaving them out leaves the other eigenvalues as they are:

- alpha: the disk may stand on the table in any direction;
- its rate, unless the spin is held: the neighbouring stationary motion, an eigenvalue of zero, of
  a tilted motion together with another attitude;
- the drift, unless the centre of gravity is held: spinning elsewhere on the table, which circles
  in the turning R-frame and has the eigenvalues +-i spin.

Without them Models 1 to 4 have 6 of the 8 eigenvalues of Eq. (55), 4, and twice the 3 of (111).

The equations of motion are quadratic in the velocities, but for friction, whose law is one of the
slip and at no slip linear in it, and rolling resistance, likewise. For upright spinning, which
neither slips nor rolls, all derivatives are therefore polynomials of degree 2 in the spin, taken
from three spins. All lengths count in radii and all times in sqrt(r / g).
"""

from dataclasses import replace
from math import cos, hypot, pi, sin, sqrt
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import qr

from analysis.mechanics import recorded
from analysis.mechanics.attitude import state_of
from analysis.mechanics.constraints import position_residuals, velocity_residuals
from analysis.mechanics.dual import derivatives, of_duals
from analysis.mechanics.penalty import Solver
from analysis.problem.checks import Array, checked, choice, instance, numbers, turn_rate
from analysis.problem.constraints import ConstraintSet
from analysis.problem.elementary import Numbers
from analysis.problem.friction import ViscousFriction
from analysis.problem.names import ArgumentError
from analysis.problem.quantities import QUANTITIES, STEEPEST_FRICTION, Level
from analysis.problem.scenario import (
    Scenario,
    require_lasting,
    require_level,
    require_plain,
    steady,
)
from analysis.problem.start import MOTIONS, Motion, Start

ComplexArray = npt.NDArray[np.complex128]

Place = tuple[float, float, float, float]
"""x and y of the geometric centre in the turning frame in m, beta and gamma in rad."""

_SPIN_STEP = 2.0
"""Spin for which derivatives are worked out, beside 0 and its negative, without units."""

_NEUTRAL = 1e-6
"""Largest relative coupling of the others to what is neutral."""

ROUND_OFF = 1e-12
"""Real parts of less than this part of the largest eigenvalue are none."""

ZERO = 1e-6
"""Eigenvalues, and differences, below this part of sqrt(g / r) or of the largest one are none.

Rounding, some 1e-12, splits a double zero into two of its square root.
"""


def spin_scale(scenario: Scenario) -> float:
    """Natural unit of spins and frequencies: sqrt(g / r) in rad/s."""
    return sqrt(instance("scenario", scenario, Scenario).fall)


def require_spinning(
    scenario: Scenario, analysis: str, level: Level | None = None, hint: str = ""
) -> None:
    """Raise `ValueError` unless a scenario has the stationary motions that an analysis knows.

    Parameters
    ----------
    scenario : Scenario
    analysis : str
        What to call it, such as "the full system".
    level : {1, 2, 3, 4}, optional
        The one model that it describes; any constraints by default.
    hint : str
        What takes the others, for the message.

    Raises
    ------
    ValueError
        If the table leans, the contact is compliant, or the model is another one.
    """
    require_level(scenario, analysis)
    if level is not None:
        require_plain(scenario, analysis)
    if scenario.contact is not None:
        raise ArgumentError(
            "contact", f"needs the ideal contact, got a {scenario.contact!r}", analysis
        )
    if level is not None and scenario.model != level:
        fault = f"is that of Model {level}, got {scenario.name}{hint}"
        raise ArgumentError("constraints", fault, analysis)


def has_drift(constraints: ConstraintSet) -> bool:
    """Whether the disk may spin at any place on the table."""
    return "fixed-cog" not in constraints


def falling(values: npt.NDArray[np.inexact]) -> ComplexArray:
    """Eigenvalues, shape (..., k), by falling real and imaginary part."""
    order = np.lexsort((-values.imag, -values.real))
    return np.take_along_axis(values.astype(complex), order, axis=-1)


def eigenvectors(matrix: Array, value: complex) -> tuple[Any, Any]:
    """Left and right unit eigenvector, each shape (n,), of a simple eigenvalue.

    By singular values: where entries are zero but for rounding, `eig` balances by these, and tells
    vectors that are none.
    """
    left, _, right = np.linalg.svd(matrix - value * np.eye(len(matrix)))
    return left[:, -1], right[-1].conj()


def upright(scenario: Scenario, gamma: float) -> Place:
    """Where the disk spins upright: G, or a centre of gravity that is held, above the origin."""
    is_held = not has_drift(scenario.constraints)
    return -scenario.disk.eccentricity * np.cos(gamma) * is_held, 0.0, pi / 2, gamma


def turning_state(
    scenario: Scenario, place: Place, spin: Any, disk: Any = None
) -> tuple[Any, ...]:
    """State of a body that turns about the vertical and keeps its place, 12 numbers.

    Parameters
    ----------
    scenario : Scenario
    place : tuple of 4 floats
        See `Place`.
    spin : number
        In rad/s.
    disk : optional
        That of the scenario with its numbers of another kind.
    """
    x, y, beta, gamma = place
    height = scenario.disk.clearance(beta, gamma, scenario.half_thickness)[0]
    height -= scenario.resting_penetration
    coordinates, rates = (x, y, height, 0.0, beta, gamma), (0.0, 0.0, 0.0, spin, 0.0, 0.0)
    return state_of(disk or scenario.disk, coordinates, rates)


def imbalance(scenario: Scenario, state: Numbers) -> Array:
    """Changes of the six velocities in a `turning_state`, in parts of those of the spinning.

    All of them are zero in a stationary motion, but for rounding: below `ZERO`.
    """
    unit = state[9] ** 2 + spin_scale(scenario) ** 2
    along = scenario.disk.radius * unit
    found = recorded.solver(scenario)(*state)[6:12]
    return np.divide(found, (along, along, along, unit, unit, unit))


class Linearisation:
    """A scenario linearised about a stationary motion.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with any constraints, or on a penalty contact. See `steady`.
    place : tuple of 4 floats
        Of the stationary motion, see `Place`.
    spin : float, optional
        Of the stationary motion in rad/s; by default any, of an upright one.
    """

    def __init__(self, scenario: Scenario, place: Place, spin: float | None = None) -> None:
        require_lasting(scenario, "the numeric linearisation")
        self._scenario, self.place = scenario, place
        self.frequency = spin_scale(scenario)
        """Unit sqrt(g / r) of the spin in rad/s."""
        radius, unit = scenario.disk.radius, self.frequency
        self._units = np.repeat((radius, 1.0, radius * unit, unit), 3)
        self._solve = recorded.solver(scenario, functions=of_duals)
        is_free = "constant-spin" not in scenario.constraints
        self._has_neighbours = is_free and spin is not None
        self._neutral = [3] + [9] * (is_free and spin is None)
        self._neutral += [0, 1] * has_drift(scenario.constraints)
        step = _SPIN_STEP * unit
        if spin is not None:
            self._powers = self._slopes(spin)[None]
        else:
            less, rest, more = (self._slopes(each) for each in (-step, 0.0, step))
            linear = (more - less) / (2 * _SPIN_STEP)
            square = (more - 2 * rest + less) / (2 * _SPIN_STEP**2)
            self._powers = np.array((rest, linear, square))

    def equations(self, disk: Any, solve: Solver, state: Numbers) -> list[Any]:
        """Time derivative of a state and residuals of constraints, 12 + m numbers of any kind."""
        changes, constraints = solve(*state)[:12], self._scenario.constraints
        if self._scenario.contact is not None:
            return [*changes]
        return [
            *changes,
            *position_residuals(constraints, disk, state),
            *velocity_residuals(constraints, disk, state),
        ]

    def _slopes(self, spin: float) -> Array:
        """Derivatives of `equations` by the state without units, shape (12 + m, 12)."""
        disk, state = self._scenario.disk, turning_state(self._scenario, self.place, spin)
        found = derivatives(lambda moving: self.equations(disk, self._solve, moving), state)
        return found * self._units / self._row_units(len(found))[:, None]

    def _row_units(self, count: int) -> Array:
        """Units of as many numbers of `equations`, shape (count,)."""
        return np.append(
            self._units * self.frequency, np.full(count - 12, self._scenario.disk.radius)
        )

    def matrices(self, spins: Array) -> Array:
        """State matrices in 1/s at spins in rad/s, shape (n, k, k), without what is neutral.

        Raises
        ------
        ArithmeticError
            If a direction is not neutral that should be, or the constraints depend on each other.
        """
        every = self._at(spins)
        jacobians = every[:, :12]
        free, bases = self._tangents(every[:, 12:])
        rows, size = jacobians[:, free], np.max(np.abs(jacobians), axis=(1, 2))
        found, coupling = rows @ bases, np.max(np.abs(rows[:, :, self._neutral]), axis=(1, 2))
        if self._has_neighbours:
            # Those at other spins have other attitudes: nothing changes along them.
            _, changes, ways = np.linalg.svd(found)
            coupling, others = np.maximum(coupling, changes[:, -1]), ways[:, :-1]
            found = others @ found @ others.swapaxes(1, 2)
        worst = float(np.max(coupling / size))
        if worst > _NEUTRAL:
            raise ArithmeticError(
                f"a change of the spin or of the place of {self._scenario.name} is not neutral: "
                f"relative coupling {worst:.1e}"
            )
        return self.frequency * found

    def spread(
        self, spin: float, left: ComplexArray, right: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """What weighs changes of the slopes of `equations`, and the deviation they act on.

        The first derivative of an eigenvalue by a parameter is that of the weighted sum of their
        slopes along the deviation: what it changes of the constraints changes how the free
        numbers carry the others.

        Parameters
        ----------
        spin : float
            In rad/s.
        left, right : ndarray, complex, shape (k,)
            Eigenvectors of the state matrix there, the left one conjugated.

        Returns
        -------
        weights : ndarray, complex, shape (12 + m,)
        deviation : ndarray, complex, shape (12,)
        """
        every = self._at(np.array([spin]))
        free, bases = self._tangents(every[:, 12:])
        carried = np.setdiff1d(np.arange(12), [*free, *self._neutral])
        weights: ComplexArray = np.zeros(every.shape[1], dtype=complex)
        weights[free] = left
        normals, rows = every[0, 12:, carried], every[0][np.ix_(free, carried)]
        weights[12:] = -np.linalg.solve(normals, rows.T @ left)
        weights /= self._row_units(weights.size)
        deviation: ComplexArray = self._units * (bases[0] @ right)
        return weights, deviation

    def _at(self, spins: Array) -> Array:
        """Those of `_slopes` at spins in rad/s, shape (n, 12 + m, 12)."""
        spin = np.vander(spins / self.frequency, len(self._powers), increasing=True)
        return np.tensordot(spin, self._powers, axes=1)

    def _tangents(self, normals: Array) -> tuple[Array, Array]:
        """Free numbers, and how all deviate with each of them, but for the neutral ones."""
        others = np.setdiff1d(np.arange(12), self._neutral)
        triangle, best = qr(self._powers[0][12:, others], mode="r", pivoting=True)
        pivots, count = np.abs(np.diag(triangle)), normals.shape[1]
        if np.any(pivots[:count] < ROUND_OFF * pivots[:1]):
            raise ArithmeticError(
                f"singular linearisation of {self._scenario.name}: one of its constraints holds "
                "nothing that the others leave free"
            )
        solved, free = others[best[:count]], others[np.sort(best[count:])]
        bases = np.zeros((len(normals), 12, free.size))
        bases[:, free] = np.eye(free.size)
        bases[:, solved] = -np.linalg.solve(normals[:, :, solved], normals[:, :, free])
        return free, bases


def spinning(scenario: Scenario, motion: Motion = "inverted") -> Linearisation:
    """Any constraints linearised about inverted or noninverted spinning at any spin.

    Raises
    ------
    ValueError
        If the motion is unknown, the table leans, the spin decays by dissipation or it is no
        stationary motion of the body.
    """
    instance("scenario", scenario, Scenario)
    choice("motion", motion, MOTIONS)
    gamma = pi / 2 if motion == "inverted" else -pi / 2  # Eq. (5)
    found = Linearisation(scenario, upright(scenario, gamma))
    if scenario.disk.is_plain:
        return found
    states = [turning_state(scenario, found.place, spin) for spin in (0.0, found.frequency)]
    if not np.max(np.abs([imbalance(scenario, state) for state in states])) <= ZERO:
        raise ValueError(
            "disk must be able to spin upright for that: the line from its centre to its centre "
            "of gravity must be an axis of inertia and of the surface, and that of this "
            f"{type(scenario.disk).__name__} is not"
        )
    return found


def stationary_eigenvalues(scenario: Scenario, spin: float, place: Place) -> ComplexArray:
    """Eigenvalues of any stationary motion in 1/s, shape (k,), by falling real part.

    The neutral ones are left out: those of the direction in which the disk stands, of the
    neighbouring spin where it is free, and of the place on the table where that is free.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with any constraints, or on a penalty contact. See `steady`.
    spin : float
        In rad/s.
    place : tuple of 4 floats
        Of a motion in which it does not change: x and y of the geometric centre in m, in the frame
        that turns with alpha, beta and gamma in rad.

    Raises
    ------
    ValueError
        If the table leans, the spin decays by dissipation, or a number is out of range.
    ArithmeticError
        If the motion is not stationary.
    """
    spin = turn_rate("spin", spin)
    x, y, beta, gamma = numbers("place", place, ("x", "y", "beta", "gamma"))
    place = x, y, checked(QUANTITIES["start.beta"], beta), gamma
    found = Linearisation(scenario, place, spin)
    off = np.max(np.abs(imbalance(scenario, turning_state(scenario, place, spin))))
    if not off <= ZERO:
        raise ArithmeticError(
            f"a motion at {spin:.9g} rad/s with beta {place[2]:.6g} and gamma {place[3]:.6g} rad "
            f"is not stationary: its accelerations are {off:.1e} of those of the "
            "spinning"
        )
    return falling(np.linalg.eigvals(found.matrices(np.array([spin]))[0]))


_EXACT = 1e-12
"""Largest deviation that rounding makes, in radii, rad and sqrt(g / r)."""

_SLOWEST = 1e-4
"""Growth rate in sqrt(g / r) that counts; rounding may split zero eigenvalues by as much."""


def unstable_start(scenario: Scenario) -> str | None:
    """Say so if a scenario starts exactly on a stationary motion that is unstable.

    Such a run stays there until rounding has grown, and rounding decides when and to which side
    it leaves. Of dissipation that lets the spin decay, nothing is taken into account.

    Parameters
    ----------
    scenario : Scenario

    Returns
    -------
    str or None
        One line; None if the start is none of inverted or noninverted spinning, or a stable one,
        or that of another body than the paper's disk or under a friction law whose force takes
        floats alone, of which nothing is known.
    """
    instance("scenario", scenario, Scenario)
    if not (scenario.table.is_horizontal and scenario.disk.is_plain and _is_stationary(scenario)):
        return None
    spin, gamma = scenario.initial_state.rates[3], scenario.initial_state.coordinates[5]
    friction = scenario.friction
    if friction.is_simple:
        # Only its slope at no slip matters, and neither its kink nor its load.
        friction = ViscousFriction(viscosity=min(friction.gradient, STEEPEST_FRICTION))
    lasting = replace(steady(scenario), friction=friction, start=Start())
    place = upright(lasting, gamma)
    if not np.max(np.abs(imbalance(lasting, turning_state(lasting, place, spin)))) <= ZERO:
        # A centred disk that turns about none of its axes of inertia.
        return None
    try:
        system = Linearisation(lasting, place)
    except ArgumentError as error:
        if error.argument != "law":
            raise
        # A force that takes floats alone has no slopes.
        return None
    values = np.linalg.eigvals(system.matrices(np.array([spin]))[0])
    growth = float(np.max(values.real))
    if growth <= _SLOWEST * system.frequency + ROUND_OFF * np.max(np.abs(values)):
        return None
    motion = "inverted" if sin(gamma) > 0.0 else "noninverted"
    if not scenario.disk.eccentricity:
        motion = "upright"
    return (
        f"start is exactly {motion} spinning, which is unstable at {spin:g} rad/s (deviations "
        f"grow with {growth:.3g} 1/s): rounding decides when and to which side the disk leaves it"
    )


def _is_stationary(scenario: Scenario) -> bool:
    """Whether the disk starts upright, in balance, and turns about the vertical at one place."""
    start, disk, frequency = scenario.initial_state, scenario.disk, spin_scale(scenario)
    *_, beta, gamma = start.coordinates
    *_, u, v, _, _, beta_rate, gamma_rate = state_of(disk, start.coordinates, start.rates)
    drifting = hypot(u, v) / (disk.radius * frequency)
    turning = max(abs(beta_rate), abs(gamma_rate)) / frequency
    aside = abs(disk.eccentricity * cos(gamma)) / disk.radius
    return max(abs(beta - pi / 2), aside, turning, drifting) <= _EXACT
