"""Forms of the equations of motion as initial value problems, and the way back to trajectories."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from math import sin
from typing import Literal, get_args

import numpy as np

from analysis.mechanics import recorded, reduced
from analysis.mechanics.attitude import paper_arrays, state_of
from analysis.mechanics.constraints import SLIPS, check_admissible, velocity_residuals
from analysis.mechanics.penalty import Solver
from analysis.motion.endings import Condition
from analysis.problem.checks import Array, choice
from analysis.problem.scenario import Scenario, require_plain
from analysis.problem.start import State
from analysis.solve.effort import contact_time, longest_step
from analysis.solve.stepping import InitialValueProblem

Form = Literal["index-1", "reduced", "free-body"]
FORMS: tuple[Form, ...] = get_args(Form)


@dataclass(frozen=True, slots=True, eq=False)
class PosedForm:
    """An initial value problem and the way back from its states.

    Parameters
    ----------
    problem : InitialValueProblem
    expand : callable
        From times, shape (n,), and states, shape (n, m), to co-rotating coordinates and rates,
        each shape (n, 6), and multipliers, shape (n, k).
    """

    problem: InitialValueProblem
    expand: Callable[[Array, Array], tuple[Array, Array, Array]]


def default_form(scenario: Scenario) -> Form:
    """Form that a scenario is simulated in: that of its contact."""
    return "index-1" if scenario.contact is None else "free-body"


def pose(scenario: Scenario, form: str, conditions: Mapping[str, Condition]) -> PosedForm:
    """Initial value problem of a scenario.

    Parameters
    ----------
    scenario : Scenario
    form : str
        One of `FORMS`.
    conditions : mapping
        From reasons to functions of a `State`; the motion ends where one turns negative.

    Raises
    ------
    ValueError
        If the form does not know what is in the scenario, or the start breaks a constraint.
    """
    check_form(scenario, form)
    return (_reduced if form == "reduced" else _full)(scenario, conditions)


def _in_states(
    conditions: Mapping[str, Condition], to_paper: Callable[[Array], tuple[Array, Array]]
) -> dict[str, Callable[[Array], float]]:
    """Conditions as functions of what is integrated."""

    def evaluated(condition: Condition, values: Array) -> float:
        coordinates, rates = (tuple(each.tolist()) for each in to_paper(values))
        return condition(State(coordinates=coordinates, rates=rates))

    return {reason: partial(evaluated, condition) for reason, condition in conditions.items()}


def check_form(scenario: Scenario, form: str) -> None:
    """Raise `ValueError` unless a form knows what is in a scenario, whose start is admissible.

    Parameters
    ----------
    scenario : Scenario
        Or that of `Members`.
    form : str
    """
    choice("form", form, FORMS)
    if (form == "free-body") != (scenario.contact is not None):
        raise ValueError(
            f"form {form!r} {'needs' if form == 'free-body' else 'knows no'} penalty contact, got "
            f"contact {scenario.contact!r}"
        )
    if form != "free-body":
        check_admissible(scenario, scenario.initial_state)
    if form == "reduced":
        if scenario.model != 4:
            raise ValueError(f"form 'reduced' exists for Model 4 alone, got {scenario.name}")
        if scenario.friction.load != "weight":
            raise ValueError(
                f"form 'reduced' takes the load 'weight' alone, got {scenario.friction.load!r}"
            )
        require_plain(scenario, "form 'reduced'")


def _full(scenario: Scenario, conditions: Mapping[str, Condition]) -> PosedForm:
    start, solved = scenario.initial_state, recorded.solver(scenario)
    to_paper = partial(paper_arrays, scenario.disk)
    longest = longest_step(scenario)
    slips = tuple(way for way in SLIPS if way not in scenario.constraints)

    def slip(state: Array) -> float:
        return float(velocity_residuals(slips, scenario.disk, state.tolist())[0])

    def expand(_: Array, states: Array) -> tuple[Array, Array, Array]:
        coordinates, rates = to_paper(states)
        # The first sample is the start itself, without the rounding on the way to it and back.
        coordinates[0], rates[0] = start.coordinates, start.rates
        return coordinates, rates, _multipliers(solved, states)

    problem = InitialValueProblem(
        lambda _, state: solved(*state.tolist())[:12],
        np.array(state_of(scenario.disk, start.coordinates, start.rates)),
        lambda state: sin(state[4]),
        lambda state: solved(*state.tolist())[12],
        longest if scenario.contact is None else min(longest, contact_time(scenario)),
        lambda states: states[..., 4:6],
        _in_states(conditions, to_paper),
        slip if scenario.rubs and len(slips) == 1 else None,
        jacobian=partial(recorded.jacobian, scenario),
    )
    return PosedForm(problem, expand)


def _reduced(scenario: Scenario, conditions: Mapping[str, Condition]) -> PosedForm:
    start, disk = scenario.initial_state, scenario.disk
    spin, alpha = start.rates[3], start.coordinates[3]
    full, solved = recorded.solver(scenario), reduced.solver(scenario, spin)

    def expand(times: Array, states: Array) -> tuple[Array, Array, Array]:
        turned = alpha + spin * (times - times[0])
        coordinates, rates = reduced.expand(disk, spin, turned, states[:, :3])
        states = np.array(state_of(disk, coordinates.T, rates.T)).T
        return coordinates, rates, _multipliers(full, states)

    def to_paper(state: Array) -> tuple[Array, Array]:
        coordinates, rates = reduced.expand(disk, spin, state[3:], state[None, :3])
        return coordinates[0], rates[0]

    derivative = reduced.right_hand_side(scenario, spin)
    begin = np.array((*start.coordinates[4:6], start.rates[4]))
    # Conditions may ask for alpha.
    begin = np.append(begin, [alpha] * bool(conditions))

    def jacobian() -> Callable[[Array], Array]:
        # Nothing depends on alpha, whose rate is held.
        by_motion, beside = reduced.jacobian(scenario, spin), (0, begin.size - 3)
        return lambda state: np.pad(by_motion(state[:3]), (beside, beside))

    problem = InitialValueProblem(
        (lambda t, state: (*derivative(t, state[:3]), spin)) if conditions else derivative,
        begin,
        lambda state: sin(state[0]),
        lambda state: solved(*state[:3].tolist())[3],
        longest_step(scenario),
        lambda states: states[..., :2],
        _in_states(conditions, to_paper),
        (lambda state: solved(*state[:3].tolist())[4]) if scenario.rubs else None,
        jacobian=jacobian,
    )
    return PosedForm(problem, expand)


def _multipliers(solved: Solver, states: Array) -> Array:
    """Constraint forces at states of the index-1 system, shape (n, 12); shape (n, k)."""
    return np.array([solved(*values)[12:] for values in states.tolist()])
