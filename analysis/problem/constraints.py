"""Constraints of the disk: the sets that make a model, and what they leave free of a state.

Kinematics of the paper's coordinates alone: both sides start and step from it.
"""

from collections.abc import Iterable
from contextlib import suppress
from itertools import combinations
from types import SimpleNamespace
from typing import Any

from analysis.problem.body import Body
from analysis.problem.checks import choice, several
from analysis.problem.elementary import cos, sin
from analysis.problem.names import ArgumentError, Named
from analysis.problem.quantities import CONSTRAINTS, HELD, Constraint, Level

_VELOCITIES = 6

_STUDIED = CONSTRAINTS[1:5]

ConstraintSet = tuple[Constraint, ...]
"""Distinct constraints in the order of `CONSTRAINTS`, as `constraint_set` makes them."""

MODELS: dict[Level, ConstraintSet] = Named(
    "MODELS",
    {
        1: ("contact",),
        2: ("contact", "fixed-cog"),
        3: ("contact", "fixed-cog", "no-slip-along"),
        4: ("contact", "fixed-cog", "no-slip-along", "constant-spin"),
    },
)
"""The paper's models, Table 2."""

DEMANDS = {name: demand for held in HELD.values() for name, demand in held.demands.items()}
"""What each constraint force keeps, by its name; see `Held`."""

MULTIPLIERS = tuple(DEMANDS)
"""Constraint forces in order, all in R-frame axes."""

PRESCRIBED = {name: held.rate for held in HELD.values() for name in held.demands if held.rate}
"""Constraint forces that do work, and the coordinate whose rate each keeps as it is. All others
hold velocities at zero."""


def constraint_set(constraints: Iterable[Constraint]) -> ConstraintSet:
    """Check a set of constraints and put it in order.

    Parameters
    ----------
    constraints : iterable of str
        Some of `CONSTRAINTS`, in any order.

    Raises
    ------
    ValueError
        If one is unknown or named twice, if the contact is missing, or if no freedom is left.
    """
    names = several("constraints", constraints, "names")
    given = [choice("constraints", each, CONSTRAINTS) for each in names]
    if twice := [each for each in given if given.count(each) > 1]:
        fault = f"must name each constraint once, got {twice[0]!r} twice"
        raise ArgumentError("constraints", fault)
    if "contact" not in given:
        raise ArgumentError(
            "constraints",
            "must hold 'contact': without it the disk falls freely and has no contact point to "
            f"slip or to rub, got {', '.join(given) or 'none'}",
        )
    ordered = tuple(each for each in CONSTRAINTS if each in given)
    count = len(multiplier_names(ordered))
    if count >= _VELOCITIES:
        raise ArgumentError(
            "constraints",
            f"must leave the disk a freedom: these are {count} conditions on its {_VELOCITIES} "
            "velocities, so that forces no longer matter; leave one out",
        )
    return ordered


def multiplier_names(constraints: ConstraintSet) -> tuple[str, ...]:
    """Names of the constraint forces of a set, in order.

    Examples
    --------
    >>> from analysis import MODELS, multiplier_names
    >>> multiplier_names(MODELS[3])
    ('normal_force', 'cog_force_x', 'cog_force_y', 'tangential_force')

    Raises
    ------
    ValueError
        If one is unknown.
    """
    with suppress(KeyError, TypeError):
        return tuple(name for each in constraints for name in HELD[each].demands)
    return multiplier_names(constraint_set(constraints))


POSSIBLE_SETS: tuple[ConstraintSet, ...] = tuple(
    constraint_set(("contact", *others))
    for count in range(len(_STUDIED))
    for others in combinations(_STUDIED, count)
)
"""Sets of the first five constraints that leave a freedom of motion, smaller ones first.

The studies go through all of them; sets that also hold the rate of the tilt are possible beside.
"""


def prescribed(constraints: ConstraintSet) -> dict[str, str]:
    """Constraint forces of a set that do work, and the coordinates whose rates they keep."""
    return {name: PRESCRIBED[name] for name in multiplier_names(constraints) if name in PRESCRIBED}


def model_of(constraints: ConstraintSet) -> Level | None:
    """Number of the paper's model with these constraints, if there is one."""
    return next((level for level, each in MODELS.items() if each == constraints), None)


def set_name(constraints: ConstraintSet) -> str:
    """What to call a set: "Model 3", or its constraints."""
    level = model_of(constraints)
    return " + ".join(constraints) if level is None else f"Model {level}"


FOLLOWING = ("x", "y", "x_rate", "y_rate", "beta_rate", "gamma_rate")
"""Fields of a `Start` that constraints may demand, in the order of `demanded`."""


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


def independent_coordinates(constraints: ConstraintSet) -> tuple[str, ...]:
    """Fields of a `Start` that are free under constraints, the spin and alpha left out.

    Positions, and then the rates that the constraints leave; a start follows from them.

    Parameters
    ----------
    constraints : tuple of str
    """
    # Any disk in any place tells; what is free comes back as the very object that it was.
    disk: Any = SimpleNamespace(radius=1.0, eccentricity=0.5)
    given = tuple(float(place) for place in range(len(FOLLOWING)))
    found = zip(FOLLOWING, given, demanded(constraints, disk, (1.0, 1.0, 1.0), given), strict=True)
    followed = [name for name, before, after in found if after is not before]
    names = ("x", "y", "beta", "gamma", *FOLLOWING[2:])
    return tuple(name for name in names if name not in followed)
