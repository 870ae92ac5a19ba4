"""What a run will take is known before it starts, and what would never end is refused."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start
from analysis.problem.limits import MOST_STEPS, Effort
from analysis.solve import effort
from mbs_models import Integrator, Scene, rest
from mbs_models import effort as engine_effort
from tests.scenes import rest_scene, scene_of
from validation.commands import options


def assert_near(predicted: float, taken: float) -> None:
    """A prediction may be off by a factor of four."""
    assert 0.25 < predicted / taken < 4.0


FALLING = Start(beta=0.015, spin=0.0)
FALLING_FAR = Start(beta=0.6, spin=2.0, gamma=0.3)


@pytest.mark.parametrize(
    ("fields", "given"),
    [
        ({}, {"tolerance": 1e-3}),
        ({}, {"tolerance": 1e-10}),
        ({}, {"local_tolerance": 1e-8}),
        ({"start": Start(spin=100.0)}, {"tolerance": 1e-8}),
        ({"friction": SmoothCoulomb(smoothing=1e-4)}, {"tolerance": 1e-6}),
        (
            {"contact": PenaltyContact.damped(1e4, STEEL_DISK, ratio=50.0)},
            {"method": "DOP853", "tolerance": 1e-6},
        ),
        ({"start": Start(beta=2.0)}, {"method": "RK45", "tolerance": 1e-6}),
        ({"start": Start(beta=0.01)}, {"tolerance": 1e-8}),
        pytest.param(
            {"start": FALLING}, {"method": "Radau", "tolerance": 1e-6}, marks=pytest.mark.slow
        ),
        ({"start": FALLING_FAR}, {"method": "Radau", "tolerance": 1e-8}),
        # As short as steps have to be here, friction is not stiff.
        ({"start": FALLING_FAR, "friction": SmoothCoulomb(smoothing=1e-3)}, {"tolerance": 1e-8}),
        ({"start": FALLING, "friction": SmoothCoulomb(smoothing=1e-3)}, {"tolerance": 1e-8}),
        ({}, {"method": "Radau", "tolerance": 1e-6}),
        ({"friction": SmoothCoulomb(smoothing=1e-8)}, {"method": "Radau", "tolerance": 1e-4}),
        ({}, {"method": "BDF", "tolerance": 1e-5}),
        ({}, {"method": "LSODA", "tolerance": 1e-6}),
    ],
    ids=str,
)
def test_evaluations_of_in_house_runs_are_predicted(
    fields: dict[str, Any], given: dict[str, Any]
) -> None:
    scenario, times = Scenario(**fields), np.array([0.0, 0.2])
    predicted, later = (
        effort.simulation_effort(scenario, begin + times, **given) for begin in (0.0, 7.0)
    )
    assert later.steps == pytest.approx(predicted.steps)
    taken = analysis.simulate(scenario, times, **given).counts["right_hand_sides"]
    evaluations = effort.METHODS[given.get("method", "DOP853")].evaluations
    assert_near(predicted.steps * evaluations, taken)


@pytest.mark.parametrize(
    ("scene", "tolerance"),
    [
        (Scene(), 1e-3),
        (Scene(), 1e-11),
        (scene_of(friction=SmoothCoulomb(smoothing=1e-3)), 1e-8),
        (scene_of(4), 1e-6),
        (scene_of(3, formulation="floating"), 1e-4),
    ],
    ids=lambda value: value.built_as if isinstance(value, Scene) else str(value),
)
def test_steps_of_engine_runs_are_predicted(scene: Scene, tolerance: float) -> None:
    times = np.linspace(0.0, 0.5, 51)
    effort_of = partial(engine_effort.simulation_effort, scene, tolerance=tolerance)
    predicted = effort_of(times)
    for how in ({}, {"step": 1e-5}, {"step": 1e-5, "integrator": Integrator(name="DOP853")}):
        # It does not depend on when a run begins.
        assert effort_of(7.0 + times, **how).steps == pytest.approx(effort_of(times, **how).steps)
    taken = mbs_models.simulate(scene, times, tolerance=tolerance).counts["steps"]
    assert_near(predicted.steps, taken)


def test_steps_to_rest_are_predicted_on_both_sides() -> None:
    scene = rest_scene()
    step = rest.SAFETY * rest.largest_step(scene.scenario)
    fixed, free = (
        mbs_models.simulate_to_rest(scene, 0.1, step=each).counts["steps"] for each in (step, None)
    )
    assert engine_effort.rest_effort(scene, 0.1, step).steps == pytest.approx(fixed, rel=0.2)
    # A tolerance takes two runs.
    assert_near(engine_effort.rest_effort(scene, 0.1).steps, 2 * free)
    soft = PenaltyContact.damped(1e4, STEEL_DISK, ratio=0.05, half_thickness=2e-4)
    bouncing = Scenario.rest(contact=soft, start=Start(beta=0.5, spin=5.0, height=0.01))
    for scenario in (scene.scenario, bouncing):
        motion = analysis.simulate_to_rest(scenario, 0.2, local_tolerance=1e-9)
        # A step takes two evaluations.
        taken = motion.counts["right_hand_sides"]
        assert_near(effort.rest_effort(scenario, 0.2).steps, taken)


STEEP = Scenario(friction=SmoothCoulomb(smoothing=1e-12))
LOW = Scenario(start=Start(beta=1.1e-6))
HARD = Scenario.rest(contact=PenaltyContact.rounded(STEEL_DISK, stiffness=1e12))
SIDES: tuple[Any, ...] = (analysis, mbs_models)
ENDLESS: list[tuple[Callable[[], object], str]] = [
    (partial(analysis.simulate, STEEP, [0.0, 2.0], method="DOP853"),
     r"friction gradient 3e\+11 s/m .* would take"),
    (partial(analysis.simulate, Scenario(), [0.0, 1e9]), "tolerance 1e-08 up to t = 1e.09 s"),
    (partial(analysis.simulate, LOW, [0.0, 10.0]), "beta 1.1e-06 rad up to t = 10 s would take"),
    (partial(mbs_models.simulate, Scene(), [0.0, 2.0], step=1e-12),
     "step 1e-12 s up to t = 2 s would take about 2"),
    (partial(mbs_models.simulate, scene_of(3), [0.0, 1e6]), "tolerance 1e-08 up to t = 1e.06 s"),
    (partial(mbs_models.simulate, STEEP, [0.0, 1e4], integrator="DOP853"),
     r"friction gradient 3e\+11 s/m .* would"),
    *((partial(side.simulate_to_rest, HARD, 80.0),
       r"end = 80 s at stiffness 1e\+12 N/m would") for side in SIDES),
    *((partial(side.simulate_to_rest, Scenario.rest(), 1e9),
       r"end asks for 5e\+11 samples") for side in SIDES),
]  # fmt: skip


@pytest.mark.parametrize(("call", "message"), ENDLESS)
def test_endless_run_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        call()


def test_smoothing_below_every_step_is_said_to_be_in_vain() -> None:
    scene = scene_of(2, friction=SmoothCoulomb(smoothing=1e-7))
    halved = Integrator(name="TrapezoidalIndex2")
    found = engine_effort.simulation_effort(scene, np.linspace(0.0, 2.0, 201), halved)
    assert "it needs steps of 4e-09 s, the shortest tried is 1e-06 s" in str(found)


@pytest.mark.parametrize(
    ("samples", "cause"), [(21, "tolerance 1e-10 "), (200_001, "times up to t = 2 s")]
)
def test_what_asks_for_so_many_steps_is_told(samples: int, cause: str) -> None:
    fixed, times = Integrator(name="RK67"), np.linspace(0.0, 2.0, samples)
    found = engine_effort.simulation_effort(Scene(), times, fixed, tolerance=1e-10)
    assert f", for {cause}" in str(found)


def test_long_runs_alone_are_announced(capsys: pytest.CaptureFixture[str]) -> None:
    short = Effort(steps=100.0, seconds=1.0, argument="tolerance", value="1")
    for found, said in (
        (short, ""),
        (replace(short, seconds=61.0), "about 1.0e+02 steps, roughly 61 s, for tolerance 1"),
        (replace(short, doubt="in vain"), "roughly 1 s, for tolerance 1; in vain"),
    ):
        with options.announced("simulate", found) as progress:
            # What is refused before it begins is refused in a line of its own.
            assert capsys.readouterr().err == ""
            progress(0.0, 2.0)
            progress(0.1, 2.0)
        shown = capsys.readouterr()
        assert shown.out == ""
        assert said in shown.err
        assert shown.err.count("\n") == bool(said)
    replace(short, steps=float(MOST_STEPS)).check()
    # A run may take some times as many as expected, and many where they are quick.
    assert replace(short, seconds=1e9).most > 2.0 * short.steps
    assert replace(short, seconds=1e-3).most > 1e3 * short.steps
