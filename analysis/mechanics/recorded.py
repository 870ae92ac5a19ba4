"""The equations as code: recorded once for each structure, run on numbers of any kind."""

from collections.abc import Callable
from functools import lru_cache, partial
from math import hypot
from types import SimpleNamespace
from typing import Any

import numpy as np

from analysis.data import elementary
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.constraint_set import ConstraintSet
from analysis.data.quantities import Load
from analysis.data.scenario import Scenario
from analysis.data.state import COORDINATES
from analysis.mechanics.attitude import EulerAngles
from analysis.mechanics.dual import Dual, derivatives, dual, rate
from analysis.mechanics.free_body import Solver, free_solver
from analysis.mechanics.newton_euler import IdealContact
from analysis.mechanics.recorder import Recorder, call
from analysis.mechanics.states import paper_of, state_of
from analysis.mechanics.vectors import Numbers

STATE = (*COORDINATES, *(f"{name}_rate" for name in COORDINATES))
"""Names of the numbers of a state; the position is that of the centre of gravity."""

NUMBERS = (
    *("mass", "radius", "eccentricity"),
    *(f"inertia_{axis}" for axis in ("x", "y", "z", "xy", "xz", "yz")),
    *(f"gravity_{axis}" for axis in "xyz"),
)
"""Names of what code is bound to: the disk, with its inertia about S, and gravity on the table."""

_FUNCTIONS = ("speed", "per_speed", "contact_load")


def numbers(scenario: Any) -> tuple[Any, ...]:
    """Those of `NUMBERS` of a scenario, or of `Members`."""
    disk = scenario.disk
    inertia = *disk.inertia_about_cog, *disk.products
    return disk.mass, disk.radius, disk.eccentricity, *inertia, *scenario.table.vector


def disk_of(values: Numbers) -> Any:
    """A round disk of the first ones of `NUMBERS`, of any kind."""
    mass, radius, eccentricity, a, b, c, *products = values[:9]
    return SimpleNamespace(
        is_round_disk=True,
        mass=mass,
        radius=radius,
        eccentricity=eccentricity,
        inertia_about_cog=(a, b, c),
        products=tuple(products),
    )


@lru_cache(maxsize=256)
def formula(
    held: ConstraintSet,
    load: Load | None,
    *,
    horizontal: bool,
    products: bool = False,
    body: Body | None = None,
    slowing: bool = False,
    chart: type[EulerAngles] = EulerAngles,
) -> Callable[..., Callable[..., tuple[Any, ...]]]:
    """Code of `IdealContact.derivative` for a structure.

    Parameters
    ----------
    held : tuple of str
        Constraints.
    load : str, optional
        What presses the disk on the table where friction acts; None where there is none.
    horizontal : bool
        Whether the table is level.
    products : bool
        Whether the disk has products of inertia.
    body : Body, optional
        Other than a round disk; its numbers are recorded in place of those of `NUMBERS`.
    slowing : bool
        Whether half the rate of the squared slip speed is told, too.
    chart : EulerAngles or EulerTurning
        What a state holds.

    Returns
    -------
    callable
        From `numbers` and, by keyword, the functions of `IdealContact` and `sin` and `cos` of
        these kinds of numbers, to a function of the 12 numbers of a state; that one returns the
        derivative and the multipliers, 12 + n numbers, and what `slowing` asks for.
    """
    recorder = Recorder(NUMBERS, STATE, _FUNCTIONS)
    along, across, down = recorder.constants[9:]
    disk: Any = body
    if body is None:
        disk = disk_of(recorder.constants)
        if not products:
            # Zeros take no time in what is recorded.
            disk.products = (0.0, 0.0, 0.0)
    contact = IdealContact(
        constraints=held,
        disk=disk,
        gravity=(0.0, 0.0, down) if horizontal else (along, across, down),
        load=load,
        chart=chart,
        **{name: partial(call, name) for name in _FUNCTIONS},
    )
    derivative, multipliers, slower = contact.derivative(recorder.variables)
    return recorder.code([*derivative, *multipliers, *([slower] if slowing else [])])


def solver(scenario: Scenario, chart: type[EulerAngles] = EulerAngles) -> Solver:
    """Function that gives the time derivative and the multipliers at one state after the other.

    An ideal contact that pulls (negative normal force) is no load: friction never gives energy.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact, or a penalty contact, whose force stands for the multipliers.
    chart : EulerAngles or EulerTurning
        What a state holds.

    Returns
    -------
    callable
        It raises `ArithmeticError` where `accelerations` does.
    """
    if scenario.contact is not None:
        return free_solver(scenario, chart)
    per_speed = scenario.friction.per_speed
    return _bound(scenario, chart, speed=hypot, per_speed=per_speed, contact_load=_contact_load)


def jacobian(scenario: Scenario) -> Callable[[Array], Array]:
    """Function that gives the Jacobian of the time derivative at one state after the other.

    It is exact. At no slip, where the size of the slip has no derivative, friction has its slope.

    Parameters
    ----------
    scenario : Scenario
        With the ideal contact.

    Returns
    -------
    callable
        From a state, shape (12,), to the derivatives, shape (12, 12). It raises `ArithmeticError`
        where `accelerations` does.
    """
    solve = dual_solver(scenario)
    return lambda state: derivatives(lambda moving: solve(*moving)[:12], state)


def dual_solver(scenario: Scenario) -> Callable[..., tuple[Any, ...]]:
    """The function of `solver` for dual numbers; the scenario is one with the ideal contact."""
    law = scenario.friction

    def per_speed(speed: Dual) -> Dual:
        slope = law.per_speed_slope(speed.value)
        return Dual(law.per_speed(speed.value), slope * speed.change)

    return _bound(
        scenario,
        EulerAngles,
        sin=elementary.sin,
        cos=elementary.cos,
        speed=_speed,
        per_speed=per_speed,
        contact_load=_contact_load,
    )


def _bound(
    scenario: Scenario, chart: type[EulerAngles], **functions: Any
) -> Callable[..., tuple[Any, ...]]:
    """Code of a scenario, which is named where it cannot be run."""
    code = formula(
        scenario.constraints,
        scenario.friction.load if scenario.rubs else None,
        horizontal=bool(scenario.table.is_horizontal),
        products=scenario.disk.has_products,
        body=None if scenario.disk.is_round_disk else scenario.disk,
        chart=chart,  # type: ignore[arg-type] # a class can be hashed
    )(*numbers(scenario), **functions)

    def solve(*state: Any) -> tuple[Any, ...]:
        try:
            return code(*state)
        except ArithmeticError as error:
            cause = "" if isinstance(error, ZeroDivisionError) else f": {error}"
            angles = [getattr(each, "value", each) for each in state[3:6]]
            raise ArithmeticError(
                f"singular index-1 system of {scenario.name} at alpha, beta, gamma = {angles}"
                + cause
            ) from error

    return solve


def _contact_load(alone: Any, added: Any) -> Any:
    """Normal force in N that friction takes as its load, from that without friction."""
    more, force = (getattr(each, "value", each) for each in (added, alone))
    if more >= 1.0:
        raise ArithmeticError(
            f"each newton of normal force calls for {more:.3g} N of it through friction"
        )
    return alone / (1.0 - added) if force > 0.0 else 0.0


def _speed(x: Any, y: Any) -> Dual:
    """Size of a slip in dual numbers."""
    x, y = dual(x), dual(y)
    size = hypot(x.value, y.value)
    return Dual(size, (x.value * x.change + y.value * y.change) / size if size else 0.0)


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
    return np.array(change), np.array(found[12:])
