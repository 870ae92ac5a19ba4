"""Any set of constraints linearised numerically about spinning, along its constraint manifold.

Independent of the matrices of `linear_full` and `linear_reduced`: the nonlinear index-1 system
x' = F(x), x = (z, u), is differenced along the tangent space T of the states that meet every
constraint on position and velocity level. Its Jacobian J maps T into itself; with Q an
orthonormal basis of T, the state matrix is Q^T J Q.

Some directions of T are neutral. They, too, are mapped into themselves (which is checked), so
that leaving them out of Q leaves the other eigenvalues as they are:

- alpha: the disk may stand on the table in any direction;
- its rate, unless the spin is held: the neighbouring stationary motion, an eigenvalue of zero;
- the drift, unless the centre of gravity is held: spinning elsewhere on the table, which circles
  in the turning R-frame and has the eigenvalues +-i spin.

With alpha and its rate left out, Models 1 to 4 have the 8 eigenvalues of Eq. (55), 4, and twice
the 3 of Eq. (111).

The equations of motion are quadratic in the rates, but for friction, whose law is one of the slip
and at no slip linear in it. J is therefore a polynomial of degree 2 in the spin, taken from three
spins. All lengths count in radii and all times in sqrt(r / g).
"""

from collections.abc import Callable
from itertools import pairwise
from math import pi

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, choice
from analysis.data.constraint_set import ConstraintSet
from analysis.data.scenario import Scenario
from analysis.data.start import MOTIONS, Motion
from analysis.models import constraints, index1
from analysis.stability.linear_full import spin_array
from analysis.stability.scope import require_spinning, spin_scale

_HALVINGS = 6
_LARGEST_STEP = 0.02
_LARGEST_SLIP = 0.1
_SMALLEST_STEP = 1e-8
"""Rounding takes more than the sixth digit of derivatives by smaller steps."""

_SPIN_STEP = 2.0
"""Spin at which J is differenced, beside 0 and its negative; all three without units."""

_SPEED_UNITS = np.array((0.0, 0.0, 0.0, 1.0, 0.0, 0.0))
_ALPHA, _ALPHA_RATE = np.eye(12)[3], np.eye(12)[9]


def numeric_matrices(
    scenario: Scenario,
    spins: npt.ArrayLike,
    motion: Motion = "inverted",
    *,
    drift: bool = True,
) -> Array:
    """State matrices of a scenario linearised numerically, shape (n, k, k).

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
        If a spin is not finite, there is none, the motion is unknown, the table leans, the contact
        is compliant or friction bends over too little slip to be differenced.
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


class UnitlessFlow:
    """The index-1 system of a scenario as x' = F(x), lengths in radii, times in sqrt(r / g).

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
        radius = scenario.disk.radius
        self.units = np.array((radius, radius, radius, 1.0, 1.0, 1.0))
        self._solve = index1.solver(scenario)

    def rates(self, state: Array) -> Array:
        """Time derivative F of a state, shape (12,), from the index-1 system."""
        z, u = self._with_units(state)
        acceleration = self._solve(*z, *u)[:6]
        return np.concatenate((state[6:], acceleration / (self.units * self.frequency**2)))

    def residuals(self, state: Array) -> Array:
        """Residuals of the constraints on position and on velocity level."""
        z, u = self._with_units(state)
        held, disk = self.scenario.constraints, self.scenario.disk
        speeds = constraints.directions(held, disk, z) @ u
        return np.concatenate((constraints.positions(held, disk, z), speeds / self.frequency))

    def _with_units(self, state: Array) -> tuple[list[float], list[float]]:
        rates = state[6:] * self.units * self.frequency
        return (state[:6] * self.units).tolist(), rates.tolist()


def neutral_directions(held: ConstraintSet, spins: Array, *, drift: bool) -> Array:
    """Directions in which the states of a stationary motion are neighbours, shape (n, 12, j).

    Parameters
    ----------
    held : tuple of str
    spins : ndarray, shape (n,)
        Without units.
    drift : bool
        Whether the place on the table is left out of them.
    """
    directions = [_ALPHA] if "constant-spin" in held else [_ALPHA, _ALPHA_RATE]
    neutral = np.repeat(np.column_stack(directions)[None], spins.size, axis=0)
    if not drift and has_drift(held):
        # A place at rest moves in the R-frame with x' = spin y, y' = -spin x.
        circling = np.zeros((spins.size, 12, 2))
        circling[:, 0, 0] = circling[:, 1, 1] = 1.0
        circling[:, 7, 0], circling[:, 6, 1] = -spins, spins
        neutral = np.concatenate((neutral, circling), axis=2)
    return neutral


