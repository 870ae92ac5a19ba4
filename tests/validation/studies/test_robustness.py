"""Numerical stability on stiff and extreme cases."""

import os
import signal
import time
from dataclasses import replace
from math import factorial
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import MODELS, POSSIBLE_SETS, STEEL_DISK, Scenario
from mbs_models import Scene
from mbs_models.linear_stability import STAGES, amplification, largest_step, stability_polynomial
from tests.helpers import not_none
from validation.studies.robustness import section as robustness
from validation.studies.robustness import steps
from validation.studies.robustness.axes import body, problems, scaled
from validation.studies.robustness.cases import HardProblem, Way, ways
from validation.studies.robustness.causes import GOOD
from validation.studies.robustness.drift import RUNNERS, conserved, drift
from validation.studies.robustness.isolated import Failure, run_isolated
from validation.studies.robustness.reference import NoReference, reference
from validation.studies.robustness.refusals import REQUESTS, refusals
from validation.studies.robustness.run import run_case

TREE = Way(source="engine", formulation="contact-tree", integrator="RK67")
EULER = Way(source="engine", formulation="euler-tree", integrator="TrapezoidalIndex2")
EASY = HardProblem(axis="none", label="", scenario=Scenario(), end=0.1, samples=11)


def misbehave(what: str) -> str:
    if what == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if what == "hang":
        time.sleep(60.0)
    return what


@pytest.mark.slow
def test_crash_and_hang_are_noted_and_the_rest_still_runs() -> None:
    calls = [("a",), ("crash",), ("b",), ("hang",), ("c",)]
    results = run_isolated(misbehave, calls, limit=1.0)
    assert [each for each in results if not isinstance(each, Failure)] == ["a", "b", "c"]
    assert [each.kind for each in results if isinstance(each, Failure)] == ["crashed", "too slow"]
    assert "ended with code -11" in results[1].reason


@pytest.mark.parametrize("integrator", STAGES)
def test_stability_function_starts_like_the_exponential(integrator: Any) -> None:
    order = {"RK44": 4, "RK67": 6}[integrator]
    found = stability_polynomial(integrator)
    expected = [1.0 / factorial(power) for power in range(order + 1)]
    np.testing.assert_allclose(found[: order + 1], expected, atol=1e-14)


@pytest.mark.parametrize("integrator", STAGES)
@pytest.mark.parametrize("z", [-0.5, -2.0 + 1.0j, 2.0j])
def test_polynomial_gives_the_engine_s_amplification(integrator: Any, z: complex) -> None:
    polynomial = np.polyval(stability_polynomial(integrator)[::-1], z)
    assert amplification(integrator, z) == pytest.approx(polynomial, abs=1e-12)


def test_stability_limit_of_the_classical_method_is_the_known_one() -> None:
    assert largest_step("RK44", -1.0) == pytest.approx(2.785, abs=2e-3)
    assert largest_step("RK44", 1.0j) == pytest.approx(2.828, abs=2e-3)
    assert largest_step("RK44", -200.0) == pytest.approx(2.785 / 200.0, rel=1e-3)


