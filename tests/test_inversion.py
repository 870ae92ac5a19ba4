"""When the disk counts as inverted: up there, and staying."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import CENTRED_DISK, Inversion, Scenario, Trajectory, simulate
from analysis.data.checks import Array
from analysis.data.endings import REACHED
from analysis.data.inversion import DEFINITION, STAYING
from tests.helpers import random_trajectory

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
    assert run.inversion_time == pytest.approx(0.49, abs=0.011)
    assert run.inversion.lost is None


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
