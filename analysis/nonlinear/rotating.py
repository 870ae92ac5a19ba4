"""Rotating motions beyond the heteroclinic connection: gamma turns round, the disk keeps tilted.

On the cylinder of gamma the connection is a pair of loops, one for either sense of turning. On
one side of its spin they join to the swinging cycles; on the other side each becomes a periodic
motion of its own (a gluing bifurcation). They are followed in their tilt where gamma passes
noninverted spinning, from zero at the connection on; as a parameter it passes folds of the spin.
"""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, real_array
from analysis.data.scenario import Scenario
from analysis.data.watch import Progress
from analysis.nonlinear.collocation import NoCycleError, require_collocation, solve
from analysis.nonlinear.cycle import INVERTED, Ends, WholePeriod, characteristics, is_stable
from analysis.nonlinear.heteroclinic import Connection, fall, heteroclinic_connection
from analysis.stability.continuation import followed, gathered, sign_changes
from analysis.stability.linear_reduced import critical_speed

TILTS: Array = np.concatenate(
    (np.geomspace(1e-4, 0.02, 6), np.linspace(0.04, 0.2, 9), np.linspace(0.25, 1.5, 26))
)
"""Tilts in rad from near the connection to a disk that is nearly flat."""

_BESIDE = (0.02, 0.005, 0.001)
"""Distances from the connection at which the first is looked for, in parts of that to the Hopf
point."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rotation(WholePeriod):
    """A periodic motion in which gamma makes a whole turn; its mirror image turns the other way.

    The period is that of a turn, from gamma at -pi/2 to gamma at 3 pi/2.

    Parameters
    ----------
    tilt : float
        beta less pi/2 in rad where gamma passes noninverted spinning. The others are those of
        `WholePeriod`.
    """

    ends = Ends(held=1, at=-np.pi, follows=0, turn=2.0 * np.pi)
    noun = "rotating motion with a tilt"
    tilt: float

    @classmethod
    def of(cls, value: float, larger: float, **fields: Any) -> Self:
        """See `PeriodicMotion`."""
        return cls(tilt=value, multiplier=larger, **fields)

    @property
    def value(self) -> float:
        """The tilt in rad."""
        return self.tilt

    @property
    def flaw(self) -> str | None:
        """Why this is not what was looked for, if it is not."""
        # A disk that is flat on the way has left the plane in which it can be seen to rotate.
        flat = np.max(np.abs(self.states[:, 0] - INVERTED[0])) >= np.pi / 2
        return "the disk would fall flat on the way" if flat else None

    @property
    def stable(self) -> bool | None:
        """Whether both multipliers lie inside the unit circle; None if too close to tell."""
        return is_stable(abs(self.multiplier))

    @property
    def largest_tilt(self) -> float:
        """Largest beta less pi/2 in rad."""
        return float(np.max(self.states[:, 0])) - np.pi / 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RotationFamily:
    """Rotating motions by rising tilt.

    Parameters
    ----------
    connection : Connection
        Where the family begins.
    rotations : tuple of Rotation
        All of them converged.
    reason : str or None
        Why it ends before the last tilt asked for, if it does; it names the last good one.
    """

    connection: Connection
    rotations: tuple[Rotation, ...]
    reason: str | None = None

    def values(self, name: str) -> Array:
        """Attribute `name` of all of them, shape (n,)."""
        return np.array([getattr(each, name) for each in self.rotations], dtype=float)


def rotating_family(
    scenario: Scenario,
    tilts: npt.ArrayLike | None = None,
    *,
    progress: Progress | None = None,
) -> RotationFamily:
    """Follow the rotating motions from the heteroclinic connection on.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.
    tilts : array_like, shape (n,), optional
        Tilts in rad, rising, between 0 and pi/2; `TILTS` by default.
    progress : callable, optional
        Called after each of them with how many there are and how many are wanted.

    Raises
    ------
    ValueError
        If the tilts are no such, or the scenario has no cycles or too steep a friction.
    NoConnectionError
        If there is no connection.
    NoCycleError
        If none is found beside it.
    """
    wanted = real_array("tilts", TILTS if tilts is None else tilts)
    proper = wanted.ndim == 1 and wanted.size and np.all(np.diff(wanted, prepend=0.0) > 0.0)
    if not proper or wanted[-1] >= np.pi / 2:
        raise ValueError(f"tilts must rise strictly between 0 and pi/2, got {tilts!r}")
    require_collocation(scenario)
    connection = heteroclinic_connection(scenario)
    first = _first(scenario, connection)
    split = int(np.searchsorted(wanted, first.tilt))
    ways = (wanted[:split][::-1], wanted[split:])
    found, reason = gathered(
        *(followed(_solved, first, way.tolist()) for way in ways),
        progress=progress,
        wanted=wanted.size,
    )
    rotations = tuple(sorted(found, key=lambda each: each.tilt))
    return RotationFamily(connection=connection, rotations=rotations, reason=reason)


def folds(family: RotationFamily) -> tuple[Rotation, ...]:
    """Where the spin turns back along a family, and the multiplier passes 1.

    Raises
    ------
    NoCycleError
        If an iteration between two neighbours fails.
    """
    found = sign_changes(_solved, family.rotations, characteristics({"fold": 1.0}))
    return tuple(each for _, each in found)


def _solved(tilt: float, start: Rotation) -> Rotation:
    return solve(start.scenario, tilt, start)


def _first(scenario: Scenario, connection: Connection) -> Rotation:
    """The one that a motion from noninverted spinning beside the connection leads to."""
    width = abs(critical_speed(scenario).spin - connection.spin)
    for distance in width * np.array(_BESIDE):
        for spin in (connection.spin - distance, connection.spin + distance):
            try:
                return _beside(scenario, spin)
            except NoCycleError:
                continue
    raise NoCycleError(f"no rotating motion found beside {connection.spin:.9g} rad/s")


def _beside(scenario: Scenario, spin: float) -> Rotation:
    way = fall(scenario, spin)
    tilts, turns = (way.states - INVERTED).T[:2]
    if way.miss < 0.0 or np.max(turns) < np.pi:
        raise NoCycleError(f"the motion turns back at {spin:.9g} rad/s")
    # A turn begins as tilted as it ends.
    last = int(np.argmax(turns >= np.pi))
    tilt = float(tilts[last])
    turn = slice(int(np.argmax(tilts >= tilt)), last + 1)
    times = way.times[turn] - way.times[turn][0]
    start = Rotation(
        scenario=scenario,
        spin=spin,
        tilt=tilt,
        period=float(times[-1]),
        times=times,
        states=way.states[turn],
        multiplier=1.0,
        log_strong=-np.inf,
    )
    return _solved(tilt, start)
