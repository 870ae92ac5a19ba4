"""Why a motion of the engine ends, and where: as the in-house one does."""

from math import pi

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import Level, PenaltyContact, Scenario, Start, State, Trajectory
from analysis.data.endings import REACHED, StopWhen
from mbs_models import Formulation, Scene, formulations
from tests.helpers import model, mostly_slow, not_none

TIMES = np.linspace(0.0, 0.5, 51)
LONG = np.linspace(0.0, 0.6, 121)


def slow(state: State) -> float:
    return state.rates[3] - 39.5


def test_first_of_several_conditions_ends_the_run() -> None:
    run = mbs_models.simulate(Scene(), TIMES, step=5e-3, stop_when=["inverted", slow])
    assert not_none(run.ending).reason == "slow"


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
    assert not_none(run.ending).time == pytest.approx(not_none(other.ending).time, abs=1e-4)


def test_work_ends_with_the_run() -> None:
    times = np.linspace(0.0, 10.0, 1001)
    run = mbs_models.simulate(Scene(), times, step=1e-2, stop_when=slow)
    assert run.counts["steps"] < 200


def test_time_limit_does_not_end_a_run_that_is_allowed_to_pull() -> None:
    scenario = model(2, start=Start(spin=150.0))
    run = mbs_models.simulate(
        Scene(scenario), TIMES[:21], step=1e-3, allow_pulling=True, time_limit=1e3
    )
    assert run.ending is None
    assert run.pulling


def test_ended_runs_have_not_pulled() -> None:
    scene = Scene(Scenario(start=Start(spin=150.0)))
    for accuracy in ({"step": 2e-3}, {"tolerance": 1e-5}, {"tolerance": 1e-6}):
        run = mbs_models.simulate(scene, TIMES, **accuracy)  # type: ignore[arg-type]
        assert run.ending is not None
        assert run.pulling == ()


def test_what_a_run_cannot_end_at_is_named() -> None:
    with pytest.raises(
        ValueError, match="stop_when must be one of inverted, lost, module:function, got 'asleep'"
    ):
        mbs_models.simulate(Scene(), TIMES, step=5e-3, stop_when="asleep")
    with pytest.raises(ValueError, match="stop_when <lambda> must be a finite number, got None"):
        mbs_models.simulate(Scene(), TIMES, step=5e-3, stop_when=lambda _: None)  # type: ignore[arg-type,return-value]


FALLING = Start(beta=1.0, gamma=pi / 2, spin=0.0)
ENGINE_WAYS = ["contact-tree", "euler-tree", "floating", "floating-lie"]


def turning(state: State) -> float:
    return 6 * pi + 1.2 - state.coordinates[5]


def check_same_ending(found: Trajectory, expected: Trajectory, apart: float) -> str:
    """Reason for which both end, at times that differ by so many seconds at most."""
    assert found.ending is not None
    assert expected.ending is not None
    assert found.ending.reason == expected.ending.reason
    assert found.ending.time == pytest.approx(expected.ending.time, abs=apart)
    return found.ending.reason


@pytest.mark.parametrize("formulation", mostly_slow(ENGINE_WAYS, ["euler-tree"]))
@pytest.mark.parametrize("condition", ["inverted", slow, turning])
def test_engine_runs_end_where_the_in_house_ones_do(
    formulation: Formulation, condition: StopWhen
) -> None:
    # Many turns of gamma before the start: a free body's angles are followed on from there.
    scenario = Scenario(start=Start(gamma=-pi / 2 + 0.1 + 6 * pi))
    expected = analysis.simulate(scenario, LONG, tolerance=1e-10, stop_when=condition)
    found = mbs_models.simulate(
        Scene(scenario, formulation), LONG, tolerance=1e-6, stop_when=condition
    )
    check_same_ending(found, expected, 1e-9)
    np.testing.assert_allclose(found.coordinates, expected.coordinates, atol=1e-7)


@pytest.mark.parametrize("level", [1, 2, 4])
@pytest.mark.parametrize(
    "formulation", mostly_slow(["contact-tree", "euler-tree", "floating-lie"], ["contact-tree"])
)
def test_a_fall_ends_in_the_engine_as_in_house(level: Level, formulation: Formulation) -> None:
    scenario = model(level, start=FALLING)
    if formulation not in formulations(scenario):
        return
    expected = analysis.simulate(scenario, LONG, tolerance=1e-9)
    found = mbs_models.simulate(Scene(scenario, formulation), LONG, tolerance=1e-6)
    assert check_same_ending(found, expected, 1e-8) == "flat"
    np.testing.assert_allclose(found.coordinates[:, 4], expected.coordinates[:, 4], atol=1e-6)


@pytest.mark.parametrize("formulation", ENGINE_WAYS)
def test_a_single_run_of_fixed_steps_ends_too(formulation: Formulation) -> None:
    run = mbs_models.simulate(Scene(Scenario(), formulation), LONG, step=1e-3, stop_when=slow)
    assert not_none(run.ending).reason == "slow"
    assert run.rate("alpha")[-1] == pytest.approx(39.5, abs=1e-9)
