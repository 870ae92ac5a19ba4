"""Stiff runs: exact Jacobians for implicit methods, and steps that resolve friction."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    MODELS,
    AnisotropicCoulomb,
    Dissipation,
    PenaltyContact,
    PowerLawCoulomb,
    Scenario,
    SmoothCoulomb,
    Stribeck,
    Trajectory,
    simulate,
    simulate_many,
)
from analysis.simulation.formulations import pose
from tests.bodies import EGG
from tests.helpers import angles_apart, jacobian, mostly_slow

LOSSES = Dissipation(rolling_dry=0.01, rolling_viscous=0.01, pivoting=1e-3, air_drag=1.0)
SOFT = PenaltyContact(stiffness=1e6, damping=300.0, half_thickness=1e-3)


@pytest.mark.parametrize(
    ("formulation", "scenario"),
    [
        ("index-1", Scenario(friction=Stribeck(load="contact"))),
        ("reduced", Scenario(constraints=MODELS[4])),
        ("reduced", Scenario(constraints=MODELS[4], friction=AnisotropicCoulomb())),
        ("free-body", Scenario(contact=SOFT, dissipation=LOSSES)),
        ("free-body", Scenario(contact=SOFT, friction=PowerLawCoulomb(load="contact"))),
    ],
)
def test_jacobian_is_that_of_differences(formulation: str, scenario: Scenario) -> None:
    problem = pose(scenario, formulation, {}).problem
    assert problem.jacobian is not None
    exact, random = problem.jacobian(), np.random.default_rng(5)
    for _ in range(3):
        state = problem.start + 0.01 * random.normal(size=problem.start.size)
        if formulation == "free-body":
            # Neither lifted nor where the damper has just let go.
            state[2] = problem.start[2] - 3e-4
        found = jacobian(lambda moved: np.array(problem.right_hand_side(0.0, moved)), state, 1e-6)
        np.testing.assert_allclose(exact(state), found, atol=1e-7 * np.max(np.abs(found)))


def test_implicit_methods_follow_friction_that_sets_in_over_a_nanometre_a_second() -> None:
    scenario = Scenario(friction=SmoothCoulomb(smoothing=1e-9))
    times = np.linspace(0.0, 0.05, 6)
    one, other = (
        simulate(scenario, times, method=method, local_tolerance=1e-8)
        for method in ("Radau", "BDF")
    )
    assert angles_apart(one, other) < 1e-6


@pytest.mark.parametrize("simulated", [simulate, mbs_models.simulate])
@pytest.mark.parametrize("smoothing", mostly_slow([1e-9, 1e-12], [1e-9]))
@pytest.mark.parametrize("contact", [None, PenaltyContact(stiffness=1e5, damping=10.0)])
def test_steps_of_runs_to_a_tolerance_resolve_the_slip_over_which_friction_sets_in(
    simulated: Callable[..., Trajectory], smoothing: float, contact: PenaltyContact | None
) -> None:
    # Two coarser ones agreed to 2e-7 rad and were wrong by 7e-4.
    scenario = Scenario(friction=SmoothCoulomb(smoothing=smoothing), contact=contact)
    times = np.linspace(0.0, 0.02, 5)
    truth = simulate(scenario, times, method="BDF", local_tolerance=1e-11)
    run = simulated(scenario, times, tolerance=1e-5)
    assert angles_apart(run, truth) < 1e-5
    local: Any = run.method["local_tolerance"]
    assert local < smoothing


def test_stiff_friction_is_followed_by_an_implicit_method_unless_another_is_asked_for() -> None:
    times, stiff = np.linspace(0.0, 0.2, 21), Scenario(friction=SmoothCoulomb(smoothing=1e-5))
    assert simulate(Scenario(), times).method["method"] == "DOP853"
    run = simulate(stiff, times, tolerance=1e-6)
    assert run.method["method"] == "Radau"
    other = simulate(stiff, times, method="LSODA", local_tolerance=1e-10)
    assert angles_apart(run, other) < 1e-6
    (member,) = simulate_many([replace(stiff, disk=EGG)], times, workers=1, tolerance=1e-6)
    assert isinstance(member, Trajectory)
    assert member.method["method"] == "Radau"
