"""Hard cases that end by themselves: what they promise, and how their references are found."""

from collections.abc import Callable
from dataclasses import replace
from math import inf, nan, pi, sqrt
from typing import Any

import numpy as np
import pytest

import analysis
from analysis import LEVELS, Scenario, Start, Trajectory
from analysis.data.checks import Array
from analysis.data.endings import CONTACT_WOULD_PULL, Ending
from tests.helpers import not_none
from validation.kit.located import up_to_ending
from validation.studies.robustness import ended, section, tables
from validation.studies.robustness import run as runs
from validation.studies.robustness.axes import QUICK, problems
from validation.studies.robustness.cases import EndedProblem, Way, ways
from validation.studies.robustness.causes import cause
from validation.studies.robustness.reference import Reference, deviation, reference
from validation.studies.robustness.run import Outcome, run_case

TREE = Way(source="engine", formulation="contact-tree", integrator="RK67")
DOP853 = Way(source="in-house", formulation="index-1", integrator="DOP853")
ENDED = EndedProblem(
    axis=ended.AXIS,
    label="",
    scenario=Scenario(),
    end=1.0,
    samples=2,
    tolerance=1e-6,
    stop_when=("inverted",),
)


@pytest.fixture(scope="module")
def known() -> Reference:
    return reference(ENDED)


def later(run: Trajectory, seconds: float) -> Trajectory:
    """A run that ends later in the same state, as a condition makes it."""
    ending = not_none(run.ending)
    times = np.append(run.times[:-1], run.times[-1] + seconds)
    return replace(run, times=times, ending=replace(ending, time=ending.time + seconds))


def turned(run: Trajectory, angle: float) -> Trajectory:
    """A run that ends at the same time with another gamma."""
    coordinates = run.coordinates.copy()
    coordinates[-1, 5] += angle
    return replace(run, coordinates=coordinates)


def unended(run: Trajectory) -> Trajectory:
    """A run that goes on to the last time asked for."""
    times = np.append(run.times[:-1], ENDED.end)
    return replace(run, times=times, ending=None)


def otherwise(run: Trajectory) -> Trajectory:
    return replace(run, ending=replace(not_none(run.ending), reason=CONTACT_WOULD_PULL))


WRONG: dict[str, Callable[[Trajectory], Trajectory]] = {
    "too late by five times what is allowed": lambda run: later(run, 5e-6),
    "too early by half of it, at some rad/s": lambda run: later(run, -5e-7),
    "in another attitude": lambda run: turned(run, 2e-6),
    "for another reason": otherwise,
    "not at all": unended,
}


@pytest.mark.parametrize("way", [TREE, DOP853], ids=lambda way: way.source)
def test_right_ending_keeps_its_promise(way: Way, known: Reference) -> None:
    outcome = run_case(ENDED, way, known)
    assert outcome.verdict == "ends: condition met"
    assert not outcome.broken
    assert cause(outcome) == ""
    assert 0.0 < not_none(outcome.error) < ENDED.tolerance


