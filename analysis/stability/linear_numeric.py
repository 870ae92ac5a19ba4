"""Any set of constraints linearised about spinning, along its constraint manifold.

Independent of the matrices of `linear_full` and `linear_reduced`: the nonlinear index-1 system
s' = F(s) in the states of `mechanics.states` is differentiated by dual numbers along the tangent
space T of the states that meet every constraint on position and velocity level. Its Jacobian J
maps T into itself; with B a basis of T and L its inverse, the state matrix is L J B.

Some directions of T are neutral. They, too, are mapped into themselves (which is checked), so
that leaving them out of B leaves the other eigenvalues as they are:

- alpha: the disk may stand on the table in any direction;
- its rate, unless the spin is held: the neighbouring stationary motion, an eigenvalue of zero;
- the drift, unless the centre of gravity is held: spinning elsewhere on the table, which circles
  in the turning R-frame and has the eigenvalues +-i spin.

With alpha and its rate left out, Models 1 to 4 have the 8 eigenvalues of Eq. (55), 4, and twice
the 3 of Eq. (111).

The equations of motion are quadratic in the velocities, but for friction, whose law is one of the
slip and at no slip linear in it. J is therefore a polynomial of degree 2 in the spin, taken from
three spins. All lengths count in radii and all times in sqrt(r / g).
"""

from math import cos, pi

import numpy as np
import numpy.typing as npt
from scipy.linalg import qr

from analysis.data.checks import Array, choice
from analysis.data.constraint_set import ConstraintSet
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.mechanics import recorded
from analysis.mechanics.constraints import places, velocities
from analysis.mechanics.dual import derivatives
from analysis.mechanics.states import state_of
from analysis.stability.linear_full import spin_array
from analysis.stability.scope import require_spinning, spin_scale

_SPIN_STEP = 2.0
"""Spin for which J is worked out, beside 0 and its negative, without units."""


def numeric_matrices(
    scenario: Scenario,
    spins: npt.ArrayLike,
    motion: Motion = "inverted",
    *,
    drift: bool = True,
) -> Array:
    """State matrices of a scenario linearised by dual numbers, shape (n, k, k).

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact and any constraints.
    spins : array_like, shape (n,)
        Spinning speeds in rad/s, of either sign.
    motion : {"inverted", "noninverted"}
    drift : bool
        Whether the pair +-i spin of a disk that spins elsewhere stays in; see `has_drift`.

    Raises
    ------
    ValueError
        If a spin is not finite, there is none, the motion is unknown, the table leans or the
        contact is compliant.
    ArithmeticError
        If a direction is not neutral that should be.
    """
    system = NumericSystem(scenario, upright_gamma(motion))
    return system.matrices(spin_array(spins), drift=drift)


def upright_gamma(motion: Motion) -> float:
    """Rotation angle in rad of a stationary motion, Eq. (5)."""
    choice("motion", motion, MOTIONS)
    return pi / 2 if motion == "inverted" else -pi / 2


def has_drift(constraints: ConstraintSet) -> bool:
    """Whether the disk may spin at any place on the table."""
    return "fixed-cog" not in constraints


class LinearFlow:
    """The index-1 system of a scenario linearised, lengths in radii, times in sqrt(r / g).

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact and any constraints.
    """

    def __init__(self, scenario: Scenario) -> None:
        require_spinning(scenario, "the numeric linearisation")
        self.scenario = scenario
        self.frequency = spin_scale(scenario)
        """Unit sqrt(g / r) of the spin in rad/s."""
        lengths = np.array((scenario.disk.radius,) * 3)
        ones = np.ones(3)
        self._units = np.concatenate(
            (lengths, ones, lengths * self.frequency, ones * self.frequency)
        )
        self._solve = recorded.solver(scenario)
        self._jacobian = recorded.jacobian(scenario)

    def stationary(self, spin: float, coordinates: tuple[float, ...]) -> Array:
        """State in which nothing but alpha changes, shape (12,).

        Parameters
        ----------
        spin : float
            In rad/s.
        coordinates : tuple of 6 floats
            The paper's coordinates in m and rad.
        """
        rates = (0.0, 0.0, 0.0, spin, 0.0, 0.0)
        return np.array(state_of(self.scenario.disk, coordinates, rates))

    def accelerations(self, state: Array) -> Array:
        """Changes of the velocities in a state, without units, shape (6,)."""
        rates = np.array(self._solve(*state.tolist())[:12]) / (self._units * self.frequency)
        result: Array = rates[6:]
        return result

    def jacobian(self, state: Array) -> Array:
        """Jacobian of the time derivative without units, shape (12, 12)."""
        found = self._jacobian(state) * self._units / self._units[:, None]
        result: Array = found / self.frequency
        return result

    def normals(self, state: Array) -> Array:
        """Derivatives of what the constraints hold, without units, shape (n, 12).

        Those of positions come first.
        """
        held, disk = self.scenario.constraints, self.scenario.disk
        rows = derivatives(
            lambda moving: [*places(held, disk, moving), *velocities(held, disk, moving)], state
        )
        result: Array = rows * self._units / self.scenario.disk.radius
        return result

    def neutral(self, state: Array, *, drift: bool) -> Array:
        """Directions in which a stationary state has neighbours, shape (12, j).

        Parameters
        ----------
        state : ndarray, shape (12,)
        drift : bool
            Whether the place on the table is left out of them.
        """
        held, every = self.scenario.constraints, np.eye(12)
        directions = [every[3]]
        if "constant-spin" not in held:
            x, y = state[:2] / self.scenario.disk.radius
            directions.append(every[9] + x * every[7] - y * every[6])
        if not drift and has_drift(held):
            directions += [every[0], every[1]]
        return np.column_stack(directions)


