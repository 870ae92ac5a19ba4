"""Critical spins: where an eigenvalue crosses the imaginary axis, where a pair is born or dies.

The real parts of the eigenvalues by falling size are continuous functions of the spin, whichever
eigenvalue they belong to: where one changes its sign on a grid of spins, root finding on it tells
the crossing. Between its spins they are looked at where they turn towards zero. Where they turn
twice within a step (of at most 0.05 rad/s and sqrt(g / r) / 300, up to 20,000 of them), what
crosses may be missed.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import isclose
from typing import Literal

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from analysis.problem.checks import Array, numbers, turn_rate
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.problem.start import Motion
from analysis.stability.linearisation import ROUND_OFF, ZERO, ComplexArray, falling, spin_scale
from analysis.stability.spectra import (
    Matrices,
    System,
    chosen_system,
    helper_spins,
    matrices_over_spin,
)

Side = Literal["below", "above"]

_DIP = 1e-4
"""How exactly a dip is looked for, in parts of two steps: those of slow disks are tiny."""

_BESIDE = 1e-3
"""How far from a crossing its eigenvalue is told, in parts of the way to the middle of a step."""


_HALVINGS = 12
"""Of a step, until what changes in it is one pair, however near others are."""

_SPLIT = 0.005
"""Part of the scale up to which rounding may split a double value."""

_MIRRORED = 1e-9
"""Sum of eigenvalues, or of their cubes, over the largest that rounding may leave."""


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
    is_hidden : bool
        Whether friction is so steep that rounding hides where the motion is stable.
    """

    scenario: Scenario
    system: System
    motion: Motion
    interval: tuple[float, float]
    crossings: tuple[Crossing, ...]
    pair_changes: tuple[PairChange, ...]
    stable: tuple[tuple[float, float], ...]
    reason: str | None = None
    is_hidden: bool = False

    @property
    def hopf(self) -> tuple[Crossing, ...]:
        """Crossings of complex pairs only."""
        return tuple(crossing for crossing in self.crossings if crossing.kind == "hopf")

    @property
    def where(self) -> str:
        """Spins in rad/s at which the motion is stable, in words."""
        told = ", ".join(f"{low:.6g} to {high:.6g}" for low, high in self.stable)
        return told or ("hidden by rounding" if self.is_hidden else "nowhere")


def spin_interval(interval: tuple[float, float], name: str = "interval") -> tuple[float, float]:
    """Return lowest and highest spin in rad/s; `ValueError` if they are no interval."""
    ends = numbers(name, interval, ("lowest", "highest spin"))
    low, high = (turn_rate(name, end) for end in ends)
    if not low < high:
        fault = f"must have lowest < highest spin, got {low:g} to {high:g}"
        raise ArgumentError(name, fault)
    return low, high


