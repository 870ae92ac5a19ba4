"""In-house simulation: accuracy, the paper's statements, and what is refused."""

from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest

import analysis
from analysis import (
    LEVELS,
    STEEL_DISK,
    ConstraintSet,
    Formulation,
    Level,
    Method,
    PenaltyContact,
    Scenario,
    Start,
    Table,
    Trajectory,
    simulate,
)
from tests.helpers import all_sets, angles_apart, assert_close, model, mostly_slow, not_none

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
@pytest.mark.parametrize("method", ["DOP853", "RK45", "Radau", "LSODA", "BDF"])
@pytest.mark.parametrize("level", [1, 4])
def test_tolerance_and_estimate_bound_the_error(
    level: Level, method: Method, tolerance: float
) -> None:
    run = simulate(model(level), TIMES, method=method, tolerance=tolerance)
    assert angles_apart(run, reference(level)) <= not_none(run.error_estimate) <= tolerance


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


@all_sets
def test_energy_balance_closes_and_no_constraint_is_left_on_a_slope(
    constraints: ConstraintSet,
) -> None:
    # So dense that Simpson's rule over the samples is no error beside the motion's own.
    times = np.linspace(0.0, 0.1, 401)
    scenario = Scenario(constraints=constraints, table=SLOPE, start=Start(beta=1.2))
    run = simulate(scenario, times, tolerance=1e-9)
    assert run.ending is None
    kinetic, _ = analysis.energies(run.scenario, run.coordinates, run.rates)
    assert np.max(np.abs(analysis.energy_residual(run))) < 1e-8 * np.max(kinetic)
    position, velocity = analysis.constraint_drift(run)
    assert np.max(position) < 1e-11
    assert np.max(velocity) < 1e-10
