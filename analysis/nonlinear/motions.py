"""Periodic motions of the reduced system: one boundary value problem with three end conditions.

| kind | where it begins | where it ends |
| --- | --- | --- |
| symmetric: its own mirror image half a period later | upright, gamma at its largest | mirrored |
| asymmetric | upright, gamma at its largest | the same |
| rotating | noninverted, with a tilt | the same, gamma a turn further |

The largest gamma or the tilt is given, spin and duration are found: as a parameter it passes folds
of the spin.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, log
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np

from analysis.problem.checks import Array
from analysis.problem.scenario import Scenario

Kind = Literal["symmetric", "asymmetric", "rotating"]

INVERTED: Array = np.array((np.pi / 2, np.pi / 2, 0.0))
"""Inverted spinning: beta and gamma in rad, and the rate of beta."""

_NEUTRAL = 1e-6
"""Distance of a multiplier from 1 below which a motion is called neither stable nor unstable."""

_BEYOND = 1e-6
"""Part of an amplitude by which a swing may exceed it, where it is largest."""

_SYMMETRIC = 1e-4
"""Difference in rad of the largest deviations to both sides below which they are the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ends:
    """What holds at the ends of the stretch of a periodic motion that is solved for.

    Parameters
    ----------
    columns : tuple of 2 str
        Names of what is told of motions of this kind alone; the first is followed.
    changes : mapping
        What happens along a family where the larger multiplier over the stretch passes a value.
    held, follows : {0, 1}
        Whether the deviation of beta or of gamma from inverted spinning is the same for a whole
        family where its motions begin, and which one is followed.
    at : float
        The one that is held in rad.
    mirrored : bool
        Whether the stretch is half a period, after which the motion is its own mirror image.
    turn : float
        What gamma gains over the stretch in rad.
    """

    columns: tuple[str, str]
    changes: Mapping[str, float]
    held: int = 0
    follows: int = 1
    at: float = 0.0
    mirrored: bool = False
    turn: float = 0.0

    @property
    def parts(self) -> int:
        """Stretches in a period."""
        return 2 if self.mirrored else 1

    def residual(self, first: Array, last: Array) -> Array:
        """What is zero of the deviations at both ends, shape (3,) each: 4 numbers."""
        closing = last + first if self.mirrored else last - first
        closing[1] -= self.turn
        return np.append(first[self.held] - self.at, closing)


_DOUBLING = {"fold": 1.0, "period-doubling": -1.0}

