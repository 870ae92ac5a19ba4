"""Model 4 in minimal coordinates, Eqs. (93)-(110)."""

from collections.abc import Callable, Sequence
from functools import cache
from types import SimpleNamespace
from typing import Any

from analysis.mechanics.dual import Functions, derivatives, of_duals, of_floats
from analysis.mechanics.penalty import Solver, friction_of
from analysis.mechanics.recorded import NUMBERS, disk_of, numbers
from analysis.mechanics.recorder import Recorder
from analysis.problem.body import Body
from analysis.problem.checks import Array
from analysis.problem.constraints import MODELS, demanded
from analysis.problem.elementary import cos, sin
from analysis.problem.friction import FrictionLaw, asked
from analysis.problem.scenario import Scenario


@cache
def formula(
    *, is_simple: bool, about_inverted: bool = False
) -> Callable[..., Callable[..., tuple[Any, ...]]]:
    """Code of the reduced system under a friction law that is simple or is not.

    Parameters
    ----------
    is_simple : bool
        See `FrictionLaw`.
    about_inverted : bool
        Whether beta and gamma are told less pi/2, and time derivatives are wanted alone: their
        digits beside inverted and noninverted spinning, about which the system is odd.

    Returns
    -------
    callable
        From `recorded.numbers`, the spin in rad/s and, by keyword, what `recorded.formula` takes,
        to a function of beta, gamma and the rate of beta. That one returns their time
        derivatives, Eqs. (102) and (109), the normal contact force in N, and the lateral slip in
        m/s.
    """
    recorder = Recorder((*NUMBERS, "spin"), ("beta", "gamma", "beta_rate"))
    *given, spin = recorder.constants
    disk = disk_of(given)
    stand_in: Any = SimpleNamespace(disk=disk, weight=disk.mass * -given[-1])
    beta, gamma, bd = recorder.variables
    sb, cb, sg, cg = sin(beta), cos(beta), sin(gamma), cos(gamma)
    if about_inverted:
        sb, cb, sg, cg = cb, -sb, cg, -sg
    directions = sb, cb, sg, cg
    slip, load = lateral_slip(disk, spin, directions, bd), 1.0 if is_simple else stand_in.weight
    _, across = friction_of(is_simple=is_simple)(0.0, slip, load)
    bdd = acceleration_from(stand_in, spin, directions, bd, -across / load)
    # The centre of gravity is (r + e sin(gamma)) sin(beta) above the table.
    e, gd, gdd = disk.eccentricity, -spin * cb, spin * sb * bd
    rise = e * (cg * gdd - sg * gd * gd) * sb + 2 * e * cg * gd * cb * bd
    rise += (disk.radius + e * sg) * (cb * bdd - sb * bd * bd)
    forces = [stand_in.weight + disk.mass * rise, slip]
    return recorder.code([bd, gd, bdd, *([] if about_inverted else forces)])


def solver(
    scenario: Scenario,
    spin: float,
    functions: Callable[[FrictionLaw], Functions] = of_floats,
    *,
    about_inverted: bool = False,
) -> Solver:
    """Function from beta, gamma and the rate of beta to what `formula` tells, 5 or 3 numbers.

    Parameters
    ----------
    scenario : Scenario
        On a horizontal table; the reduced system knows the weight as load only, and neither the
        constraints nor `friction.load` is looked at.
    spin : float
        Constant spinning speed in rad/s (paper: Omega).
    functions : callable
        `of_floats` or `of_duals`, for states of that kind.
    """
    law = scenario.friction
    code = formula(is_simple=law.is_simple, about_inverted=about_inverted)
    return code(*numbers(scenario), spin, force=asked(law, "force"), **functions(law))


def right_hand_side(
    scenario: Scenario, spin: float
) -> Callable[[float, Array], tuple[float, ...]]:
    """Time derivative of states x = (beta, gamma, beta_rate), Eqs. (102), (109), for SciPy."""
    solve = solver(scenario, spin)
    return lambda _, x: solve(*x.tolist())[:3]


def jacobian(scenario: Scenario, spin: float) -> Callable[[Array], Array]:
    """Exact Jacobian of these time derivatives at one state, shape (3,), after the other."""
    solve = solver(scenario, spin, of_duals)
    return lambda x: derivatives(lambda moving: solve(*moving)[:3], x)


def lateral_slip(disk: Body, spin: Any, directions: Sequence[Any], bd: Any) -> Any:
    """Slip across the edge in m/s, for numbers of any kind; see `acceleration_from`."""
    r, e, (sb, _, sg, cg) = disk.radius, disk.eccentricity, directions
    return (r + e * sg) * bd * sb - e * spin * sb * sb * cg


def acceleration_from(
    scenario: Scenario, spin: Any, directions: Sequence[Any], bd: Any, friction: Any
) -> Any:
    """Second derivative of beta from Eqs. (102)-(108) in rad/s², for numbers of any kind.

    Parameters
    ----------
    scenario : Scenario
        See `solver`; its friction law is not looked at.
    spin : number or array
        In rad/s.
    directions : sequence of 4 numbers or arrays
        Sine and cosine of beta, sine and cosine of gamma.
    bd : number or array
        Rate of beta in rad/s.
    friction : number or array
        Force against `lateral_slip` for each newton of load.
    """
    disk, weight = scenario.disk, scenario.weight
    m, r, e = disk.mass, disk.radius, disk.eccentricity
    A, B_bar, _ = disk.inertia_about_cog
    Omega = spin
    sb, cb, sg, cg = directions
    height = r + e * sg
    M = A * cg * cg + B_bar * sg * sg + m * height * height * cb * cb
    h = (
        (A * cg * cg + B_bar * sg * sg) * Omega * Omega * sb * cb
        - 2 * (A - B_bar) * Omega * bd * cb * sg * cg
        + m * height * height * bd * bd * sb * cb
        + m * e * height * Omega * Omega * sb * cb * cb * cb * sg
        - m * e * height * (3 * sb * sb - 2) * Omega * bd * cb * cg
    )
    f = -weight * height * cb
    return (h + f - height * sb * weight * friction) / M


def expanded(
    disk: Body, spin: Any, alpha: Any, x: Sequence[Any] | Array
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Co-rotating coordinates and rates of a reduced state, 6 numbers each; Eqs. (94), (96), (97).

    Parameters
    ----------
    disk : Body
    spin : number
        Constant spinning speed in rad/s.
    alpha : number
        Angle of the R-frame in rad.
    x : 3 numbers
        beta, gamma and the rate of beta, of any kind.
    """
    beta, gamma, beta_rate = x
    # Eq. (97) prints sin(gamma) in the second term of y'; the constraint (83) gives cos(gamma).
    free = 0.0, 0.0, 0.0, 0.0, beta_rate, 0.0
    *place, x_rate, y_rate, _, gamma_rate = demanded(MODELS[4], disk, (beta, gamma, spin), free)
    coordinates = *place, disk.radius * sin(beta), alpha, beta, gamma
    rise = disk.radius * cos(beta) * beta_rate
    return coordinates, (x_rate, y_rate, rise, spin, beta_rate, gamma_rate)