def complement(normals: Array, neutral: Array) -> Array:
    """Orthonormal bases of what is normal to rows and columns, shape (n, 12, k)."""
    every = np.concatenate((normals, np.swapaxes(neutral, 1, 2)), axis=1)
    right = np.linalg.svd(every)[2]
    return np.swapaxes(right[:, every.shape[1] :], 1, 2)


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
        self._flow = UnitlessFlow(scenario)
        self._scenario = scenario
        radius = scenario.disk.radius
        self.frequency = self._flow.frequency
        """Unit sqrt(g / r) of the spin in rad/s."""
        self._place = np.array((0.0, 0.0, 1.0, 0.0, pi / 2, gamma))
        if not has_drift(scenario.constraints):
            # The centre of gravity is held above the origin; see `constraints.positions`.
            self._place[:2] -= (
                constraints.positions(
                    scenario.constraints, scenario.disk, self._place * self._flow.units
                )[1:]
                / radius
            )
        behind, rest, ahead = (
            self._jacobian(self._flow.rates, spin) for spin in (-_SPIN_STEP, 0.0, _SPIN_STEP)
        )
        self._powers = (
            rest,
            (ahead - behind) / (2 * _SPIN_STEP),
            (ahead - 2 * rest + behind) / (2 * _SPIN_STEP**2),
        )
        still = self._jacobian(self._flow.residuals, 0.0)
        self._normals = (
            still,
            (self._jacobian(self._flow.residuals, _SPIN_STEP) - still) / _SPIN_STEP,
        )

    def matrices(self, spins: Array, *, drift: bool = True) -> Array:
        """State matrices in 1/s at spins in rad/s, shape (n,), as `numeric_matrices` tells."""
        bases, neutral = self.bases(spins, drift=drift)
        spin = (spins / self.frequency)[:, None, None]
        constant, linear, square = self._powers
        jacobians = constant + spin * linear + spin**2 * square
        rows = np.swapaxes(bases, 1, 2)
        coupling = np.max(np.abs(rows @ jacobians @ neutral), axis=(1, 2))
        worst = float(np.max(coupling / np.max(np.abs(jacobians), axis=(1, 2))))
        if worst > 1e-6:
            raise ArithmeticError(
                f"a change of the spin or of the place of {self._scenario.name} is not neutral: "
                f"relative coupling {worst:.1e}"
            )
        return self.frequency * (rows @ jacobians @ bases)

    def bases(self, spins: Array, *, drift: bool = True) -> tuple[Array, Array]:
        """Orthonormal bases of the tangent spaces without the neutral directions, and these.

        The bases change smoothly with the spin: each is the nearest one to that at spin 0.

        Returns
        -------
        bases : ndarray, shape (n, 12, k)
            In coordinates and rates without units.
        neutral : ndarray, shape (n, 12, j)
        """
        start, _ = self._complement(np.zeros(1), drift=drift)
        complements, neutral = self._complement(spins / self.frequency, drift=drift)
        left, _, right = np.linalg.svd(
            complements @ (np.swapaxes(complements, 1, 2) @ start), full_matrices=False
        )
        return left @ right, neutral

    def _complement(self, spins: Array, *, drift: bool) -> tuple[Array, Array]:
        """Some orthonormal bases of the same spaces, from spins without units."""
        neutral = neutral_directions(self._scenario.constraints, spins, drift=drift)
        still, linear = self._normals
        return complement(still + spins[:, None, None] * linear, neutral), neutral

    def accelerations(self, spin: float) -> Array:
        """Accelerations at the stationary motion without units, shape (6,): zero if it is one."""
        state = np.concatenate((self._place, spin / self.frequency * _SPEED_UNITS))
        return self._flow.rates(state)[6:]

    def _jacobian(self, function: Callable[[Array], Array], spin: float) -> Array:
        """Jacobian at the stationary motion with a spin without units, shape (n, 12)."""
        place = np.concatenate((self._place, spin * _SPEED_UNITS))
        columns = []
        for index in range(12):
            step = np.zeros(12)
            step[index] = self._first_step(1.0 if index >= 6 else abs(spin))
            columns.append(slope(function, place, step) / step[index])
        return np.column_stack(columns)

    def _first_step(self, speed: float) -> float:
        """Step that slips by a tenth of the law's finest speed at most, at a speed of the rim."""
        unit = self._scenario.disk.radius * self.frequency
        by_slip = _LARGEST_SLIP * self._scenario.friction.finest_speed / unit
        step = min(_LARGEST_STEP, by_slip / max(2 * speed, 1e-9))
        if step < _SMALLEST_STEP:
            raise ValueError(
                "friction must have a finest_speed of at least "
                f"{_SMALLEST_STEP / step * self._scenario.friction.finest_speed:.1g} m/s to be "
                f"differenced, got {self._scenario.friction.finest_speed:g}"
            )
        return step


def slope(function: Callable[[Array], Array], place: Array, step: Array) -> Array:
    """Derivative of a function along `step`, by differences over parts of it.

    The friction law has a kink in its second derivative at zero slip, so central differences err
    in all powers of the step, not only in the even ones; extrapolating to step 0 with a
    polynomial in the step takes them away.
    """
    values: list[Array] = []
    for part in 0.5 ** np.arange(_HALVINGS):
        ahead, behind = function(place + part * step), function(place - part * step)
        values.append((ahead - behind) / (2 * part))
    for order in range(1, _HALVINGS):
        factor = 2.0**order
        values = [(factor * fine - rough) / (factor - 1.0) for rough, fine in pairwise(values)]
    return values[0]
