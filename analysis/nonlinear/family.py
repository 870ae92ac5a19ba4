"""The family of cycles, continued in its amplitude from the Hopf point."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from analysis.data.checks import Array, number, real_array
from analysis.data.scenario import Scenario
from analysis.data.watch import Progress
from analysis.nonlinear.collocation import NoCycleError, hopf_cycle, require_collocation, solve
from analysis.nonlinear.cycle import Cycle, characteristics
from analysis.nonlinear.heteroclinic import NoConnectionError, last_amplitude
from analysis.stability.continuation import Solve, followed, gathered, sign_changes
from analysis.stability.linear_reduced import CriticalSpeed, critical_speed

AMPLITUDES: Array = np.concatenate(
    (np.linspace(0.1, 3.0, 30), np.pi - np.geomspace(0.1, 1e-6, 16))
)
"""Amplitudes in rad from near the Hopf point to near the end of the family at pi.

About a saddle-focus it ends beyond pi; see `_amplitudes`.
"""

_SAME_END = 1e-6
"""Distance in rad from the connection at which a family ends."""

BifurcationKind = Literal["fold", "symmetry-breaking"]

_MULTIPLIERS: dict[BifurcationKind, float] = {"fold": 1.0, "symmetry-breaking": -1.0}
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

    def amplitude(count: float, _: float) -> None:
        if progress is not None:
            progress(float(np.ravel(wanted)[round(count) - 1]), float(np.max(wanted)))

    found = _from_hopf_point(scenario, wanted)
    cycles, reason = gathered(found, progress=amplitude, wanted=np.size(wanted))
    if not cycles:
        raise NoCycleError(reason)
    hopf = critical_speed(scenario)
    return CycleFamily(scenario=scenario, hopf=hopf, cycles=cycles, reason=reason)


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


def _from_hopf_point(scenario: Scenario, amplitudes: npt.ArrayLike) -> Iterator[Cycle]:
    """Cycles one by one; `NoCycleError` names the last good one."""
    wanted = real_array("amplitudes", amplitudes)
    proper = wanted.ndim == 1 and wanted.size and np.all(np.diff(wanted, prepend=0.0) > 0.0)
    if not proper or wanted[-1] >= 1.5 * np.pi:
        raise ValueError(f"amplitudes must rise strictly between 0 and 3 pi/2, got {amplitudes!r}")
    return followed(_of_amplitude(scenario), hopf_cycle(scenario), wanted.tolist())


def _of_amplitude(scenario: Scenario) -> Solve[Cycle]:
    return lambda amplitude, near: solve(scenario, amplitude, near)


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
    spin = number("spin", spin)
    before = hopf_cycle(scenario)
    spins = [before.spin]
    for cycle in _from_hopf_point(scenario, _amplitudes(scenario)):
        part = (spin - before.spin) / (cycle.spin - before.spin)
        if 0.0 < part <= 1.0:
            # Squares of the amplitude go nearly straight with the spin, also at the Hopf point.
            low, high = before.amplitude**2, cycle.amplitude**2
            amplitude = float(np.sqrt(low + part * (high - low)))
            return solve(scenario, amplitude, cycle, spin=spin)
        spins.append(cycle.spin)
        before = cycle
    raise ValueError(
        f"spin must lie between {min(spins):.9g} and {max(spins):.9g} rad/s, where there are "
        f"cycles, got {spin:.9g}"
    )


def bifurcations(family: CycleFamily) -> tuple[Bifurcation, ...]:
    """Find where the stability changes along a family, between its neighbouring cycles.

    Raises
    ------
    NoCycleError
        If an iteration between two of its cycles fails.
    """
    tests = characteristics(_MULTIPLIERS)
    found = sign_changes(_of_amplitude(family.scenario), family.cycles, tests)
    return tuple(Bifurcation(kind=kind, cycle=cycle) for kind, cycle in found)
