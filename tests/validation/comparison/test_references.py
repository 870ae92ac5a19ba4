"""References: two methods, what they leave open, how far a run is from them, where motions end."""

from collections.abc import Callable
from dataclasses import replace
from math import asin, inf, pi, sqrt
from typing import Any

import numpy as np
import pytest

import analysis
from analysis import STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.motion.endings import CONTACT_WOULD_PULL, Ending
from analysis.problem.checks import Array
from tests.helpers import not_none
from validation.comparison.differences import deviation, ending_error, energy_error
from validation.comparison.references import Reference, reference, up_to_ending
from validation.comparison.ways import StepLimit, Way, WorkLimitError

TREE = Way("engine", "contact-tree", "RK67")
DOP853 = Way("in-house", "index-1", "DOP853")
TIMES = np.linspace(0.0, 0.1, 11)


@pytest.fixture(scope="module")
def easy() -> Reference:
    return reference(Scenario(), TIMES)


@pytest.fixture(scope="module")
def inverted() -> Reference:
    """Up to the inversion, located apart, of a run of two samples."""
    return reference(Scenario(), np.array((0.0, 1.0)), stop_when="inverted")


SOFT = Scenario(
    contact=PenaltyContact.damped(1e5, STEEL_DISK), friction=SmoothCoulomb(load="contact")
)
HELD = {
    "the other side": (Scenario(), TREE, "DOP853"),
    "the same method": (Scenario(), DOP853, "LSODA"),
    "stiff friction": (Scenario(friction=SmoothCoulomb(smoothing=1e-4)), DOP853, "Radau"),
    "a penalty contact": (SOFT, Way("engine"), "DOP853"),
    "thrown onto its damper": (replace(SOFT, start=Start(height=1e-3)), Way("engine"), "DOP853"),
}


@pytest.mark.parametrize("case", HELD)
def test_a_run_is_held_against_another_method_that_fits_the_motion(case: str) -> None:
    scenario, way, by = HELD[case]
    times = TIMES / 10.0 if by == "Radau" else TIMES
    known, run = reference(scenario, times), way.run(scenario, times, tolerance=1e-6)
    assert known.beside(run).method["method"] == by
    assert known.second.method["method"] == "LSODA"
    assert deviation(run, known.beside(run)) < 1e-6
    assert 0.0 < known.doubt < 1e-9


@pytest.mark.parametrize("way", [TREE, DOP853], ids=lambda way: way.name)
def test_steps_count_over_all_passes_and_a_run_that_takes_them_all_says_so(way: Way) -> None:
    whole, single, count = StepLimit(100_000), StepLimit(100_000), StepLimit(7)
    way.run(Scenario(), TIMES, tolerance=1e-6, progress=whole)
    coarse = {"step": 1e-2} if way == TREE else {"local_tolerance": 1e-3}
    way.run(Scenario(), TIMES, **coarse, progress=single)
    assert whole.steps >= 3 * single.steps > 0
    with pytest.raises(WorkLimitError, match=r"7 steps taken, the last pass at t = 0\.0"), count:
        way.run(Scenario(), TIMES, tolerance=1e-6, progress=count)
    assert count.steps == 7
    assert [StepLimit(100, end).most for end in (0.1, 30.0)] == [100, 3000]


def test_runs_are_compared_over_what_they_have_in_common(easy: Reference) -> None:
    run, rows = easy.first, 8
    names = ("times", "coordinates", "rates", "multipliers")
    cut = {name: getattr(run, name)[:rows].copy() for name in names}
    cut["coordinates"][-1] += 1.0
    # The last sample is that of an ending, and not one asked for.
    ending = Ending(reason="other", time=float(run.times[rows - 1]), value=0.0)
    unlike = replace(run, **cut, ending=ending)
    assert deviation(unlike, run) == deviation(run, unlike) == 0.0
    assert ending_error(unlike, run) == inf


