"""Cycles that are not their own mirror images, from where symmetric ones lose their symmetry.

They are collocated over a whole period and followed in their largest deviation of gamma, which
grows smoothly through the bifurcation; their mirror images have it as the least one. A run beside
the bifurcation settles to the first of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from analysis.data.checks import Array, real_array
from analysis.data.scenario import Scenario
from analysis.data.watch import Progress
from analysis.mechanics import reduced
from analysis.nonlinear.collocation import NoCycleError, collocated_period, period_values
from analysis.nonlinear.cycle import WholePeriod
from analysis.nonlinear.family import Bifurcation, CycleFamily, bifurcations, cycle_family
from analysis.nonlinear.following import followed, locate, reach

Change = Literal["fold", "period-doubling"]
_AT: dict[Change, float] = {"fold": 1.0, "period-doubling": -1.0}

_BESIDE = 0.04
"""How much larger in rad the symmetric cycle is from which a run leaves."""

_PUSH = 1e-2
_PERIODS = 400
_SETTLED = 1e-5
"""Push of gamma in rad, periods to settle in, and change over one in rad that is small enough."""

_SYMMETRIC = 1e-4
"""Difference in rad of the largest deviations to both sides below which they are the same."""

_HALVINGS = 4

BEYOND: Array = np.concatenate(((0.005, 0.02), np.linspace(0.05, 1.3, 26)))
"""Amplitudes in rad beyond that of the bifurcation, to which the cycles are followed."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AsymmetricCycle(WholePeriod):
    """A cycle without mirror symmetry; gamma is largest at its first state.

    Parameters
    ----------
    amplitude, lowest : float
        Largest and least deviation of gamma from pi/2 in rad. The others are those of
        `WholePeriod`.
    """

    amplitude: float
    lowest: float

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
        Of the kind "symmetry-breaking", into stable cycles.
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
        If no cycle without symmetry settles.
    """
    if bifurcation.kind != "symmetry-breaking":
        raise ValueError(f"bifurcation must be symmetry-breaking, got {bifurcation.kind!r}")
    begin = bifurcation.cycle.amplitude
    wanted = real_array("amplitudes", begin + BEYOND if amplitudes is None else amplitudes)
    if wanted.ndim != 1 or not wanted.size or np.any(np.diff(wanted, prepend=begin) <= 0.0):
        raise ValueError(f"amplitudes must rise strictly beyond {begin:.6g}, got {amplitudes!r}")
    first = _settled(bifurcation)
    found: list[AsymmetricCycle] = []
    reason = None
    try:
        for cycle in followed(_solved, wanted, first, lambda each: each.amplitude, _HALVINGS):
            found.append(cycle)
            if progress is not None:
                progress(float(len(found)), float(wanted.size))
    except NoCycleError as error:
        reason = str(error)
    return AsymmetricFamily(bifurcation=bifurcation, cycles=tuple(found), reason=reason)


def first_asymmetric_family(
    family: CycleFamily, *, progress: Progress | None = None
) -> AsymmetricFamily:
    """Cycles without symmetry from the first place of a family where some settle.

    Parameters
    ----------
    family : CycleFamily
        Of symmetric cycles.
    progress : callable, optional
        As in `asymmetric_family`.

    Raises
    ------
    NoCycleError
        If no cycle of the family loses its symmetry, or none without it settles.
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
    return tuple(
        (kind, _located(first, last, value))
        for first, last in pairwise(branch)
        for kind, value in _AT.items()
        if (first.multiplier - value) * (last.multiplier - value) < 0.0
    )


def _located(first: AsymmetricCycle, last: AsymmetricCycle, value: float) -> AsymmetricCycle:
    return locate(
        lambda amplitude: reach(_solved, first.amplitude, amplitude, first, _HALVINGS),
        lambda each: each.multiplier - value,
        {first.amplitude: first, last.amplitude: last},
    )


def _solved(amplitude: float, start: AsymmetricCycle) -> AsymmetricCycle:

    def ends(first: Array, last: Array, _: Array) -> Array:
        return np.append((first[0], first[1] - amplitude), last - first)

    found = collocated_period(start, ends)
    highest, lowest = float(np.max(found.y[1])), float(np.min(found.y[1]))
    symmetric = highest + lowest < _SYMMETRIC
    if found.status != 0 or np.min(found.p) <= 0.0 or highest > amplitude + 1e-6 or symmetric:
        raise NoCycleError(f"no cycle without symmetry found at {amplitude:.9g} rad")
    return AsymmetricCycle(
        amplitude=amplitude, lowest=lowest, **period_values(start.scenario, found)
    )


def _settled(bifurcation: Bifurcation) -> AsymmetricCycle:
    """What a run settles to that starts on a symmetric cycle beyond the bifurcation, pushed."""
    near = bifurcation.cycle
    scenario = near.scenario
    cycle = cycle_family(scenario, (near.amplitude, near.amplitude + _BESIDE)).cycles[-1]
    state, highest = cycle.states[0] + np.array((0.0, _PUSH, 0.0)), np.inf
    for _ in range(_PERIODS):
        times, states = _swing(scenario, cycle.spin, state)
        state, before, highest = states[-1], highest, float(states[-1, 1]) - np.pi / 2
        if abs(highest - before) < _SETTLED:
            break
    else:
        raise NoCycleError(f"nothing settles beside {near.spin:.9g} rad/s")
    start = AsymmetricCycle(
        scenario=scenario,
        spin=cycle.spin,
        amplitude=highest,
        lowest=float(np.min(states[:, 1])) - np.pi / 2,
        period=float(times[-1]),
        times=times,
        states=states,
        multiplier=np.nan,
        log_strong=np.nan,
    )
    return _solved(highest, start)


def _swing(scenario: Scenario, spin: float, state: Array) -> tuple[Array, Array]:
    """Times, shape (n,), and states, (n, 3), from one largest gamma to the next."""

    def upright(_: float, x: Array) -> float:
        return float(x[0]) - np.pi / 2

    upright.direction = -1.0  # type: ignore[attr-defined]
    upright.terminal = True  # type: ignore[attr-defined]
    parts = []
    time = 0.0
    # A part of the period first, in which the disk leaves the event's place.
    for end, events in ((0.5 / spin * np.pi, None), (20.0, upright)):
        run = solve_ivp(
            reduced.right_hand_side(scenario, spin),
            (0.0, end),
            state,
            method="LSODA",
            rtol=1e-10,
            atol=1e-11,
            events=events,
        )
        parts.append((time + run.t, run.y.T))
        time, state = time + float(run.t[-1]), run.y[:, -1]
    times = np.append(parts[0][0][:-1], parts[1][0])
    return times, np.concatenate((parts[0][1][:-1], parts[1][1]))
