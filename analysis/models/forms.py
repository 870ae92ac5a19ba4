"""Forms of the equations of motion as initial value problems, and the way back to trajectories."""

from collections.abc import Callable
from dataclasses import dataclass
from math import sin
from typing import Literal, get_args

import numpy as np

from analysis.data import frames
from analysis.data.checks import Array, choice
from analysis.data.constraint_set import multiplier_names
from analysis.data.scenario import Scenario
from analysis.models import index1, reduced
from analysis.models.constraints import check_admissible
from analysis.models.effort import longest_step
from analysis.models.integration import InitialValueProblem
from analysis.rest.free_disk import FreeDisk, vertical
from analysis.rest.to_rest import contact_time, sampled, start_vector

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
    attitudes : callable
        From states, shape (n, m), to numbers that tell beta and gamma, shape (n, k), in rad;
        errors are judged by them.
    """

    problem: InitialValueProblem
    expand: Callable[[Array, Array], tuple[Array, Array, Array]]
    attitudes: Callable[[Array], Array]


def default_form(scenario: Scenario) -> Form:
    """Form that a scenario is simulated in: that of its contact."""
    return "index-1" if scenario.contact is None else "free-body"


def pose(scenario: Scenario, form: Form) -> PosedForm:
    """Initial value problem of a scenario.

    Raises
    ------
    ValueError
        If the form does not know what is in the scenario, or the start breaks a constraint.
    """
    choice("form", form, FORMS)
    if (form == "free-body") != (scenario.contact is not None):
        raise ValueError(
            f"form {form!r} {'needs' if form == 'free-body' else 'knows no'} penalty contact, got "
            f"contact {scenario.contact!r}"
        )
    if form == "free-body":
        return _free_body(scenario)
    check_admissible(scenario, scenario.initial_state)
    return _index1(scenario) if form == "index-1" else _reduced(scenario)


def _index1(scenario: Scenario) -> PosedForm:
    def derivative(_: float, state: Array) -> Array:
        values = state.tolist()
        z, u = values[:6], values[6:]
        return np.concatenate((u, index1.accelerations(scenario, z, u)[0]))

    def normal_force(state: Array) -> float:
        values = state.tolist()
        return float(index1.accelerations(scenario, values[:6], values[6:])[1][0])

    def expand(_: Array, states: Array) -> tuple[Array, Array, Array]:
        return states[:, :6], states[:, 6:], _multipliers(scenario, states)

    return PosedForm(
        InitialValueProblem(
            derivative,
            scenario.initial_state.vector,
            lambda state: sin(state[4]),
            normal_force,
            longest_step(scenario),
        ),
        expand,
        lambda states: states[:, 4:6],
    )


def _reduced(scenario: Scenario) -> PosedForm:
    if scenario.model != 4:
        raise ValueError(f"form 'reduced' exists for Model 4 alone, got {scenario.name}")
    if scenario.friction.load != "weight":
        raise ValueError(
            f"form 'reduced' takes the load 'weight' alone, got {scenario.friction.load!r}"
        )
    scenario.require_horizontal_table("form 'reduced'")
    start = scenario.initial_state
    spin, alpha = start.rates[3], start.coordinates[3]

    def derivative(_: float, state: Array) -> tuple[float, float, float]:
        return reduced.right_hand_side(scenario, spin, state.tolist())

    def expand(times: Array, states: Array) -> tuple[Array, Array, Array]:
        turned = alpha + spin * (times - times[0])
        coordinates, rates = reduced.expand(scenario.disk, spin, turned, states)
        return coordinates, rates, _multipliers(scenario, np.hstack((coordinates, rates)))

    return PosedForm(
        InitialValueProblem(
            derivative,
            np.array((*start.coordinates[4:6], start.rates[4])),
            lambda state: sin(state[0]),
            lambda state: reduced.normal_force(scenario, spin, state.tolist()),
            longest_step(scenario),
        ),
        expand,
        lambda states: states[:, :2],
    )


def _free_body(scenario: Scenario) -> PosedForm:
    model = FreeDisk(scenario)
    start = scenario.initial_state

    def expand(times: Array, states: Array) -> tuple[Array, Array, Array]:
        states = states.copy()
        states[:, 3:7] /= np.linalg.norm(states[:, 3:7], axis=1)[:, None]
        motion = sampled(model, times, states)
        coordinates, rates = frames.from_poses(
            motion["positions"],
            frames.rotations(motion["quaternions"]),
            motion["velocities"],
            motion["angular_velocities"],
        )
        # The first sample is the start itself, turns and all.
        coordinates[0], rates[0] = start.coordinates, start.rates
        frames.follow_turns(times, coordinates, rates)
        return coordinates, rates, motion["normal_force"][:, None]

    def upright(state: Array) -> float:
        x, y, _ = vertical(state.tolist())
        return float(np.hypot(x, y)) - _NEARLY_FLAT

    return PosedForm(
        InitialValueProblem(
            model.derivative,
            start_vector(scenario.disk, start),
            upright,
            lambda state: model.touch(state.tolist()).force,
            min(longest_step(scenario), contact_time(model)),
        ),
        expand,
        lambda states: np.array([vertical(state) for state in states.tolist()]),
    )


_NEARLY_FLAT = 1e-6
"""Sine of the inclination at which the Euler angles of a free body end."""


def _multipliers(scenario: Scenario, states: Array) -> Array:
    """Constraint forces at coordinates and rates, shape (n, 12); shape (n, k)."""
    result = np.empty((len(states), len(multiplier_names(scenario.constraints))))
    for row, values in enumerate(states.tolist()):
        result[row] = index1.accelerations(scenario, values[:6], values[6:])[1]
    return result
