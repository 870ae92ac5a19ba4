"""Why a motion of the engine ends, and where: as the in-house one does."""

from math import pi

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import Level, PenaltyContact, Scenario, SmoothCoulomb, Start, State, Trajectory
from analysis.data.endings import REACHED, StopWhen
from mbs_models import Formulation, Scene, formulations
from tests.scenes import scenario_of

TIMES = np.linspace(0.0, 0.5, 51)
FALLING = Start(beta=1.0, gamma=pi / 2, spin=0.0)


def turned(state: State) -> float:
    """Negative after more than a turn about the vertical."""
    return 7.0 - state.coordinates[3]


def slow(state: State) -> float:
    return state.rates[3] - 39.5


def assert_ends_alike(
    engine: Trajectory, other: Trajectory, reason: str, within: float = 1e-6
) -> None:
    assert engine.ending is not None
    assert other.ending is not None
    assert engine.ending.reason == other.ending.reason == reason
    assert engine.ending.time == engine.times[-1] == pytest.approx(other.ending.time, abs=within)
    np.testing.assert_allclose(engine.coordinates[:-1], other.coordinates[:-1], atol=2e-6)


@pytest.mark.parametrize("stop_when", ["inverted", turned, slow], ids=str)
@pytest.mark.parametrize("formulation", formulations(Scenario()))
def test_engine_ends_where_the_in_house_run_does(
    formulation: Formulation, stop_when: StopWhen
) -> None:
    scenario = Scenario()
    scene = Scene(scenario, formulation)
    run = mbs_models.simulate(scene, TIMES, tolerance=1e-6, stop_when=stop_when)
    other = analysis.simulate(scenario, TIMES, tolerance=1e-9, stop_when=stop_when)
    reason = stop_when if isinstance(stop_when, str) else stop_when.__name__  # type: ignore[union-attr]
    assert_ends_alike(run, other, reason)
    assert run.ending is not None
    assert run.ending.value == pytest.approx(0.0, abs=1e-4)
    assert TIMES[0] < run.ending.time < TIMES[-1]


FALLS = [(level, each) for level in (1, 4) for each in formulations(scenario_of(level))]


@pytest.mark.parametrize(("level", "formulation"), FALLS)
def test_a_fall_is_a_result_that_ends_where_the_disk_lies_flat(
    level: Level, formulation: Formulation
) -> None:
    scenario = scenario_of(level, start=FALLING, friction=SmoothCoulomb(coefficient=0.0))
    run = mbs_models.simulate(Scene(scenario, formulation), TIMES, tolerance=1e-6)
    other = analysis.simulate(scenario, TIMES, tolerance=1e-9)
    assert_ends_alike(run, other, "flat", within=1e-5)
    assert 0.0 < run.coordinate("beta")[-1] < 1e-4


def test_first_of_several_conditions_ends_the_run() -> None:
    run = mbs_models.simulate(Scene(), TIMES, step=5e-3, stop_when=["inverted", slow])
    assert run.ending is not None
    assert run.ending.reason == "slow"


def test_a_condition_that_holds_from_the_start_waits_until_it_has_not() -> None:
    inverted = Scenario(start=Start(gamma=pi / 2 - 0.01, spin=40.0))
    assert np.sin(inverted.initial_state.coordinates[5]) > REACHED
    for formulation in formulations(inverted):
        scene = Scene(inverted, formulation)
        run = mbs_models.simulate(scene, TIMES[:11], step=2e-3, stop_when="inverted")
        assert run.ending is None


def test_a_condition_ends_the_run_on_a_penalty_contact_too() -> None:
    scenario = Scenario(contact=PenaltyContact(stiffness=1e6, damping=300.0))
    run = mbs_models.simulate(Scene(scenario), TIMES, step=1e-4, stop_when="inverted")
    other = analysis.simulate(scenario, TIMES, tolerance=1e-8, stop_when="inverted")
    assert run.ending is not None
    assert other.ending is not None
    assert run.ending.time == pytest.approx(other.ending.time, abs=1e-4)


def test_work_ends_with_the_run() -> None:
    times = np.linspace(0.0, 10.0, 1001)
    run = mbs_models.simulate(Scene(), times, step=1e-2, stop_when=slow)
    assert run.counts["steps"] < 200


def test_time_limit_does_not_end_a_run_that_is_allowed_to_pull() -> None:
    scenario = scenario_of(2, start=Start(spin=150.0))
    run = mbs_models.simulate(
        Scene(scenario), TIMES[:21], step=1e-3, allow_pulling=True, time_limit=1e3
    )
    assert run.ending is None
    assert run.pulling


def test_ended_runs_have_not_pulled() -> None:
    run = mbs_models.simulate(Scene(Scenario(start=Start(spin=150.0))), TIMES, step=2e-3)
    assert run.ending is not None
    assert run.pulling == ()


def test_what_a_run_cannot_end_at_is_named() -> None:
    with pytest.raises(ValueError, match="stop_when must be one of inverted, got 'asleep'"):
        mbs_models.simulate(Scene(), TIMES, step=5e-3, stop_when="asleep")
