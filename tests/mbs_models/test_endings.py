"""Why a motion of the engine ends, and where: as the in-house one does."""

from collections import Counter
from itertools import product
from math import pi
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start, State, Trajectory
from analysis.motion.endings import StopWhen
from analysis.problem.checks import Array
from analysis.problem.choices import SOURCES, Source
from analysis.problem.start import FlatError
from analysis.solve.stepping import SolverError
from analysis.solve.watch import Watch
from mbs_models import FORMULATIONS, EngineError, Formulation, Scene
from mbs_models.accelerations import AccelerationProblem
from mbs_models.endings import Search, Suspect, suspects
from mbs_models.solving import solving
from tests.helpers import model, mostly_slow, not_none, reaching
from tests.scenes import runner, scene_of
from validation.comparison.references import reference
from validation.studies.robustness.outcomes import is_broken, outcome, ways
from validation.studies.robustness.problems import ENDED, problems

TIMES = np.linspace(0.0, 0.5, 51)
LONG = np.linspace(0.0, 0.6, 121)


@pytest.mark.parametrize("formulation", FORMULATIONS[:2])
def test_accelerations_know_nothing_of_a_run_that_has_exploded(formulation: Formulation) -> None:
    soft = Scenario(contact=PenaltyContact.damped(1e5, STEEL_DISK))
    motion = AccelerationProblem(Scene(soft, formulation), {})
    data, start = motion.system.systemData, soft.initial_state.vector
    data.SetSystemState([np.full(len(part), np.nan) for part in data.GetSystemState()])
    with solving(motion.system):
        assert np.isfinite(motion.starting_at(start).right_hand_side(0.0, start)).all()


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 1.0], [-1.0], [-1.0, 1.0]], ids=str)
def test_a_run_of_which_next_to_nothing_makes_sense_ends_at_no_condition(
    values: list[float],
) -> None:
    assert not list(suspects(np.linspace(0.0, 1.0, 11), {"slow": values}, None))


def test_a_dip_is_looked_for_where_it_is_though_the_condition_is_negative_at_first() -> None:
    told = {"near": [-1.0, -1.0, 1.0, 1.0, 0.01, 1.0]}
    assert list(suspects(np.arange(6.0), told, None)) == [Suspect(3, 2.0, "")]


@pytest.mark.parametrize("row", [0, 2])
def test_an_ending_that_no_record_shows_is_looked_for_where_the_run_was_stopped(row: int) -> None:
    found = suspects(np.arange(6.0), {"near": np.ones(6)}, (row + 0.5, "near"))
    assert list(found) == [Suspect(row, 0.5, "near")]


def recorded(scenario: Scenario, moments: Any, **how: Any) -> tuple[Trajectory, Array]:
    """In-house motion, and the records of it that a run of the engine would have."""
    run = analysis.simulate(scenario, moments, **how)
    return run, np.hstack((run.coordinates, run.rates, run.multipliers))


def searching(scenario: Scenario, watch: Watch, conditions: Any = None, **how: Any) -> Search:
    motion = AccelerationProblem(Scene(scenario), conditions or {})
    return Search(motion=motion, watch=watch, **how)


def test_a_contact_that_pulls_at_a_record_ends_the_run_there() -> None:
    fast, suspect = Scenario(start=Start(spin=200.0)), Suspect(0, 0.1, "contact would pull")
    run, records = recorded(fast, np.linspace(0.0, 0.11, 2), allow_pulling=True)
    assert run.normal_force[1] < 0.0
    for limit, reason in ((None, "contact would pull"), (1e-9, "time limit")):
        search = searching(fast, Watch(limit), allow_pulling=False)
        found = search.until_ending(LONG, records[1:], [suspect], 0.0)
        assert (found[0], *found[1]) == (reason, 0.0)


TUGGED = Start(spin=51.3877, beta=1.0, gamma=0.0)
"""Its contact pulls for 0.4 ms, which either of two intervals between records may hold."""


class Late(Watch):
    """A watch whose time is over when it is asked again."""

    asked = 0

    @property
    def is_out_of_time(self) -> bool:
        self.asked += 1
        return self.asked > 1


FAST = Start(spin=300.0)


@pytest.mark.parametrize(
    ("start", "moments", "watch"),
    [
        *((TUGGED, np.linspace(0.0, 0.156, count), None) for count in (6, 7)),
        # It pulls at four records in a row, and presses in between.
        (FAST, np.array([0.0, 0.07, 0.078, 0.0883, 0.092]), None),
        # What no time is left to locate is told between two records.
        *((FAST, np.linspace(0.0, 0.1, 201), watch) for watch in (Watch(1e-9), Late())),
    ],
)
def test_times_of_pulling_are_those_in_house_wherever_records_lie(
    start: Start, moments: Any, watch: Watch | None
) -> None:
    scenario = Scenario(start=start)
    known, records = recorded(scenario, moments, allow_pulling=True, local_tolerance=1e-12)
    search = searching(scenario, watch or Watch())
    found = search.pulling_times(moments, records, known.normal_force)
    assert known.pulling
    if watch is not None:
        assert search.counts["steps"] <= 1
        assert len(known.pulling) > 1
    within = 1e-9 if watch is None else 1e-4
    np.testing.assert_allclose(found, known.pulling, rtol=0.0, atol=within)


