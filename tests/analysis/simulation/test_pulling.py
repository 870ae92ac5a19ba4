"""A bilateral contact that would have to pull, time limits, and progress, on both sides."""

from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LOADS,
    Level,
    Load,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    TimeLimitError,
)
from analysis.problem.choices import SOURCES, Source
from mbs_models import Formulation, Scene, formulations
from tests.helpers import model, mostly_slow, not_none
from tests.scenes import scene_of
from validation.kit.differences import ending_error
from validation.run import run

TIMES = np.linspace(0.0, 0.2, 21)
FAST = Start(spin=150.0)
SIDES = pytest.mark.parametrize("source", SOURCES)
LOADED = {load: SmoothCoulomb(load=load) for load in LOADS}
CASES: list[tuple[Level, Formulation, Load]] = [
    (level, formulation, load)
    for level in (1, 2)
    for load in LOADS
    for formulation in formulations(model(level, friction=LOADED[load]))
]


@pytest.mark.parametrize("case", mostly_slow(CASES, CASES[::4]), ids=str)
def test_both_sides_end_where_the_contact_would_pull(
    case: tuple[Level, Formulation, Load],
) -> None:
    level, formulation, load = case
    scenario = model(level, friction=LOADED[load], start=FAST)
    engine = mbs_models.simulate(Scene(scenario, formulation), TIMES, tolerance=1e-5)
    in_house = analysis.simulate(scenario, TIMES, tolerance=1e-9)
    assert ending_error(engine, in_house) < 1e-7
    assert not_none(in_house.ending).reason == "contact would pull"
    np.testing.assert_allclose(engine.coordinates, in_house.coordinates, atol=1e-5)
    for found in (engine, in_house):
        assert np.all(found.normal_force[:-1] > 0.0)
        assert abs(found.normal_force[-1]) < 1e-4 * found.scenario.weight
        assert not_none(found.ending).value == found.normal_force[-1]


@pytest.mark.parametrize("formulation", ["euler-tree", "floating-lie"])
def test_a_penalty_contact_that_holds_down_ends_as_the_ideal_one(formulation: Any) -> None:
    contact = PenaltyContact(stiffness=1e6, damping=300.0, bilateral=True)
    scene = scene_of(1, formulation, contact=contact, friction=LOADED["contact"], start=FAST)
    held = mbs_models.simulate(scene, TIMES, step=5e-5)
    ideal = analysis.simulate(replace(scene.scenario, contact=None), TIMES)
    assert held.ending is not None
    assert ending_error(held, ideal) < 2e-4


@SIDES
def test_a_start_that_needs_a_pulling_contact_is_refused(source: Source) -> None:
    start = Start(beta=0.5, spin=0.0, beta_rate=-40.0, gamma_rate=0.0)
    with pytest.raises(ValueError, match="start needs a contact that pulls, with a normal force"):
        run(Scenario(start=start), TIMES, source=source)


@SIDES
def test_a_run_ends_at_its_time_limit_or_raises_where_no_tolerance_was_met(source: Source) -> None:
    times = np.linspace(0.0, 1000.0, 100_001)
    how: dict[str, Any] = {"step": 1e-3} if source == "engine" else {"local_tolerance": 1e-8}
    found = run(model(2), times, source=source, time_limit=0.2, **how)
    assert not_none(found.ending).reason == "time limit"
    assert not_none(found.ending).value > 0.2
    assert found.times.size < times.size
    np.testing.assert_array_equal(found.times[:-1], times[: found.times.size - 1])
    with pytest.raises(TimeLimitError, match="time limit met"):
        run(model(2), times, source=source, tolerance=1e-6, time_limit=0.1)


@SIDES
def test_solver_seconds_are_those_of_the_last_run_to_a_tolerance(
    source: Source, monkeypatch: pytest.MonkeyPatch
) -> None:
    readings = count()
    monkeypatch.setattr("analysis.solve.stepping.time.thread_time", lambda: float(next(readings)))
    assert run(model(2), TIMES, source=source, tolerance=1e-4).solver_seconds == 1.0
    # Each run reads the clock twice.
    assert next(readings) >= 4


def test_two_runs_that_agree_up_to_a_time_limit_are_a_result_up_to_the_samples_of_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    steps = count()
    monkeypatch.setattr("analysis.solve.watch.time.process_time", lambda: float(next(steps)))
    whole = analysis.simulate(model(2), TIMES, tolerance=1e-3, time_limit=1e9)
    taken = next(steps)
    part = analysis.simulate(model(2), TIMES, tolerance=1e-3, time_limit=0.75 * taken)
    last = part.times.size
    assert not_none(part.ending).reason == "time limit"
    assert 1 < last < TIMES.size
    np.testing.assert_array_equal(part.times, TIMES[:last])
    assert np.max(np.abs(part.coordinates - whole.coordinates[:last])[:, 4:]) < 1e-6
    assert not_none(part.error_estimate) <= 1e-3
