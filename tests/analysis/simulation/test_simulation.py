"""In-house simulation: accuracy, the paper's statements, and what is refused."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest

from analysis import (
    LEVELS,
    STEEL_DISK,
    ConstraintSet,
    Form,
    Level,
    Method,
    PenaltyContact,
    Scenario,
    Start,
    Table,
    ToleranceError,
    Trajectory,
    constraint_drift,
    energies,
    energy_residual,
    simulate,
)
from analysis.mechanics import reduced
from analysis.problem.checks import Array
from analysis.simulation.forms import pose
from analysis.simulation.request import TIGHTEST_LOCAL_TOLERANCE
from analysis.solve.stepping import Run
from analysis.solve.to_tolerance import run_to, tighter_and_tighter
from tests.helpers import all_sets, assert_close, model, mostly_slow, not_none

TIMES = np.linspace(0.0, 0.6, 301)
"""The inversion of Model 1 from Table 3."""

FORMS_OF_4: tuple[Form, ...] = ("index-1", "reduced")

levels = pytest.mark.parametrize("level", LEVELS)


@cache
def reference(level: Level) -> Trajectory:
    """Run from Table 3, accurate to some 1e-12 rad."""
    return simulate(model(level), TIMES, local_tolerance=1e-13)


def difference(first: Trajectory, second: Trajectory) -> float:
    """Largest difference in beta and gamma in rad."""
    return float(np.max(np.abs(first.coordinates - second.coordinates)[:, 4:]))


def test_index_1_and_reduced_form_of_model_4_agree() -> None:
    scenario = model(4, start=Start(beta=1.3, gamma=-0.7, spin=30.0, beta_rate=2.0))
    full, minimal = (
        simulate(scenario, TIMES, form=form, local_tolerance=1e-13) for form in FORMS_OF_4
    )
    for name in ("coordinates", "rates", "multipliers"):
        assert_close(getattr(minimal, name), getattr(full, name), relative=1e-11)


@pytest.mark.parametrize("form", FORMS_OF_4)
def test_forms_keep_alpha_and_the_clock_of_the_start(form: Form) -> None:
    turned = model(4, start=Start(alpha=2.0))
    late = simulate(turned, TIMES + 5.0, form=form, local_tolerance=1e-13)
    expected = reference(4).coordinates + np.array([0.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    np.testing.assert_array_equal(late.times, TIMES + 5.0)
    # Subtracting the start from the late times leaves 1e-15 s, at 40 rad/s.
    np.testing.assert_allclose(late.coordinates, expected, rtol=0.0, atol=2e-12)


@pytest.mark.parametrize("tolerance", mostly_slow([1e-4, 1e-6, 1e-8], [1e-6]))
@pytest.mark.parametrize("method", ["DOP853", "RK45", "Radau", "LSODA", "BDF"])
@pytest.mark.parametrize("level", [1, 4])
def test_tolerance_and_estimate_bound_the_error(
    level: Level, method: Method, tolerance: float
) -> None:
    run = simulate(model(level), TIMES, method=method, tolerance=tolerance)
    assert difference(run, reference(level)) <= not_none(run.error_estimate) <= tolerance


@levels
def test_motion_does_not_depend_on_the_times_asked_for(level: Level) -> None:
    sparse = simulate(model(level), TIMES[::60], tolerance=1e-9)
    samples = reference(level).coordinates[::60, 4:]
    np.testing.assert_allclose(sparse.coordinates[:, 4:], samples, rtol=0.0, atol=1e-9)


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
    position, velocity = constraint_drift(replace(run, coordinates=places, rates=speeds))
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
    kinetic, _ = energies(run.scenario, run.coordinates, run.rates)
    assert np.max(np.abs(energy_residual(run))) < 1e-8 * np.max(kinetic)
    position, velocity = constraint_drift(run)
    assert np.max(position) < 1e-11
    assert np.max(velocity) < 1e-10


def test_integration_that_gives_up_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    # gamma = 1 / (1.005 - t) has no value at t = 1.005 s.
    scenario = model(4, start=Start(gamma=1 / 1.005))

    def diverging(*_: object) -> Callable[[float, Array], tuple[float, ...]]:
        return lambda _, x: (0.0, x[1] ** 2, 0.0)

    monkeypatch.setattr(reduced, "right_hand_side", diverging)
    with pytest.raises(ArithmeticError, match=r"^DOP853 stopped after t = 1\.005 s: "):
        simulate(scenario, np.linspace(0.0, 2.0, 201), form="reduced")


def test_unreachable_tolerance_is_refused() -> None:
    message = r"^tolerance 1e-16 rad cannot be reached with RK23: .* is \d\.\de-\d\d rad$"
    with pytest.raises(ToleranceError, match=message):
        simulate(Scenario(), [0.0, 0.01], method="RK23", tolerance=1e-16)


@pytest.mark.parametrize("first", [1e-3, 1e-13, 1e-16])
def test_compared_runs_share_neither_their_local_tolerance_nor_their_longest_step(
    first: float,
) -> None:
    # Two runs of nearly the same one agree without being right.
    used: list[tuple[float, float]] = []

    def never_agree(*how: float) -> Run:
        used.append(how)  # type: ignore[arg-type]
        return Run(TIMES, np.full((TIMES.size, 12), float(len(used))), 1, None, ())

    rungs = tighter_and_tighter(first, TIGHTEST_LOCAL_TOLERANCE)
    problem = pose(Scenario(), "index-1", {}).problem
    with pytest.raises(ToleranceError):
        run_to(never_agree, problem, TIMES, 1e-6, rungs, method="none")
    local, longest = np.transpose(used)
    assert local[-1] == TIGHTEST_LOCAL_TOLERANCE
    assert np.min(local[:-1] / local[1:]) >= 3.0
    assert np.max(longest[1:] / longest[:-1]) <= 0.9
