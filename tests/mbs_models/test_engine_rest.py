"""The engine's way to rest against the in-house one, and its refusals."""

from dataclasses import fields
from itertools import pairwise
from math import log2

import numpy as np
import pytest

import mbs_models
from analysis import (
    Scenario,
    Start,
    TimeLimitError,
    ToleranceError,
    simulate_to_rest,
)
from analysis.data.dissipation import Dissipation
from analysis.data.spatial_motion import SpatialMotion
from tests.helpers import mostly_slow, not_none
from tests.scenes import rest_scene

EVERYTHING = Dissipation(
    rolling_dry=1e-3, rolling_viscous=1e-4, pivoting=5e-5, air_drag=1.2, rolling_smoothing=0.1
)
SETTLING = Dissipation(rolling_viscous=2e-3, pivoting=2e-4)


@pytest.fixture(scope="module")
def settled() -> SpatialMotion:
    return mbs_models.simulate_to_rest(rest_scene(dissipation=SETTLING), 30.0, step=1e-4)


@pytest.mark.slow
def test_engine_converges_to_the_in_house_motion_with_order_4() -> None:
    scene = rest_scene(dissipation=EVERYTHING)
    other = simulate_to_rest(
        scene.scenario,
        0.5,
        spacing=1e-2,
        method="DOP853",
        local_tolerance=1e-12,
    )
    errors, unexplained, damping = [], [], []
    for step in (2e-4, 1e-4, 5e-5):
        found = mbs_models.simulate_to_rest(scene, 0.5, step=step, spacing=1e-2)
        errors.append(float(np.max(np.abs(found.rotations - other.rotations))))
        unexplained.append(float(np.max(np.abs(found.energy_residual))))
        taken = [motion.energy_taken("damping")[-1] for motion in (found, other)]
        damping.append(abs(taken[0] - taken[1]))
        np.testing.assert_allclose(found.positions, other.positions, atol=1e-9)
    assert errors[-1] < 1e-8
    np.testing.assert_allclose(found.dissipated, other.dissipated, atol=1e-9)
    assert taken[0] == pytest.approx(taken[1], rel=0.01)
    for measured in (errors, unexplained, damping):
        for coarse, fine in pairwise(measured):
            assert log2(coarse / fine) > 3.5


@pytest.fixture(scope="module")
def impacts() -> SpatialMotion:
    return simulate_to_rest(
        Scenario.rest(start=Start(height=5e-3)), 0.5, spacing=5e-3, local_tolerance=1e-12
    )


@pytest.mark.parametrize("tolerance", mostly_slow([1e-2, None, 1e-5], [None]))
def test_impacts_meet_the_tolerance_and_its_estimate(
    tolerance: float | None, impacts: SpatialMotion
) -> None:
    scene = rest_scene(start=Start(height=5e-3))
    found = mbs_models.simulate_to_rest(scene, 0.5, tolerance=tolerance, spacing=5e-3)
    assert found.deviation(impacts) <= not_none(found.error_estimate) <= (tolerance or 1e-3)
    assert found.energy_taken("damping")[-1] == pytest.approx(0.0213610, rel=tolerance or 1e-3)


def test_engine_says_when_no_two_runs_agree() -> None:
    scene = rest_scene(start=Start(height=1e-3))
    with pytest.raises(ToleranceError, match="tolerance 1e-15 cannot be reached"):
        mbs_models.simulate_to_rest(scene, 0.04, tolerance=1e-15, spacing=1e-2)


def test_time_limit_ends_engine_runs_with_what_they_reached(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = iter(range(10**9))
    monkeypatch.setattr("analysis.data.watch.time.process_time", lambda: 0.1 * next(clock))
    told: list[tuple[float, float]] = []
    for settings, limit in (({"step": 1e-4}, 0.45), ({"tolerance": 1e-3}, 15.0)):
        found = mbs_models.simulate_to_rest(
            rest_scene(),
            1.0,
            time_limit=limit,
            progress=lambda reached, end: told.append((reached, end)),
            **settings,  # type: ignore[arg-type]
        )
        assert found.ending is not None
        assert found.ending.reason == "time limit"
        assert found.ending.time == found.times[-1] < 1.0
        assert found.ending.value > limit
        assert found.rest_time is None
        assert found.error_estimate is None
    assert {end for _, end in told} == {1.0}
    assert max(reached for reached, _ in told) > 0.1
    with pytest.raises(TimeLimitError, match="before the first sample"):
        mbs_models.simulate_to_rest(rest_scene(), 1.0, time_limit=1e-3)


def test_scene_runs_like_any_other_and_as_in_house_before_the_disk_lies_flat() -> None:
    scene = rest_scene(dissipation=EVERYTHING)
    times = np.linspace(0.0, 0.2, 21)
    motion = simulate_to_rest(scene.scenario, 0.2, spacing=1e-2, local_tolerance=1e-11)
    to_rest = mbs_models.simulate_to_rest(scene, 0.2, step=1e-4, spacing=1e-2)
    np.testing.assert_allclose(to_rest.dissipated, motion.dissipated, atol=1e-8)
    found, other = mbs_models.simulate(scene, times, tolerance=1e-6), motion.to_trajectory()
    np.testing.assert_allclose(found.coordinates, other.coordinates, atol=1e-6)
    np.testing.assert_allclose(found.normal_force, other.normal_force, atol=1e-4)


@pytest.mark.slow
def test_engine_comes_to_rest_as_the_in_house_motion_does(settled: SpatialMotion) -> None:
    other = simulate_to_rest(settled.scenario, 30.0, local_tolerance=1e-10)
    count = min(settled.times.size, other.times.size)
    np.testing.assert_allclose(settled.tilt[:count], other.tilt[:count], atol=1e-4)
    one, two = settled.phases, other.phases
    for phase in fields(one):
        found = getattr(one, phase.name)
        assert found == pytest.approx(getattr(two, phase.name), abs=5e-3)
