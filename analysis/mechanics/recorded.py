"""The equations as code: recorded once for each structure, run on numbers of any kind."""

from collections.abc import Callable
from functools import lru_cache, partial
from itertools import chain
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from analysis.mechanics.attitude import EulerAngles, paper_of, state_of
from analysis.mechanics.dual import (
    Dual,
    Functions,
    derivatives,
    dual,
    of_duals,
    of_floats,
    rate,
    value_of,
)
from analysis.mechanics.newton_euler import Friction, Structure, derivative
from analysis.mechanics.penalty import Solver, free_solver, friction_of
from analysis.mechanics.recorder import Recorder, call
from analysis.problem.bodies import noting
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.constraints import multiplier_names
from analysis.problem.elementary import Numbers
from analysis.problem.friction import FrictionLaw, LawError, asked
from analysis.problem.limits import CONTACT_JAMS, JAMMING
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES

_PLACES = (*np.logspace(0.0, 4.0, 129).tolist(), *np.logspace(8.0, 32.0, 7).tolist())
"""Loads over the normal force under no load, up to the first of which the load is looked for that
is large enough: the least is, unless two lie between neighbours. Friction may be strong, or all
forces tiny."""

_TINIEST, _MOST = float(np.finfo(float).tiny), 5000
"""Width in N of a bracket that a contact force stays in, and steps in which it is reached."""


def any_contact_force(friction: Friction, *given: Any) -> Any:
    """Normal force in N, under which as its load friction itself changes it.

    It is that without friction, and what the friction under it adds. Of several solutions it is
    the least: the one that there is without friction, as that sets in. Where the contact pulls
    under no load, it rubs under none.

    Parameters
    ----------
    friction : callable
        Any law's; see `Friction`.
    *given : 5 float or Dual
        Normal force in N without friction; what each newton of friction along the edge and across
        it adds to it; slip velocities along and across in m/s.

    Raises
    ------
    ArithmeticError
        If there is no solution.
    """
    alone, per_along, per_across, along, across = given
    force, by_along, by_across, slip_x, slip_y = map(value_of, given)

    def missing(load: float) -> float:
        x, y = friction(slip_x, slip_y, load)
        return float(load - (force + by_along * x + by_across * y))

    pressing, low = -missing(0.0), 0.0
    if pressing <= 0.0:
        # Whatever other load there is that friction would call for by itself.
        x, y = friction(along, across, 0.0)
        return alone + per_along * x + per_across * y
    for high in (pressing * place for place in _PLACES):
        if missing(high) >= 0.0:
            break
        low = high
    else:
        raise ArithmeticError(
            f"no contact force up to {low:.3g} N is what friction under it calls for"
        )
    # Friction that goes with a small power of the load is strong under next to none.
    load = float(brentq(missing, low, high, xtol=_TINIEST, rtol=1e-14, maxiter=_MOST))
    if not any(isinstance(each, Dual) for each in given):
        return load
    # One step of Newton's from the value is exact for its derivative.
    x, y = friction(along, across, load)
    change = dual(alone + per_along * x + per_across * y).change
    x, y = friction(slip_x, slip_y, Dual(load, 1.0))
    feedback = dual(by_along * x + by_across * y).change
    return Dual(load, change / (1.0 - feedback))


STATE = (*COORDINATES, *(f"{name}_rate" for name in COORDINATES))
"""Names of the numbers of a state; the position is that of the centre of gravity."""

NUMBERS = (
    *("mass", "radius", "eccentricity"),
    *(f"inertia_{axis}" for axis in ("x", "y", "z", "xy", "xz", "yz")),
    *(f"gravity_{axis}" for axis in "xyz"),
)
"""Names of what code is bound to: the disk, with its inertia about S, and gravity on the table;
behind them stands the `SURFACE` of a body that has one."""


def numbers(scenario: Any) -> tuple[Any, ...]:
    """Those of `NUMBERS` of a scenario, or of `Members`, and of the surface."""
    disk = scenario.disk
    inertia = *disk.inertia_about_cog, *disk.products
    surface = (getattr(disk, name) for name in disk.SURFACE or ())
    return disk.mass, disk.radius, disk.eccentricity, *inertia, *scenario.table.vector, *surface


def disk_of(values: Numbers, body: type[Body] | Body | None = None) -> Any:
    """A round disk of the first ones of `NUMBERS`, of any kind, or one with another surface.

    Parameters
    ----------
    values : 9 numbers or more
        All of them, and those of the surface, for a class of bodies.
    body : type or Body, optional
        That has the surface.
    """
    mass, radius, eccentricity, a, b, c, *products = values[:9]
    lowest_point = body and body.lowest_point
    if isinstance(body, type):
        surface = dict(zip(body.SURFACE or (), values[len(NUMBERS) :], strict=True))
        one_like: Any = SimpleNamespace(**{"radius": radius} | surface)
        lowest_point = partial(body.lowest_point, one_like)
    return SimpleNamespace(
        is_round_disk=body is None,
        lowest_point=lowest_point,
        mass=mass,
        radius=radius,
        eccentricity=eccentricity,
        inertia_about_cog=(a, b, c),
        products=tuple(products),
    )


