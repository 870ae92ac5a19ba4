"""Cycles continued in any parameter of the scenario: friction, disk, gravity.

Held is either the amplitude, and the spin is found, or the spin, and the amplitude is found. Every
cycle starts from that of the scenario before; where that fails, from the Hopf point of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.data.checks import number
from analysis.data.scenario import Scenario
from analysis.nonlinear.collocation import NoCycleError, require_collocation, solve
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import cycle_at, cycle_family
from analysis.nonlinear.flow import open_amplitude


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CyclesOver:
    """Cycles of a sequence of scenarios.

    Parameters
    ----------
    cycles : tuple of Cycle
        One for each scenario up to the last that has one; each holds its scenario.
    reason : str or None
        Why they end before the last scenario, if they do; it names the last good cycle.
    """

    cycles: tuple[Cycle, ...]
    reason: str | None = None


def cycles_over(
    scenarios: Sequence[Scenario], *, amplitude: float | None = None, spin: float | None = None
) -> CyclesOver:
    """Follow a cycle through scenarios, at a given amplitude or a given spin.

    Parameters
    ----------
    scenarios : sequence of Scenario
        Of Model 4 with friction that knows the weight, and an eccentricity; each near the one
        before.
    amplitude : float, optional
        Of gamma about pi/2 in rad, between 0 and pi.
    spin : float, optional
        In rad/s; either this or the amplitude.

    Raises
    ------
    ValueError
        If there are no scenarios, one has no cycles at all, not one of the two is given, or the
        first scenario has no cycle there.
    NoCycleError
        If the first cycle is not found.

    Examples
    --------
    >>> from analysis import MODELS, Scenario, SmoothCoulomb
    >>> laws = [SmoothCoulomb(coefficient=mu) for mu in (0.2, 0.4)]
    >>> scenarios = [Scenario(constraints=MODELS[4], friction=law) for law in laws]
    >>> found = cycles_over(scenarios, amplitude=1.0)
    >>> [round(cycle.spin, 3) for cycle in found.cycles]
    [30.696, 30.7]
    """
    if not scenarios:
        raise ValueError("scenarios must be 1 or more, got 0")
    if (amplitude is None) == (spin is None):
        raise ValueError(f"amplitude or spin must be given, got {amplitude} and {spin}")
    for scenario in scenarios:
        require_collocation(scenario)
    amplitude = None if amplitude is None else open_amplitude(amplitude)
    spin = None if spin is None else number("spin", spin)
    cycles: list[Cycle] = []
    for scenario in scenarios:
        try:
            cycles.append(_next(scenario, amplitude, spin, cycles))
        except (NoCycleError, ValueError) as error:
            if not cycles:
                raise
            last = cycles[-1]
            reason = (
                f"{error}; the last good one is cycle {len(cycles)} of {len(scenarios)}, with "
                f"{last.amplitude:.9g} rad at a spin of {last.spin:.9g} rad/s"
            )
            return CyclesOver(cycles=tuple(cycles), reason=reason)
    return CyclesOver(cycles=tuple(cycles))


def _next(
    scenario: Scenario, amplitude: float | None, spin: float | None, before: Sequence[Cycle]
) -> Cycle:
    if before:
        try:
            return solve(scenario, amplitude or before[-1].amplitude, before[-1], spin=spin)
        except NoCycleError:
            pass
    if spin is not None:
        return cycle_at(scenario, spin)
    return cycle_family(scenario, np.array([amplitude])).cycles[-1]