def test_no_record_is_added_to_a_run_at_the_time_of_its_last_one() -> None:
    search = searching(Scenario(), Late())
    record, moments = np.append(Scenario().initial_state.vector, 0.0), np.array([1e15])
    reason, times, _ = search.until_ending(moments, record[None], [Suspect(0, 0.1, "")], 0.0)
    assert (reason, *times) == ("time limit", 1e15)


INVERTED = Start(gamma=pi / 2 - 0.01, spin=40.0)
SPINNING = Start(gamma=0.3, spin=20.0)


@pytest.mark.parametrize(
    ("start", "condition"),
    [(INVERTED, "inverted"), *((SPINNING, reaching("alpha_rate", 20.0, x)) for x in (-1.0, 1.0))],
)
@pytest.mark.parametrize("formulation", [*FORMULATIONS, "to rest"])
def test_a_condition_that_holds_at_the_start_or_is_zero_there_waits_until_it_has_not(
    formulation: Any, start: Start, condition: StopWhen
) -> None:
    simulate = runner(formulation, [0.0, 0.02], start=start)
    for accuracy in ({"step": 1e-4}, {"tolerance": 1e-6}):
        assert simulate(stop_when=condition, **accuracy).ending is None
    if formulation == "to rest":
        rest = Scenario.rest(start=start)
        assert analysis.simulate_to_rest(rest, 0.02, stop_when=condition).ending is None


def test_a_pull_of_steps_too_long_ends_their_run_though_the_motion_pulls_later() -> None:
    scene = scene_of(1, "euler-tree", start=Start(beta=1.407, gamma=-1.799, spin=114.6))
    accuracies: list[dict[str, Any]] = [{"step": 4e-3}, {"tolerance": 1e-6}]
    runs = [mbs_models.simulate(scene, np.linspace(0.0, 0.2, 21), **each) for each in accuracies]
    # It does not go on to the end only to be cut.
    assert runs[0].counts["steps"] < 12
    coarse, fine = (not_none(run.ending) for run in runs)
    assert coarse.reason == fine.reason == "contact would pull"
    assert coarse.time < fine.time


def test_steps_that_jump_across_a_flat_disk_come_to_nothing_with_a_condition_as_without() -> None:
    scene = scene_of(1, "contact-tree", start=Start(beta=0.02, spin=0.0))
    conditions: list[StopWhen] = [(), reaching("alpha", 1.0)]
    for stop_when in conditions:
        with pytest.raises(FlatError, match="the disk lies nearly flat"):
            mbs_models.simulate(scene, TIMES[:11], step=1e-3, stop_when=stop_when)


def test_a_constraint_force_that_goes_up_and_down_is_no_pull() -> None:
    scene = scene_of(
        4,
        "floating-lie",
        friction=SmoothCoulomb(coefficient=0.16, smoothing=0.04),
        start=Start(beta=0.95, gamma=1.93, spin=31.7),
    )
    # In-house, the contact presses with 3.77 N or more all the way.
    with pytest.raises(EngineError, match=r"up and down.* presses with 4\.31 N; .*smaller step"):
        mbs_models.simulate(
            scene, np.linspace(0.0, 0.8, 81), step=0.01, integrator="GeneralizedAlpha"
        )


def test_an_ending_that_cannot_be_located_is_no_time_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lost = Mock(side_effect=SolverError("lost the way"))
    monkeypatch.setattr("mbs_models.endings.integrate", lost)
    with pytest.raises(EngineError, match=r"'inverted' after t = .* not found: .*lost the way"):
        mbs_models.simulate(scene_of(1, "euler-tree"), LONG, step=5e-3, stop_when="inverted")


