"""Critical spins: where an eigenvalue crosses the imaginary axis, where a pair is born or dies.

Candidates are bracketed on a grid of spins and refined by root finding on the eigenvalues
themselves. Two crossings of the same branch within one step of that grid (0.05 rad/s) would
cancel out and be missed.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from analysis.data.checks import number
from analysis.data.scenario import Scenario
from analysis.data.start import Motion
from analysis.stability.linearisation import ROUND_OFF, ZERO, ComplexArray, spin_scale
from analysis.stability.spectra import (
    Branches,
    System,
    branches,
    chosen_system,
    helper_spins,
    matrices_over_spin,
)

Side = Literal["below", "above"]
Spectrum = Callable[[float], ComplexArray]


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
    reason : str or None
        Why there is no crossing, if there is none.
    """

    scenario: Scenario
    system: System
    motion: Motion
    interval: tuple[float, float]
    crossings: tuple[Crossing, ...]
    pair_changes: tuple[PairChange, ...]
    reason: str | None = None

    @property
    def hopf(self) -> tuple[Crossing, ...]:
        """Crossings of complex pairs only."""
        return tuple(crossing for crossing in self.crossings if crossing.kind == "hopf")


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
    """Find the critical spins of a linear system.

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
    spectrum = _spectrum(scenario, system, motion)
    followed = branches(scenario, helper_spins(low, high), system, motion)
    values = np.delete(followed.values, followed.drift, axis=1)
    # Where all eigenvalues are zero, as those of a round disk that is held in all but its tilt,
    # what rounding makes of them is not to be judged against itself.
    values[np.abs(values) < ZERO * spin_scale(scenario)] = 0.0
    relevant = Branches(spins=followed.spins, values=values)

    crossings: list[Crossing] = []
    reason: str | None = "no friction: undamped, the eigenvalues lie mirrored at both axes"
    if scenario.rubs:
        crossings = all_crossings(relevant, spectrum)
        nothing = f"no eigenvalue crosses the imaginary axis from {low:g} to {high:g} rad/s"
        reason = None if crossings else nothing
    return CriticalSpeeds(
        scenario=scenario,
        system=chosen_system(scenario, system),
        motion=motion,
        interval=(low, high),
        crossings=tuple(sorted(crossings, key=_spin)),
        pair_changes=tuple(sorted(_pair_changes(relevant, spectrum), key=_spin)),
        reason=reason,
    )


def _spectrum(scenario: Scenario, system: System | None, motion: Motion) -> Spectrum:
    matrices = matrices_over_spin(scenario, system, motion)

    def eigenvalues(spin: float) -> ComplexArray:
        return np.linalg.eigvals(matrices(np.array([spin]))[0]).astype(complex)

    return eigenvalues


def _spin(event: Crossing | PairChange) -> float:
    return event.spin


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root between two spins; an end if round-off hides the change of sign there."""
    at_low, at_high = function(low), function(high)
    if at_low * at_high >= 0.0:
        return low if abs(at_low) < abs(at_high) else high
    return float(brentq(function, low, high, xtol=1e-13, rtol=1e-14, maxiter=200))


def all_crossings(followed: Branches, spectrum: Spectrum) -> list[Crossing]:
    """Crossings of the imaginary axis: changes of sign of the real part along a branch.

    Parameters
    ----------
    followed : Branches
        Eigenvalue branches on a fine grid of spins.
    spectrum : callable
        Eigenvalues at any spin between, shape (k,).
    """
    largest = np.max(np.abs(followed.values))
    spins = followed.spins.tolist()
    result = []
    for branch in followed.values.T:
        clear = np.nonzero(np.abs(branch.real) > ROUND_OFF * largest)[0].tolist()
        for start, end in pairwise(clear):
            ends, around = (
                (spins[start], spins[end]),
                (complex(branch[start]), complex(branch[end])),
            )
            if around[0].real * around[1].real < 0.0:
                frequencies = branch.imag[start : end + 1]
                if np.all(frequencies > ZERO * largest):
                    result.append(_hopf_crossing(ends, around, spectrum))
                elif np.all(frequencies == 0.0):
                    result.append(_static_crossing(ends, around, spectrum, _neutral(followed)))
    return result


