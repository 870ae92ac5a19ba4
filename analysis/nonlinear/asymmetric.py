"""Cycles that are not their own mirror images, from where symmetric ones lose their symmetry.

They are collocated over a whole period and followed in their largest deviation of gamma, which
grows smoothly through the bifurcation; their mirror images have it as the least one. The mode that
breaks the symmetry leads to the first of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Self

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, real_array
from analysis.data.watch import Progress
from analysis.nonlinear.collocation import NoCycleError, breaking_mode, solve
from analysis.nonlinear.cycle import Ends, WholePeriod, characteristics
from analysis.nonlinear.family import Bifurcation, CycleFamily, bifurcations
from analysis.stability.continuation import followed, gathered, sign_changes

Change = Literal["fold", "period-doubling"]
_MULTIPLIERS: dict[Change, float] = {"fold": 1.0, "period-doubling": -1.0}

_FIRST = 0.05
"""How much larger in rad than at the bifurcation the first cycle is that is looked for."""

_SYMMETRIC = 1e-4
"""Difference in rad of the largest deviations to both sides below which they are the same."""

BEYOND: Array = np.concatenate(((0.005, 0.02), np.linspace(0.05, 1.3, 26)))
"""Amplitudes in rad beyond that of the bifurcation, to which the cycles are followed."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AsymmetricCycle(WholePeriod):
    """A cycle without mirror symmetry; gamma is largest at its first state.

    Parameters
    ----------
    amplitude : float
        Largest deviation of gamma from pi/2 in rad. The others are those of `WholePeriod`.
    """

    ends = Ends(held=0, follows=1)
    noun = "cycle without symmetry with an amplitude"
    amplitude: float

    @classmethod
    def of(cls, value: float, larger: float, **fields: Any) -> Self:
        """See `PeriodicMotion`."""
        return cls(amplitude=value, multiplier=larger, **fields)

    @property
    def value(self) -> float:
        """The amplitude in rad."""
        return self.amplitude

    @property
    def lowest(self) -> float:
        """Least deviation of gamma from pi/2 in rad."""
        return float(np.min(self.states[:, 1])) - np.pi / 2

    @property
    def flaw(self) -> str | None:
        """Why this is not what was looked for, if it is not."""
        if self.amplitude + self.lowest < _SYMMETRIC:
            return "it swings as far to the other side"
        return WholePeriod.flaw.fget(self)  # type: ignore[attr-defined, no-any-return]

    @property
    def stable(self) -> bool:
        """Whether both multipliers lie inside the unit circle."""
        return abs(self.multiplier) < 1.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AsymmetricFamily:
    """Cycles without mirror symmetry by rising amplitude.

    Parameters
    ----------
    bifurcation : Bifurcation
        Where they branch off symmetric ones.
    cycles : tuple of AsymmetricCycle
        All of them converged.
    reason : str or None
        Why it ends before the last amplitude asked for, if it does; it names the last good one.
    """

    bifurcation: Bifurcation
    cycles: tuple[AsymmetricCycle, ...]
    reason: str | None = None


def asymmetric_family(
    bifurcation: Bifurcation,
    amplitudes: npt.ArrayLike | None = None,
    *,
    progress: Progress | None = None,
) -> AsymmetricFamily:
    """Follow the cycles that branch off where symmetric ones lose their symmetry.

    Parameters
    ----------
    bifurcation : Bifurcation
        Of the kind "symmetry-breaking", into larger cycles.
    amplitudes : array_like, shape (n,), optional
        Largest deviations of gamma in rad, rising, beyond that of the bifurcation; by default
        further by `BEYOND`.
    progress : callable, optional
        Called after each of them with how many there are and how many are wanted.

    Raises
    ------
    ValueError
        If the bifurcation is another one, or the amplitudes are no such.
    NoCycleError
        If there is no cycle without symmetry beside the bifurcation.
    """
    if bifurcation.kind != "symmetry-breaking":
        raise ValueError(f"bifurcation must be symmetry-breaking, got {bifurcation.kind!r}")
    begin = bifurcation.cycle.amplitude
    wanted = real_array("amplitudes", begin + BEYOND if amplitudes is None else amplitudes)
    if wanted.ndim != 1 or not wanted.size or np.any(np.diff(wanted, prepend=begin) <= 0.0):
        raise ValueError(f"amplitudes must rise strictly beyond {begin:.6g}, got {amplitudes!r}")
    cycles = followed(_solved, _first(bifurcation), wanted.tolist())
    found, reason = gathered(cycles, progress=progress, wanted=wanted.size)
    return AsymmetricFamily(bifurcation=bifurcation, cycles=found, reason=reason)


def first_asymmetric_family(
    family: CycleFamily, *, progress: Progress | None = None
) -> AsymmetricFamily:
    """Cycles without symmetry from the first place of a family where some branch off.

    Parameters
    ----------
    family : CycleFamily
        Of symmetric cycles.
    progress : callable, optional
        As in `asymmetric_family`.

    Raises
    ------
    NoCycleError
        If no cycle of the family loses its symmetry, or none without it is found.
    """
    reason = "no cycle of the family loses its symmetry"
    for bifurcation in bifurcations(family):
        if bifurcation.kind == "symmetry-breaking":
            try:
                return asymmetric_family(bifurcation, progress=progress)
            except NoCycleError as error:
                reason = str(error)
    raise NoCycleError(reason)


def changes(branch: Sequence[AsymmetricCycle]) -> tuple[tuple[Change, AsymmetricCycle], ...]:
    """Where the multiplier passes 1 (a fold) or -1 (the period doubles) between neighbours.

    Raises
    ------
    NoCycleError
        If an iteration between two of them fails.
    """
    return tuple(sign_changes(_solved, branch, characteristics(_MULTIPLIERS)))


def _solved(amplitude: float, start: AsymmetricCycle) -> AsymmetricCycle:
    return solve(start.scenario, amplitude, start)


def _first(bifurcation: Bifurcation) -> AsymmetricCycle:
    """The one that the mode leads to."""
    near, mode = bifurcation.cycle, _FIRST * breaking_mode(bifurcation.cycle)
    times, states = near.full
    start = AsymmetricCycle(
        scenario=near.scenario,
        spin=near.spin,
        amplitude=near.amplitude + _FIRST,
        period=near.period,
        times=times,
        # The mode is the same on the other side, where the cycle is mirrored.
        states=states + np.concatenate((mode, mode[1:])),
        multiplier=1.0,
        log_strong=-np.inf,
    )
    return _solved(start.amplitude, start)