@lru_cache(maxsize=256)
def formula(structure: Structure) -> Callable[..., Callable[..., tuple[Any, ...]]]:
    """Code of `recording`.

    Returns
    -------
    callable
        From `numbers` and, by keyword, `speed`, `per_speed`, `force` and `contact_load` of these
        kinds of numbers, to a function of the 12 numbers of a state; that one returns the results.
    """
    recorder, results = recording(structure)
    return recorder.code(results)


def recording(structure: Structure) -> tuple[Recorder, list[Any]]:
    """Symbols of `newton_euler.derivative`.

    Returns
    -------
    recorder : Recorder
        With `NUMBERS` as constants and `STATE` as variables.
    results : list
        The derivative and the multipliers, 12 + n, and the slips along and across the edge that
        friction acts on.
    """
    kind = structure.body
    surface = kind.SURFACE or () if isinstance(kind, type) else ()
    # Its fields may have the names of others, such as beta, or of what code calls its own.
    recorder = Recorder((*NUMBERS, *(f"surface_{name}" for name in surface)), STATE)
    along, across, down = recorder.constants[9 : len(NUMBERS)]
    disk = disk_of(recorder.constants, kind)
    if not structure.products:
        # Zeros take no time in what is recorded.
        disk.products = (0.0, 0.0, 0.0)
    with noting(kind):
        results = derivative(
            structure,
            disk,
            recorder.variables,
            gravity=(0.0, 0.0, down) if structure.horizontal else (along, across, down),
            friction=friction_of(is_simple=structure.law.force is FrictionLaw.force),
            contact_load=partial(call, "contact_load"),
        )
    return recorder, [*chain(*results)]


def solver(
    scenario: Scenario, functions: Callable[[FrictionLaw], Functions] = of_floats
) -> Solver:
    """Function that gives what `recording` tells at one state after the other.

    An ideal contact that pulls (negative normal force) is no load: friction never gives energy.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact, or a penalty contact, whose force stands for the multipliers, and
        behind which stands what `free_solver` gives.
    functions : callable
        `of_floats` or `of_duals`, for states of that kind.

    Returns
    -------
    callable
        It raises `ArithmeticError` where `accelerations` does.
    """
    law = scenario.friction
    if scenario.contact is not None:
        return free_solver(scenario, EulerAngles, functions(law))
    ask = asked(law, "force")
    contact_load = _contact_load if law.IS_PROPORTIONAL else partial(any_contact_force, ask)

    def force(along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        return ask(along, across, max(0.0, load))

    code = formula(Structure.of(scenario))(
        *numbers(scenario), force=force, contact_load=contact_load, **functions(law)
    )

    def solve(*state: Any) -> tuple[Any, ...]:
        try:
            return code(*state)
        except LawError:
            raise
        except ArithmeticError as error:
            cause = "" if isinstance(error, ZeroDivisionError) else f": {error}"
            angles = [value_of(each) for each in state[3:6]]
            raise ArithmeticError(
                f"singular index-1 system of {scenario.name} at alpha, beta, gamma = {angles}"
                + cause
            ) from error

    return solve


def jacobian(scenario: Scenario) -> Callable[[Array], Array]:
    """Function that gives the Jacobian of the time derivative at one state after the other.

    It is exact, see `of_duals`.

    Parameters
    ----------
    scenario : Scenario

    Returns
    -------
    callable
        From a state, shape (12,), to the derivatives, shape (12, 12). It raises `ArithmeticError`
        where `accelerations` does.
    """
    solve = solver(scenario, functions=of_duals)
    return lambda state: derivatives(lambda moving: solve(*moving)[:12], state)


def _contact_load(alone: Any, added: Any) -> Any:
    """Normal force in N that friction takes as its load, from that without friction."""
    more, force = value_of(added), value_of(alone)
    if more > JAMMING:
        raise ArithmeticError(
            f"{CONTACT_JAMS}, where each newton of normal force calls for {more:.3g} N of it "
            "through friction"
        )
    return alone / (1.0 - added) if force > 0.0 else 0.0


def accelerations(scenario: Scenario, coordinates: Numbers, rates: Numbers) -> tuple[Array, Array]:
    """Accelerations and multipliers with all constraints on acceleration level, at one state.

    Parameters
    ----------
    scenario : Scenario
    coordinates, rates : array_like, shape (6,)
        Co-rotating coordinates and their rates, which meet the constraints.

    Returns
    -------
    accelerations : ndarray, shape (6,)
        Second derivatives of the coordinates.
    multipliers : ndarray, shape (n,)
        Constraint forces in the order of `multiplier_names(scenario.constraints)`.

    Raises
    ------
    ArithmeticError
        If the system is singular, or if the friction of each newton of normal force calls for a
        newton more of it: Eq. (79) then has no solution, or two.
    """
    disk = scenario.disk
    state = state_of(disk, [*map(float, coordinates)], [*map(float, rates)])
    found = solver(scenario)(*state)
    change = rate(lambda moving: paper_of(disk, moving)[1], state, found[:12])
    count = len(multiplier_names(scenario.constraints))
    return np.array(change), np.array(found[12 : 12 + count])
