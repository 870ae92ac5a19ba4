"""Periodic motions of the reduced system: one boundary value problem with three end conditions.

| kind | where it begins | where it ends |
| --- | --- | --- |
| its own mirror image half a period later | upright, gamma at its largest | mirrored |
| without that symmetry | upright, gamma at its largest | the same |
| rotating | noninverted, with a tilt | the same, gamma a turn further |

The largest gamma or the tilt is given, spin and duration are found: as a parameter it passes folds
of the spin.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from analysis.data.checks import Array
from analysis.data.scenario import Scenario

K = TypeVar("K")

INVERTED: Array = np.array((np.pi / 2, np.pi / 2, 0.0))
"""Inverted spinning: beta and gamma in rad, and the rate of beta."""

_NEUTRAL = 1e-6
"""Distance of a multiplier from 1 below which a cycle is called neither stable nor unstable."""

_BEYOND = 1e-6
"""Part of an amplitude by which a swing may exceed it, where it is largest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ends:
    """What holds at the ends of the stretch of a periodic motion that is solved for.

    Parameters
    ----------
    held, follows : {0, 1}
        Whether the deviation of beta or of gamma from inverted spinning is the same for a whole
        family where its motions begin, and which one is followed.
    at : float
        The former in rad.
    mirrored : bool
        Whether the stretch is half a period, after which the motion is its own mirror image.
    turn : float
        What gamma gains over the stretch in rad.
    """

    held: int
    follows: int
    at: float = 0.0
    mirrored: bool = False
    turn: float = 0.0

    def residual(self, value: float | None, first: Array, last: Array) -> Array:
        """Residuals of two deviations, shape (3,) each; 5, or 4 if no value is given."""
        closing = last + first if self.mirrored else last - first
        closing[1] -= self.turn
        begins = [first[self.held] - self.at]
        if value is not None:
            begins.append(first[self.follows] - value)
        return np.array((*begins, *closing))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PeriodicMotion:
    """A periodic motion of the reduced system.

    Parameters
    ----------
    scenario : Scenario
    spin : float
        Constant spinning speed in rad/s.
    period : float
        In s.
    times : ndarray, shape (n,)
        Over a period in s, or over half of it if the motion is then its own mirror image.
    states : ndarray, shape (n, 3)
        beta, gamma in rad and the rate of beta in rad/s at `times`.
    log_strong : float
        Logarithm of the size of the smaller nontrivial Floquet multiplier, which mostly is below
        rounding.
    """

    ends: ClassVar[Ends]
    noun: ClassVar[str]
    scenario: Scenario
    spin: float
    period: float
    times: Array
    states: Array
    log_strong: float

    @classmethod
    def of(cls, value: float, larger: float, **fields: Any) -> Self:
        """The motion of a value with the larger multiplier over its stretch."""
        raise NotImplementedError

    @property
    def value(self) -> float:
        """The amplitude or tilt in rad in which its family is followed."""
        raise NotImplementedError

    @property
    def larger(self) -> float:
        """The larger multiplier over the stretch that is told."""
        raise NotImplementedError

    @property
    def flaw(self) -> str | None:
        """Why this is not what was looked for, if it is not."""
        beyond = np.max(np.abs(self.states[:, 1] - INVERTED[1])) > (1.0 + _BEYOND) * self.value
        return "it swings further" if beyond else None

    def characteristic(self, multiplier: float) -> float:
        """Characteristic polynomial of the stretch, which changes sign with the stability.

        Over half a period with the mirror image the product of both multipliers is negative,
        since that turns all three directions round and the flow none; over a whole period it is
        positive.
        """
        sign, halves = (-1.0, 2.0) if self.ends.mirrored else (1.0, 1.0)
        other = np.copysign(np.exp(self.log_strong / halves), sign * self.larger)
        return float((self.larger - multiplier) * (other - multiplier))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cycle(PeriodicMotion):
    """A periodic motion about inverted spinning that is its own mirror image half a period later.

    `times` and `states` hold half a period; gamma is largest at the first.

    Parameters
    ----------
    amplitude : float
        Largest deviation of gamma from pi/2 in rad.
    half_multiplier : float
        The larger of the two multipliers, over half a period with the mirror image. The cycle
        meets others in a fold where it is 1, and loses its mirror symmetry where it is -1. Both
        are real, since their product is negative, and the third multiplier, along the motion,
        is 1.
    method : str
        How it was found. The others are those of `PeriodicMotion`.
    """

    ends = Ends(held=0, follows=1, mirrored=True)
    noun = "periodic motion with an amplitude"
    amplitude: float
    half_multiplier: float
    method: str = "collocation"

    @classmethod
    def of(cls, value: float, larger: float, **fields: Any) -> Self:
        """See `PeriodicMotion`."""
        return cls(amplitude=value, half_multiplier=larger, **fields)

    @property
    def value(self) -> float:
        """The amplitude in rad."""
        return self.amplitude

    @property
    def larger(self) -> float:
        """The larger multiplier over half a period."""
        return self.half_multiplier

    @property
    def multiplier(self) -> float:
        """Size of the larger nontrivial Floquet multiplier, over a whole period."""
        return self.half_multiplier**2

    @property
    def stable(self) -> bool | None:
        """Whether both multipliers lie inside the unit circle; None if too close to tell."""
        return is_stable(self.multiplier)

    @property
    def full(self) -> tuple[Array, Array]:
        """Times, shape (2 n - 1,), and states, (2 n - 1, 3), over the whole period."""
        mirrored = 2.0 * INVERTED - self.states[1:]
        times = np.concatenate((self.times, self.times[-1] + self.times[1:]))
        return times, np.concatenate((self.states, mirrored))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WholePeriod(PeriodicMotion):
    """A periodic motion that is told over its whole period.

    Parameters
    ----------
    multiplier : float
        The larger of the two nontrivial Floquet multipliers: 1 at a fold, -1 where the period
        doubles. The others are those of `PeriodicMotion`.
    """

    multiplier: float

    @property
    def larger(self) -> float:
        """The larger multiplier over the period."""
        return self.multiplier


def is_stable(multiplier: float) -> bool | None:
    """Whether the size of the largest multiplier is below 1; None if too close to tell."""
    return None if abs(multiplier - 1.0) < _NEUTRAL else multiplier < 1.0


def characteristics(multipliers: Mapping[K, float]) -> dict[K, Callable[[PeriodicMotion], float]]:
    """Functions of a motion that change sign where a multiplier passes these values, by name."""
    return {
        name: partial(PeriodicMotion.characteristic, multiplier=value)
        for name, value in multipliers.items()
    }
