"""Simulation in the engine."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    Scenario,
    SmoothCoulomb,
    Start,
    TimeLimitError,
    ToleranceError,
    Trajectory,
)
from mbs_models import EngineError, Integrator, Newton, Scene
from mbs_models.extrapolation import Ladder
from mbs_models.newton import force_rounding
from mbs_models.scene import build
from tests.helpers import model, mostly_slow, not_none
from tests.scenes import rest_scene, scene_of

TIMES = np.linspace(0.0, 0.5, 51)


def angle_error(run: Trajectory, other: Trajectory) -> float:
    return float(np.max(np.abs(run.coordinates - other.coordinates)[:, 4:6]))


@pytest.mark.parametrize("tolerance", mostly_slow([1e-3, 1e-5, 1e-7, 1e-9], [1e-5, 1e-7]))
@pytest.mark.parametrize("scene", [Scene(), scene_of(3), scene_of(2)])
def test_tolerance_is_met_and_the_estimate_is_honest(scene: Scene, tolerance: float) -> None:
    truth = analysis.simulate(scene.scenario, TIMES, local_tolerance=1e-13)
    run = mbs_models.simulate(scene, TIMES, tolerance=tolerance)
    assert angle_error(run, truth) <= not_none(run.error_estimate) <= tolerance


def test_unreachable_tolerance_raises_with_the_best_estimate() -> None:
    times, scene = np.linspace(0.0, 0.1, 11), scene_of(1, "floating-lie")
    with pytest.raises(ToleranceError, match=r"tolerance 2\.1e-13 rad cannot be reached .* is \d"):
        mbs_models.simulate(scene, times, tolerance=2.1e-13)


@pytest.mark.parametrize(
    ("integrator", "order"), [("RK44", 4), ("RK67", 6), ("TrapezoidalIndex2", 2)]
)
def test_observed_order_is_that_of_the_integrator(integrator: Any, order: int) -> None:
    truth = analysis.simulate(Scenario(), TIMES, local_tolerance=1e-13)
    step = 2.5e-3 if order < 6 else 5e-3
    errors = [
        angle_error(mbs_models.simulate(Scene(), TIMES, step=size, integrator=integrator), truth)
        for size in (step, step / 2)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("formulation", ["floating", "euler-tree"])
def test_contact_force_as_load_costs_no_order(formulation: Any) -> None:
    friction = SmoothCoulomb(load="contact")
    truth = analysis.simulate(model(3, friction=friction), TIMES, local_tolerance=1e-13)
    scene = scene_of(3, formulation, friction=friction)
    errors = [
        angle_error(mbs_models.simulate(scene, TIMES, step=size), truth) for size in (2e-3, 1e-3)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(
    ("formulation", "accuracy"),
    [
        ("contact-tree", {"integrator": Integrator(name="DOPRI5", local_tolerance=1e-11)}),
        ("contact-tree", {"tolerance": 1e-6, "integrator": "RK67"}),
        ("euler-tree", {"tolerance": 1e-5, "integrator": "TrapezoidalIndex2"}),
        ("floating-lie", {"tolerance": 1e-6}),
    ],
)
def test_uneven_times_give_the_same_motion_as_even_ones(
    formulation: Any, accuracy: dict[str, Any]
) -> None:
    uneven = np.array([0.0, 0.003, 0.1, 0.1001, 0.13, 0.2])
    truth = analysis.simulate(Scenario(), uneven, local_tolerance=1e-13)
    run = mbs_models.simulate(Scene(Scenario(), formulation), uneven, **accuracy)
    np.testing.assert_array_equal(run.times, uneven)
    np.testing.assert_allclose(run.coordinates, truth.coordinates, atol=1e-5)
    np.testing.assert_allclose(run.multipliers, truth.multipliers, atol=1e-3)


@pytest.mark.parametrize("formulation", mbs_models.formulations(Scenario()))
def test_coarse_sampling_of_a_fast_spin_loses_no_turns(formulation: Any) -> None:
    start = Start(gamma=np.pi / 2 - 0.01, spin=300.0)
    times = np.linspace(0.0, 0.2, 5)
    truth = analysis.simulate(
        Scenario(start=start), times, local_tolerance=1e-11, allow_pulling=True
    )
    scene = scene_of(1, formulation, start=start)
    run = mbs_models.simulate(scene, times, tolerance=1e-4, allow_pulling=True)
    assert truth.coordinates[-1, 3] > 18 * np.pi
    np.testing.assert_allclose(run.coordinates[:, 3:], truth.coordinates[:, 3:], atol=1e-3)


def test_start_time_only_shifts_the_times() -> None:
    early = mbs_models.simulate(Scene(), TIMES, step=5e-3)
    late = mbs_models.simulate(Scene(), TIMES + 8.0, step=5e-3)
    np.testing.assert_allclose(late.coordinates, early.coordinates, atol=1e-9)


def test_lost_order_shows_up_as_a_slow_ladder_and_not_as_a_false_estimate() -> None:
    ladder = Ladder("euler-tree", "TrapezoidalIndex2", 0.0)
    for step in (1.0, 0.5, 0.25, 0.125):
        # A first-order error, which the extrapolation in even powers does not expect.
        ladder.add(np.full((3, 12), 1.0 + 0.1 * step), np.arange(3.0), step)
        if ladder.estimate < np.inf:
            assert ladder.estimate >= float(np.max(np.abs(ladder.best - 1.0)))


@pytest.mark.parametrize(
    ("errors", "least"),
    [
        # Two runs that agree by chance: their error may still be a quarter of that before.
        ((0.0, 0.1, 0.1), 0.1 / 4),
        # Two extrapolated runs that agree by chance: no better than the next order.
        ((0.16, 0.04, 0.01), 0.03 / 4),
    ],
)
def test_runs_that_agree_by_chance_count_for_what_those_before_let_expect(
    errors: tuple[float, ...], least: float
) -> None:
    ladder = Ladder("euler-tree", "TrapezoidalIndex2", 0.0)
    for halvings, error in enumerate(errors):
        ladder.add(np.full((3, 12), 1.0 + error), np.arange(3.0), 0.01 / 2**halvings)
    assert ladder.estimate >= 0.999 * least


@pytest.mark.parametrize(
    ("scene", "proposal"),
    [
        (Scene(), "integrator 'DOPRI5'"),
        (scene_of(1, "floating"), "formulation 'contact-tree'"),
        (scene_of(3), "the in-house equations"),
        (scene_of(1, "floating", friction=SmoothCoulomb(load="contact")), "the in-house"),
    ],
)
def test_a_tolerance_that_is_not_met_proposes_another_way(scene: Scene, proposal: str) -> None:
    with pytest.raises(TimeLimitError, match=f"time limit met.*; try {proposal}"):
        mbs_models.simulate(scene, np.linspace(0.0, 99.0, 991), tolerance=1e-9, time_limit=0.05)


@pytest.mark.parametrize("spin", [3.0, 40.0, 150.0])
@pytest.mark.parametrize("formulation", ["euler-tree", "floating", "floating-lie"])
@pytest.mark.parametrize("level", [2, 3, 4])
def test_newtons_limit_lies_where_rounding_does(level: Any, formulation: Any, spin: float) -> None:
    start = Start(beta=1.2, spin=spin, beta_rate=0.3 * spin)
    scene = scene_of(level, formulation, start=start)
    strict = Integrator(name="TrapezoidalIndex2", newton=Newton(modified=False, relative=1e-30))
    # Below the limit nothing but rounding is left, so that no further iteration is needed.
    run = mbs_models.simulate(
        scene, [0.0, 1e-4, 2e-4], step=1e-4, integrator=strict, allow_pulling=True
    )
    assert run.counts["newton_iterations"] <= 8 * run.counts["steps"]
    assert force_rounding(build(scene)) < 1e-11 * scene.scenario.weight


def test_runs_print_nothing_and_write_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    mbs_models.simulate(scene_of(2, friction=SmoothCoulomb(load="contact")), TIMES, step=2e-4)
    mbs_models.simulate_to_rest(rest_scene(), 0.01)
    with pytest.raises(EngineError):
        mbs_models.simulate(scene_of(1, "euler-tree"), [0.0, 2.0], step=1.0)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())