def test_a_search_has_some_steps_of_its_own_and_tells_no_progress(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("mbs_models.endings.MOST_STEPS_OF_A_SEARCH", 20)
    told: list[tuple[float, float]] = []
    watch = Watch(progress=lambda *at: told.append(at))
    watch.steps = 100
    motion = AccelerationProblem(Scene(Scenario()), {})
    record, work = np.append(Scenario().initial_state.vector, 0.0), Counter[str]()

    def search(width: float, reason: str) -> str | None:
        how = Search(motion=motion, watch=watch, counts=work)
        return how.until_ending(LONG, record[None], [Suspect(0, width, reason)], 0.0)[0]

    assert search(1e-4, "") is None
    assert work["steps"] > 0
    assert search(0.5, "") is None
    with pytest.raises(
        EngineError, match=r"'lost' after t = 0 s is not found: .*20 steps are too few"
    ):
        search(0.5, "lost")
    assert not told


MET = 0.025
"""Time in s at which alpha is 1 rad, nearly."""

LOCATED: dict[str, tuple[Scenario, list[Suspect], bool]] = {
    "on steep friction, by implicit steps": (
        Scenario(friction=SmoothCoulomb(smoothing=1e-8)), [Suspect(1, 0.08, "1.0")], True
    ),
    # Within a tenth of that time.
    "what a run has met, a little later": (Scenario(), [Suspect(0, 0.95 * MET, "1.0")], True),
    "not what it may have met": (Scenario(), [Suspect(0, 0.95 * MET, "")], False),
    "earlier first": (Scenario(), [Suspect(1, 0.02, "1.0"), Suspect(2, 0.02, "2.0")], True),
    "earlier last": (Scenario(), [Suspect(2, 0.02, "2.0"), Suspect(1, 0.02, "1.0")], True),
}  # fmt: skip
"""What is searched, and whether that ends it."""


@pytest.mark.parametrize("case", LOCATED)
def test_the_earliest_ending_that_a_run_has_met_is_located_near_there(case: str) -> None:
    scenario, told, is_found = LOCATED[case]
    conditions = {str(limit): reaching("alpha", limit) for limit in (1.0, 2.0)}
    known, records = recorded(scenario, [0.0, 0.02, 0.04])
    search = searching(scenario, Watch(), conditions)
    reason, moments, _ = search.until_ending(known.times, records, told, 0.1 * MET)
    met = analysis.simulate(scenario, [0.0, 0.1], stop_when=conditions["1.0"]).ending
    assert reason == ("1.0" if is_found else None)
    assert moments[-1] == pytest.approx(not_none(met).time if is_found else 0.04, abs=1e-7)


@pytest.mark.parametrize("top", [0.76458, 1.78355])
def test_a_condition_that_is_positive_only_shortly_ends_the_run_where_it_no_longer_is(
    top: float,
) -> None:
    # At the first two maxima of this rate, both times within half a millisecond.
    shortly, times = reaching("beta_rate", 0.9999 * top, -1.0), TIMES[::10]
    known = not_none(analysis.simulate(Scenario(), times, stop_when=shortly).ending)
    ways: list[tuple[Formulation, float | None, float]] = [
        ("contact-tree", None, 1e-8), ("contact-tree", 5e-3, 1e-6), ("floating", 2e-3, 1e-3)
    ]  # fmt: skip
    for formulation, step, within in ways:
        scene = Scene(Scenario(), formulation)
        ending = mbs_models.simulate(scene, times, step=step, stop_when=shortly).ending
        assert not_none(ending).time == pytest.approx(known.time, abs=within)


ENDS = [problem for name, problem in problems().items() if name.startswith(ENDED)]
QUICK = [
    *((number, "engine") for number in (4, 8, 17)),
    *((number, "in-house") for number in (4, 9, 11, 17)),
]
LONG_RUNS = {(number, "engine") for number in (0, 1, 3)}
"""By fixed steps, ten seconds each."""

CASES = [
    *mostly_slow(sorted({*product(range(8), SOURCES), *QUICK} - LONG_RUNS), QUICK),
    *(pytest.param(case, marks=pytest.mark.whole) for case in sorted(LONG_RUNS)),
]


@pytest.mark.parametrize("case", CASES)
def test_hard_and_random_motions_end_where_and_when_they_promise(case: tuple[int, Source]) -> None:
    number, side = case
    problem = ENDS[number]
    # By two other methods, in which endings are located apart.
    known = reference(problem.scenario, problem.times, stop_when=problem.stop_when)
    rows = [outcome(problem, way, known) for way in ways(problem) if way.source == side]
    assert rows
    for row in rows:
        assert row["verdict"] == "accurate" or row["verdict"].startswith("ends: ")
        assert not is_broken(row)


def near(state: State) -> float:
    return (state.coordinates[3] - 40.0 * 0.045) ** 2 - (40.0 * 4e-4) ** 2


def slightly(state: State) -> float:
    """The same in small numbers."""
    return 1e-3 * near(state)


@pytest.mark.parametrize("condition", [near, slightly])
@pytest.mark.parametrize("formulation", ["euler-tree", "floating"])
def test_a_condition_that_is_negative_between_two_steps_alone_ends_the_run_there(
    formulation: Formulation, condition: Any
) -> None:
    # Model 4 turns at 40 rad/s: from 0.0446 to 0.0454 s, between steps at 0.044 and 0.046 s.
    scene, late = Scene(model(4), formulation), reaching("alpha", 1.81)
    run = mbs_models.simulate(scene, TIMES[:11], step=2e-3, stop_when=[late, condition])
    ending = not_none(run.ending)
    assert ending.reason == condition.__name__
    assert ending.time == pytest.approx(0.0446, abs=1e-5)
