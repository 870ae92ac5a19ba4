"""Symmetric cycles over any parameter of the scenario: friction, disk, gravity."""

from collections.abc import Sequence
from contextlib import suppress
from itertools import chain

import numpy as np

from analysis.data.checks import number
from analysis.data.scenario import Scenario
from analysis.nonlinear.collocation import NoCycleError, require_collocation, solve
from analysis.nonlinear.families import cycle_at, cycle_family
from analysis.nonlinear.flow import open_amplitude
from analysis.nonlinear.following import Family, followed
from analysis.nonlinear.motions import PeriodicMotion
from analysis.stability.printed import critical_speed


def cycles_over(
    scenarios: Sequence[Scenario], *, amplitude: float | None = None, spin: float | None = None
) -> Family:
    """Follow a symmetric cycle through scenarios, at a given amplitude or a given spin.

    Every cycle starts from that of the scenario before; where that fails, from the Hopf point of
    its own.

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
    >>> [round(cycle.spin, 3) for cycle in found.motions]
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

    def first(scenario: Scenario) -> PeriodicMotion:
        if spin is not None:
            return cycle_at(scenario, spin)
        return cycle_family(scenario, np.array([amplitude])).motions[-1]

    def further(scenario: Scenario, last: PeriodicMotion) -> PeriodicMotion:
        with suppress(NoCycleError):
            return solve(scenario, amplitude or last.value, last, spin=spin)
        try:
            return first(scenario)
        except ValueError as error:
            raise NoCycleError(str(error)) from error

    begin = first(scenarios[0])
    found = chain([begin], followed(further, begin, scenarios[1:]))
    return Family.of(critical_speed(scenarios[0]).spin, found)