@pytest.mark.parametrize("name", WRONG)
def test_wrong_ending_breaks_the_promise(
    name: str, known: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    def judged(run: Trajectory) -> Outcome:
        run = replace(run, error_estimate=1e-9)
        monkeypatch.setattr(runs, "simulate", lambda *_: run)
        return run_case(ENDED, TREE, known)

    assert not judged(known.first).broken
    wrong = judged(WRONG[name](known.first))
    assert wrong.broken
    assert wrong.verdict == "inaccurate"
    assert cause(wrong) == "wrong angles or ending"


def test_time_of_an_ending_counts_where_the_angles_stand_still(known: Reference) -> None:
    rates = known.first.rates.copy()
    rates[-1] = 0.0
    still = replace(known.first, rates=rates)
    assert deviation(later(still, 1e-5), still) == pytest.approx(1e-5, rel=1e-6)
    assert deviation(later(known.first, 1e-5), known.first) > 2e-5


@pytest.mark.parametrize("wrong", [nan, inf])
@pytest.mark.parametrize("name", ["error", "ending_error"])
def test_error_that_is_no_number_breaks_a_promise(name: str, wrong: float) -> None:
    right = Outcome(
        axis="",
        label="",
        level=1,
        way=TREE,
        verdict="accurate",
        error=1e-9,
        ending_error=1e-9,
        estimate=1e-9,
        doubt=0.0,
    )
    assert not right.broken
    assert replace(right, **{name: wrong}).broken  # type: ignore[arg-type]


def test_accuracy_asked_for_decides(known: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    run = replace(later(known.first, 1e-5), error_estimate=1e-9)
    monkeypatch.setattr(runs, "simulate", lambda *_: run)
    coarse = run_case(replace(ENDED, tolerance=1e-3), TREE, known)
    assert coarse.verdict == "ends: condition met"
    assert run_case(replace(ENDED, tolerance=1e-8), TREE, known).broken


def test_references_that_end_otherwise_leave_the_verdict_in_doubt(known: Reference) -> None:
    doubtful = Reference(first=known.first, second=otherwise(known.second))
    outcome = run_case(ENDED, DOP853, doubtful)
    assert outcome.verdict == "reference in doubt"
    assert not outcome.broken


def test_reference_ends_where_a_run_of_many_samples_does(known: Reference) -> None:
    many = analysis.simulate(
        ENDED.scenario, np.linspace(0.0, 1.0, 2001), stop_when="inverted", tolerance=1e-11
    )
    assert known.doubt < 1e-10
    assert not_none(known.first.ending).time == pytest.approx(
        not_none(many.ending).time, abs=1e-10
    )
    assert known.first.times.size == 2


def made(height: float, *, contact: Callable[[Array], Array] = np.ones_like) -> Any:
    """Runs of which gamma rises by 2 rad/s from -1 rad and the normal force is given."""

    def plain(scenario: Scenario, times: Array) -> Trajectory:
        zeros = np.zeros(times.size)
        angles = (zeros, np.full(times.size, height), 2.0 * times - 1.0)
        rates = np.tile((0.0, 0.0, 0.0, 0.0, 0.0, 2.0), (times.size, 1))
        return Trajectory(
            times=times,
            coordinates=np.column_stack((zeros, zeros, zeros, *angles)),
            rates=rates,
            multipliers=contact(times)[:, None],
            scenario=scenario,
            source="in-house",
            method={},
        )

    return plain


def located(plain: Any, stop_when: tuple[Any, ...] = ()) -> Ending | None:
    found = up_to_ending(plain, Scenario(), np.array((0.0, 0.7, 2.0)), stop_when, 2e-4)
    rows = 3 if found.ending is None else 1 + int(np.searchsorted((0.0, 0.7), found.times[-1]))
    assert found.times.size == rows
    return found.ending


def passes_zero(state: Any) -> float:
    return -float(state.coordinates[5])


def test_condition_is_located_where_it_is_met_first() -> None:
    found = not_none(located(made(pi / 2), (passes_zero, "inverted")))
    assert found.reason == "passes_zero"
    assert found.time == pytest.approx(0.5, abs=1e-13)
    found = not_none(located(made(pi / 2), ("inverted",)))
    expected = 0.5 + 0.5 * float(np.arcsin(0.9))
    assert found.reason == "inverted"
    assert found.time == pytest.approx(expected, abs=1e-12)
    assert located(made(0.5), ("inverted",)) is None


@pytest.mark.parametrize("middle", [0.123456, 0.7, 1.99])
@pytest.mark.parametrize("half", [1e-3, 1e-5, 1e-6])
def test_pull_shorter_than_the_samples_are_apart_is_found(middle: float, half: float) -> None:
    def dip(depth: float) -> Any:
        return made(1.0, contact=lambda times: ((times - middle) ** 2 - depth) * 1e4)

    found = not_none(located(dip(half**2)))
    assert found.reason == CONTACT_WOULD_PULL
    assert found.time == pytest.approx(middle - half, abs=1e-11)
    assert located(dip(-(half**2))) is None


def test_pull_with_a_kink_is_located_at_the_kink() -> None:
    # Friction by the contact force is gone from there on.
    def force(times: Array) -> Array:
        left = 1.0 / sqrt(2.0) - times
        return np.where(left >= 0.0, left, 7.0 * left)

    found = not_none(located(made(1.0, contact=force)))
    assert found.time == pytest.approx(1.0 / sqrt(2.0), abs=1e-11)


def test_start_that_meets_a_condition_already_has_to_leave_it_first() -> None:
    def gamma_up(state: Any) -> float:
        return float(np.cos(state.coordinates[5]) - 0.9)

    found = not_none(located(made(pi / 2), (gamma_up,)))
    assert found.time == pytest.approx(0.5 + 0.5 * float(np.arccos(0.9)), abs=1e-12)


CASES = [(problem, way) for problem in ended.problems() for way in ways(problem, quick=False)]


def test_axis_has_every_model_side_condition_and_accuracy_with_few_samples() -> None:
    assert 60 <= len(CASES) <= 90
    few = [(problem, way) for problem, way in CASES if problem.samples == 2]
    assert len(few) > len(CASES) / 2
    assert {problem.scenario.model for problem, _ in few} == set(LEVELS)
    assert {way.formulation for _, way in CASES} == {
        "contact-tree", "euler-tree", "floating", "floating-lie", "index-1", "reduced",
    }  # fmt: skip
    names = {name for problem, _ in few for name in problem.stop_when}
    own = {ended.OWN + each for each in ("passes_sideways", "falls_low")}
    assert names == {"inverted", "lost", *own}
    assert any(not problem.stop_when for problem, _ in few)
    assert {problem.tolerance for problem, _ in few} == {10.0**-n for n in range(3, 9)}
    assert {problem.scenario.friction.load for problem, _ in few} == {"weight", "contact"}


def test_axis_is_the_same_each_time_and_told_apart_by_labels() -> None:
    assert list(ended.problems()) == list(ended.problems())
    keys = [(problem.label, problem.scenario.model) for problem in ended.problems()]
    assert len(set(keys)) == len(keys)


def test_every_label_of_the_quick_sample_is_one_of_its_axis() -> None:
    found = {(each.axis, each.label) for each in problems(quick=False)}
    assert {(axis, label) for axis, labels in QUICK.items() for label in labels} <= found


def test_section_says_how_endings_are_judged_where_there_are_any() -> None:
    plain = Outcome(axis="other", label="", level=1, way=TREE, verdict="accurate", error=1e-9)
    ends = replace(plain, axis=ended.AXIS, tolerance=1e-8, estimate=1e-9, ending_error=1e-9)
    told, without = (" ".join(section._paragraphs(each)) for each in ([plain, ends], [plain]))
    assert "1 cases end by themselves and ask for 1e-08 to 1e-08 rad" in told
    assert "end by themselves" not in without
    assert "Of these cases none crashed or broke a promise." in told
    broken = " ".join(section._paragraphs([plain, replace(ends, ending_error=1e-6)]))
    assert "Of these cases 1 crashed or broke a promise." in broken


def test_broken_case_of_this_run_fails_the_report_whatever_is_shipped() -> None:
    right = Outcome(axis="a", label="", level=1, way=TREE, verdict="accurate", estimate=1e-9)
    right = replace(right, error=1e-9)
    wrong = replace(right, error=1e-3)
    assert tables.confirmation([(right, right)]).checks() == [True]
    assert tables.confirmation([(wrong, right)]).checks() == [False]
    assert tables.confirmation([(wrong, None)]).checks() == [False]


def test_fast_start_is_that_of_the_known_pull() -> None:
    (problem,) = (each for each in ended.problems() if each.label == ended.QUICK[0])
    assert problem.scenario.start == Start(spin=139.0)
    assert problem.times.tolist() == [0.0, 1.0]
