"""Critical spins: where an eigenvalue crosses the imaginary axis, where a pair is born or dies.

They are bracketed on a grid of spins, between whose neighbours each eigenvalue goes to the nearest
one, and refined by root finding on the eigenvalues themselves. Two crossings within one step of
that grid (0.05 rad/s) that cancel out are missed.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.optimize import brentq, linear_sum_assignment

from analysis.data.checks import Array, number
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.linearisation import ROUND_OFF, ZERO, ComplexArray, spin_scale
from analysis.stability.spectra import (
    Matrices,
    System,
    chosen_system,
    helper_spins,
    matrices_over_spin,
)

Side = Literal["below", "above"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """A spin at which an eigenvalue or a pair crosses the imaginary axis.

    Parameters
    ----------
    spin : float
        Critical spinning speed in rad/s.
    frequency : float
        Imaginary part in rad/s; 0 for a static crossing.
    kind : {"hopf", "static"}
        A complex pair, or one real eigenvalue through zero.
    stable_side : {"below", "above"}
        Side on which this eigenvalue or pair is stable; others may be unstable there.
    """

    spin: float
    frequency: float
    kind: Literal["hopf", "static"]
    stable_side: Side


@dataclass(frozen=True, slots=True, kw_only=True)
class PairChange:
    """A spin at which two real eigenvalues collide and a complex pair is born or dies.

    Parameters
    ----------
    spin : float
        Spinning speed in rad/s.
    value : float
        The double real eigenvalue in 1/s.
    complex_side : {"below", "above"}
        Side on which the pair is complex: above if it is born with growing spin, below if it dies.
    """

    spin: float
    value: float
    complex_side: Side


@dataclass(frozen=True, slots=True, kw_only=True)
class CriticalSpeeds:
    """Critical spins of one system in an interval, each tuple by rising spin.

    Parameters
    ----------
    scenario : Scenario
    system : {"full", "reduced", "numeric"}
    motion : {"inverted", "noninverted"}
    interval : tuple of 2 floats
        Spins searched in rad/s.
    crossings : tuple of Crossing
    pair_changes : tuple of PairChange
    stable : tuple of tuples of 2 floats
        Intervals of the spin in rad/s in which every eigenvalue has a negative real part. The
        pair that only moves the disk on the table does not count; eigenvalues that are zero at
        every spin, as those of a round disk, do: with them the motion is not asymptotically
        stable.
    reason : str or None
        Why there is no crossing, if there is none.
    """

    scenario: Scenario
    system: System
    motion: Motion
    interval: tuple[float, float]
    crossings: tuple[Crossing, ...]
    pair_changes: tuple[PairChange, ...]
    stable: tuple[tuple[float, float], ...]
    reason: str | None = None

    @property
    def hopf(self) -> tuple[Crossing, ...]:
        """Crossings of complex pairs only."""
        return tuple(crossing for crossing in self.crossings if crossing.kind == "hopf")

    @property
    def where(self) -> str:
        """Spins in rad/s at which the motion is stable, in words."""
        return ", ".join(f"{low:.6g} to {high:.6g}" for low, high in self.stable) or "nowhere"


def spin_interval(interval: tuple[float, float]) -> tuple[float, float]:
    """Return lowest and highest spin in rad/s; `ValueError` if they are no interval."""
    ends = list(interval) if isinstance(interval, Iterable) else []
    if len(ends) != 2:
        raise ValueError(f"interval must be lowest and highest spin, got {interval!r}")
    low, high = (number("interval", end) for end in ends)
    if not 0.0 <= low < high:
        raise ValueError(f"interval must have 0 <= lowest < highest spin, got {low:g} to {high:g}")
    return low, high


def critical_speeds(
    scenario: Scenario,
    interval: tuple[float, float] = (0.0, 60.0),
    system: System | None = None,
    motion: Motion = "inverted",
) -> CriticalSpeeds:
    """Find the critical spins of a linear system, and where the motion is stable as a whole.

    Without friction there is no damping and no crossing: the eigenvalues lie mirrored at both
    axes. An eigenvalue that is zero at every spin, as for a round disk, does not count.

    Parameters
    ----------
    scenario, system, motion
        See `spectra.matrices_over_spin`.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s, not negative: the spectra are even in the spin.

    Raises
    ------
    ValueError
        If the interval is empty or not finite, the system or the motion is unknown, or the
        scenario none of this system.
    """
    low, high = spin_interval(interval)
    matrices = matrices_over_spin(scenario, system, motion)
    # Where all eigenvalues are zero, as those of a round disk that is held in all but its tilt,
    # what rounding makes of them is not to be judged against itself.
    spectra = Spectra(matrices, helper_spins(low, high), ZERO * spin_scale(scenario))
    crossings: tuple[Crossing, ...] = ()
    reason: str | None = "no friction: undamped, the eigenvalues lie mirrored at both axes"
    if scenario.rubs:
        crossings = spectra.crossings()
        nothing = f"no eigenvalue crosses the imaginary axis from {low:g} to {high:g} rad/s"
        reason = None if crossings else nothing
    ends = (low, *(each.spin for each in crossings), high)
    return CriticalSpeeds(
        scenario=scenario,
        system=chosen_system(scenario, system),
        motion=motion,
        interval=(low, high),
        crossings=crossings,
        pair_changes=spectra.pair_changes(),
        # Between neighbouring crossings nothing changes.
        stable=tuple(each for each in pairwise(ends) if spectra.decay(sum(each) / 2.0)),
        reason=reason,
    )


class Spectra:
    """Eigenvalues on a grid of spins, each with the nearest one at the next spin.

    Parameters
    ----------
    matrices : callable
        State matrices at any spins.
    spins : ndarray, shape (n,)
        A fine grid in rad/s.
    zero : float
        Size in 1/s below which eigenvalues are zero.
    """

    def __init__(self, matrices: Matrices, spins: Array, zero: float = 0.0) -> None:
        self._matrices = matrices
        values = np.linalg.eigvals(matrices(spins)).astype(complex)
        values[np.abs(values) < zero] = 0.0
        self._largest = float(np.max(np.abs(values)))
        none = np.abs(values) < ZERO * self._largest
        self._neutral = int(np.min(np.sum(none, axis=1)))
        # One that lies on the axis at a single spin crosses between the spins beside it.
        count = np.sum(self._signs(values) == 0.0, axis=1)
        alone = (count[1:-1] > count[:-2]) & (count[1:-1] > count[2:])
        kept = np.concatenate(((True,), ~alone, (True,)))
        self._spins, self._values = spins[kept].tolist(), values[kept]
        self._after = _nearest(self._values)

    def _signs(self, values: ComplexArray) -> Array:
        """Signs of the real parts, 0 where rounding hides them."""
        clear = np.abs(values.real) > ROUND_OFF * self._largest
        result: Array = np.sign(values.real) * clear
        return result

    def _at(self, spin: float) -> ComplexArray:
        return np.linalg.eigvals(self._matrices(np.array([spin]))[0]).astype(complex)

    def decay(self, spin: float) -> bool:
        """Whether every eigenvalue has a negative real part."""
        values = self._at(spin)
        return bool(np.max(values.real) + ROUND_OFF * np.max(np.abs(values)) < 0.0)

    def crossings(self) -> tuple[Crossing, ...]:
        """Crossings of the imaginary axis, by rising spin."""
        before, after = self._values[:-1], self._after
        found = []
        for step, place in np.argwhere(self._signs(before) * self._signs(after) < 0.0).tolist():
            ends = self._spins[step], self._spins[step + 1]
            around = complex(before[step, place]), complex(after[step, place])
            frequencies = [each.imag for each in around]
            if min(frequencies) > ZERO * self._largest or not any(frequencies):
                found.append(self._crossing(ends, around))
        return tuple(sorted(found, key=lambda each: each.spin))

    def _crossing(self, ends: tuple[float, float], around: tuple[complex, complex]) -> Crossing:
        """The crossing of the eigenvalue that is `around` at the ends of a step."""

        def eigenvalue(spin: float) -> complex:
            values = self._at(spin)
            return complex(values[np.argmin(np.abs(values - _between(ends, around, spin)))])

        def product(spin: float) -> float:
            # The lowest coefficient of the characteristic polynomial that does not vanish.
            values = self._at(spin)
            return float(np.poly(values)[values.size - self._neutral].real)

        side: Side = "above" if around[1].real < 0.0 else "below"
        if not around[0].imag:
            spin = _root(product, *ends)
            return Crossing(spin=spin, frequency=0.0, kind="static", stable_side=side)
        spin = _root(lambda spin: eigenvalue(spin).real, *ends)
        frequency = eigenvalue(spin).imag
        return Crossing(spin=spin, frequency=frequency, kind="hopf", stable_side=side)

    def pair_changes(self) -> tuple[PairChange, ...]:
        """Collisions of two real eigenvalues, by rising spin."""
        before, after = self._values[:-1], self._after
        # Of a pair the upper one, and what is real on the other side.
        changes = (before.imag > 0.0) & (after.imag == 0.0) | (
            (before.imag == 0.0) & (after.imag > 0.0)
        )
        found = []
        for step, place in np.argwhere(changes).tolist():
            sides = before[step], after[step]
            inside = int(sides[1][place].imag > 0.0)
            partner = int(np.argmin(np.abs(sides[inside] - np.conj(sides[inside][place]))))
            pairs = np.array(sides)[:, [place, partner]]
            # A double zero that round-off splits into a pair is none.
            if np.max(np.abs(pairs[:, 0] - pairs[:, 1])) > ZERO * self._largest:
                ends = self._spins[step], self._spins[step + 1]
                low, high = pairs.mean(axis=1).real.tolist()
                found.append(self._pair_change(ends, (low, high), ("below", "above")[inside]))
        return tuple(sorted(found, key=lambda each: each.spin))

    def _pair_change(
        self, ends: tuple[float, float], centres: tuple[float, float], side: Side
    ) -> PairChange:
        """A collision; the squared difference of the two eigenvalues passes zero smoothly."""

        def pair(spin: float) -> ComplexArray:
            values = self._at(spin)
            moving = values[np.argsort(np.abs(values))[self._neutral :]]
            nearest = np.argsort(np.abs(moving - _between(ends, centres, spin)))[:2]
            return moving[nearest]

        spin = _root(lambda spin: float((np.diff(pair(spin))[0] ** 2).real), *ends)
        return PairChange(spin=spin, value=float(pair(spin).mean().real), complex_side=side)


def _nearest(values: ComplexArray) -> ComplexArray:
    """Next value of each, shape (n - 1, k): the nearest one, and no two the same."""
    # Roots of distances, so that one stays where it is rather than two of them move.
    cost = np.sqrt(np.abs(values[:-1, :, None] - values[1:, None, :]))
    order = np.argmin(cost, axis=2)
    taken_twice = np.any(np.diff(np.sort(order, axis=1), axis=1) == 0, axis=1)
    for step in np.flatnonzero(taken_twice).tolist():
        order[step] = linear_sum_assignment(cost[step])[1]
    return np.take_along_axis(values[1:], order, axis=1)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root between two spins; an end if round-off hides the change of sign there."""
    at_low, at_high = function(low), function(high)
    if at_low * at_high >= 0.0:
        return low if abs(at_low) < abs(at_high) else high
    return float(brentq(function, low, high, xtol=1e-13, rtol=1e-14, maxiter=200))


def _between(ends: tuple[float, float], values: tuple[complex, complex], spin: float) -> complex:
    part = (spin - ends[0]) / (ends[1] - ends[0])
    return (1.0 - part) * values[0] + part * values[1]
