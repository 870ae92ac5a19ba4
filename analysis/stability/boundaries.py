"""Boundaries of stability of the full system over spin and friction gradient, and where they meet.

Hopf points are followed along curves by pseudo-arclength, from the crossings of pairs at some
gradients. On the other kind of boundary, known in closed form, a real eigenvalue is zero; see
`static_gradient`. A Hopf curve starts on it where the frequency comes to zero, or crosses it; and
Hopf curves cross each other.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import root

from analysis.mechanics.paper import paper_numbers, printed_matrices
from analysis.problem.checks import Array, positive
from analysis.problem.scenario import Scenario
from analysis.problem.start import Motion
from analysis.solve.continuation import Curve
from analysis.stability.chart import gradient_array
from analysis.stability.critical import Spectra, spin_interval
from analysis.stability.linearisation import ZERO, falling, require_spinning, spin_scale
from analysis.stability.spectra import full_matrices

SPINS = (0.0, 100.0)
"""Lowest and highest spin in rad/s by default."""

_GRID = 1001
"""Spins between which crossings are looked for."""

_STEP = 0.1
"""Longest step along a curve, and how near to its points a Hopf point lies that is on it."""

_MET = 1e-9
"""Largest residual at a corner."""

_NO_FREQUENCY = 1e-30
"""In place of none, to divide by."""

Kind = Literal["double zero", "zero hopf", "double hopf"]


class HopfCurve(NamedTuple):
    """Hopf points of the full system along a curve; where the gradient turns back, it folds.

    Parameters
    ----------
    spins : ndarray, shape (n,)
        Spinning speeds in rad/s.
    gradients : ndarray, shape (n,)
        Friction gradients mu / epsilon in s/m.
    frequencies : ndarray, shape (n,)
        Imaginary part of the crossing pair in rad/s.
    """

    spins: Array
    gradients: Array
    frequencies: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """A point at which two stability boundaries of the full system meet.

    Parameters
    ----------
    kind : {"double zero", "zero hopf", "double hopf"}
        A Hopf curve starts on the static curve, or crosses it; or two Hopf curves cross.
    spin : float
        Spinning speed in rad/s.
    gradient : float
        Friction gradient mu / epsilon in s/m.
    frequencies : tuple of float
        Imaginary parts of the critical pairs in rad/s.
    """

    kind: Kind
    spin: float
    gradient: float
    frequencies: tuple[float, ...]


def hopf_curves(
    scenario: Scenario,
    gradients: npt.ArrayLike,
    spins: tuple[float, float] = SPINS,
    motion: Motion = "inverted",
) -> tuple[HopfCurve, ...]:
    """Hopf points of the full system over spin and friction gradient.

    Each curve is followed both ways from a Hopf point at one of the gradients, through folds,
    until it leaves the spins or the gradients or its frequency comes to zero. Those that none of
    the gradients meets are missed, and so are two that cancel out within a thousandth of the
    spins.

    Parameters
    ----------
    scenario : Scenario
        Of Model 1, on a horizontal table; its friction is not looked at.
    gradients : array_like, shape (n,)
        Friction gradients mu / epsilon in s/m, positive, two or more.
    spins : tuple of 2 floats
        Lowest and highest spin in rad/s.
    motion : {"inverted", "noninverted"}

    Returns
    -------
    tuple of HopfCurve
        By rising frequency at their ends; each with rising frequency where it was begun.

    Raises
    ------
    ValueError
        If an argument is out of range, the motion is unknown or the scenario another one.
    ArithmeticError
        If a curve is lost; the message names the last good point.
    """
    unit, lines = spin_scale(scenario), _Pairs(scenario, motion).lines(gradients, spins)
    return tuple(
        HopfCurve(unit * spin, np.exp(log), unit * frequency)
        for spin, log, frequency in map(np.transpose, lines)
    )


def corners(
    scenario: Scenario,
    gradients: npt.ArrayLike,
    spins: tuple[float, float] = SPINS,
    motion: Motion = "inverted",
) -> tuple[Corner, ...]:
    """Where stability boundaries of the full system meet, by rising gradient.

    Parameters
    ----------
    scenario, gradients, spins, motion
        See `hopf_curves`, on whose curves all corners lie.

    Raises
    ------
    ValueError
        See `hopf_curves`.
    ArithmeticError
        See `hopf_curves`, or if the place where two boundaries meet cannot be refined.
    """
    pairs, found = _Pairs(scenario, motion), list[Corner]()
    for line in pairs.lines(gradients, spins):
        found += [pairs.corner("double zero", place) for place in line[line[:, 2] <= ZERO]]
        found += pairs.corners_along(line[line[:, 2] > ZERO])
    return tuple(sorted(found, key=lambda corner: corner.gradient))


class _Pairs:
    """Pairs of eigenvalues of a motion, at places of three numbers.

    They are the spin over `spin_scale`, the logarithm of the gradient in s/m, and the frequency
    over `spin_scale`.
    """

    def __init__(self, scenario: Scenario, motion: Motion) -> None:
        require_spinning(scenario, "the full system", 1)
        self._unit = spin_scale(scenario)
        self._matrices = partial(full_matrices, scenario, motion=motion)
        numbers, disk = paper_numbers(scenario, motion), scenario.disk
        m, r = disk.mass, disk.radius
        units = {"m": m, "r": r, "e": r, **dict.fromkeys("ABC", m * r * r), "mg": scenario.weight}
        whole = {name: numbers[name] / unit for name, unit in units.items()}
        self._printed = printed_matrices(whole).values()
        self._soft = 1.0 / (r * self._unit)

    def matrices(self, places: Array) -> Array:
        """State matrices over `spin_scale`, shape (n, k, k), at n places."""
        spins, gradients = self._unit * places[:, 0], np.exp(places[:, 1])
        return self._matrices(spins, gradient=gradients) / self._unit

    def lines(self, gradients: npt.ArrayLike, spins: tuple[float, float]) -> list[Array]:
        """Hopf curves, each shape (n, 3), of the arguments of `hopf_curves`."""
        wanted = gradient_array(gradients)
        least, largest = positive("gradients", float(np.min(wanted))), float(np.max(wanted))
        if least == largest:
            raise ValueError(
                f"gradients must be two or more to follow curves in, got {gradients!r}"
            )
        grid = np.linspace(*spin_interval(spins, "spins"), _GRID)
        low, high = grid[[0, -1]] / self._unit
        bounds = np.array((low, np.log(least), 0.0)), np.array((high, np.log(largest), np.inf))
        curve, found = Curve(self._on_axis, bounds, _STEP, self._where), list[Array]()
        for gradient in wanted.tolist():
            matrices = partial(self._matrices, gradient=gradient)
            for each in Spectra(matrices, grid, self._unit).crossings():
                spin, frequency = each.spin / self._unit, each.frequency / self._unit
                begin = np.array((spin, np.log(gradient), frequency))
                apart = (np.min(np.linalg.norm(line - begin, axis=1)) for line in found)
                if each.kind == "hopf" and all(distance > _STEP for distance in apart):
                    found.append(np.array(curve.through(begin)))
        return sorted(found, key=lambda line: float(line[-1, 2]))

    def _where(self, place: Array) -> str:
        spin, gradient = self._unit * place[0], np.exp(place[1])
        return f"near {spin:.6g} rad/s with a friction gradient of {gradient:.6g} s/m"

    def _on_axis(self, places: Array) -> Array:
        """What is zero at Hopf points, shape (n, 2): of det(lambda - A) at lambda = i frequency.

        Its real part, and its imaginary part over the frequency, are smooth, also where the pair
        comes together in zero. The force of friction is an unknown of its own, so that what steep
        friction leaves of damping is no difference of large numbers.
        """
        # The slip is D_C times the velocities and B_C times the turned places; in radii, these.
        M, G_h, K_h, K_f, D_C, B_C = self._printed
        spin, soft = places[:, :1, None], self._soft * np.exp(-places[:, 1])
        frequency = np.where(places[:, 2] == 0.0, _NO_FREQUENCY, places[:, 2])
        each = 1j * frequency[:, None, None]
        whole = np.zeros((len(places), 6, 6), dtype=complex)
        whole[:, :4, :4] = spin**2 * K_h + K_f + each * (spin * G_h + each * M)
        whole[:, :4, 4:] = -D_C[:, :2]
        whole[:, 4:, :4] = each * D_C[:2] + spin * B_C[:2]
        whole[:, 4:, 4:] = soft[:, None, None] * np.eye(2)
        # Velocities of G in place of its places, which leaves the drift out.
        whole[:, :4, :2] = M[:, :2] @ (each * np.eye(2) + spin * B_C[:2, :2])
        whole[:, 4:, :2] = np.eye(2)
        found = np.linalg.det(whole)
        return np.column_stack((found.real, found.imag / frequency / soft))

    def corners_along(self, line: Array) -> Iterator[Corner]:
        """Corners along a Hopf curve at which a real eigenvalue or a faster pair crosses."""
        values, squared = np.linalg.eigvals(self.matrices(line)), line[:, 2:] ** 2
        order = np.argsort(np.abs(values**2 + squared), axis=1)
        others = falling(np.take_along_axis(values, order[:, 2:], axis=1))
        crossed = np.argwhere(others[:-1].real * others[1:].real < 0.0)
        for step, place in crossed.tolist():
            before, after = others[step : step + 2, place].tolist()
            part = before.real / (before.real - after.real)
            begin = line[step] + part * (line[step + 1] - line[step])
            if not (before.imag and after.imag):
                yield self._refined("zero hopf", begin)
            elif before.imag > begin[2]:
                yield self._refined("double hopf", np.append(begin, before.imag))

    def _refined(self, kind: Kind, begin: Array) -> Corner:
        """Corner near a place, which has a second frequency if two pairs cross."""
        # All but the eigenvalue that crosses, if a real one does.
        scale = np.prod(np.sort(np.abs(np.linalg.eigvals(self.matrices(begin[None])[0])))[1:])

        def equations(place: Array) -> Array:
            pairs = self._on_axis(np.array([[*place[:2], each] for each in place[2:]]))
            if kind == "double hopf":
                return pairs.ravel()
            return np.append(pairs, np.linalg.det(self.matrices(place[None])) / scale)

        found = root(equations, begin, tol=1e-13)
        # It may end where rounding lets it get no nearer.
        if not np.max(np.abs(found.fun)) < _MET:
            raise ArithmeticError(f"no {kind} found {self._where(begin)}: {found.message}")
        return self.corner(kind, found.x)

    def corner(self, kind: Kind, place: Array) -> Corner:
        """Corner at a place, which has a second frequency if two pairs lie on the axis."""
        return Corner(
            kind=kind,
            spin=float(self._unit * place[0]),
            gradient=float(np.exp(place[1])),
            frequencies=tuple(sorted((self._unit * np.abs(place[2:])).tolist())),
        )
