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
from analysis.models import reduced
from analysis.nonlinear.collocation import NoCycleError, collocated_period, period_values
from analysis.nonlinear.cycle import WholePeriod
from analysis.nonlinear.family import Bifurcation, cycle_family
from analysis.nonlinear.following import locate, reach

Change = Literal["fold", "period-doubling"]
_AT: dict[Change, float] = {"fold": 1.0, "period-doubling": -1.0}

_BESIDE = 0.04
"""How much larger in rad the symmetric cycle is from which a run leaves."""

_PUSH = 1e-2
_PERIODS = 400
_SETTLED = 1e-5
"""Push of gamma in rad, periods to settle in, and change over one in rad that is small enough."""

_HALVINGS = 4


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


def asymmetric_branch(
    bifurcation: Bifurcation, amplitudes: npt.ArrayLike
) -> tuple[AsymmetricCycle, ...]:
    """Follow the cycles that branch off where symmetric ones lose their symmetry.

    Parameters
    ----------
    bifurcation : Bifurcation
        Of the kind "symmetry-breaking", into stable cycles.
    amplitudes : array_like, shape (n,)
        Largest deviations of gamma in rad, rising, beyond that of the bifurcation.

    Raises
    ------
    ValueError
        If the bifurcation is another one, or the amplitudes are no such.
    NoCycleError
        If no cycle without symmetry settles, or an iteration fails; the message names the last
        good one.
    """
    if bifurcation.kind != "symmetry-breaking":
        raise ValueError(f"bifurcation must be symmetry-breaking, got {bifurcation.kind!r}")
    wanted = real_array("amplitudes", amplitudes)
    begin = bifurcation.cycle.amplitude
    if wanted.ndim != 1 or not wanted.size or np.any(np.diff(wanted, prepend=begin) <= 0.0):
        raise ValueError(f"amplitudes must rise strictly beyond {begin:.6g}, got {amplitudes!r}")
    last = _settled(bifurcation)
    found: list[AsymmetricCycle] = []
    for amplitude in wanted.tolist():
        try:
            last = reach(_solved, last.amplitude, amplitude, last, _HALVINGS)
        except NoCycleError as error:
            raise NoCycleError(
                f"{error}; the last good one has {last.amplitude:.9g} rad at a spin of "
                f"{last.spin:.9g} rad/s"
            ) from error
        found.append(last)
    return tuple(found)


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
    if found.status != 0 or np.min(found.p) <= 0.0 or highest > amplitude + 1e-6:
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
    found = _solved(highest, start)
    if found.amplitude + found.lowest < _PUSH:
        raise NoCycleError(f"a run beside {near.spin:.9g} rad/s settles to a symmetric cycle")
    return found


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
            lambda _, x: reduced.right_hand_side(scenario, spin, x.tolist()),
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
