"""Runs to rest that are told where to end."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import (
    Dissipation,
    Scenario,
    SpatialMotion,
    Start,
    State,
    ToleranceError,
    load_run,
    simulate_to_rest,
)
from analysis.data.agreement import until_agreement
from analysis.data.trajectory import SOURCES, Source
from tests.calls import printed
from tests.helpers import mostly_slow, not_none
from validation.run import run_to_rest

SCENARIO = Scenario.rest(start=Start(spin=40.0))
LIMIT = 1.6


def tilted(state: State) -> float:
    return LIMIT - state.coordinates[4]


@pytest.fixture(scope="module")
def whole() -> SpatialMotion:
    return simulate_to_rest(SCENARIO, 0.3, tolerance=1e-3)


@pytest.fixture(scope="module")
def ended() -> SpatialMotion:
    return simulate_to_rest(SCENARIO, 0.3, tolerance=1e-3, stop_when=tilted)


def test_run_to_rest_is_the_whole_one_until_a_condition_turns_negative(
    whole: SpatialMotion, ended: SpatialMotion
) -> None:
    first = int(np.argmax(whole.tilt > LIMIT))
    assert 0 < first == ended.times.size - 1
    np.testing.assert_allclose(ended.tilt[:-1], whole.tilt[:first], atol=1e-6)
    ending = not_none(ended.ending)
    assert ending.reason == "tilted"
    assert ending.value == pytest.approx(0.0, abs=1e-9)
    assert ended.rest_time is None


def test_motion_in_the_papers_coordinates_keeps_its_ending_and_its_error(
    ended: SpatialMotion,
) -> None:
    run = ended.to_trajectory()
    assert run.ending == ended.ending
    # It is of the vertical's direction, which gamma moves by the sine of the tilt.
    steepest = not_none(ended.error_estimate) / np.sin(ended.leaning.min())
    assert run.error_estimate == pytest.approx(steepest)
    assert ended.to_trajectory(0.5 * ended.times[-1]).ending is None


def test_command_ends_where_the_disk_is_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    call = f"rest --source in-house --end 1 --stop-when inverted --out {tmp_path}/up.npz"
    assert "the centre of gravity is up, at 90% of its largest height" in printed(capsys, call)
    motion = load_run(tmp_path / "up.npz", SpatialMotion)
    assert motion.cog_direction[-1] == pytest.approx(0.9, abs=1e-6)


@pytest.fixture(scope="module")
def truth() -> float:
    """Time at which the disk of `SCENARIO` is `tilted`, by another solver in short steps."""
    how: dict[str, Any] = {"method": "DOP853", "spacing": 1e-3, "local_tolerance": 1e-12}
    return not_none(simulate_to_rest(SCENARIO, 0.1, stop_when=tilted, **how).ending).time


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("spacing", [0.002, 0.1])
@pytest.mark.parametrize("tolerance", mostly_slow([1e-3, 1e-6, None], [1e-3, None]))
def test_ending_does_not_depend_on_how_far_apart_the_samples_are(
    source: Source, spacing: float, tolerance: float | None, truth: float
) -> None:
    how: dict[str, Any] = {"step": 5e-5} if source == "engine" else {"local_tolerance": 1e-10}
    if tolerance is not None:
        how = {"tolerance": tolerance}
    motion = run_to_rest(SCENARIO, 0.1, source=source, spacing=spacing, stop_when=tilted, **how)
    ending = not_none(motion.ending)
    assert ending.time == motion.times[-1]
    assert abs(ending.time - truth) <= (motion.error_estimate or 1e-7)
    assert motion.tilt[-1] == pytest.approx(LIMIT, abs=1e-9)
    np.testing.assert_allclose(motion.times[:-1], spacing * np.arange(motion.times.size - 1))


def test_ending_after_impacts_is_located() -> None:
    loss = Dissipation(pivoting=1e-3)
    dropped = Scenario.rest(start=Start(beta=0.5, spin=0.0, height=0.01), dissipation=loss)

    def low(state: State) -> float:
        return state.coordinates[4] - 0.2

    def motion(spacing: float, *stop_when: Any) -> SpatialMotion:
        return simulate_to_rest(
            dropped, 0.25, spacing=spacing, local_tolerance=1e-10, stop_when=stop_when
        )

    times = [not_none(motion(spacing, low).ending).time for spacing in (2e-3, 0.25)]
    assert np.ptp(times) < 1e-7
    whole = motion(1e-3)
    before = whole.times < times[0]
    assert np.min(whole.normal_force[before]) == 0.0 < np.max(whole.normal_force[before])
    assert np.min(whole.tilt[before]) > 0.2 > whole.tilt[~before][0]


@pytest.mark.parametrize("source", SOURCES)
def test_the_first_of_two_conditions_ends_the_run_though_both_hold_at_the_next_sample(
    source: Source,
) -> None:
    def later(state: State) -> float:
        return LIMIT + 0.001 - state.coordinates[4]

    how: dict[str, Any] = {"source": source, "spacing": 0.05, "tolerance": 1e-3}
    for both in ([tilted, later], [later, tilted]):
        motion = run_to_rest(SCENARIO, 0.3, stop_when=both, **how)
        assert not_none(motion.ending).reason == "tilted"


def test_estimate_covers_the_time_of_an_ending_which_both_runs_must_have(
    whole: SpatialMotion, ended: SpatialMotion
) -> None:
    late = float(ended.times[-1]) + 1e-5
    ending = replace(not_none(ended.ending), time=late)
    ahead = replace(ended, times=np.append(ended.times[:-1], late), ending=ending)
    runs = iter([ended, ahead])
    agreed = until_agreement(lambda _local: next(runs), 1e-6, 1.0)
    # Both end at the same tilt: by the states alone, they would not differ.
    moved = 1e-5 * float(np.hypot(*ended.angular_velocities[-1, :2]))
    assert agreed.error_estimate == pytest.approx(max(moved, 1e-5), rel=1e-6)
    different = itertools.cycle([ended, whole])
    with pytest.raises(ToleranceError, match="differ by inf"):
        until_agreement(lambda _local: next(different), 1e-9, 1.0)
