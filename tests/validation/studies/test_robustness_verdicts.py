"""What the robustness study calls accurate, ended, doubtful and unfinished."""

from dataclasses import replace
from math import cos, inf
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import MODELS, STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.endings import Ending
from tests.helpers import not_none
from validation.kit.provenance import Provenance
from validation.studies.robustness import figures, random_scenarios, stored, tables
from validation.studies.robustness import run as runs
from validation.studies.robustness.axes import body, problems
from validation.studies.robustness.cases import TOLERANCE, HardProblem, Way, ways
from validation.studies.robustness.causes import cause
from validation.studies.robustness.causes import table as causes_table
from validation.studies.robustness.reference import (
    NoReference,
    Reference,
    deviation,
    ending_error,
    limited,
    reference,
    reference_or_reason,
)
from validation.studies.robustness.run import DOUBT, Outcome, run_case
from validation.studies.robustness.work import StepCount

TREE = Way(source="engine", formulation="contact-tree", integrator="RK67")
EULER = Way(source="engine", formulation="euler-tree", integrator="TrapezoidalIndex2")
DOP853 = Way(source="in-house", formulation="index-1", integrator="DOP853")
RADAU = Way(source="in-house", formulation="index-1", integrator="Radau")
EASY = HardProblem(axis="none", label="", scenario=Scenario(), end=0.1, samples=11)
PULLING = HardProblem(
    axis="none",
    label="fast",
    scenario=Scenario(start=Start(spin=300.0)),
    end=0.1,
    samples=21,
)
BLANK = Outcome(axis="none", label="", level=1, way=TREE, verdict="accurate")


@pytest.fixture(scope="module")
def easy() -> Reference:
    return reference(EASY)


@pytest.fixture(scope="module")
def pulling() -> Reference:
    return reference(PULLING)


def moved(run: Trajectory, angle: float = 0.0, ending: float | None = 0.0) -> Trajectory:
    """A run with other angles, and ending later, or not at all."""
    other = replace(run, coordinates=run.coordinates + angle)
    if run.ending is None:
        return other
    end = None if ending is None else replace(run.ending, time=run.ending.time + ending)
    return replace(other, ending=end)


def returning(run: Trajectory) -> Any:
    return lambda *_arguments, **_options: run


def test_run_that_ends_where_the_contact_would_pull_has_a_class_of_its_own(
    pulling: Reference,
) -> None:
    for way in (TREE, DOP853):
        outcome = run_case(PULLING, way, pulling)
        assert outcome.verdict == "ends: contact would pull"
        assert not_none(outcome.ending_error) < TOLERANCE
        assert not_none(outcome.error) < TOLERANCE
        assert "would have to pull" in outcome.reason