@pytest.mark.parametrize("smoothing", [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize("integrator", STAGES)
def test_largest_stable_step_over_smoothing_is_the_predicted_one(
    integrator: Any, smoothing: float
) -> None:
    (limit,) = steps.stable_over_smoothing(smoothing, integrator)
    assert limit.step == pytest.approx(limit.predicted, rel=0.03)


@pytest.mark.parametrize("stiffness", [1e4, 1e6, 1e9])
@pytest.mark.parametrize("integrator", STAGES)
def test_largest_stable_step_over_stiffness_is_the_predicted_one(
    integrator: Any, stiffness: float
) -> None:
    (limit,) = steps.stable_over_stiffness(stiffness, integrator)
    assert limit.step == pytest.approx(limit.predicted, rel=0.03)


def test_implicit_integrator_needs_no_smaller_step_for_a_stiffer_contact() -> None:
    way = [("euler-tree", "RK44"), ("euler-tree", "TrapezoidalIndex2")]
    soft, stiff = (
        steps.accurate_steps("stiffness", value, way, 1e-4)  # type: ignore[arg-type]
        for value in (1e5, 1e7)
    )
    assert not_none(stiff[0].step) < 0.2 * not_none(soft[0].step)
    assert stiff[1].step == soft[1].step


def test_steps_at_which_a_run_leaves_all_bounds_are_no_accurate_ones() -> None:
    (limit,) = steps.accurate_steps("stiffness", 1e7, [("euler-tree", "RK44")], 3e-3)
    assert limit.step is None


@pytest.mark.parametrize("way", [TREE, EULER])
def test_easy_case_is_accurate(way: Way) -> None:
    outcome = run_case(EASY, way, reference(EASY))
    assert outcome.verdict == "accurate"
    assert not_none(outcome.error) <= not_none(outcome.estimate)


def test_wrong_result_is_called_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    simulate = mbs_models.simulate

    def wrong(*arguments: Any, **options: Any) -> Any:
        run = simulate(*arguments, **options)
        return replace(run, coordinates=run.coordinates + 1e-4)

    monkeypatch.setattr(mbs_models, "simulate", wrong)
    outcome = run_case(EASY, TREE, reference(EASY))
    assert outcome.verdict == "inaccurate"
    assert outcome.broken
    assert not replace(outcome, estimate=None).broken


def test_drift_and_energy_count_as_well_as_the_angles(monkeypatch: pytest.MonkeyPatch) -> None:
    simulate, known = mbs_models.simulate, reference(EASY)

    def wrong(column: int, amount: float) -> Any:
        def run(*arguments: Any, **options: Any) -> Any:
            made = simulate(*arguments, **options)
            rates = made.rates + amount * (np.arange(6) == column)
            coordinates = made.coordinates + amount * (np.arange(6) == column) * (column == 2)
            return replace(made, coordinates=coordinates, rates=rates)

        return run

    for column, amount in ((2, 1e-6), (4, 1e-1)):
        monkeypatch.setattr(mbs_models, "simulate", wrong(column, amount))
        outcome = run_case(EASY, EULER, known)
        assert not_none(outcome.error) < 1e-6
        assert outcome.verdict == "inaccurate"
        assert not outcome.broken


def test_crash_and_other_bits_break_a_promise() -> None:
    outcome = run_case(EASY, TREE, reference(EASY))
    assert not outcome.broken
    assert replace(outcome, verdict="crashed").broken
    assert replace(outcome, repeatable=False).broken


def test_result_without_a_reference_is_not_called_accurate() -> None:
    outcome = run_case(EASY, TREE, NoReference(reason="too stiff"))
    assert outcome.verdict == "reference in doubt"
    assert "too stiff" in outcome.reason


def test_failed_run_and_refused_case_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    refused = run_case(EASY, replace(EULER, integrator="RK44"), NoReference(reason="none"))
    assert refused.verdict == "refused"
    assert "cannot take the constraints" in refused.reason

    def failing(*_arguments: Any, **_options: Any) -> Any:
        raise mbs_models.EngineError("engine run stopped")

    monkeypatch.setattr(mbs_models, "simulate", failing)
    failed = run_case(EASY, EULER, NoReference(reason="none"))
    assert failed.verdict == "diverged"
    assert failed.reason == "engine run stopped"


@pytest.mark.parametrize("name", REQUESTS)
def test_what_cannot_work_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]+$"):
        REQUESTS[name]()


def test_all_refusals_come_at_once() -> None:
    assert all(row[1] is True for row in refusals().rows)


@pytest.mark.parametrize("eccentricity", [0.0, 1e-9, 0.99 * STEEL_DISK.radius])
def test_rigid_body_exists_for_every_eccentricity(eccentricity: float) -> None:
    disk = body(STEEL_DISK.inertia_about_cog, eccentricity)
    assert disk.eccentricity == eccentricity
    np.testing.assert_allclose(disk.inertia_about_cog, STEEL_DISK.inertia_about_cog, rtol=1e-9)


@pytest.mark.parametrize("radius", [1e-3, 10.0])
def test_scaled_disk_makes_the_same_motion(radius: float) -> None:
    problem = scaled(Scenario(), radius)
    scene = Scene(problem.scenario)
    run = mbs_models.simulate(scene, np.linspace(0.0, problem.end, 51), tolerance=1e-8)
    original = mbs_models.simulate(Scene(), np.linspace(0.0, 0.5, 51), tolerance=1e-8)
    np.testing.assert_allclose(run.coordinates[:, 3:], original.coordinates[:, 3:], atol=1e-7)


@pytest.mark.parametrize(
    ("level", "formulation", "integrator"),
    [
        (1, "floating", "GeneralizedAlpha"),
        (3, "floating-lie", "TrapezoidalIndex2"),
        (4, "floating", "GeneralizedAlpha"),
        (4, "floating-lie", "TrapezoidalIndex2"),
    ],
)
def test_newton_is_content_with_rounding_on_a_disk_that_weighs_next_to_nothing(
    level: Any, formulation: Any, integrator: Any
) -> None:
    problem = scaled(Scenario(constraints=MODELS[level]), 1e-3)
    way = Way(source="engine", formulation=formulation, integrator=integrator)
    assert run_case(problem, way, reference(problem)).verdict == "accurate"


@pytest.mark.parametrize(
    ("formulation", "integrator", "energy"),
    [("contact-tree", "RK67", 1e-9), ("euler-tree", "TrapezoidalIndex2", 1e-3)],
)
def test_frictionless_disk_keeps_energy_and_momenta(
    formulation: Any, integrator: Any, energy: float
) -> None:
    found = conserved(formulation, integrator, 0.5)
    assert not found.failure
    assert max(found.energy, found.momentum, found.spin) < energy


def test_acceleration_level_drifts_and_minimal_coordinates_do_not() -> None:
    acceleration, minimal = drift(RUNNERS[0], 1.0), drift(RUNNERS[-1], 1.0)
    assert acceleration.position[-1] > 5 * acceleration.position[100]
    assert acceleration.position[-1] > 1e-9
    assert np.max(minimal.position) < 1e-15


def test_full_grid_covers_all_formulations_integrators_and_models() -> None:
    full = [
        (problem, way) for problem in problems(quick=False) for way in ways(problem, quick=False)
    ]
    for constraints in MODELS.values():
        scenario = Scenario(constraints=constraints)
        found = [way for problem, way in full if problem.scenario.constraints == constraints]
        names = {way.name for way in found}
        for formulation in mbs_models.formulations(scenario):
            for integrator in mbs_models.integrators(formulation):
                assert f"{formulation}, {integrator}" in names
    assert len(problems(quick=True)) < len(problems(quick=False)) / 3


def test_report_and_grid_have_every_axis_of_the_study() -> None:
    for quick in (True, False):
        axes = {problem.axis for problem in problems(quick=quick)}
        assert len(axes) == 15
        contacts = [each for each in problems(quick=quick) if each.scenario.contact is not None]
        assert contacts
        for problem in contacts:
            ways_of_it = ways(problem, quick=quick)
            assert {way.formulation for way in ways_of_it} == {
                "euler-tree", "floating", "floating-lie",
            }  # fmt: skip


def test_full_grid_tries_every_possible_set_of_constraints_on_both_sides() -> None:
    tried = {
        (problem.scenario.constraints, way.source)
        for problem in problems(quick=False)
        for way in ways(problem, quick=False)
    }
    assert tried == {(each, source) for each in POSSIBLE_SETS for source in ("engine", "in-house")}


@pytest.mark.parametrize("axis", ["constraint set", "inclination of the table"])
def test_further_sets_and_a_leaning_table_are_accurate_in_every_formulation(axis: str) -> None:
    for problem in problems(quick=True):
        if problem.axis == axis:
            short = replace(problem, end=0.1, samples=11)
            known = reference(short)
            for way in ways(short, quick=True):
                assert run_case(short, way, known).verdict == "accurate"


def test_reduced_equations_are_not_asked_for_a_leaning_table() -> None:
    for problem in problems(quick=False):
        tried = {way.formulation for way in ways(problem, quick=False)}
        assert problem.scenario.table.is_horizontal or "reduced" not in tried


def test_every_quick_problem_is_known_by_its_key() -> None:
    keys = [job.key for job in robustness.jobs(quick=True)]
    assert len(set(keys)) == len(keys)
    assert all(key[0] == "robustness" for key in keys)


@pytest.mark.slow
@pytest.mark.parametrize("problem", problems(quick=True), ids=lambda p: f"{p.axis} {p.label}")
def test_quick_case_is_accurate_or_misses_the_energy_of_an_impact(
    problem: HardProblem,
) -> None:
    known = reference(problem)
    for way in ways(problem, quick=True):
        if way.source == "engine":
            outcome = run_case(problem, way, known)
            elastic = problem.axis == "start above the table"
            assert outcome.verdict in (*GOOD, *(("inaccurate",) if elastic else ()))
            assert not outcome.broken
