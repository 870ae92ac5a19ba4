"""The family of cycles, continued in its amplitude from the Hopf point."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from analysis.data.checks import Array, number, real_array
from analysis.data.scenario import Scenario
from analysis.data.watch import Progress
from analysis.nonlinear.collocation import (
    Mesh,
    NoCycleError,
    hopf_mesh,
    require_collocation,
    solve,
)
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.following import locate, reach
from analysis.nonlinear.heteroclinic import NoConnectionError, last_amplitude
from analysis.stability.linear_reduced import CriticalSpeed, critical_speed

AMPLITUDES: Array = np.concatenate(
    (np.linspace(0.1, 3.0, 30), np.pi - np.geomspace(0.1, 1e-6, 16))
)
"""Amplitudes in rad from near the Hopf point to near the end of the family at pi.

About a saddle-focus it ends beyond pi; see `_amplitudes`.
"""

_SAME_END = 1e-6
"""Distance in rad from the connection at which a family ends."""

_HALVINGS = 5
"""How often a step in amplitude that fails is halved before the family ends there."""

BifurcationKind = Literal["fold", "symmetry-breaking"]

_CROSSINGS: dict[BifurcationKind, float] = {"fold": 1.0, "symmetry-breaking": -1.0}
"""There are no others: the multipliers over half a period are real; see `Cycle`."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CycleFamily:
    """Cycles by rising amplitude.

    Parameters
    ----------
    scenario : Scenario
    hopf : CriticalSpeed
        Where the family begins.
    cycles : tuple of Cycle
        All of them converged.
    reason : str or None
        Why it ends before the last amplitude asked for, if it does.
    """

    scenario: Scenario
    hopf: CriticalSpeed
    cycles: tuple[Cycle, ...]
    reason: str | None = None

    def values(self, name: str) -> Array:
        """Attribute `name` of all cycles, shape (n,)."""
        return np.array([getattr(cycle, name) for cycle in self.cycles], dtype=float)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bifurcation:
    """A place on a family of cycles where their stability changes.

    Parameters
    ----------
    kind : {"fold", "symmetry-breaking"}
        By the multiplier over half a period that passes the unit circle: at 1, or at -1, where
        two cycles branch off that are not their own mirror images.
    cycle : Cycle
        The one there.
    """

    kind: BifurcationKind
    cycle: Cycle


def cycle_family(
    scenario: Scenario,
    amplitudes: npt.ArrayLike | None = None,
    *,
    progress: Progress | None = None,
) -> CycleFamily:
    """Follow the periodic motions of the reduced system from the Hopf point.

    Parameters
    ----------
    scenario : Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity.
    amplitudes : array_like, shape (n,), optional
        Amplitudes of gamma about pi/2 in rad, rising, between 0 and 3 pi/2; by default up to
        the heteroclinic connection, which lies at pi or, about a saddle-focus, beyond.
    progress : callable, optional
        Called after each cycle with its amplitude and the last one wanted, in rad.

    Raises
    ------
    ValueError
        If the amplitudes are no such, or the scenario has no cycles.
    NoCycleError
        If not even the first cycle is found.
    """
    require_collocation(scenario)
    wanted = _amplitudes(scenario) if amplitudes is None else amplitudes
    cycles: list[Cycle] = []
    reason = None
    try:
        for cycle in _followed(scenario, wanted):
            cycles.append(cycle)
            if progress is not None:
                progress(cycle.amplitude, float(np.max(wanted)))
    except NoCycleError as error:
        if not cycles:
            raise
        reason = str(error)
    hopf = critical_speed(scenario)
    return CycleFamily(scenario=scenario, hopf=hopf, cycles=tuple(cycles), reason=reason)


def _amplitudes(scenario: Scenario) -> Array:
    """`AMPLITUDES`, but beyond 3 rad closing in on that of the connection."""
    try:
        last = last_amplitude(scenario)
    except NoConnectionError:
        return np.array(AMPLITUDES)
    beyond = last - np.pi
    if beyond < _SAME_END:
        return np.array(AMPLITUDES)
    near = last - np.geomspace(0.1 + beyond, _SAME_END, 16)
    return np.concatenate((AMPLITUDES[near[0] - 0.05 > AMPLITUDES], near))


