"""Slow passage through the critical speed: the growth rate, the delay and its law."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import Dissipation, Scenario
from tests.calls import run as call
from tests.helpers import not_none
from validation.run import run
from validation.studies.nonlinear.confirm import thinned
from validation.studies.nonlinear.passage import (
    LOST,
    Passage,
    SlowPair,
    delay_law,
    follow,
    law_table,
    measure,
    passage_table,
    slowed,
)

README = Scenario.rest(dissipation=Dissipation(rolling_dry=1e-3, pivoting=5e-5))


@pytest.fixture(scope="module")
def pair() -> SlowPair:
    return SlowPair.of(Scenario())


def test_the_growth_rate_is_the_real_part_of_the_slow_pair(pair: SlowPair) -> None:
    rates = pair.growth(np.array((25.0, 29.5, pair.spin, 40.0)))
    assert rates == pytest.approx([0.98801, 0.11146, 0.0, -1.93133], abs=2e-4)
    fast = pair.fast(np.array((25.0, 40.0)))
    assert fast == pytest.approx([20.423, 37.204], abs=2e-3)


def test_a_compliant_contact_has_the_slow_pair_of_the_ideal_one(pair: SlowPair) -> None:
    assert SlowPair.of(README).spin == pair.spin


def passage(pair: SlowPair, rate: float, delay: float) -> Passage:
    times = np.array((0.0, delay / rate))
    return Passage(
        source="in-house",
        pair=pair,
        times=times,
        spins=pair.spin - rate * times,
        deviations=np.full(2, 0.1),
        linear=np.full(2, 0.1),
        crossing=0.0,
        lost=None,
        predicted=None,
    )


def test_a_delay_with_the_root_of_the_rate_is_recognised(pair: SlowPair) -> None:
    rates = (0.1, 0.4, 1.6)
    found = delay_law([passage(pair, rate, 3.0 * rate**0.5) for rate in rates])
    assert found.exponent == pytest.approx(0.5, abs=1e-12)
    assert found.rates == pytest.approx(rates)
    slope = -0.18370
    assert found.growth == pytest.approx(-slope * 9.0 / 2.0, rel=5e-3)
    other = delay_law([passage(pair, rate, 3.0 * rate**0.8) for rate in rates])
    assert other.exponent == pytest.approx(0.8, abs=1e-12)


def test_a_passage_with_few_samples_keeps_lowest_spin_and_rate(pair: SlowPair) -> None:
    times = np.linspace(0.0, 4.0, 2001)
    many = replace(
        passage(pair, 1.0, 1.0),
        times=times,
        spins=pair.spin - times + (times / 3.1) ** 4,
        deviations=times,
        linear=times,
    )
    few = thinned(many)
    assert few.times.size < many.times.size / 20
    assert (few.times[0], few.times[-1]) == (0.0, 4.0)
    assert (few.lowest_spin, few.rate) == (many.lowest_spin, many.rate)


@pytest.fixture(scope="module")
def quick() -> Passage:
    return slowed(16e-5, "in-house")


@pytest.mark.slow
def test_a_quickly_slowed_disk_is_lost_far_below_the_critical_speed(quick: Passage) -> None:
    found = quick
    assert found.crossing == pytest.approx(0.0, abs=0.01)
    assert found.lost == pytest.approx(3.788, abs=0.01)
    assert found.lowest_spin < found.pair.spin - 8.0
    # What the fast oscillation leaves in the slow deviation is small beside it.
    assert found.deviations[0] == pytest.approx(0.02, rel=0.2)
    assert np.all(np.abs(np.log(found.deviations / found.linear))[found.deviations < 0.3] < 0.3)


@pytest.mark.slow
def test_the_delay_goes_with_the_root_of_the_rate_of_decay() -> None:
    found = delay_law([slowed(lever, "in-house") for lever in (4e-5, 8e-5, 12e-5)])
    assert found.exponent == pytest.approx(0.5, abs=0.03)
    assert found.growth < np.log(LOST / 0.02)
    assert len(law_table(found).rows) == 3


@pytest.mark.slow
def test_both_sides_lose_the_inversion_at_the_same_time_and_spin(quick: Passage) -> None:
    engine = slowed(16e-5, "engine")
    assert engine.lost == pytest.approx(not_none(quick.lost), abs=2.5e-3)
    # It is still falling when the disk is lost, at 2.5 rad/s².
    assert engine.lowest_spin == pytest.approx(quick.lowest_spin, abs=5e-3)
    assert len(passage_table([("slowed", quick), ("slowed", engine)]).rows) == 2


@pytest.mark.slow
def test_the_way_to_rest_loses_the_inversion_when_it_is_said_to() -> None:
    assert follow(README, 11.5, "in-house").lost == pytest.approx(10.664, abs=0.005)


@pytest.mark.slow
def test_the_eigenvalues_alone_tell_when_model_1_is_lost() -> None:
    found = follow(Scenario(), 19.0, "in-house")
    assert found.crossing is not None
    assert found.lost is not None
    assert found.lost - found.crossing > 9.0
    assert found.predicted == pytest.approx(found.lost, rel=0.06)
    # What was lost on the way in is regained on the way out.
    least = found.times[np.argmin(found.linear)]
    assert least == pytest.approx(found.crossing, abs=0.01)
    assert np.min(found.deviations) < 1e-3


def test_a_motion_without_inversion_is_refused() -> None:
    motion = run(Scenario(), np.linspace(0.0, 0.2, 101), source="in-house")
    with pytest.raises(ValueError, match="inverts the disk"):
        measure(motion)
    held = replace(Scenario(), constraints=("contact", "no-slip-along", "no-slip-across"))
    with pytest.raises(ValueError, match="must have a Hopf point"):
        SlowPair.of(held)
    with pytest.raises(ValueError, match="passages must be 3 or more"):
        delay_law([])


def test_the_command_refuses_what_it_cannot_follow(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("passage --end 0.2") == 2
    assert "inverts the disk" in capsys.readouterr().err
    assert call("passage --rolling 1e-3") == 2
    assert "penalty contact" in capsys.readouterr().err
