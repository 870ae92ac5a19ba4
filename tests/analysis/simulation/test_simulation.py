"""In-house simulation: accuracy, energy and the work of constraints, stiff friction."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import pi
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    STEEL_DISK,
    AnisotropicCoulomb,
    ConstraintSet,
    Dissipation,
    Formulation,
    Level,
    Load,
    Method,
    PenaltyContact,
    PowerLawCoulomb,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    Trajectory,
    simulate,
    simulate_many,
    simulate_to_rest,
)
from analysis.simulation.formulations import pose
from tests.bodies import COMPOSED, EGG, TIPPE_TOP
from tests.helpers import (
    EITHER_METHOD,
    angles_apart,
    assert_close,
    jacobian,
    model,
    more_sets,
    mostly_slow,
    not_none,
)
from tests.scenes import LOADED, truth

TIMES = np.linspace(0.0, 0.6, 301)
"""The inversion of Model 1 from Table 3."""


@cache
def reference(level: Level) -> Trajectory:
    """Run from Table 3, accurate to some 1e-12 rad."""
    return simulate(model(level), TIMES, local_tolerance=1e-13)


@pytest.mark.parametrize("formulation", ["index-1", "reduced"])
def test_forms_agree_and_keep_alpha_and_the_clock_of_the_start(formulation: Formulation) -> None:
    turned = model(4, start=Start(alpha=2.0))
    late = simulate(turned, TIMES + 5.0, formulation=formulation, local_tolerance=1e-13)
    expected = reference(4).coordinates + np.array([0.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    np.testing.assert_array_equal(late.times, TIMES + 5.0)
    # Subtracting the start from the late times leaves 1e-15 s, at 40 rad/s.
    np.testing.assert_allclose(late.coordinates, expected, rtol=0.0, atol=2e-12)
    for name in ("rates", "multipliers"):
        assert_close(getattr(late, name), getattr(reference(4), name), relative=1e-11)


@pytest.mark.parametrize("tolerance", mostly_slow([1e-4, 1e-6, 1e-8], [1e-6]))
@pytest.mark.parametrize("method", [*EITHER_METHOD, "RK45", "Radau", "LSODA", "BDF"])
@pytest.mark.parametrize("level", [1, 4])
def test_tolerance_and_estimate_bound_the_error(
    level: Level, method: Method, tolerance: float
) -> None:
    run = simulate(model(level), TIMES, method=method, tolerance=tolerance)
    assert angles_apart(run, reference(level)) <= not_none(run.error_estimate) <= tolerance


@pytest.mark.parametrize("method", ["DOP853", "RK45", "Radau", "BDF"])
def test_a_first_step_that_any_tolerance_leads_to_hides_no_error(method: Method) -> None:
    # SciPy's guess at it is 0.0212 s, where the error that DOP853 sees of it nearly vanishes.
    unlucky = model(2, start=Start(spin=30.0, beta=1.3, gamma=-1.0))
    times = np.linspace(0.0, 1.0, 101)
    truth = simulate(unlucky, times, method="LSODA", local_tolerance=1e-12)
    runs = [simulate(unlucky, times, tolerance=1e-6, method=method)]
    if method == "DOP853":
        runs.append(mbs_models.simulate(unlucky, times, tolerance=1e-6, integrator=method))
    for run in runs:
        assert angles_apart(run, truth) <= not_none(run.error_estimate) <= 1e-6


FREE = Scenario(contact=PenaltyContact.damped(1e5, STEEL_DISK))


@pytest.mark.parametrize("scenario", [*map(model, LEVELS), FREE], ids=str)
def test_motion_begins_with_the_start_and_its_turns(scenario: Scenario) -> None:
    start = Start(alpha=8.0, beta=1.2, gamma=6 * pi + 0.4, spin=-20.0, beta_rate=0.3)
    scenario = replace(scenario, start=start)
    run = simulate(scenario, TIMES[:5], tolerance=1e-6)
    assert run.state(0) == scenario.initial_state
    assert np.max(np.abs(np.diff(run.coordinates[:, 3:], axis=0))) < 0.1


def test_drift_is_the_largest_broken_constraint() -> None:
    run = reference(2)
    places, speeds = run.coordinates.copy(), run.rates.copy()
    places[7, 1] -= 3e-3
    speeds[9, 2] += 5e-2
    position, velocity = analysis.constraint_drift(replace(run, coordinates=places, rates=speeds))
    assert position[7] == pytest.approx(3e-3, rel=1e-9)
    assert velocity[9] == pytest.approx(5e-2, rel=1e-9)
    assert np.max(np.delete(position, 7)) < 1e-11
    assert np.max(np.delete(velocity, 9)) < 1e-10


SLOPE = Table(inclination=0.035, downhill=0.7)
"""Of two degrees."""


@more_sets
@pytest.mark.parametrize("load", LOADS)
def test_energy_balance_closes_and_no_constraint_is_left_on_a_slope(
    constraints: ConstraintSet, load: Load
) -> None:
    # So dense that Simpson's rule over the samples is no error beside the motion's own.
    times = np.linspace(0.0, 0.1, 401)
    start = Start(beta=1.2, beta_rate=0.5 if "held-tilt-rate" in constraints else None)
    law = SmoothCoulomb(load=load)
    scenario = Scenario(
        constraints=constraints, disk=COMPOSED, friction=law, table=SLOPE, start=start
    )
    run = simulate(scenario, times, tolerance=1e-9)
    assert run.ending is None
    kinetic, _ = analysis.energies(run.scenario, run.coordinates, run.rates)
    assert np.max(np.abs(analysis.energy_residual(run))) < 1e-8 * np.max(kinetic)
    position, velocity = analysis.constraint_drift(run)
    assert np.max(position) < 1e-11
    assert np.max(velocity) < 1e-10


def test_balance_refuses_a_motion_whose_losses_it_does_not_know() -> None:
    rolling = Dissipation(rolling_viscous=1e-3, pivoting=5e-5)
    yielding = Scenario(contact=PenaltyContact(stiffness=1e5))
    runs = (
        simulate_to_rest(Scenario.rest(dissipation=rolling), 0.1).to_trajectory(),
        simulate(yielding, [0.0, 0.01], local_tolerance=1e-6),
        mbs_models.simulate(yielding, [0.0, 0.01], step=1e-3),
    )
    for each in runs:
        with pytest.raises(ValueError, match=r"must hold all .* a penalty contact does"):
            analysis.energy_residual(each)
    # Friction acts at another point of a rounded rim.
    with pytest.raises(ValueError, match="must be that of a disk with a sharp rim"):
        analysis.power(runs[0])


LOSSES = Dissipation(rolling_dry=0.01, rolling_viscous=0.01, pivoting=1e-3, air_drag=1.0)
ROUNDED = PenaltyContact(stiffness=1e6, damping=300.0, half_thickness=1e-3)


@pytest.mark.parametrize(
    ("formulation", "scenario"),
    [
        ("reduced", Scenario(constraints=MODELS[4])),
        ("reduced", Scenario(constraints=MODELS[4], friction=AnisotropicCoulomb())),
        ("free-body", Scenario(contact=ROUNDED, dissipation=LOSSES)),
        ("free-body", Scenario(contact=ROUNDED, friction=PowerLawCoulomb(load="contact"))),
    ],
)
def test_jacobian_is_that_of_differences(formulation: str, scenario: Scenario) -> None:
    problem, _ = pose(scenario, formulation, {})
    assert problem.jacobian is not None
    exact, random = problem.jacobian(), np.random.default_rng(5)
    for _ in range(3):
        state = problem.start + 0.01 * random.normal(size=problem.start.size)
        if formulation == "free-body":
            # Neither lifted nor where the damper has just let go.
            state[2] = problem.start[2] - 3e-4
        found = jacobian(lambda moved: np.array(problem.right_hand_side(0.0, moved)), state, 1e-6)
        np.testing.assert_allclose(exact(state), found, atol=1e-7 * np.max(np.abs(found)))


TOP_DROPPED = Scenario(
    disk=TIPPE_TOP,
    contact=PenaltyContact.damped(1e5, TIPPE_TOP),
    start=Start(beta=1.2, gamma=0.6, spin=24.0, height=1.3e-3),
)
BENT: list[tuple[Scenario, Any, dict[str, Any], float]] = [
    # A contact whose force rubs begins or ceases to pull: across that, it would be 1e-6.
    (Scenario(friction=LOADED, start=Start(spin=-122.0, beta=0.7448, gamma=-2.1845)), TIMES[:101],
     {"method": "DOP853", "local_tolerance": 1e-8, "allow_pulling": True}, 5e-8),
    # Slip in one direction reverses, and is small in the other one at the touch-down, too: 4e-9.
    (Scenario(contact=PenaltyContact(stiffness=4.2e4, damping=135.0), friction=LOADED,
              start=Start(beta=0.39, gamma=2.0, spin=18.7, height=3.8e-5)),
     [0.0, 0.062], {"local_tolerance": 1e-9}, 5e-10),
    # A contact opens or closes: across that, two runs agree to 1e-5 by chance, and are 3.7e-5 off.
    *((TOP_DROPPED, [0.0, 0.05], {"tolerance": each}, each)
      for each in np.geomspace(1e-4, 1e-8, 9).tolist()),
]  # fmt: skip
"""Motions that bend, when and how they are run, and what error in rad may be left."""


@pytest.mark.parametrize(("scenario", "times", "how", "within"), BENT)
def test_steps_end_where_a_motion_bends(
    scenario: Scenario, times: Any, how: dict[str, Any], within: float
) -> None:
    pulls = "allow_pulling" in how
    finest: Any = {"method": "DOP853", "allow_pulling": True} if pulls else {"method": "LSODA"}
    found, known = simulate(scenario, times, **how), truth(scenario, times, **finest)
    assert angles_apart(found, known) < within
    assert (len(found.pulling) > 1) == pulls


@pytest.mark.parametrize(
    "simulated",
    [simulate, mbs_models.simulate, partial(mbs_models.simulate, integrator="TrapezoidalIndex2")],
)
def test_no_step_goes_across_where_friction_has_its_full_grip(
    simulated: Callable[..., Trajectory],
) -> None:
    # By a first step across that, runs of both sides were 1.8e-8 off.
    touching = Scenario(
        contact=PenaltyContact(stiffness=1e5, damping=100.0),
        start=Start(beta=2.1, gamma=-1.9, spin=-39.0, height=0.0),
    )
    times = np.array([0.0, 0.02])
    known = truth(touching, times, method="Radau")
    assert angles_apart(simulated(touching, times, tolerance=1e-8), known) < 1e-9


@pytest.mark.parametrize("simulated", [simulate, mbs_models.simulate])
@pytest.mark.parametrize("late", [-3.0, 1e5])
def test_a_motion_is_the_same_at_any_time_on_the_clock(
    simulated: Callable[..., Trajectory], late: float
) -> None:
    dropped = Scenario(
        contact=PenaltyContact.damped(1e5, STEEL_DISK),
        start=Start(height=1e-3, beta=1.0, spin=5.0),
    )
    pulled = Scenario(start=Start(spin=200.0))
    for scenario, how in (
        (dropped, {}), (Scenario(), {"stop_when": "inverted"}), (pulled, {"allow_pulling": True})
    ):  # fmt: skip
        times = np.array([0.0, 0.05, 0.5]) if scenario.contact is None else np.array([0.0, 0.05])
        runs = [simulated(scenario, each + times, tolerance=1e-8, **how) for each in (0.0, late)]
        first, second = runs
        np.testing.assert_allclose(second.times - late, first.times, atol=1e-10)
        np.testing.assert_allclose(second.coordinates, first.coordinates, atol=1e-7)
        assert (second.ending and second.ending.reason) == (first.ending and first.ending.reason)
        shifted = [[each - late for each in pair] for pair in second.pulling]
        np.testing.assert_allclose(shifted, first.pulling, atol=1e-9)


@pytest.mark.parametrize("simulated", [simulate, mbs_models.simulate])
@pytest.mark.parametrize("smoothing", mostly_slow([1e-9, 1e-12], [1e-9]))
@pytest.mark.parametrize("contact", [None, PenaltyContact(stiffness=1e5, damping=10.0)])
def test_steps_of_runs_to_a_tolerance_resolve_the_slip_over_which_friction_sets_in(
    simulated: Callable[..., Trajectory], smoothing: float, contact: PenaltyContact | None
) -> None:
    # Two coarser ones agreed to 2e-7 rad and were wrong by 7e-4.
    scenario = Scenario(friction=SmoothCoulomb(smoothing=smoothing), contact=contact)
    times = np.linspace(0.0, 0.01, 3)
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