def _followed(scenario: Scenario, amplitudes: npt.ArrayLike) -> Iterator[Cycle]:
    """Cycles one by one; `NoCycleError` names the last good one."""
    wanted = real_array("amplitudes", amplitudes)
    proper = wanted.ndim == 1 and wanted.size and np.all(np.diff(wanted, prepend=0.0) > 0.0)
    if not proper or wanted[-1] >= 1.5 * np.pi:
        raise ValueError(f"amplitudes must rise strictly between 0 and 3 pi/2, got {amplitudes!r}")
    last: Cycle | None = None
    for amplitude in wanted.tolist():
        try:
            last = _reach(scenario, amplitude, last)
        except NoCycleError as error:
            if last is None:
                raise
            raise NoCycleError(
                f"{error}; the last good one has {last.amplitude:.9g} rad at a spin of "
                f"{last.spin:.9g} rad/s"
            ) from error
        yield last


def _reach(scenario: Scenario, amplitude: float, start: Cycle | None) -> Cycle:
    """The cycle of an amplitude, followed from another one or from the Hopf point."""

    def solved(wanted: float, near: Cycle | None) -> Cycle:
        mesh = hopf_mesh(scenario) if near is None else Mesh.of(near)
        return solve(scenario, wanted, mesh)

    begin = 0.0 if start is None else start.amplitude
    return reach(solved, begin, amplitude, start, _HALVINGS)


def cycle_at(scenario: Scenario, spin: float) -> Cycle:
    """The cycle at a spin: that of smallest amplitude if there are several.

    Parameters
    ----------
    scenario : Scenario
    spin : float
        In rad/s.

    Raises
    ------
    ValueError
        If the scenario has no cycles, or none at this spin.
    NoCycleError
        If the iteration fails.
    """
    require_collocation(scenario)
    spin, hopf = number("spin", spin), critical_speed(scenario).spin
    spins = [hopf]
    before: Cycle | None = None
    for last in _followed(scenario, _amplitudes(scenario)):
        if (last.spin - spin) * (spins[-1] - spin) <= 0.0 and spin != hopf:
            return _between(scenario, spin, before, last)
        spins.append(last.spin)
        before = last
    raise ValueError(
        f"spin must lie between {min(spins):.9g} and {max(spins):.9g} rad/s, where there are "
        f"cycles, got {spin:.9g}"
    )


def _between(scenario: Scenario, spin: float, first: Cycle | None, last: Cycle) -> Cycle:
    # Squares of the amplitude go nearly straight with the spin, also at the Hopf point.
    found = {last.amplitude**2: last} | ({} if first is None else {first.amplitude**2: first})

    def miss(square: float) -> float:
        if square == 0.0:
            return critical_speed(scenario).spin - spin
        if square not in found:
            found[square] = _reach(scenario, float(np.sqrt(square)), first)
        return found[square].spin - spin

    low = 0.0 if first is None else first.amplitude**2
    brentq(miss, low, last.amplitude**2, xtol=1e-13, rtol=1e-13)
    return min(found.values(), key=lambda cycle: abs(cycle.spin - spin))


def bifurcations(family: CycleFamily) -> tuple[Bifurcation, ...]:
    """Find where the stability changes along a family, between its neighbouring cycles.

    Raises
    ------
    NoCycleError
        If an iteration between two of its cycles fails.
    """
    return tuple(
        _located(family.scenario, kind, first, last)
        for first, last in pairwise(family.cycles)
        for kind in _CROSSINGS
        if _test(first, kind) * _test(last, kind) < 0.0
    )


def _located(scenario: Scenario, kind: BifurcationKind, first: Cycle, last: Cycle) -> Bifurcation:
    cycle = locate(
        lambda amplitude: _reach(scenario, amplitude, first),
        lambda each: _test(each, kind),
        {first.amplitude: first, last.amplitude: last},
    )
    return Bifurcation(kind=kind, cycle=cycle)


def _test(cycle: Cycle, kind: BifurcationKind) -> float:
    """Characteristic polynomial of the mirrored half period, which changes sign there."""
    weak, strong = cycle.half_multiplier, cycle.strong_half_multiplier
    return (weak - _CROSSINGS[kind]) * (strong - _CROSSINGS[kind])
