"""Rotating motions beyond the heteroclinic connection: gamma turns round, the disk keeps tilted.

On the cylinder of gamma the connection is a pair of loops, one for either sense of turning. On
one side of its spin they join to the swinging cycles; on the other side each becomes a periodic
motion of its own (a gluing bifurcation). They are followed in their tilt where gamma passes
noninverted spinning, from zero at the connection on; as a parameter it passes folds of the spin.
"""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from analysis.data.checks import Array, real_array
from analysis.data.scenario import Scenario
from analysis.data.watch import Progress
from analysis.mechanics import reduced
from analysis.nonlinear.collocation import (
    NoCycleError,
    collocated_period,
    period_values,
    require_collocation,
)
from analysis.nonlinear.cycle import WholePeriod, is_stable
from analysis.nonlinear.following import followed, locate
from analysis.nonlinear.heteroclinic import Connection, fall, heteroclinic_connection
from analysis.stability.linear_reduced import critical_speed

TILTS: Array = np.concatenate(
    (np.geomspace(1e-4, 0.02, 6), np.linspace(0.04, 0.2, 9), np.linspace(0.25, 1.5, 26))
)
"""Tilts in rad from near the connection to a disk that is nearly flat."""

_BESIDE = (0.02, 0.005, 0.001)
"""Distances from the connection at which one may settle, in parts of that to the Hopf point."""

_TURNS = 40
_SETTLED = 3e-3
"""Turns within which it has to settle; relative change over a turn that is near enough."""

_LONGEST = 100.0
"""Longest turn in s."""

_HALVINGS = 5


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

    tilt: float

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
        If the motions next to it are unstable, so that none settles there.
    """
    wanted = real_array("tilts", TILTS if tilts is None else tilts)
    proper = wanted.ndim == 1 and wanted.size and np.all(np.diff(wanted, prepend=0.0) > 0.0)
    if not proper or wanted[-1] >= np.pi / 2:
        raise ValueError(f"tilts must rise strictly between 0 and pi/2, got {tilts!r}")
    require_collocation(scenario)
    connection = heteroclinic_connection(scenario)
    first = _settled(scenario, connection)
    split = int(np.searchsorted(wanted, first.tilt))
    found: list[Rotation] = []
    reason = None
    for way in (wanted[:split][::-1], wanted[split:]):
        solve = partial(rotation, scenario)
        try:
            for each in followed(solve, way, first, lambda each: each.tilt, _HALVINGS):
                found.append(each)
                if progress is not None:
                    progress(float(len(found)), float(wanted.size))
        except NoCycleError as error:
            reason = str(error)
    found.sort(key=lambda each: each.tilt)
    return RotationFamily(connection=connection, rotations=tuple(found), reason=reason)


def folds(family: RotationFamily) -> tuple[Rotation, ...]:
    """Where the spin turns back along a family, and the multiplier passes 1.

    Raises
    ------
    NoCycleError
        If an iteration between two neighbours fails.
    """
    return tuple(
        locate(
            partial(rotation, first.scenario, start=first),
            lambda each: each.multiplier - 1.0,
            {first.tilt: first, last.tilt: last},
        )
        for first, last in pairwise(family.rotations)
        if (first.multiplier - 1.0) * (last.multiplier - 1.0) < 0.0
    )


def rotation(scenario: Scenario, tilt: float, start: Rotation) -> Rotation:
    """Find the rotating motion of a tilt, from one near it.

    Raises
    ------
    NoCycleError
        If the iteration does not converge.
    """

    def ends(first: Array, last: Array, _: Array) -> Array:
        return np.array(
            (
                first[0] - tilt,
                first[1] + np.pi,
                last[0] - tilt,
                last[1] - np.pi,
                last[2] - first[2],
            )
        )

    found = collocated_period(start, ends)
    # A disk that is flat on the way has left the plane in which it can be seen to rotate.
    flat = np.max(np.abs(found.y[0])) >= np.pi / 2
    if found.status != 0 or np.min(found.p) <= 0.0 or flat:
        why = "the disk would fall flat on the way" if flat else "the collocation fails"
        raise NoCycleError(f"no rotating motion found with a tilt of {tilt:.9g} rad: {why}")
    return Rotation(tilt=tilt, **period_values(scenario, found))


def _settled(scenario: Scenario, connection: Connection) -> Rotation:
    """The one to which the motion from noninverted spinning settles beside the connection."""
    width = abs(critical_speed(scenario).spin - connection.spin)
    for part in _BESIDE:
        sides = (connection.spin - part * width, connection.spin + part * width)
        ways = {spin: fall(scenario, spin) for spin in sides}
        for spin, way in ways.items():
            if way.miss > 0.0:
                try:
                    return _settled_at(scenario, spin, way.states[-1])
                except NoCycleError:
                    continue
    raise NoCycleError(
        f"no rotating motion settles beside the connection at {connection.spin:.9g} rad/s"
    )


def _settled_at(scenario: Scenario, spin: float, state: Array) -> Rotation:
    tilt = 0.0
    for _ in range(_TURNS):
        times, states = _turn(scenario, spin, state)
        state, before, tilt = states[-1].copy(), tilt, float(states[-1, 0]) - np.pi / 2
        if tilt > 0.0 and abs(tilt - before) < _SETTLED * tilt:
            states[:, 1] -= state[1] - 1.5 * np.pi
            rough = Rotation(
                scenario=scenario,
                spin=spin,
                tilt=tilt,
                period=float(times[-1]),
                times=times,
                states=states,
                multiplier=np.nan,
                log_strong=np.nan,
            )
            return rotation(scenario, tilt, rough)
    raise NoCycleError(f"no rotating motion settles at {spin:.9g} rad/s")


def _turn(scenario: Scenario, spin: float, state: Array) -> tuple[Array, Array]:
    """Times, shape (n,), and states, (n, 3), until gamma is a turn further, noninverted."""
    goal = 1.5 * np.pi + 2 * np.pi * np.round((state[1] - 1.5 * np.pi) / (2 * np.pi) + 1.0)

    def turned(_: float, x: Array) -> float:
        return float(x[1] - goal)

    turned.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(
        reduced.right_hand_side(scenario, spin),
        (0.0, _LONGEST),
        state,
        method="LSODA",
        rtol=1e-10,
        atol=1e-11,
        events=turned,
    )
    if not run.t_events[0].size:
        raise NoCycleError(f"no rotating motion settles at {spin:.9g} rad/s: the disk falls")
    return run.t, run.y.T.copy()
