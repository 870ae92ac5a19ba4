"""Formulations of the equations of motion as initial value problems, and the way back."""

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from itertools import chain
from math import sin
from typing import Any

import numpy as np

from analysis.mechanics import recorded, reduced
from analysis.mechanics.attitude import paper_of, state_of
from analysis.mechanics.constraints import SLIPS, check_admissible
from analysis.mechanics.penalty import Solver, kinks
from analysis.motion.endings import CONTACT_WOULD_PULL, FLAT, Condition
from analysis.problem.checks import Array, choice, instance
from analysis.problem.choices import FORMULATIONS, Formulation
from analysis.problem.constraints import multiplier_names
from analysis.problem.limits import LEAST_TILT
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario, require_plain
from analysis.solve.effort import longest_step
from analysis.solve.stepping import InitialValueProblem
from analysis.solve.watch import PaperState, of_states

Expand = Callable[[Array, Array], Array]
"""From times, shape (n,), and states, shape (n, m), to co-rotating coordinates, rates and
multipliers, shape (n, 12 + k)."""


def default_formulation(scenario: Scenario) -> Formulation:
    """Formulation that a scenario is simulated in: that of its contact."""
    return "index-1" if scenario.contact is None else "free-body"


def formulations(scenario: Scenario) -> tuple[Formulation, ...]:
    """Formulations that can describe a scenario, the default one first.

    Parameters
    ----------
    scenario : Scenario

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> from analysis import MODELS, Scenario, formulations
    >>> formulations(Scenario(constraints=MODELS[4]))
    ('index-1', 'reduced')
    """
    instance("scenario", scenario, Scenario)
    found: list[Formulation] = []
    for each in FORMULATIONS:
        with suppress(ValueError):
            _check_described(scenario, each)
            found.append(each)
    return tuple(found)


def pose(
    scenario: Scenario, formulation: str, conditions: Mapping[str, Condition]
) -> tuple[InitialValueProblem, Expand]:
    """Initial value problem of a scenario, and the way back from its states.

    Parameters
    ----------
    scenario : Scenario
    formulation : str
        One of `FORMULATIONS`.
    conditions : mapping
        From reasons to functions of a `State`; the motion ends where one turns negative.

    Raises
    ------
    ValueError
        If the formulation cannot describe the scenario, or the start breaks a constraint.
    """
    check_formulation(scenario, formulation)
    return (_reduced if formulation == "reduced" else _full)(scenario, conditions)


def check_formulation(scenario: Scenario, formulation: str) -> None:
    """Raise `ValueError` unless a formulation can describe a scenario, from an admissible start.

    Parameters
    ----------
    scenario : Scenario
        Or that of `Members`.
    formulation : str
    """
    _check_described(scenario, choice("formulation", formulation, FORMULATIONS))
    if scenario.contact is None:
        check_admissible(scenario, scenario.initial_state)


def _check_described(scenario: Scenario, formulation: str) -> None:
    """Raise `ValueError` unless a formulation can describe a scenario."""
    needs_contact, subject = formulation == "free-body", f"formulation {formulation!r}"
    fault = ""
    if needs_contact != (scenario.contact is not None):
        what = "needs a" if needs_contact else "takes no"
        fault = f"{what} penalty contact, got contact {scenario.contact!r}"
    elif formulation == "reduced":
        if scenario.model != 4:
            fault = f"exists for Model 4 alone, got {scenario.name}"
        elif scenario.friction.load != "weight":
            fault = f"takes the load 'weight' alone, got {scenario.friction.load!r}"
        else:
            require_plain(scenario, subject)
    if fault:
        raise ArgumentError("formulation", fault, subject)


def _full(
    scenario: Scenario, conditions: Mapping[str, Condition]
) -> tuple[InitialValueProblem, Expand]:
    start, solved = scenario.initial_state, recorded.solver(scenario)
    slips = slice(12 + len(multiplier_names(scenario.constraints)), None)
    # To look for two gains nothing here, other than where a touch-down reverses small ones.
    is_watched = scenario.rubs and any(way in scenario.constraints for way in SLIPS)

    def reversing(state: Array) -> tuple[float, ...]:
        return solved(*state.tolist())[slips] if is_watched else ()

    def expand(_: Array, states: Array) -> Array:
        found = _in_rows(paper_of(scenario.disk, states.T))
        # The first sample is the start itself, without the rounding on the way to it and back.
        found[0] = start.vector
        return np.hstack((found, _multipliers(scenario, solved, states)))

    problem = InitialValueProblem(
        lambda _, state: solved(*state.tolist())[:12],
        np.array(state_of(scenario.disk, start.coordinates, start.rates)),
        longest_step(scenario),
        {
            FLAT: lambda state: sin(state[4]) - LEAST_TILT,
            CONTACT_WOULD_PULL: lambda state: scenario.pressing_force(solved(*state.tolist())[12]),
            **of_states(conditions, lambda state: paper_of(scenario.disk, state.tolist())),
        },
        slice(4, 6),
        reversing if scenario.contact is None else kinks(scenario, solved),
        jacobian=partial(recorded.jacobian, scenario),
        kinked_load=scenario.kinked_load,
    )
    return problem, expand


def _reduced(
    scenario: Scenario, conditions: Mapping[str, Condition]
) -> tuple[InitialValueProblem, Expand]:
    start, disk = scenario.initial_state, scenario.disk
    spin, alpha = start.rates[3], start.coordinates[3]
    full, solved = recorded.solver(scenario), reduced.solver(scenario, spin)

    def expand(times: Array, states: Array) -> Array:
        turned = alpha + spin * (times - times[0])
        found = _in_rows(reduced.expanded(disk, spin, turned, states[:, :3].T))
        states = np.array(state_of(disk, found.T[:6], found.T[6:])).T
        return np.hstack((found, _multipliers(scenario, full, states)))

    derivative = reduced.right_hand_side(scenario, spin)
    begin = np.array((*start.coordinates[4:6], start.rates[4]))
    # Conditions may ask for alpha.
    begin = np.append(begin, [alpha] * bool(conditions))

    def to_paper(state: Array) -> PaperState:
        *moving, turned = state.tolist()
        return reduced.expanded(disk, spin, turned, moving)

    def jacobian() -> Callable[[Array], Array]:
        # Nothing depends on alpha, whose rate is held.
        by_motion, beside = reduced.jacobian(scenario, spin), (0, begin.size - 3)
        return lambda state: np.pad(by_motion(state[:3]), (beside, beside))

    problem = InitialValueProblem(
        (lambda t, state: (*derivative(t, state[:3]), spin)) if conditions else derivative,
        begin,
        longest_step(scenario),
        {
            FLAT: lambda state: sin(state[0]) - LEAST_TILT,
            CONTACT_WOULD_PULL: lambda state: solved(*state[:3].tolist())[3],
            **of_states(conditions, to_paper),
        },
        slice(0, 2),
        lambda state: solved(*state[:3].tolist())[4:5] if scenario.rubs else (),
        jacobian=jacobian,
    )
    return problem, expand


def _in_rows(both: Iterable[Iterable[Any]]) -> Array:
    """Coordinates and rates, shape (n, 12), from the n numbers of each of them, or one."""
    return np.stack(np.broadcast_arrays(*chain(*both)), axis=-1)


def _multipliers(scenario: Scenario, solved: Solver, states: Array) -> Array:
    """Constraint forces at states of the index-1 system, shape (n, 12); shape (n, k)."""
    end = 12 + len(multiplier_names(scenario.constraints))
    return np.array([solved(*values)[12:end] for values in states.tolist()])
