"""How many steps an in-house run will take, told from its arguments before it starts.

The numbers come from measured runs. A step resolves the fastest of what happens: the turning of
the disk, as finely as the tolerance asks; friction at no slip, for explicit methods; and the
Euler angles, which turn the faster the flatter the disk leans.
"""

from math import inf, pi
from typing import Literal, NamedTuple

from analysis.problem.checks import Array, choice, positive
from analysis.problem.choices import Method
from analysis.problem.elementary import cos, sin, sqrt
from analysis.problem.limits import DEFAULT_TOLERANCE, Effort
from analysis.problem.scenario import Scenario


class _Method(NamedTuple):
    """How steps fall with the tolerance, how long they may be, and what they take.

    The step is as the tolerance to the power 1 / `order`; `stable` is the largest product of
    step and decay rate, and a step takes so many evaluations of the right-hand side, each with
    so much processor time in s for linear equations.
    """

    order: int
    stable: float
    evaluations: float
    linear: float = 0.0


METHODS: dict[Method, _Method] = {
    "DOP853": _Method(10, 6.0, 12),
    "RK45": _Method(7, 3.3, 6),
    "RK23": _Method(5, 2.5, 3),
    "Radau": _Method(4, inf, 10, 4e-5),
    "BDF": _Method(4, inf, 2, 4e-5),
    "LSODA": _Method(5, inf, 2),
    "taylor": _Method(10, 6.0, 0.7),
}
"""From measured runs; compiled steps take their time in parts of an evaluation."""

STIFF = 2.0
"""Times what implicit steps should take at which explicit ones are estimated where they begin to
take longer: motions pass the finest speed of friction only now and then."""

FALLS = 0.5
"""Part of its inclination at the start to which a disk comes down that falls: again and again it
passes nearly flat and rises,"""

_PER_FALL = 16.0
"""and steps that each such fall takes, to an accuracy of a radian."""

_SECONDS = 1.2e-5
"""Processor time in s that goes with one evaluation of the equations, the solver's included,"""

_FREE_BODY_SECONDS = 2.5e-5
"""and with one of a free body on a penalty contact."""


def longest_step(scenario: Scenario) -> float:
    """Longest step in s: a part of a turn, of the time of a fall and of a swing on the contact.

    On an unstable equilibrium nothing but rounding moves, and steps without a bound would grow
    past the time in which a deviation does.
    """
    swing = inf if scenario.contact is None else contact_time(scenario)
    return min(turning_time(scenario), swing)


def turning_time(scenario: Scenario) -> float:
    """Time in s in which a disk falls by some part, or turns by 2 rad."""
    fall = 0.5 * sqrt(scenario.disk.radius / scenario.table.gravity)
    return min(fall, 2.0 / max(abs(scenario.initial_state.rates[3]), 1e-3))


def contact_time(scenario: Scenario) -> float:
    """Half a period in s of the disk on its contact: steps no longer find every impact."""
    return pi / sqrt(scenario.penalty_contact.stiffness * scenario.disk.contact_mobility)


def usual_method(
    scenario: Scenario, times: Array, *, stiff: float = STIFF, **accuracy: float | None
) -> Literal["DOP853", "Radau"]:
    """Method that is taken where none is asked for: Radau where friction is stiff, else DOP853.

    Parameters
    ----------
    scenario, times
        See `simulation_effort`.
    stiff : float
        See `STIFF`.
    **accuracy
        Tolerance or local_tolerance, see there.
    """
    explicit = simulation_effort(scenario, times, method="DOP853", **accuracy)
    implicit = simulation_effort(scenario, times, method="Radau", **accuracy)
    return "Radau" if explicit.seconds > stiff * implicit.seconds else "DOP853"