def _hopf_crossing(
    ends: tuple[float, float], around: tuple[complex, complex], spectrum: Spectrum
) -> Crossing:
    """Refine the crossing of the eigenvalue that is `around` at the `ends` of a short bracket."""

    def eigenvalue(spin: float) -> complex:
        found = spectrum(spin)
        return complex(found[np.argmin(np.abs(found - _between(ends, around, spin)))])

    spin = _root(lambda spin: eigenvalue(spin).real, *ends)
    return Crossing(
        spin=spin, frequency=eigenvalue(spin).imag, kind="hopf", stable_side=_stable_side(around)
    )


def _static_crossing(
    ends: tuple[float, float],
    around: tuple[complex, complex],
    spectrum: Spectrum,
    neutral: int,
) -> Crossing:
    """Refine the crossing of a real eigenvalue, beside `neutral` ones that are always zero.

    The lowest coefficient of the characteristic polynomial that does not vanish, the product of
    the other eigenvalues, changes sign with it.
    """

    def coefficient(spin: float) -> float:
        found = spectrum(spin)
        return float(np.poly(found)[found.size - neutral].real)

    spin = _root(coefficient, *ends)
    return Crossing(spin=spin, frequency=0.0, kind="static", stable_side=_stable_side(around))


def _stable_side(around: tuple[complex, complex]) -> Side:
    return "above" if around[1].real < 0.0 else "below"


def _between(ends: tuple[float, float], values: tuple[complex, complex], spin: float) -> complex:
    part = (spin - ends[0]) / (ends[1] - ends[0])
    return (1.0 - part) * values[0] + part * values[1]


def _neutral(followed: Branches) -> int:
    """Number of eigenvalues that are zero at every spin."""
    size = np.abs(followed.values)
    return int(np.min(np.sum(size < ZERO * np.max(size), axis=1)))


def _pair_changes(followed: Branches, spectrum: Spectrum) -> list[PairChange]:
    """Collisions of two real eigenvalues: changes between real and complex along a branch."""
    values, spins = followed.values, followed.spins.tolist()
    largest, neutral = np.max(np.abs(values)), _neutral(followed)

    def moving(spin: float) -> ComplexArray:
        found = spectrum(spin)
        return found[np.argsort(np.abs(found))[neutral:]]

    result = []
    for column, branch in enumerate(values.T):
        is_complex = branch.imag > 0.0
        changes: list[int] = np.nonzero(np.diff(is_complex))[0].tolist()
        for start in changes:
            inside = start if is_complex[start] else start + 1
            partner = int(np.argmin(np.abs(values[inside] - np.conj(branch[inside]))))
            pairs = values[start : start + 2, [column, partner]]
            # A double zero that round-off splits into a pair is none.
            if np.max(np.abs(pairs[:, 0] - pairs[:, 1])) > ZERO * largest:
                centres = pairs.mean(axis=1).real.tolist()
                ends = (spins[start], spins[start + 1])
                side: Side = "below" if is_complex[start] else "above"
                result.append(_pair_change(ends, (centres[0], centres[1]), side, moving))
    return result


def _pair_change(
    ends: tuple[float, float], centres: tuple[float, float], side: Side, spectrum: Spectrum
) -> PairChange:
    """Refine a collision; the squared difference of the two eigenvalues passes zero smoothly."""

    def pair(spin: float) -> ComplexArray:
        found = spectrum(spin)
        nearest = np.argsort(np.abs(found - _between(ends, centres, spin)))[:2]
        return found[nearest]

    def squared_difference(spin: float) -> float:
        one, other = pair(spin)
        return float(((one - other) ** 2).real)

    spin = _root(squared_difference, *ends)
    return PairChange(spin=spin, value=float(pair(spin).mean().real), complex_side=side)
