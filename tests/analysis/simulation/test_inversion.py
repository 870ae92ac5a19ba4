"""When the disk counts as inverted: up there, and staying."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analysis import (
    CENTRED_DISK,
    LEVELS,
    STEEL_DISK,
    Inversion,
    Level,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    simulate,
)
from analysis.motion.endings import REACHED
from analysis.motion.inversion import STAYING, inversions
from analysis.problem.checks import Array
from tests.helpers import model, not_none

SPACING = 0.01
TIMES = np.arange(0.0, 4.0 + SPACING / 2, SPACING)


def risen(*stretches: tuple[float, float], low: float = -1.0, high: float = 1.0) -> Array:
    """Directions that are high from each of these times to the next, and low otherwise."""
    is_up = [(since - 1e-9 <= TIMES) & (until - 1e-9 > TIMES) for since, until in stretches]
    return np.where(np.any(is_up, axis=0), high, low)


def judged(times: Array, directions: Array, rates: Array) -> Inversion:
    """What becomes of a motion, also beside another one like it."""
    told = {"times": times, "cog_direction": directions, "cog_direction_rate": rates}
    stacks = {name: np.stack((each, each)) for name, each in told.items()}
    disk = SimpleNamespace(eccentricity=np.full(2, STEEL_DISK.eccentricity))
    sampled: Any = SimpleNamespace(scenario=SimpleNamespace(disk=disk), **stacks)
    found = inversions(sampled)
    assert found[0] == found[1]
    return found[0]


@pytest.mark.parametrize(
    ("direction", "end", "outcome", "time", "lost"),
    [
        (risen((0.5, 5.0)), 4.0, "inverted", 0.5, None),
        (np.sin(2 * np.pi * TIMES), 3.9, "not inverted", None, None),
        # The rise that lasts counts.
        (risen((0.5, 0.7), (1.2, 5.0)), 4.0, "inverted", 1.2, None),
        # To sink without coming below the centre is to stay.
        (risen((0.5, 0.7), (0.9, 5.0), low=0.1), 4.0, "inverted", 0.5, None),
        (risen((0.5, 5.0), high=0.89), 4.0, "not inverted", None, None),
        (risen((0.5, 0.52 + STAYING)), 4.0, "lost", 0.5, 0.52 + STAYING),
        (risen((0.5, 0.49 + STAYING)), 4.0, "not inverted", None, None),
        (risen((0.5, 5.0)), 1.4, "not decided", None, None),
        (risen((0.5, 5.0)), 1.5, "inverted", 0.5, None),
        # What fell back before the end is decided.
        (risen((0.5, 1.0)), 1.4, "not inverted", None, None),
    ],
)
def test_disk_is_inverted_that_rises_and_stays_up(
    direction: Array, end: float, outcome: str, time: float | None, lost: float | None
) -> None:
    shown = end + 1e-9 >= TIMES
    found = judged(TIMES[shown], direction[shown], 0.0 * TIMES[shown])
    assert found.outcome == outcome
    for told, expected in ((found.time, time), (found.lost, lost)):
        assert told == (expected and pytest.approx(expected, abs=SPACING))


@pytest.mark.parametrize("last", [-1e-14, 1e-14])
def test_motion_that_ends_at_a_level_is_there_whatever_its_last_digit(last: float) -> None:
    times, directions = np.array([0.0, 0.5, 2.0]), np.array([-1.0, 1.0, last])
    found = judged(times, directions, np.zeros(3))
    assert (found.outcome, found.lost) == ("lost", 2.0)


RISES = Scenario(friction=SmoothCoulomb(coefficient=0.2), start=Start(spin=44.326))
FALLS = Scenario(table=Table(inclination=0.07056958, downhill=0.7))
SOFT = Scenario(contact=PenaltyContact.damped(1e5, STEEL_DISK))
LOCATED: list[tuple[Scenario, Any, float, float]] = [
    *((model(level), "inverted", *each)
      for level in LEVELS for each in ((0.2, 0.2), (0.05, 1e-4), (0.01, 1e-8))),
    # Between two samples.
    (RISES, "inverted", 0.01, 1e-6),
    (FALLS, "lost", 0.01, 1e-6),
    (SOFT, "inverted", 0.01, 1e-6),
]  # fmt: skip
"""Motions whose first rise or fall lasts, spacings of the samples, and errors they may leave."""


@pytest.mark.parametrize(("scenario", "ending", "spacing", "enough"), LOCATED)
def test_time_told_from_samples_is_that_which_the_solver_locates_to_its_error(
    scenario: Scenario, ending: Any, spacing: float, enough: float
) -> None:
    end = 4.0 if ending == "lost" else 2.0
    times = np.arange(0.0, end + SPACING / 2, spacing)
    how: dict[str, Any] = {"local_tolerance": 1e-11}
    found = simulate(scenario, times, **how).inversion
    located = simulate(scenario, times[[0, -1]], stop_when=ending, **how).ending
    name = {"inverted": "time", "lost": "lost"}[ending]
    time, error = (not_none(getattr(found, each)) for each in (name, f"{name}_error"))
    assert abs(time - not_none(located).time) <= error + 1e-10
    assert error < enough


@pytest.mark.parametrize(
    ("level", "start", "spacing", "enough"),
    [
        # It rises, and sinks again before the next sample; it rises, and falls between two.
        (3, Start(beta=1.183, gamma=-0.9917, spin=46.525), 0.2, 1e-5),
        (2, Start(beta=2.258, gamma=-2.3827, spin=54.78), 0.1, 1e-5),
        # It is up between the first two samples alone, which are nearly alike.
        (4, Start(beta=1.18, gamma=2.08, spin=38.4), 0.15, 1.0),
        (4, Start(beta=2.034, gamma=1.174, spin=48.26), 0.05, 1.0),
        (4, Start(beta=2.034, gamma=1.174, spin=48.26), 0.1, 1.0),
    ],
)
def test_error_of_the_time_covers_what_no_sample_shows(
    level: Level, start: Start, spacing: float, enough: float
) -> None:
    scenario = model(level, start=start)
    fine, coarse = (
        simulate(scenario, np.arange(0.0, 4.0, each), local_tolerance=1e-10).inversion
        for each in (1e-3, spacing)
    )
    apart = abs(not_none(coarse.time) - not_none(fine.time))
    assert apart <= min(enough, not_none(coarse.time_error))
    assert not_none(fine.time_error) < 1e-8


@pytest.mark.parametrize("begin", [0.0, 1e5])
@pytest.mark.parametrize("count", [11, 501])
def test_inversion_and_its_loss_are_located_between_samples(count: int, begin: float) -> None:
    times, rate = np.linspace(0.0, 5.0, count), 0.4 * np.pi
    found = judged(begin + times, np.sin(rate * times), rate * np.cos(rate * times))
    assert found.outcome == "lost"
    spacing = times[1]
    for time, error, truth in (
        (found.time, found.time_error, np.arcsin(REACHED) / rate),
        (found.lost, found.lost_error, 2.5),
    ):
        # Of a smooth motion the best polynomial is far better than those it is told from.
        apart = abs(not_none(time) - begin - truth)
        assert apart <= 0.01 * not_none(error) + 1e-14 + 1e-15 * begin
        assert not_none(error) < min(spacing, 0.1 * spacing**4)


@pytest.mark.parametrize("part", [0.1, 0.9])
@pytest.mark.parametrize("after", [0.05, 3.0])
def test_an_impact_between_two_samples_leaves_the_time_open(part: float, after: float) -> None:
    # The rate jumps from 1 to another while the centre of gravity rises.
    times, impact = np.arange(0.0, 4.0, 0.05), 0.85 + 0.05 * part
    rates = np.where(times < impact, 1.0, after)
    directions = np.where(times < impact, times, impact + after * (times - impact))
    truth = REACHED if impact > REACHED else impact + (REACHED - impact) / after
    found = judged(times, directions, rates)
    assert abs(not_none(found.time) - truth) <= not_none(found.time_error) + 1e-12
    assert not_none(found.time_error) <= 0.05


@pytest.mark.parametrize(("rise", "fall", "part"), [(2.5, -7.0, 0.87), (7.8, -3.3, 0.11)])
def test_an_impact_below_the_level_does_not_come_up_to_it_between_two_samples(
    rise: float, fall: float, part: float
) -> None:
    # Polynomials through samples on both sides of it do.
    times = np.arange(0.0, 3.0, 0.1)
    since = times - 0.7 - 0.1 * part
    slopes, least = np.where(since < 0.0, rise, fall), np.where(since < 0.0, -1.4, -0.5)
    directions = 0.89 + np.maximum(slopes * since, least)
    rates = np.where(slopes * since > least, slopes, 0.0)
    assert judged(times, directions, rates).outcome == "not inverted"


def test_staying_counts_from_the_rise_and_not_from_the_sample_behind_it() -> None:
    run = simulate(Scenario(), np.linspace(0.0, 1.49, 11), local_tolerance=1e-8)
    assert not_none(run.inversion_time) + STAYING < 1.49
    assert run.times[run.cog_direction > REACHED][0] + STAYING > 1.49
    short = simulate(Scenario(), np.linspace(0.0, 1.48, 149), local_tolerance=1e-8)
    assert short.inversion == Inversion(outcome="not decided")


def test_disk_without_eccentricity_is_never_inverted() -> None:
    upright = Start(beta=np.pi / 2, gamma=np.pi / 2, spin=40.0)
    for disk, time in ((STEEL_DISK, 0.0), (CENTRED_DISK, None)):
        scenario = Scenario(disk=disk, start=upright)
        assert simulate(scenario, [0.0, 0.5, 1.0, 1.5]).inversion_time == time