@pytest.mark.parametrize("ending", [1e-5, None])
def test_run_that_ends_elsewhere_or_goes_on_is_inaccurate(
    pulling: Reference, ending: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = moved(pulling.first, ending=ending)
    monkeypatch.setattr(runs, "simulate", returning(replace(run, error_estimate=1e-8)))
    outcome = run_case(PULLING, TREE, pulling)
    assert outcome.verdict == "inaccurate"
    assert outcome.broken


def test_no_run_in_which_the_contact_pulls_silently_is_accurate(easy: Reference) -> None:
    run = analysis.simulate(PULLING.scenario, PULLING.times, allow_pulling=True, tolerance=1e-8)
    assert np.min(run.normal_force) < 0.0
    outcome = replace(BLANK, error=0.0, doubt=0.0, drift=0.0, energy=0.0)
    assert runs._verdict(outcome, run) == "inaccurate"
    assert runs._verdict(outcome, easy.first) == "accurate"


def test_runs_are_compared_over_what_they_have_in_common(pulling: Reference) -> None:
    run = pulling.first
    rows = run.times.size - 3
    shorter = replace(
        run,
        times=run.times[:rows],
        coordinates=run.coordinates[:rows],
        rates=run.rates[:rows],
        multipliers=run.multipliers[:rows],
        ending=Ending(reason="contact would pull", time=float(run.times[rows - 1]), value=0.0),
    )
    # The last sample is that of an ending, and not one asked for.
    strange = shorter.coordinates.copy()
    strange[-1] += 1.0
    unlike = replace(shorter, ending=replace(not_none(shorter.ending), reason="other"))
    assert deviation(replace(unlike, coordinates=strange), run) == 0.0
    assert ending_error(unlike, run) == inf
    assert ending_error(shorter, run) > 1e-3
    assert ending_error(moved(run, ending=None), run) == inf


@pytest.mark.parametrize(("doubt", "verdict"), [(0.9, "accurate"), (1.1, "reference in doubt")])
def test_accurate_needs_a_reference_known_to_a_tenth_of_the_tolerance(
    easy: Reference, doubt: float, verdict: str
) -> None:
    known = Reference(first=easy.first, second=moved(easy.first, doubt * DOUBT * TOLERANCE))
    outcome = run_case(EASY, TREE, known)
    assert outcome.doubt == pytest.approx(doubt * DOUBT * TOLERANCE, rel=1e-6)
    assert outcome.verdict == verdict


def test_error_beyond_tolerance_and_doubt_is_inaccurate_in_any_doubt(
    easy: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = Reference(first=easy.first, second=moved(easy.first, 1e-4))
    for error, verdict in ((1e-3, "inaccurate"), (1e-5, "reference in doubt")):
        monkeypatch.setattr(runs, "simulate", returning(moved(easy.first, error)))
        assert run_case(EASY, TREE, known).verdict == verdict


def test_each_reference_is_by_another_method_than_the_one_judged(easy: Reference) -> None:
    assert easy.for_way(TREE).method["method"] == "DOP853"
    assert easy.for_way(DOP853).method["method"] == "LSODA"
    assert easy.for_way(RADAU).method["method"] == "DOP853"
    scenario = Scenario(friction=SmoothCoulomb(smoothing=1e-4))
    stiff = reference(replace(EASY, scenario=scenario, end=0.01))
    assert stiff.for_way(RADAU).method["method"] == "LSODA"
    assert easy.doubt < 0.01 * DOUBT * TOLERANCE


def test_penalty_reference_is_of_another_formulation_and_integrator() -> None:
    scenario = Scenario(
        contact=PenaltyContact.damped(1e4, STEEL_DISK), friction=SmoothCoulomb(load="contact")
    )
    known = reference(replace(EASY, scenario=scenario))
    assert known.doubt < DOUBT * TOLERANCE
    for formulation, integrator in (("euler-tree", "DOPRI5"), ("floating-lie", "RK67")):
        way = Way(source="engine", formulation=formulation, integrator=integrator)  # type: ignore[arg-type]
        method = known.for_way(way).method
        assert (method["formulation"], method["integrator"]) != (formulation, integrator)


@pytest.mark.parametrize("way", [TREE, EULER, DOP853])
def test_run_that_takes_all_its_steps_is_not_finished_and_no_failure(
    way: Way, easy: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(runs.STEPS, way.source, 7)
    outcome = run_case(EASY, way, easy)
    assert outcome.verdict == "not finished in the limit"
    assert outcome.steps == 7
    assert "7 steps taken, the last pass at t = 0.0" in outcome.reason
    assert not outcome.broken


@pytest.mark.slow
def test_damper_that_meets_the_table_has_a_reference_by_short_steps() -> None:
    scenario = Scenario(
        contact=PenaltyContact.damped(1e5, STEEL_DISK),
        friction=SmoothCoulomb(load="contact"),
        start=Start(height=1e-3),
    )
    known = reference(replace(EASY, scenario=scenario, end=0.02))
    assert known.first.method["integrator"] == "RK44"
    assert 0.0 < known.doubt < DOUBT * TOLERANCE


def test_longer_motion_may_take_more_steps() -> None:
    assert limited(100, EASY) == 100
    assert limited(100, replace(EASY, end=30.0)) == 3000


def test_steps_count_over_all_passes() -> None:
    count = StepCount(100_000)
    TREE.run(EASY.scenario, EASY.times, tolerance=1e-6, progress=count)
    single = StepCount(100_000)
    TREE.run(EASY.scenario, EASY.times, step=1e-2, progress=single)
    assert single.steps == pytest.approx(10, abs=1)
    assert count.steps >= 30
    assert single.reached == pytest.approx(0.1)


def test_start_that_needs_a_pulling_contact_is_refused_by_run_and_reference() -> None:
    start, rate = EASY.scenario.initial_state, 100.0
    x, y, _, alpha, _, gamma = start.rates
    rising = STEEL_DISK.radius * cos(start.coordinates[4]) * rate
    thrown = replace(start, rates=(x, y, rising, alpha, rate, gamma))
    problem = replace(EASY, scenario=Scenario(start=thrown))
    known = reference_or_reason(problem)
    assert isinstance(known, NoReference)
    assert known.refused
    outcome = run_case(problem, TREE, known)
    assert outcome.verdict == "refused"
    assert cause(outcome) == "starts where the contact would pull"
    assert run_case(EASY, TREE, known).verdict == "inaccurate"


@pytest.mark.parametrize(
    ("verdict", "reason", "expected"),
    [
        ("accurate", "", ""),
        ("ends: contact would pull", "ended at t = 1 s", ""),
        (
            "diverged",
            "engine run stopped: Newton's iteration did not converge (residual 1e-3)",
            "Newton's iteration does not converge",
        ),
        (
            "diverged",
            "singular: each newton of normal force calls for 1.5 N of it through friction",
            "contact load: friction calls for more normal force than it gets",
        ),
        ("diverged", "the disk lies flat, and", "falls flat, where Euler angles end"),
        ("not finished in the limit", "100000 steps taken", "too many steps"),
        ("reference in doubt", "", "no reference is good enough"),
    ],
)
def test_causes_are_told_from_what_runs_say(verdict: Any, reason: str, expected: str) -> None:
    assert cause(replace(BLANK, verdict=verdict, reason=reason)) == expected


def test_inaccurate_energy_is_told_from_inaccurate_angles() -> None:
    wrong = replace(BLANK, verdict="inaccurate", doubt=0.0)
    assert cause(replace(wrong, error=1e-7)) == "angles accurate, energy or constraint not"
    assert cause(replace(wrong, error=1e-5)) == "wrong angles or ending"


def test_causes_are_counted_with_where_they_lie() -> None:
    late = replace(BLANK, verdict="not finished in the limit")
    wrong = replace(BLANK, verdict="inaccurate", error=1.0)
    table = causes_table([BLANK, late, replace(late, axis="other"), late, wrong])
    assert [list(row) for row in table.rows] == [
        ["not finished in the limit", "too many steps", 3, "none (2), other (1)"],
        ["inaccurate", "wrong angles or ending", 1, "none (1)"],
    ]


def study_of(*outcomes: Outcome) -> stored.Study:
    return stored.Study(provenance=Provenance.here(), outcomes=outcomes)


def test_confirmation_counts_what_has_the_verdict_of_the_study() -> None:
    other = replace(BLANK, label="other")
    study = study_of(BLANK, replace(other, verdict="diverged"))
    here = [BLANK, other, replace(BLANK, label="new")]
    (row,) = tables.confirmation(stored.beside(here, study)).rows
    assert list(row[:4]) == ["none", 3, 2, 1]
    assert "other, contact-tree, RK67: accurate, there diverged" in str(row[4])


def test_axis_that_the_full_study_does_not_hold_is_told_so() -> None:
    here = [replace(BLANK, axis="new"), replace(BLANK, axis="new", verdict="refused")]
    (row,) = tables.confirmation(stored.beside(here, study_of(BLANK))).rows
    assert list(row[:4]) == ["new", 2, 0, 0]
    assert row[4] == "not in the full study; here 1 accurate, 1 refused"


def test_shipped_study_holds_all_cases_of_its_axes() -> None:
    study = stored.shipped()
    if study is None:
        pytest.skip("no full study is shipped")
    axes = {outcome.axis for outcome in study.outcomes}
    wanted = {
        (problem.axis, problem.label, problem.scenario.model, way.name)
        for problem in problems(quick=False)
        for way in ways(problem, quick=False)
        if problem.axis in axes
    }
    assert {stored.key(outcome) for outcome in study.outcomes} == wanted
    assert not any(outcome.broken for outcome in study.outcomes)


def test_bodies_reach_the_limits_that_a_rigid_body_allows() -> None:
    found = {each.label: each for each in problems(quick=False) if "inertia" in each.axis}
    a, b, c = found["lamina, COG at 0.9 r"].scenario.disk.inertia_about_cog
    assert a + b == pytest.approx(c, rel=1e-12)
    a, b, c = found["rod along x"].scenario.disk.inertia_about_cog
    assert a < 2e-3 * b
    with pytest.raises(ValueError, match="must not exceed the sum"):
        body((1e-4, 1e-4, 2.001e-4), 0.0)


def test_random_draws_are_those_of_their_seed_and_within_their_ranges() -> None:
    drawn = random_scenarios.draws(40, 3)
    assert [str(each) for each in drawn] == [str(each) for each in random_scenarios.draws(40, 3)]
    assert str(drawn[0]) != str(random_scenarios.draws(1, 4)[0])
    scenarios = [each.problem.scenario for each in drawn]
    assert {each.constraints for each in scenarios} == set(MODELS.values())
    assert {each.friction.load for each in scenarios} == {"weight", "contact"}
    for each in drawn:
        by_weight = each.problem.scenario.friction.load == "weight"
        assert each.formulation != "contact-tree" or by_weight
        assert 1e-8 <= each.tolerance <= 1e-3


def test_random_draw_that_breaks_its_promise_is_found(
    easy: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = random_scenarios.Draw(problem=EASY, formulation="contact-tree", tolerance=1e-5)
    monkeypatch.setattr(random_scenarios, "reference_or_reason", lambda _: easy)
    assert random_scenarios.verdict(drawn)[0] == "kept"
    for wrong, word in ((0.9e-5, "kept"), (1.1e-5, "BROKEN")):
        run = replace(moved(easy.first, wrong), error_estimate=1e-6)
        monkeypatch.setattr(mbs_models, "simulate", returning(run))
        assert random_scenarios.verdict(drawn)[0] == word


def test_labels_of_further_sets_leave_room_for_what_they_label() -> None:
    study = not_none(stored.shipped())
    further = [outcome for outcome in study.outcomes if outcome.level is None]
    # Labels that take all the room are a warning, and so an error.
    (picture,) = figures.verdicts(further)
    assert picture.png.startswith(b"\x89PNG")


@pytest.mark.parametrize(("steps", "verdict"), [(0, "refused"), (1, "crashed")])
def test_value_error_on_the_way_is_no_refusal(
    steps: int, verdict: str, easy: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(_problem: HardProblem, _way: Way, count: StepCount) -> Trajectory:
        for step in range(steps):
            count(float(step), 1.0)
        raise ValueError("beta must lie in the open interval (0, pi)")

    monkeypatch.setattr(runs, "simulate", failing)
    outcome = run_case(EASY, DOP853, easy)
    assert outcome.verdict == verdict
    assert outcome.broken is (steps > 0)
    assert "beta must lie" in outcome.reason
