"""When the disk counts as inverted: up there, and staying."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import (
    CENTRED_DISK,
    LEVELS,
    Inversion,
    Level,
    Scenario,
    Start,
    Trajectory,
    simulate,
    simulate_to_rest,
)
from analysis.data.checks import Array
from analysis.data.endings import REACHED
from analysis.data.inversion import DEFINITION, STAYING
from tests.helpers import model, not_none, random_trajectory

TIMES = np.linspace(0.0, 4.0, 401)


def judged(direction: Array, end: float = 4.0) -> Inversion:
    shown = end + 1e-9 >= TIMES
    return Inversion.of_direction(TIMES[shown], direction[shown])


def risen(since: float, until: float = np.inf) -> Array:
    return np.where((since - 1e-9 <= TIMES) & (until - 1e-9 > TIMES), 1.0, -1.0)


def test_rising_for_good_is_inversion_at_the_first_time_up() -> None:
    found = judged(risen(0.5))
    assert found.outcome == "inverted"
    assert found.time == pytest.approx(0.5)
    assert found.lost is None


def test_swinging_up_and_falling_back_is_no_inversion() -> None:
    swinging = np.sin(2 * np.pi * TIMES)
    assert np.max(swinging) > REACHED
    assert judged(swinging, end=3.9) == Inversion(outcome="not inverted")


def test_time_is_that_of_the_rise_that_lasts() -> None:
    up = np.maximum(risen(0.5, 0.7), risen(1.2))
    assert judged(up).time == pytest.approx(1.2)


def test_sinking_below_nine_tenths_but_not_below_the_centre_is_staying() -> None:
    up = np.where((TIMES > 0.7) & (TIMES < 0.9), 0.1, risen(0.5))
    assert judged(up).time == pytest.approx(0.5)
    assert judged(np.where((TIMES > 0.7) & (TIMES < 0.9), -0.1, up)).time == pytest.approx(0.9)


def test_less_than_nine_tenths_is_not_up() -> None:
    assert judged(0.89 * risen(0.5)).outcome == "not inverted"


def test_motion_that_ends_where_it_is_up_is_so_whatever_its_last_digit() -> None:
    for ending in (REACHED, np.nextafter(REACHED, 0.0)):
        found = Inversion.of_direction(np.array([0.0, 0.5]), np.array([-1.0, ending]))
        assert found.outcome == "not decided"


@pytest.mark.parametrize("last", [-1e-14, 0.0, 1e-14])
def test_motion_that_ends_where_it_is_lost_is_so_whatever_its_last_digit(last: float) -> None:
    found = Inversion.of_direction(np.array([0.0, 0.5, 2.0]), np.array([-1.0, 1.0, last]))
    assert (found.outcome, found.lost) == ("lost", 2.0)
    short = Inversion.of_direction(np.array([0.0, 0.5, 1.0]), np.array([-1.0, 1.0, last]))
    assert short.outcome == "not inverted"


def test_staying_for_less_than_the_stated_time_is_no_inversion() -> None:
    assert judged(risen(0.5, 0.5 + STAYING)).time == pytest.approx(0.5)
    assert judged(risen(0.5, 0.49 + STAYING)).outcome == "not inverted"


def test_inversion_that_ends_is_lost_at_the_first_time_below_the_centre() -> None:
    found = judged(risen(0.5, 2.0))
    assert found.outcome == "lost"
    assert found.time == pytest.approx(0.5)
    assert found.lost == pytest.approx(2.0)


def test_motion_that_ends_before_the_disk_has_stayed_up_is_not_decided() -> None:
    assert judged(risen(0.5), end=1.4) == Inversion(outcome="not decided")
    assert judged(risen(0.5), end=1.5).outcome == "inverted"
    # What fell back before the end is decided.
    assert judged(risen(0.5, 1.0), end=1.4).outcome == "not inverted"


def test_model_1_inverts_from_table_3_within_half_a_second() -> None:
    run = simulate(Scenario(), TIMES, local_tolerance=1e-6)
    assert run.inversion_time == pytest.approx(0.4852, abs=1e-4)
    assert run.inversion.lost is None


@pytest.mark.parametrize("level", LEVELS)
def test_time_of_inversion_is_right_to_its_error_however_far_apart_the_samples_are(
    level: Level,
) -> None:
    scenario = model(level)

    def run(times: Array, *stop_when: str) -> Trajectory:
        return simulate(scenario, times, local_tolerance=1e-11, stop_when=stop_when)

    # The first rise of these motions lasts; the solver locates it while it runs.
    truth = not_none(run(np.linspace(0.0, 2.0, 3), "inverted").ending).time
    for spacing, enough in ((0.2, 0.2), (0.1, 0.1), (0.05, 1e-4), (0.02, 1e-6), (0.01, 1e-8)):
        found = run(np.arange(0.0, 3.0 + 0.5 * spacing, spacing)).inversion
        assert abs(not_none(found.time) - truth) <= not_none(found.time_error) + 1e-10
        assert not_none(found.time_error) < enough


@pytest.mark.parametrize(
    ("level", "start", "spacing"),
    [
        # It rises, and sinks again before the next sample; it rises, and falls between two.
        (3, Start(beta=1.183, gamma=-0.9917, spin=46.525), 0.2),
        (2, Start(beta=2.258, gamma=-2.3827, spin=54.78), 0.1),
    ],
)
def test_error_covers_what_no_sample_shows(level: Level, start: Start, spacing: float) -> None:
    scenario = model(level, start=start)
    fine, coarse = (
        simulate(scenario, np.arange(0.0, 4.0, each), local_tolerance=1e-8).inversion
        for each in (0.005, spacing)
    )
    apart = abs(not_none(coarse.time) - not_none(fine.time))
    assert spacing < apart <= not_none(coarse.time_error)
    assert not_none(fine.time_error) < 1e-8


@pytest.mark.parametrize("count", [11, 16, 26, 51, 501])
def test_inversion_and_its_loss_are_located_between_samples(count: int) -> None:
    times, rate = np.linspace(0.0, 5.0, count), 0.4 * np.pi
    found = Inversion.of_direction(times, np.sin(rate * times), rate * np.cos(rate * times))
    assert found.outcome == "lost"
    spacing = times[1]
    for time, error, truth in (
        (found.time, found.time_error, np.arcsin(REACHED) / rate),
        (found.lost, found.lost_error, 2.5),
    ):
        assert abs(not_none(time) - truth) <= not_none(error) + 1e-14
        assert not_none(error) < min(spacing, 0.1 * spacing**4)


@pytest.mark.parametrize("part", [0.1, 0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("after", [0.05, 0.2, 3.0, 10.0])
def test_an_impact_between_two_samples_leaves_the_time_open(part: float, after: float) -> None:
    # The rate jumps from 1 to another while the centre of gravity rises.
    times, impact = np.arange(0.0, 4.0, 0.05), 0.85 + 0.05 * part
    rates = np.where(times < impact, 1.0, after)
    directions = np.where(times < impact, times, impact + after * (times - impact))
    truth = REACHED if impact > REACHED else impact + (REACHED - impact) / after
    found = Inversion.of_direction(times, directions, rates)
    assert abs(not_none(found.time) - truth) <= not_none(found.time_error) + 1e-12
    assert not_none(found.time_error) <= 0.05


def test_staying_counts_from_the_rise_and_not_from_the_sample_behind_it() -> None:
    run = simulate(Scenario(), np.linspace(0.0, 1.49, 11), local_tolerance=1e-8)
    assert not_none(run.inversion_time) + STAYING < 1.49
    assert run.times[run.cog_direction > REACHED][0] + STAYING > 1.49
    short = simulate(Scenario(), np.linspace(0.0, 1.48, 149), local_tolerance=1e-8)
    assert short.inversion == Inversion(outcome="not decided")


def test_motion_that_was_told_to_end_inverted_is_up_at_its_last_sample() -> None:
    run = simulate(Scenario(), TIMES, local_tolerance=1e-8, stop_when="inverted")
    assert run.inversion.outcome == "not decided"


def test_inversion_of_a_way_to_rest_is_that_in_the_papers_coordinates() -> None:
    motion = simulate_to_rest(Scenario.rest(), 1.6, spacing=0.01, local_tolerance=1e-9)
    same = motion.to_trajectory()
    np.testing.assert_allclose(motion.cog_direction_rate, same.cog_direction_rate, atol=1e-9)
    for name in ("time", "time_error"):
        found, expected = (getattr(each.inversion, name) for each in (motion, same))
        assert found == pytest.approx(expected, abs=1e-9)
    assert motion.phases.inversion == motion.inversion_time


def test_trajectory_tells_where_its_centre_of_gravity_lies() -> None:
    run = random_trajectory()
    beta, gamma = run.coordinate("beta"), run.coordinate("gamma")
    np.testing.assert_allclose(run.cog_direction, np.sin(beta) * np.sin(gamma))


def test_disk_without_eccentricity_is_never_inverted() -> None:
    run = replace(upright(), scenario=Scenario(disk=CENTRED_DISK))
    assert upright().inversion_time == 0.0
    assert run.inversion_time is None


def upright() -> Trajectory:
    run = random_trajectory()
    coordinates = np.tile([0.0, 0.0, 0.045, 0.0, np.pi / 2, np.pi / 2], (run.times.size, 1))
    return replace(
        run,
        scenario=Scenario(),
        multipliers=run.multipliers[:, :1],
        times=np.linspace(0.0, 2.0, run.times.size),
        coordinates=coordinates,
    )


def test_definition_names_its_numbers() -> None:
    assert f"{REACHED:.0%}" in DEFINITION
    assert f"{STAYING:g} s" in DEFINITION
