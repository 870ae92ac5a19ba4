"""Why a motion ends, and where: flat, inverted, or where the user says."""

from math import pi
from typing import Any

import numpy as np
import pytest

import analysis
from analysis import PenaltyContact, Scenario, Start, State
from analysis.data.endings import REACHED
from tests.helpers import model, not_none

TIMES = np.linspace(0.0, 0.6, 121)
SOFT = PenaltyContact(stiffness=1e6, damping=300.0)


@pytest.mark.parametrize("contact", [None, SOFT], ids=["ideal", "penalty"])
def test_a_run_ends_where_the_disk_is_inverted(contact: PenaltyContact | None) -> None:
    scenario = Scenario(contact=contact)
    whole = analysis.simulate(scenario, TIMES, tolerance=1e-8)
    ended = analysis.simulate(scenario, TIMES, tolerance=1e-8, stop_when=iter(["inverted"]))
    assert not_none(ended.ending).reason == "inverted"
    assert ended.cog_direction[-1] == pytest.approx(REACHED, abs=1e-9)
    count = ended.times.size - 1
    np.testing.assert_allclose(
        ended.coordinates[:count, 4:], whole.coordinates[:count, 4:], atol=2e-8
    )
    assert np.all(whole.cog_direction[:count] < REACHED)
    assert whole.cog_direction[count] > REACHED


def test_a_run_ends_where_the_inversion_is_lost() -> None:
    falling = Scenario(start=Start(beta=pi / 2, gamma=pi / 2 - 0.3, spin=15.0))
    ended = analysis.simulate(falling, TIMES, tolerance=1e-8, stop_when=["lost", "inverted"])
    ending = not_none(ended.ending)
    assert ending.reason == "lost"
    assert ended.cog_direction[-1] == pytest.approx(0.0, abs=1e-9)
    assert np.all(ended.cog_direction[:-1] > 0.0)


def slow(state: State) -> float:
    return state.rates[3] - 39.5


def test_a_run_ends_at_the_first_of_ones_own_conditions() -> None:
    first = analysis.simulate(Scenario(), TIMES, tolerance=1e-9, stop_when=[slow, "inverted"])
    ending = not_none(first.ending)
    assert (ending.reason, str(ending)[-7:]) == ("slow", "s: slow")
    assert first.rate("alpha")[-1] == pytest.approx(39.5, abs=1e-7)
    assert ending.value == pytest.approx(0.0, abs=1e-9)
    times = np.linspace(0.0, 3.0, 301)
    other = analysis.simulate(
        model(4), times, form="reduced", tolerance=1e-9, stop_when=[slow, "inverted"]
    )
    assert not_none(other.ending).reason == "inverted"


def test_a_condition_that_holds_from_the_start_waits_until_it_has_not() -> None:
    inverted = Scenario(start=Start(beta=pi / 2, gamma=pi / 2 - 0.01, spin=40.0))
    run = analysis.simulate(inverted, TIMES, tolerance=1e-6, stop_when="inverted")
    assert run.ending is None


@pytest.mark.parametrize(
    ("stop_when", "message"),
    [
        ("asleep", "stop_when must be one of inverted, lost, module:function, got 'asleep'"),
        ([3], "stop_when must hold names or functions of a State, got 3"),
        ("math:pi", "stop_when must hold names or functions of a State, got 'math:pi'"),
        (lambda _: "low", "stop_when <lambda> must be a finite number, got 'low'"),
        (lambda _: float("nan"), "stop_when <lambda> must be a finite number, got nan"),
        ("no.such:thing", "stop_when 'no.such:thing' cannot be loaded: No module named 'no'"),
    ],
)
def test_what_a_run_cannot_end_at_is_named(stop_when: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}$"):
        analysis.simulate(Scenario(), [0.0, 0.1], stop_when=stop_when)


def test_a_condition_goes_by_the_name_of_its_module_too() -> None:
    named, own = (
        analysis.simulate(Scenario(), TIMES, tolerance=1e-6, stop_when=each)
        for each in (f"{__name__}:slow", slow)
    )
    assert named.ending == own.ending is not None


def test_of_two_conditions_of_one_name_none_is_forgotten() -> None:
    both: list[Any] = [lambda state: 1.0 - state.rates[3], lambda state: state.rates[3] - 1.0]
    with pytest.raises(ValueError, match="functions of different names, got <lambda> twice"):
        analysis.simulate(Scenario(), TIMES, stop_when=both)


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
    run = analysis.simulate(scenario, [0.0, 2.0], tolerance=tolerance, stop_when="inverted")
    assert not_none(run.ending).time == pytest.approx(time, abs=tolerance / 3.0)
    whole = analysis.simulate(
        scenario, run.times, form="reduced", method="Radau", local_tolerance=1e-9
    )
    assert np.max(np.abs(run.coordinates - whole.coordinates)[:, 4:]) < tolerance
