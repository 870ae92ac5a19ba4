"""The contact force where friction knows it, but not in proportion."""

from typing import Any

import numpy as np
from scipy.optimize import brentq

from analysis.data.friction import FrictionLaw
from analysis.mechanics.dual import Dual, dual, plain

_PLACES = (0.0, *np.logspace(-4.0, 4.0, 33).tolist())
"""Loads over the normal force without friction, between which solutions are told apart."""


def any_contact_load(law: FrictionLaw, *given: Any) -> Any:
    """Load in N that friction acts with, which itself changes the normal force.

    The normal force N is that without friction, and what the friction under the load max(0, N)
    adds to it.

    Parameters
    ----------
    law : FrictionLaw
        Of any kind.
    *given : 5 float or Dual
        Normal force in N without friction; what each newton of friction along the edge and across
        it adds to it; slip velocities along and across in m/s.

    Raises
    ------
    ArithmeticError
        If there is no solution, or several.
    """
    alone, per_along, per_across, along, across = given
    force, by_along, by_across, slip_x, slip_y = map(plain, given)

    def missing(load: float) -> float:
        x, y = law.force(slip_x, slip_y, load)
        return float(load - (force + by_along * x + by_across * y))

    size = abs(force) or 1.0
    loads = [size * place for place in _PLACES]
    misses = [missing(load) for load in loads]
    # With no load the normal force need not be zero, but may pull.
    found = [0.0] * (misses[0] >= 0.0)
    for low, high, first, last in zip(loads, loads[1:], misses, misses[1:], strict=False):
        if (first < 0.0) != (last < 0.0):
            found.append(brentq(missing, low, high, xtol=1e-15 * size, rtol=1e-14))
    if len(found) != 1:
        told = ", ".join(f"{each:.6g} N" for each in found) or "none"
        raise ArithmeticError(
            f"friction under the contact force has {len(found)} solutions for it: {told}"
        )
    (load,) = found
    if load == 0.0 or not any(isinstance(each, Dual) for each in given):
        return load
    # One step of Newton's from the value is exact for its derivative.
    x, y = law.force(along, across, load)
    change = dual(alone + per_along * x + per_across * y).change
    x, y = law.force(slip_x, slip_y, Dual(load, 1.0))
    feedback = dual(by_along * x + by_across * y).change
    return Dual(load, change / (1.0 - feedback))
