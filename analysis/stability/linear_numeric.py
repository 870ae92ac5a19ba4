"""Any set of constraints linearised about spinning, along its constraint manifold.

Independent of the matrices of `linear_full` and `linear_reduced`: the nonlinear index-1 system
s' = F(s) in the states of `mechanics.states` is differentiated by dual numbers along the tangent
space T of the states that meet every constraint on position and velocity level. Its Jacobian J
maps T into itself, so that it is told by the numbers of a state that are free in T.

Some directions of T are neutral. They, too, are mapped into themselves (which is checked), so
that leaving them out leaves the other eigenvalues as they are:

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

    def neutral(self, *, drift: bool) -> list[int]:
        """Numbers of a state by which a stationary one has neighbours.

        A free spin is that about the centre of gravity: no other motion is stationary.

        Parameters
        ----------
        drift : bool
            Whether the place on the table is left out of them.
        """
        held = self.scenario.constraints
        free_spin = [] if "constant-spin" in held else [9]
        place = [] if drift or not has_drift(held) else [0, 1]
        return [3, *free_spin, *place]


class Tangents:
    """How states may deviate that meet every constraint, the neutral numbers left out.

    Parameters
    ----------
    normals : ndarray, shape (m, 12)
        Of the constraints in one state.
    neutral : list of ints
        Numbers of a state that do not deviate.
    """

    def __init__(self, normals: Array, neutral: list[int]) -> None:
        others = np.setdiff1d(np.arange(12), neutral)
        best = qr(normals[:, others], mode="r", pivoting=True)[1]
        self._solved = others[best[: len(normals)]]
        self._neutral, self.free = neutral, others[np.sort(best[len(normals) :])]

    def bases(self, normals: Array) -> Array:
        """Deviations of all numbers by each free one, shape (n, 12, k), from (n, m, 12)."""
        result = np.zeros((len(normals), 12, self.free.size))
        result[:, self.free] = np.eye(self.free.size)
        found = np.linalg.solve(normals[:, :, self._solved], normals[:, :, self.free])
        result[:, self._solved] = -found
        return result

    def matrices(self, jacobians: Array, normals: Array) -> tuple[Array, float]:
        """State matrices, shape (n, k, k), and what the neutral numbers do in them at most.

        The flow maps what is tangent to the constraints into the same, so that the free numbers
        tell the others.
        """
        rows = jacobians[:, self.free]
        coupling = np.max(np.abs(rows[:, :, self._neutral]), axis=(1, 2))
        worst = float(np.max(coupling / np.max(np.abs(jacobians), axis=(1, 2))))
        return rows @ self.bases(normals), worst


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
        spin = (spins / self.frequency)[:, None, None]
        constant, linear, square = self._powers
        jacobians = constant + spin * linear + spin**2 * square
        found, worst = self._tangents(drift=drift).matrices(jacobians, self._normals_at(spins))
        if worst > 1e-6:
            raise ArithmeticError(
                f"a change of the spin or of the place of {self._scenario.name} is not neutral: "
                f"relative coupling {worst:.1e}"
            )
        return self.frequency * found

    def bases(self, spins: Array, *, drift: bool = True) -> Array:
        """Deviations of a state without units by each free number, shape (n, 12, k)."""
        return self._tangents(drift=drift).bases(self._normals_at(spins))

    def _tangents(self, *, drift: bool) -> Tangents:
        return Tangents(self._normals[0], self._flow.neutral(drift=drift))

    def _normals_at(self, spins: Array) -> Array:
        still, linear = self._normals
        return still + (spins / self.frequency)[:, None, None] * linear

    def accelerations(self, spin: float) -> Array:
        """Accelerations at the stationary motion without units, shape (6,): zero if it is one."""
        return self._flow.accelerations(self.state(spin))