KINDS: Mapping[Kind, Ends] = MappingProxyType(
    {
        "symmetric": Ends(
            columns=("amplitude", "half_multiplier"),
            # There are no others: the multipliers over half a period are real.
            changes={"fold": 1.0, "symmetry-breaking": -1.0},
            mirrored=True,
        ),
        "asymmetric": Ends(columns=("amplitude", "lowest"), changes=_DOUBLING),
        "rotating": Ends(
            columns=("tilt", "largest_tilt"),
            changes=_DOUBLING,
            held=1,
            follows=0,
            at=-np.pi,
            turn=2.0 * np.pi,
        ),
    }
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PeriodicMotion:
    """A periodic motion of the reduced system.

    Parameters
    ----------
    scenario : Scenario
    kind : {"symmetric", "asymmetric", "rotating"}
    spin : float
        Constant spinning speed in rad/s.
    value : float
        What its family is followed in, in rad: its amplitude, which is the largest deviation of
        gamma from pi/2, or its tilt, beta less pi/2 where gamma passes noninverted spinning.
    times : ndarray, shape (n,)
        Over a period in s, or over half of it if the motion is then its own mirror image.
    states : ndarray, shape (n, 3)
        beta, gamma in rad and the rate of beta in rad/s at `times`.
    larger : float
        The larger of the two nontrivial Floquet multipliers over `times`, of a complex pair its
        real part. Over half a period, with the mirror image, both are real, since their product
        is negative; the third one, along the motion, is 1.
    imaginary : float
        Imaginary part of a complex pair, else 0.
    log_strong : float
        Logarithm of the size of the other one over a period, which mostly is below rounding.
    """

    scenario: Scenario
    kind: Kind
    spin: float
    value: float
    times: Array
    states: Array
    larger: float = 1.0
    imaginary: float = 0.0
    log_strong: float = -np.inf

    @property
    def ends(self) -> Ends:
        """What holds at the ends of `times`."""
        return KINDS[self.kind]

    @property
    def period(self) -> float:
        """In s; of a rotating motion that of a turn."""
        return self.ends.parts * float(self.times[-1])

    @property
    def place(self) -> Array:
        """Where it lies in its family, shape (3,): `value`, `spin`, and the last of `times`."""
        return np.array((self.value, self.spin, self.times[-1]))

    def place_with(self, *, value: float | None = None, spin: float | None = None) -> Array:
        """Its `place` with another value or spin, shape (3,)."""
        return np.array((value or self.value, spin or self.spin, self.times[-1]))

    @property
    def multiplier(self) -> float:
        """The larger multiplier over a whole period, of a complex pair its real part."""
        return self.larger**self.ends.parts

    @property
    def stable(self) -> bool | None:
        """Whether both multipliers lie inside the unit circle; None if too close to tell."""
        return is_stable(hypot(self.multiplier, self.imaginary))

    @property
    def lowest(self) -> float:
        """Least deviation of gamma from pi/2 in rad over `times`."""
        return float(np.min(self.states[:, 1])) - np.pi / 2

    @property
    def whole(self) -> tuple[Array, Array]:
        """Times, shape (m,), and states, (m, 3), over a whole period."""
        if not self.ends.mirrored:
            return self.times, self.states
        times = np.concatenate((self.times, self.times[-1] + self.times[1:]))
        return times, np.concatenate((self.states, 2.0 * INVERTED - self.states[1:]))

    @property
    def flaw(self) -> str | None:
        """Why this is not what was looked for, if it is not."""
        tilts, turns = np.abs(self.states - INVERTED).T[:2]
        if self.kind == "rotating":
            # A disk that is flat on the way has left the plane in which it can be seen to rotate.
            flat = np.max(tilts) >= np.pi / 2
            return "the disk would fall flat on the way" if flat else None
        if self.kind == "asymmetric" and self.value + self.lowest < _SYMMETRIC:
            return "it is a symmetric one"
        return "it swings further" if np.max(turns) > (1.0 + _BEYOND) * self.value else None

    def characteristic(self, multiplier: float) -> float:
        """Characteristic polynomial of the stretch, which changes sign with the stability.

        Over half a period with the mirror image the product of both multipliers is negative,
        since that turns all three directions round and the flow none; over a whole period it is
        positive. A complex pair passes neither 1 nor -1.
        """
        if self.imaginary:
            return (self.larger - multiplier) ** 2 + self.imaginary**2
        sign = -self.larger if self.ends.mirrored else self.larger
        other = np.copysign(np.exp(self.log_strong / self.ends.parts), sign)
        return float((self.larger - multiplier) * (other - multiplier))

    @property
    def log_product(self) -> float:
        """Logarithm of the size of the product of both multipliers over a period."""
        larger = hypot(self.larger, self.imaginary)
        return self.log_strong + self.ends.parts * log(larger)

    def as_row(self) -> dict[str, Any]:
        """What tables and files tell of it, as plain data by names."""
        second = {
            "half_multiplier": self.larger,
            "lowest": self.lowest,
            "largest_tilt": float(np.max(self.states[:, 0])) - np.pi / 2,
        }
        followed, other = self.ends.columns
        names = ("spin", "period", "multiplier", "imaginary", "stable")
        common = {name: getattr(self, name) for name in names}
        common["log10_strong"] = self.log_strong / np.log(10.0)
        return {followed: self.value, other: second[other], **common}


def is_stable(multiplier: float) -> bool | None:
    """Whether the size of the largest multiplier is below 1; None if too close to tell."""
    return None if abs(multiplier - 1.0) < _NEUTRAL else multiplier < 1.0


class Event(NamedTuple):
    """A motion of a family at which something happens, such as a fold of the spin.

    Parameters
    ----------
    kind : str
    motion : PeriodicMotion
    place : float
        Along the family: from 3 to 4 between motions 3 and 4, counted from 0. Below 0 it is where
        the family is born.
    """

    kind: str
    motion: PeriodicMotion
    place: float = -1.0