def dependent(rows: Array) -> npt.NDArray[np.intp]:
    """Numbers of the columns by which rows, shape (m, 12), are solved best; shape (m,)."""
    found: npt.NDArray[np.intp] = qr(rows, mode="r", pivoting=True)[1][: len(rows)]
    return found


def tangent_bases(rows: Array, solved: npt.NDArray[np.intp]) -> Array:
    """Bases of what is normal to rows, shape (n, m, 12), each with a free number of its own.

    Parameters
    ----------
    rows : ndarray, shape (n, m, 12)
    solved : ndarray of int, shape (m,)
        Numbers of a state that follow from the free ones, which are the others.

    Returns
    -------
    ndarray, shape (n, 12, 12 - m)
    """
    free = np.setdiff1d(np.arange(12), solved)
    result = np.zeros((len(rows), 12, free.size))
    result[:, free] = np.eye(free.size)
    result[:, solved] = -np.linalg.solve(rows[:, :, solved], rows[:, :, free])
    return result


class NumericSystem:
    """A scenario linearised about upright spinning at every spin.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table, with the ideal contact and any constraints.
    gamma : float
        Rotation angle in rad of the stationary motion: pi / 2 or -pi / 2, or any for a round disk.
    """

    def __init__(self, scenario: Scenario, gamma: float) -> None:
        self._flow, self._scenario = LinearFlow(scenario), scenario
        self.frequency = self._flow.frequency
        """Unit sqrt(g / r) of the spin in rad/s."""
        disk = scenario.disk
        # A centre of gravity that is held stands above the origin.
        x = 0.0 if has_drift(scenario.constraints) else -disk.eccentricity * cos(gamma)
        self._place = x, 0.0, disk.radius, 0.0, pi / 2, gamma
        states = [self.state(spin * self.frequency) for spin in (-_SPIN_STEP, 0.0, _SPIN_STEP)]
        behind, rest, ahead = (self._flow.jacobian(state) for state in states)
        self._powers = (
            rest,
            (ahead - behind) / (2 * _SPIN_STEP),
            (ahead - 2 * rest + behind) / (2 * _SPIN_STEP**2),
        )
        still, moving = (self._flow.normals(state) for state in states[1:])
        self._normals = still, (moving - still) / _SPIN_STEP

    def state(self, spin: float) -> Array:
        """State of the stationary motion at a spin in rad/s, shape (12,)."""
        return self._flow.stationary(spin, self._place)

    def matrices(self, spins: Array, *, drift: bool = True) -> Array:
        """State matrices in 1/s at spins in rad/s, shape (n,), as `numeric_matrices` tells."""
        bases, neutral = self.bases(spins, drift=drift)
        spin = (spins / self.frequency)[:, None, None]
        constant, linear, square = self._powers
        jacobians = constant + spin * linear + spin**2 * square
        rows = np.linalg.pinv(bases)
        coupling = np.max(np.abs(rows @ jacobians @ neutral), axis=(1, 2))
        worst = float(np.max(coupling / np.max(np.abs(jacobians), axis=(1, 2))))
        if worst > 1e-6:
            raise ArithmeticError(
                f"a change of the spin or of the place of {self._scenario.name} is not neutral: "
                f"relative coupling {worst:.1e}"
            )
        return self.frequency * (rows @ jacobians @ bases)

    def bases(self, spins: Array, *, drift: bool = True) -> tuple[Array, Array]:
        """Bases of the tangent spaces without the neutral directions, and these.

        Returns
        -------
        bases : ndarray, shape (n, 12, k)
            In numbers of a state without units, smooth in the spin.
        neutral : ndarray, shape (12, j)
        """
        neutral = self._flow.neutral(self.state(0.0), drift=drift)
        still, linear = self._normals
        normals = still + (spins / self.frequency)[:, None, None] * linear
        columns = np.broadcast_to(neutral.T, (spins.size, *neutral.T.shape))
        rows = np.concatenate((normals, columns), axis=1)
        return tangent_bases(rows, dependent(np.concatenate((still, neutral.T)))), neutral

    def accelerations(self, spin: float) -> Array:
        """Accelerations at the stationary motion without units, shape (6,): zero if it is one."""
        return self._flow.accelerations(self.state(spin))
