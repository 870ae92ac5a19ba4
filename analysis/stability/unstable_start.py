"""Whether a scenario starts exactly on a stationary motion that is unstable."""

from dataclasses import replace
from math import cos, hypot, pi, sin

import numpy as np

from analysis.data.dissipation import Dissipation
from analysis.data.friction import ViscousFriction
from analysis.data.quantities import STEEPEST_FRICTION
from analysis.data.scenario import Scenario
from analysis.data.start import Start
from analysis.stability.linearisation import (
    ROUND_OFF,
    Linearisation,
    has_drift,
    spin_scale,
    upright,
)

_EXACT = 1e-12
"""Largest deviation that rounding makes, in radii, rad and sqrt(g / r)."""

_SLOWEST = 1e-4
"""Growth rate in sqrt(g / r) that counts; rounding may split zero eigenvalues by as much."""


def unstable_start(scenario: Scenario) -> str | None:
    """Say so if a scenario starts exactly on a stationary motion that is unstable.

    Such a run stays there until rounding has grown, and rounding decides when and to which side
    it leaves. On a penalty contact the stability is that of the same disk on the ideal one.

    Parameters
    ----------
    scenario : Scenario

    Returns
    -------
    str or None
        One line; None if the start is none of inverted or noninverted spinning, or a stable one,
        or that of another body than the paper's disk, of which nothing is known.
    """
    if not scenario.table.is_horizontal or not scenario.disk.is_plain:
        return None
    if not _is_stationary(scenario):
        return None
    spin, gamma = scenario.initial_state.rates[3], scenario.initial_state.coordinates[5]
    friction = scenario.friction
    if friction.is_simple:
        # Only its slope at no slip matters, and neither its kink nor its load.
        friction = ViscousFriction(viscosity=min(friction.gradient, STEEPEST_FRICTION))
    ideal = replace(
        scenario, friction=friction, contact=None, dissipation=Dissipation(), start=Start()
    )
    system = Linearisation(ideal, upright(ideal, gamma))
    values = np.linalg.eigvals(system.matrices(np.array([spin]))[0])
    growth = float(np.max(values.real))
    if growth <= _SLOWEST * system.frequency + ROUND_OFF * np.max(np.abs(values)):
        return None
    motion = "inverted" if sin(gamma) > 0.0 else "noninverted"
    if not scenario.disk.eccentricity:
        motion = "upright"
    return (
        f"start is exactly {motion} spinning, which is unstable at {spin:g} rad/s (deviations "
        f"grow with {growth:.3g} 1/s): rounding decides when and to which side the disk leaves it"
    )


def _is_stationary(scenario: Scenario) -> bool:
    """Whether the disk starts upright, in balance, and turns about the vertical at one place."""
    x, y, _, _, beta, gamma = scenario.initial_state.coordinates
    x_rate, y_rate, _, spin, beta_rate, gamma_rate = scenario.initial_state.rates
    disk, frequency = scenario.disk, spin_scale(scenario)
    free = has_drift(scenario.constraints)
    drifting = free * hypot(x_rate - spin * y, y_rate + spin * x) / (disk.radius * frequency)
    turning = max(abs(beta_rate), abs(gamma_rate)) / frequency
    aside = abs(disk.eccentricity * cos(gamma)) / disk.radius
    return max(abs(beta - pi / 2), aside, turning, drifting) <= _EXACT