def test_energy_is_compared_relative_to_its_largest_value(easy: Reference) -> None:
    run = easy.first
    rates = run.rates * (1.0 + 1e-3)
    kinetic, potential = analysis.energies(run.scenario, run.coordinates, run.rates)
    expected = 2e-3 * np.max(kinetic) / np.max(kinetic + potential)
    assert energy_error(replace(run, rates=rates), run) == pytest.approx(expected, rel=2e-3)


def test_the_time_of_an_ending_counts_even_where_the_angles_stand_still(
    inverted: Reference,
) -> None:
    def later(run: Trajectory) -> Trajectory:
        ending = replace(not_none(run.ending), time=not_none(run.ending).time + 1e-5)
        return replace(run, ending=ending)

    still = replace(inverted.first, rates=0.0 * inverted.first.rates)
    assert deviation(later(still), still) == pytest.approx(1e-5, rel=1e-6)
    assert deviation(later(inverted.first), inverted.first) > 2e-5


# --- Endings located apart ----------------------------------------------------------------------


def located(
    height: float = 1.0,
    stop_when: tuple[Any, ...] = (),
    force: Callable[[Array], Array] = np.ones_like,
) -> Ending | None:
    """Ending of a run of which gamma rises by 2 rad/s from -1 rad, under a given normal force."""

    def plain(scenario: Scenario, times: Array) -> Trajectory:
        zeros = np.zeros(times.size)
        angles = (zeros, np.full(times.size, height), 2.0 * times - 1.0)
        return Trajectory(
            times=times,
            coordinates=np.column_stack((zeros, zeros, zeros, *angles)),
            rates=np.tile((0.0, 0.0, 0.0, 0.0, 0.0, 2.0), (times.size, 1)),
            multipliers=force(times)[:, None],
            scenario=scenario,
            source="in-house",
            method={},
        )

    found = up_to_ending(plain, Scenario(), np.array((0.0, 0.7, 2.0)), stop_when, 2e-3)
    rows = 3 if found.ending is None else 1 + int(np.searchsorted((0.0, 0.7), found.times[-1]))
    assert found.times.size == rows
    return found.ending


def passes_zero(state: Any) -> float:
    return -float(state.coordinates[5])


def test_a_condition_is_located_where_it_is_met_first() -> None:
    for conditions, reason, angle in (
        ((passes_zero, "inverted"), "passes_zero", 0.0),
        (("inverted",), "inverted", asin(0.9)),
    ):
        found = not_none(located(pi / 2, conditions))
        assert found.reason == reason
        assert found.time == pytest.approx(0.5 + 0.5 * angle, abs=1e-12)
    assert located(0.5, ("inverted",)) is None


PULLS: list[tuple[float, float, Callable[[Array], Array]]] = [
    # Shorter than the samples are apart.
    (0.123455, 1e-11, lambda t: ((t - 0.123456) ** 2 - 1e-12) * 1e4),
    (1.989, 1e-11, lambda t: ((t - 1.99) ** 2 - 1e-6) * 1e4),
    # With a kink: friction by the contact force is gone from there on.
    (sqrt(0.5), 1e-11, lambda t: np.where(t <= sqrt(0.5), 1.0, 7.0) * (sqrt(0.5) - t)),
    # Missed by little in a finer run.
    (0.5, 2e-3, lambda t: 0.5 - t + (1e-2 if np.ptp(t) < 1e-2 else 0.0)),
]


@pytest.mark.parametrize(("time", "within", "force"), PULLS)
def test_a_pull_is_located_where_it_begins(
    time: float, within: float, force: Callable[[Array], Array]
) -> None:
    found = not_none(located(force=force))
    assert found.reason == CONTACT_WOULD_PULL
    assert found.time == pytest.approx(time, abs=within)


def test_a_force_that_nearly_vanishes_does_not_pull() -> None:
    assert located(force=lambda t: ((t - 0.123456) ** 2 + 1e-12) * 1e4) is None
