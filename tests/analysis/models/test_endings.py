"""Why a motion ends, and where: inverted, lost, or where the user says."""

from collections.abc import Iterable
from math import pi

import numpy as np
import pytest

from analysis import PenaltyContact, Scenario, Start, State, simulate
from analysis.data.endings import REACHED
from tests.helpers import model, not_none

TIMES = np.linspace(0.0, 0.6, 121)
SOFT = Scenario(contact=PenaltyContact(stiffness=1e6, damping=300.0))
FALLING = Scenario(start=Start(beta=pi / 2, gamma=pi / 2 - 0.3, spin=15.0))


@pytest.mark.parametrize(
    ("scenario", "stop_when", "level"),
    [
        (Scenario(), iter(["inverted"]), REACHED),
        (SOFT, ["inverted"], REACHED),
        (FALLING, ["lost", "inverted"], 0.0),
    ],
    ids=["inverted", "inverted on a penalty contact", "lost"],
)
def test_a_run_is_the_whole_one_up_to_where_the_disk_is_up_or_down_again(
    scenario: Scenario, stop_when: Iterable[str], level: float
) -> None:
    whole = simulate(scenario, TIMES, tolerance=1e-8)
    ended = simulate(scenario, TIMES, tolerance=1e-8, stop_when=stop_when)
    assert not_none(ended.ending).reason == ("inverted" if level else "lost")
    assert ended.cog_direction[-1] == pytest.approx(level, abs=1e-9)
    count = ended.times.size - 1
    np.testing.assert_allclose(
        ended.coordinates[:count, 4:], whole.coordinates[:count, 4:], atol=2e-8
    )
    above = whole.cog_direction > level
    assert np.all(above[:count] == above[0])
    assert above[count] != above[0]


def slow(state: State) -> float:
    return state.rates[3] - 39.5


def test_a_run_ends_at_the_first_of_ones_own_conditions() -> None:
    first, named = (
        simulate(Scenario(), TIMES, tolerance=1e-9, stop_when=[each, "inverted"])
        for each in (slow, f"{__name__}:slow")
    )
    ending = not_none(first.ending)
    assert ending == named.ending
    assert (ending.reason, str(ending)[-7:]) == ("slow", "s: slow")
    assert first.rate("alpha")[-1] == pytest.approx(39.5, abs=1e-7)
    assert ending.value == pytest.approx(0.0, abs=1e-9)
    # The spin of Model 4 is held.
    other = simulate(model(4), [0.0, 3.0], form="reduced", stop_when=[slow, "inverted"])
    assert not_none(other.ending).reason == "inverted"


def test_a_condition_that_holds_from_the_start_waits_until_it_has_not() -> None:
    inverted = Scenario(start=Start(beta=pi / 2, gamma=pi / 2 - 0.01, spin=40.0))
    assert simulate(inverted, TIMES, tolerance=1e-6, stop_when="inverted").ending is None


@pytest.mark.parametrize(
    ("start", "tolerance", "time"),
    [
        # The first two runs end in nearly the same state, half a microsecond apart.
        (Start(spin=45.2112, gamma=-1.467538, beta=1.356142), 1e-6, 0.743089983348),
        # Two runs of an early reversal of slip, where friction has a kink, agree by chance.
        (Start(spin=37.25768, gamma=-1.761848, beta=1.823287), 1e-8, 0.469902896322),
    ],
)
def test_tolerance_covers_the_time_of_an_ending_and_the_state_there(
    start: Start, tolerance: float, time: float
) -> None:
    scenario = model(4, start=start)
    run = simulate(scenario, [0.0, 2.0], tolerance=tolerance, stop_when="inverted")
    assert not_none(run.ending).time == pytest.approx(time, abs=tolerance / 3.0)
    whole = simulate(scenario, run.times, form="reduced", method="Radau", local_tolerance=1e-9)
    assert np.max(np.abs(run.coordinates - whole.coordinates)[:, 4:]) < tolerance