def critical_speeds(
    scenario: Scenario,
    interval: tuple[float, float] = (0.0, 60.0),
    system: System | None = None,
    motion: Motion = "inverted",
) -> CriticalSpeeds:
    """Find the critical spins of a linear system, and where the motion is stable as a whole.

    Without friction there mostly is no damping and no crossing: the eigenvalues lie mirrored at
    both axes, but for a body without a plane of symmetry that rolls, as a rattleback does. An
    eigenvalue that is zero at every spin, as for a round disk, does not count.

    Parameters
    ----------
    scenario, system, motion
        See `spectra.matrices_over_spin`.
    interval : tuple of 2 floats
        Lowest and highest spin in rad/s. With `inertia_yz` in the body, the two senses of turning
        are not each other's mirror images.

    Raises
    ------
    ValueError
        If the interval is empty or not finite, the system or the motion is unknown, or the
        scenario none of this system.
    """
    low, high = spin_interval(interval)
    matrices = matrices_over_spin(scenario, system, motion)
    spectra = Spectra(matrices, helper_spins(scenario, low, high), spin_scale(scenario))
    crossings: tuple[Crossing, ...] = ()
    without = "no friction at little slip" if scenario.rubs else "no friction"
    reason: str | None = f"{without}: undamped, the eigenvalues lie mirrored at both axes"
    if (scenario.rubs and scenario.friction_gradient > 0.0) or not spectra.is_mirrored:
        crossings = spectra.crossings()
        nothing = f"no eigenvalue crosses the imaginary axis from {low:g} to {high:g} rad/s"
        if spectra.is_hidden:
            nothing = "friction so steep that rounding hides whether slow motions grow or decay"
        reason = None if crossings else nothing
    ends = (low, *(each.spin for each in crossings), high)
    return CriticalSpeeds(
        scenario=scenario,
        system=chosen_system(scenario, system),
        motion=motion,
        interval=(low, high),
        crossings=crossings,
        # What meets at an end may be a pair beyond, too, as without friction at no spin.
        pair_changes=tuple(each for each in spectra.pair_changes() if low < each.spin < high),
        # Between neighbouring crossings nothing changes.
        stable=tuple(each for each in pairwise(ends) if spectra.decay(sum(each) / 2.0)),
        reason=reason,
        is_hidden=spectra.is_hidden and not crossings and not spectra.grows,
    )


