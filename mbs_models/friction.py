"""Laws of friction for the engine, in Python on plain floats.

They are written here a second time, independently of those of the in-house side.
"""

from collections.abc import Callable, Sequence
from math import cos, exp, hypot, sin, sqrt, tanh
from typing import Any

from analysis.problem.friction import (
    AnisotropicCoulomb,
    FrictionLaw,
    LubricatedCoulomb,
    PowerLawCoulomb,
    SmoothCoulomb,
    Stribeck,
    TanhCoulomb,
    ViscousFriction,
    asked,
)
from analysis.problem.scenario import Scenario

LawForce = Callable[[float, float, float], tuple[float, float]]
"""From slip along and across the edge in m/s and a load in N to the friction force in N."""


def law_force(law: FrictionLaw) -> LawForce:
    """Friction law for the engine; a law of the user's own is taken as it is."""
    written = _WRITTEN.get(type(law))
    return asked(law, "force") if written is None else written(law)


def _isotropic(resistance: Callable[[float, float], float]) -> LawForce:
    """Force against a slip from its size over the slip's, which follows from slip and load."""

    def force(along: float, across: float, load: float) -> tuple[float, float]:
        factor = -resistance(hypot(along, across), load)
        return factor * along, factor * across

    return force


def _smooth_coulomb(law: SmoothCoulomb) -> LawForce:
    coefficient, smoothing = law.coefficient, law.smoothing

    def force(along: float, across: float, load: float) -> tuple[float, float]:
        # The law that is asked most often: a further call would cost 2 % of a run.
        factor = -coefficient * load / (hypot(along, across) + smoothing)
        return factor * along, factor * across

    return force


def _stribeck(law: Stribeck) -> LawForce:
    kinetic, drop, smoothing = law.kinetic, law.static - law.kinetic, law.smoothing
    narrowness = 1.0 / law.stribeck_speed**2
    return _isotropic(
        lambda speed, load: (
            load * (kinetic + drop * exp(-narrowness * speed * speed)) / (smoothing + speed)
        )
    )


def _tanh(law: TanhCoulomb) -> LawForce:
    coefficient, smoothing = law.coefficient, law.smoothing
    gradient = coefficient / smoothing
    # Below a ten-thousandth of the smoothing, (x/s)^2 / 3 is all that tanh bends.
    return _isotropic(
        lambda speed, load: (
            load * coefficient * tanh(speed / smoothing) / speed
            if speed > 1e-4 * smoothing
            else load * (gradient - gradient * (speed / smoothing) ** 2 / 3.0)
        )
    )


def _viscous(law: ViscousFriction) -> LawForce:
    viscosity = law.viscosity
    return _isotropic(lambda _speed, load: load * viscosity)


def _power_law(law: PowerLawCoulomb) -> LawForce:
    # The load under the reference one and both constants make one number.
    exponent, smoothing = law.exponent, law.smoothing
    constant = law.coefficient * law.reference_load ** (1.0 - exponent)
    return _isotropic(lambda speed, load: constant * load**exponent / (speed + smoothing))


def _lubricated(law: LubricatedCoulomb) -> LawForce:
    coefficient, smoothing, film = law.coefficient, law.smoothing, law.film
    return _isotropic(lambda speed, load: film + coefficient * load / (speed + smoothing))


def _anisotropic(law: AnisotropicCoulomb) -> LawForce:
    # Over the larger coefficient, the smaller one is a flattening.
    largest, smoothing = max(law.along, law.across), law.smoothing
    flat_x, flat_y = (law.along / largest) ** 2, (law.across / largest) ** 2

    def force(along: float, across: float, load: float) -> tuple[float, float]:
        x, y = flat_x * along, flat_y * across
        factor = -largest * load / (sqrt(x * along + y * across) + smoothing)
        return factor * x, factor * y

    return force


_WRITTEN: dict[type[FrictionLaw], Callable[[Any], LawForce]] = {
    SmoothCoulomb: _smooth_coulomb,
    Stribeck: _stribeck,
    TanhCoulomb: _tanh,
    ViscousFriction: _viscous,
    AnisotropicCoulomb: _anisotropic,
    PowerLawCoulomb: _power_law,
    LubricatedCoulomb: _lubricated,
}
"""Laws written a second time. What derives from one of them may differ, so it is not of it."""


def free_slip_force(scenario: Scenario, part: float) -> LawForce:
    """The scenario's friction law without the slip that its constraints hold at zero.

    Parameters
    ----------
    scenario : Scenario
    part : float
        Of a slip at which the law is asked, for as large a part of the force: of a law that is
        asked for a tiny one, only the slope at no slip is left.
    """
    law = whole = law_force(scenario.friction)
    if part != 1.0:

        def law(along: float, across: float, load: float) -> tuple[float, float]:
            x, y = whole(part * along, part * across, load)
            return x / part, y / part

    if "no-slip-along" in scenario.constraints:
        return lambda _, across, load: (0.0, law(0.0, across, load)[1])
    if "no-slip-across" in scenario.constraints:
        return lambda along, _, load: (law(along, 0.0, load)[0], 0.0)
    return law


def slip_velocity(
    radius: float, coordinates: Sequence[float], rates: Sequence[float]
) -> tuple[float, float]:
    """Slip along and across the edge in m/s, in co-rotating coordinates."""
    x, y, _, _, beta, _ = coordinates
    x_rate, y_rate, _, spin, beta_rate, gamma_rate = rates
    along = x_rate + (radius * cos(beta) - y) * spin + radius * gamma_rate
    return along, y_rate + x * spin + radius * sin(beta) * beta_rate
