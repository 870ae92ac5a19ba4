"""What constraints leave free of a state, and how the rest follows from that.

Kinematics of the paper's coordinates alone: both sides start and step from it.
"""

from typing import Any

from analysis.data.body import Body
from analysis.data.constraint_set import ConstraintSet
from analysis.data.elementary import cos, sin

FOLLOWING = ("x", "y", "x_rate", "y_rate", "beta_rate", "gamma_rate")
"""Fields of a `Start` that constraints may demand, in the order of `demanded`."""


def independent_coordinates(constraints: ConstraintSet) -> tuple[str, ...]:
    """Fields of a `Start` that are free under constraints, the spin and alpha left out.

    Positions, and then the rates that the constraints leave; a start follows from them.

    Parameters
    ----------
    constraints : tuple of str
    """
    held, along, across = (
        name in constraints for name in ("fixed-cog", "no-slip-along", "no-slip-across")
    )
    free = {
        "x": not held,
        "y": not held,
        "beta": True,
        "gamma": True,
        "x_rate": not held and not along,
        "y_rate": not held and not across,
        "beta_rate": not (held and across),
        "gamma_rate": not (held and along),
    }
    return tuple(name for name, is_free in free.items() if is_free)


def demanded(
    constraints: ConstraintSet,
    disk: Body,
    angles: tuple[Any, Any, Any],
    free: tuple[Any, ...],
) -> tuple[Any, ...]:
    """The fields `FOLLOWING` as the constraints demand them, and as given where they do not.

    Parameters
    ----------
    constraints : tuple of str
    disk : Body
        One that further constraints than the contact hold is a round disk.
    angles : tuple of 3 numbers
        beta and gamma in rad, and the spin in rad/s.
    free : tuple of 6 numbers
        The fields as they would be without constraints.
    """
    beta, gamma, spin = angles
    x, y, x_rate, y_rate, beta_rate, gamma_rate = free
    r, e = disk.radius, disk.eccentricity
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    along, across = "no-slip-along" in constraints, "no-slip-across" in constraints
    if "fixed-cog" in constraints:
        if along:
            gamma_rate = -spin * cb
        if across:
            beta_rate = e * cg * (cb * gamma_rate + spin) / (sb * (r + e * sg))
        x, y = -e * cg, -e * cb * sg
        x_rate = e * sg * gamma_rate
        y_rate = e * (sb * sg * beta_rate - cb * cg * gamma_rate)
    else:
        if along:
            x_rate = -(r * cb - y) * spin - r * gamma_rate
        if across:
            y_rate = -x * spin - r * sb * beta_rate
    return x, y, x_rate, y_rate, beta_rate, gamma_rate