class Spectra:
    """Eigenvalues on a grid of spins.

    Parameters
    ----------
    matrices : callable
        State matrices at any spins.
    spins : ndarray, shape (n,)
        A fine grid in rad/s.
    scale : float
        Size in 1/s that eigenvalues are compared with where all are smaller: what rounding makes
        of those of a round disk, held in all but its tilt, is not to be judged against itself.
    """

    def __init__(self, matrices: Matrices, spins: Array, scale: float = 0.0) -> None:
        self._matrices, self._neutral, self._scale = matrices, 0, scale
        values = self._eigenvalues(spins)
        largest = np.maximum(scale, np.max(np.abs(values), axis=1, keepdims=True))
        self._largest = float(np.max(largest))
        # Beside a large eigenvalue, rounding splits a double zero by a root of the two sizes.
        small = ZERO * np.sqrt(largest * (scale or largest))
        self._small = float(np.max(small))
        # So many are zero as have a product that is none: a single small one may be what it is.
        sizes = np.sort(np.abs(values), axis=1)
        none = (np.cumprod(sizes / largest, axis=1) <= ROUND_OFF) & (sizes <= small)
        self._neutral = int(np.min(np.max(none * np.arange(1, sizes.shape[1] + 1), axis=1)))
        values = self._moving(values)
        self._whole = spins, values
        count = np.sum(self._signs(values) == 0.0, axis=1)
        self._still = int(np.min(count))
        # One that lies on the axis, or so near that rounding hides its side, crosses between the
        # spins beside; with steep friction, whose eigenvalue is large, these may be far apart.
        kept = count == self._still
        kept[[0, -1]] = True
        self._spins, self._values = spins[kept].tolist(), values[kept]
        # A dip at a spin of the grid takes its place there.
        found = dict(zip(self._spins, self._values, strict=True))
        found |= {dip: self._at(dip) for dip in self._dips()}
        self._spins = sorted(found)
        self._values = np.array([found[spin] for spin in self._spins])

    def _eigenvalues(self, spins: Array) -> ComplexArray:
        return np.linalg.eigvals(self._matrices(spins)).astype(complex)

    def _moving(self, values: ComplexArray) -> ComplexArray:
        """Without those that are zero at every spin."""
        order = np.argsort(np.abs(values), axis=-1)[..., self._neutral :]
        return np.take_along_axis(values, order, axis=-1)

    def _damped(self, values: ComplexArray) -> ComplexArray:
        """By falling real part, without as many as lie on the axis at every spin."""
        order = np.argsort(np.abs(values.real), axis=-1)[..., self._still :]
        return falling(np.take_along_axis(values, order, axis=-1))

    def _at(self, spin: float) -> ComplexArray:
        return self._moving(self._eigenvalues(np.array([spin]))[0])

    def _signs(self, values: ComplexArray) -> Array:
        """Signs of the real parts, 0 where rounding hides them."""
        clear = np.abs(values.real) > ROUND_OFF * self._largest
        return np.sign(values.real) * clear

    def _dips(self) -> list[float]:
        """Spins between those of the grid at which a real part has another sign than beside."""
        values = self._damped(self._values)
        signs, sizes = self._signs(values), np.abs(values.real)
        falls, rises = sizes[:-2] - sizes[1:-1], sizes[2:] - sizes[1:-1]
        same = (signs[:-2] * signs[1:-1] > 0.0) & (signs[2:] * signs[1:-1] > 0.0)
        # One that turns between two spins falls on by less than it changes beside.
        near = same & (falls >= 0.0) & (rises >= 0.0) & (sizes[1:-1] <= falls + rises)
        return [
            spin
            for step, place in np.argwhere(near).tolist()
            if (spin := self._dip(step, place, float(signs[step, place]))) is not None
        ]

    def _dip(self, step: int, place: int, sign: float) -> float | None:
        """Spin within two steps at which a real part of this sign has the other one."""

        def size(spin: float) -> float:
            return sign * float(self._damped(self._at(spin))[place].real)

        ends = self._spins[step], self._spins[step + 2]
        how = {"xatol": _DIP * (ends[1] - ends[0])}
        least = minimize_scalar(size, bounds=ends, method="bounded", options=how)
        below = least.fun < -ROUND_OFF * self._largest
        return float(least.x) if below else None

    @property
    def is_mirrored(self) -> bool:
        """Whether as much decays as grows at every spin: sums of odd powers are zero."""
        return all(
            np.max(np.abs(np.sum(self._values**power, axis=1))) <= _MIRRORED * self._largest**power
            for power in (1, 3)
        )

    @property
    def is_hidden(self) -> bool:
        """Whether rounding of the largest eigenvalue is as large as what the slow ones tell."""
        # Of a large one a, what is slow has a real part of less than scale² / a.
        return 10.0 * ROUND_OFF * self._largest**2 > self._scale**2

    @property
    def grows(self) -> bool:
        """Whether something clearly grows at every spin between the first and the last."""
        return bool(np.all(np.max(self._signs(self._values[1:-1]), axis=1) > 0.0))

    def decay(self, spin: float) -> bool:
        """Whether every eigenvalue has a negative real part."""
        values = self._eigenvalues(np.array([spin]))[0]
        return bool(np.max(values.real) + ROUND_OFF * np.max(np.abs(values)) < 0.0)

    def crossings(self) -> tuple[Crossing, ...]:
        """Crossings of the imaginary axis, by rising spin."""
        values = self._damped(self._values)
        signs = self._signs(values)
        # Of a pair the upper one: at both ends of a step, and at the crossing.
        upper = np.maximum(values[:-1].imag, values[1:].imag) >= 0.0
        changes = np.argwhere((signs[:-1] * signs[1:] < 0.0) & upper).tolist()
        found = (self._crossing(step, place, signs[step, place]) for step, place in changes)
        kept: list[Crossing] = []
        for each in sorted(found, key=lambda each: each.spin):
            # Of a pair born just before it crosses, both members may count as the upper one.
            again = each.kind == "hopf" and any(_is_same(each, last) for last in kept[-1:])
            if each.frequency >= 0.0 and not again:
                kept.append(each)
        return tuple(kept)

    def _crossing(self, step: int, place: int, before: float) -> Crossing:
        """That at a place in the order of falling real parts, of this sign before it."""
        ends = self._spins[step : step + 2]

        def product(spin: float) -> float:
            # The lowest coefficient of the characteristic polynomial that does not vanish.
            values = self._eigenvalues(np.array([spin]))[0]
            return float(np.poly(values)[values.size - self._neutral].real)

        def value(spin: float) -> complex:
            return complex(self._damped(self._at(spin))[place])

        side: Side = "above" if before > 0.0 else "below"
        spin = _root(lambda spin: value(spin).real, *ends)
        # Told beside the axis, where it is none of those that stay there.
        beside, values = value(spin + _BESIDE * (sum(ends) / 2.0 - spin)), self._at(spin)
        off = np.abs(values.real)
        values = values[off <= np.sort(off)[self._still] + ROUND_OFF * self._largest]
        frequency = float(values[np.argmin(np.abs(values - beside))].imag)
        if abs(frequency) > self._small:
            return Crossing(spin=spin, frequency=frequency, kind="hopf", stable_side=side)
        # It has one sign at both ends where another one crosses in this step, too.
        spin = _root(product, *ends) if product(ends[0]) * product(ends[1]) < 0.0 else spin
        return Crossing(spin=spin, frequency=0.0, kind="static", stable_side=side)

    def pair_changes(self) -> tuple[PairChange, ...]:
        """Collisions of two real eigenvalues, by rising spin; none where rounding makes them."""
        if self._small > _SPLIT * self._scale > 0.0:
            return ()
        spins, values = self._whole
        pairs = [self._pairs(each) for each in values]
        steps = zip(pairwise(spins.tolist()), pairwise(pairs), strict=True)
        found = (change for step in steps for change in self._pair_changes(*step))
        return tuple(sorted(found, key=lambda each: each.spin))

    def _pairs(self, values: ComplexArray) -> ComplexArray:
        """Upper ones of complex pairs; a double value split by round-off is none."""
        return values[values.imag > self._small / 2.0]

    def _pair_changes(
        self,
        ends: tuple[float, float],
        pairs: tuple[ComplexArray, ComplexArray],
        halvings: int = 0,
    ) -> Iterator[PairChange]:
        """Those between two spins with these pairs: the step is halved while their number differs.

        Of a pair just born, the imaginary part is the smallest there is.
        """
        born = pairs[1].size - pairs[0].size
        if born and halvings < _HALVINGS:
            middle = sum(ends) / 2.0
            between = self._pairs(self._at(middle))
            yield from self._pair_changes((ends[0], middle), (pairs[0], between), halvings + 1)
            yield from self._pair_changes((middle, ends[1]), (between, pairs[1]), halvings + 1)
        elif born:
            several = pairs[born > 0]
            for value in several[np.argsort(several.imag)[: abs(born)]].real.tolist():
                yield self._pair_change(ends, value, "above" if born > 0 else "below")

    def _pair_change(self, ends: tuple[float, float], centre: float, side: Side) -> PairChange:
        """A collision; the squared difference of the two eigenvalues passes zero smoothly."""

        def pair(spin: float) -> ComplexArray:
            values = self._at(spin)
            return values[np.argsort(np.abs(values - centre))[:2]]

        def apart(spin: float) -> float:
            return float((np.diff(pair(spin))[0] ** 2).real)

        # What is taken for real beside it may be a narrow pair, over many such steps.
        real, paired = ends if side == "above" else ends[::-1]
        for _ in range(_HALVINGS + 2):
            if apart(real) > 0.0:
                break
            real = float(np.clip(2.0 * real - paired, *self._whole[0][[0, -1]]))
        spin = _root(apart, *sorted((real, paired)))
        return PairChange(spin=spin, value=float(pair(spin).mean().real), complex_side=side)


def _is_same(one: Crossing, other: Crossing) -> bool:
    """Whether two crossings are one but for rounding."""
    return isclose(one.spin, other.spin, rel_tol=1e-6) and isclose(
        one.frequency, other.frequency, rel_tol=1e-6
    )


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root between two spins; an end if round-off hides the change of sign there."""
    function = cache(function)
    at_low, at_high = function(low), function(high)
    if at_low * at_high >= 0.0:
        return low if abs(at_low) < abs(at_high) else high
    return float(brentq(function, low, high, xtol=1e-13, rtol=1e-14, maxiter=200))