def simulation_effort(
    scenario: Scenario,
    times: Array,
    *,
    method: Method | None = None,
    tolerance: float | None = None,
    local_tolerance: float | None = None,
) -> Effort:
    """Effort of `analysis.simulate` with these arguments.

    Parameters
    ----------
    scenario : Scenario
    times : ndarray, shape (n,)
        In s.
    method : str, optional
        One of `METHODS`; by default `usual_method`.
    tolerance, local_tolerance : float, optional
        As in `analysis.simulate`; a tolerance takes two runs or more.

    Raises
    ------
    ValueError
        If a tolerance is not positive, or the method is none.
    """
    if method is None:
        method = usual_method(
            scenario, times, tolerance=tolerance, local_tolerance=local_tolerance
        )
    used = METHODS[choice("method", method, METHODS)]
    name, wanted = "tolerance", DEFAULT_TOLERANCE if tolerance is None else tolerance
    if local_tolerance is not None:
        name, wanted = "local_tolerance", local_tolerance
    wanted = positive(name, wanted)
    if local_tolerance is None:
        wanted = min(wanted, scenario.finest_slip)
    start, gradient = scenario.initial_state, scenario.friction_gradient
    spin, *others = map(abs, start.rates[3:])
    turning = spin + sum(others)
    sharpness = wanted ** (-1.0 / used.order)
    beta = start.coordinates[4]
    leaning = sin(beta)
    # How many steps in a second are asked for, by what, and its value.
    rates = [
        (1.0 / longest_step(scenario), "times", ""),
        (0.4 * spin * sharpness, name, f"{wanted:g} "),
        (scenario.slip_decay / used.stable, "friction", f"gradient {gradient:g} s/m "),
        (turning / leaning, "beta", f"{beta:g} rad "),
    ]
    if _lowest(scenario) < FALLS * leaning:
        falls = sqrt(scenario.fall / (2.0 * leaning)) / 2.0
        rates.append((_PER_FALL * falls * sharpness, "beta", f"{beta:g} rad "))
    seconds = _SECONDS
    if scenario.contact is not None:
        seconds = _FREE_BODY_SECONDS
        rates += _on_spring(scenario, used.stable)
    fastest, argument, value = max(rates)
    steps = float(times[-1] - times[0]) * fastest * (2.0 if local_tolerance is None else 1.0)
    return Effort(
        steps=steps,
        seconds=steps * used.evaluations * (seconds + used.linear),
        argument=argument,
        value=f"{value}up to t = {times[-1]:g} s",
    )


def _on_spring(scenario: Scenario, stable: float) -> list[tuple[float, str, str]]:
    """Steps in a second that the spring and the damper of a penalty contact ask for."""
    contact, disk = scenario.penalty_contact, scenario.disk
    swinging = sqrt(contact.stiffness * disk.contact_mobility) / min(stable, 3.0)
    return [
        (swinging, "stiffness", f"{contact.stiffness:g} N/m "),
        (contact.damping / (disk.mass * stable), "damping", f"{contact.damping:g} N s/m "),
    ]


def _lowest(scenario: Scenario) -> float:
    """Inclination in rad, where it is small, at which a disk that falls turns back.

    The angular momentum about the vertical, as if nothing rubbed, lets it come no lower.
    """
    (turn, tilt, roll), disk = scenario.initial_state.rates[3:], scenario.disk
    beta = scenario.initial_state.coordinates[4]
    across, _, axial = disk.inertia_about_cog
    momentum = across * turn * sin(beta) ** 2 - axial * (turn * cos(beta) + roll) * (1 - cos(beta))
    turning = across * (tilt**2 + (turn * sin(beta)) ** 2) / 2.0
    energy = scenario.weight * disk.radius * sin(beta) + turning
    return abs(momentum) / sqrt(2.0 * across * energy)


def rest_effort(scenario: Scenario, end: float) -> Effort:
    """Effort of `analysis.simulate_to_rest` to a tolerance with LSODA, up to the time `end` in s.

    Raises
    ------
    ValueError
        If the scenario has no penalty contact.
    """
    stiffness = scenario.penalty_contact.stiffness
    # Two runs follow the contact, and the motion on it; the method changes to implicit steps where
    # friction is stiff.
    end = positive("end", end)
    steps = 2.0 * end * (3.0 / contact_time(scenario) + 100.0 / turning_time(scenario))
    return Effort(
        steps=steps,
        seconds=2.0 * steps * _SECONDS,
        argument="end",
        value=f"= {end:g} s at stiffness {stiffness:g} N/m",
    )
