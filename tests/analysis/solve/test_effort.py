"""What a run will take is known before it starts, and what would never end is refused."""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import LEVELS, STEEL_DISK, Level, PenaltyContact, Scenario, SmoothCoulomb, Start
from analysis.data.limits import MOST_STEPS, Effort
from analysis.solve import effort
from analysis.solve.stepping import Method
from mbs_models import Integrator, Scene, rest_run
from mbs_models import effort as engine_effort
from tests.helpers import model
from tests.scenes import rest_scene, scene_of
from validation.commands import options

FACTOR = 4.0
"""How far a prediction may be off."""

FRICTION = SmoothCoulomb()


def in_house(
    friction: SmoothCoulomb = FRICTION,
    *,
    spin: float = 40.0,
    beta: float = pi / 2,
    end: float = 0.5,
    method: Method = "DOP853",
    **accuracy: float,
) -> tuple[dict[str, Any], Effort]:
    start = Start(spin=spin, beta=beta)
    scenario = Scenario(friction=friction, start=start)
    times = np.array([0.0, end])
    predicted = effort.simulation_effort(scenario, times, method=method, **accuracy)
    call: dict[str, Any] = {"scenario": scenario, "times": times, "method": method}
    return call | accuracy, predicted


@pytest.mark.parametrize(
    "given",
    [
        {"tolerance": 1e-3},
        {"tolerance": 1e-6},
        {"tolerance": 1e-10},
        {"local_tolerance": 1e-8},
        {"spin": 100.0},
        {"friction": SmoothCoulomb(smoothing=1e-2)},
        {"friction": SmoothCoulomb(smoothing=1e-3), "end": 0.2},
        {"friction": SmoothCoulomb(coefficient=10.0), "end": 0.2},
        {"beta": 0.1, "end": 0.02},
        {"beta": 0.01, "end": 0.02},
        {"method": "RK45", "tolerance": 1e-6},
        {"method": "Radau", "tolerance": 1e-6},
        {"method": "BDF", "tolerance": 1e-5},
        {"method": "LSODA", "tolerance": 1e-6},
    ],
    ids=str,
)
def test_evaluations_of_in_house_runs_are_predicted(given: dict[str, Any]) -> None:
    call, predicted = in_house(**given)
    taken = analysis.simulate(**call).counts["right_hand_sides"]
    expected = predicted.steps * effort.METHODS[call["method"]].evaluations
    assert 1.0 / FACTOR < expected / taken < FACTOR


@pytest.mark.parametrize(
    ("scene", "tolerance"),
    [
        (Scene(), 1e-3),
        (Scene(), 1e-6),
        (Scene(), 1e-11),
        (scene_of(friction=SmoothCoulomb(smoothing=1e-3)), 1e-8),
        (scene_of(start=Start(spin=100.0)), 1e-8),
        (scene_of(2), 1e-4),
        (scene_of(4), 1e-6),
        (scene_of(3, formulation="floating"), 1e-4),
    ],
    ids=lambda value: value.built_as if isinstance(value, Scene) else str(value),
)
def test_steps_of_engine_runs_are_predicted(scene: Scene, tolerance: float) -> None:
    times = np.linspace(0.0, 0.5, 51)
    predicted = engine_effort.simulation_effort(scene, times, tolerance=tolerance)
    taken = mbs_models.simulate(scene, times, tolerance=tolerance).counts["steps"]
    assert 1.0 / FACTOR < predicted.steps / taken < FACTOR


def test_steps_to_rest_are_predicted_on_both_sides() -> None:
    scene = rest_scene()
    step = rest_run.SAFETY * rest_run.largest_step(scene)
    predicted = engine_effort.rest_effort(scene, 0.1, step).steps
    assert predicted == pytest.approx(
        mbs_models.simulate_to_rest(scene, 0.1, step=step).counts["steps"], rel=0.2
    )
    steps = 2 * mbs_models.simulate_to_rest(scene, 0.1).counts["steps"]  # of two runs
    assert 1.0 / FACTOR < engine_effort.rest_effort(scene, 0.1).steps / steps < FACTOR
    motion = analysis.simulate_to_rest(scene.scenario, 0.2, local_tolerance=1e-9)
    taken = motion.counts["right_hand_sides"]
    evaluations = 2.0 * effort.rest_effort(scene.scenario, 0.2).steps
    assert 1.0 / FACTOR < evaluations / taken < FACTOR


TWO_SECONDS: dict[str, Any] = {"times": [0.0, 2.0]}


@pytest.mark.parametrize(
    ("fields", "end", "message"),
    [
        (
            {"friction": SmoothCoulomb(smoothing=1e-12)},
            2.0,
            r"friction gradient 3e\+11 s/m .* would take about",
        ),
        (
            {"friction": SmoothCoulomb(coefficient=1e9)},
            2.0,
            r"friction gradient 1e\+10 s/m up to",
        ),
        ({}, 1e9, "tolerance 1e-08 up to t = 1e.09 s would take about"),
        ({"start": Start(beta=1.1e-6)}, 10.0, "beta 1.1e-06 rad up to t = 10 s would take"),
    ],
)
def test_endless_in_house_run_is_refused(fields: dict[str, Any], end: float, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        analysis.simulate(Scenario(**fields), [0.0, end])


@pytest.mark.parametrize(
    ("scene", "given", "message"),
    [
        (Scene(), {"step": 1e-12}, "step 1e-12 s up to t = 2 s would take about 2.0e"),
        (
            scene_of(3),
            {"times": [0.0, 5e5, 1e6]},
            "tolerance 1e-08 up to t = 1e.06 s",
        ),
        (Scene(), {"times": [0.0, 1e9], "step": 1.0}, "step 1 s up to t = 1e.09 s would take"),
        (
            scene_of(friction=SmoothCoulomb(smoothing=1e-10)),
            {"times": [0.0, 1e4], "integrator": "DOP853"},
            r"friction gradient 3e\+09 s/m .* would take about",
        ),
    ],
)
def test_endless_engine_run_is_refused(scene: Scene, given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        mbs_models.simulate(scene, **TWO_SECONDS | given)


def test_endless_way_to_rest_is_refused() -> None:
    contact = PenaltyContact.rounded(STEEL_DISK, stiffness=1e12)
    with pytest.raises(ValueError, match=r"^end = 80 s .* stiffness 1e\+12 N/m .* would take"):
        mbs_models.simulate_to_rest(rest_scene(contact=contact), 80.0, step=1e-8)
    for simulate in (mbs_models.simulate_to_rest, analysis.simulate_to_rest):
        with pytest.raises(ValueError, match=r"^stiffness 1e\+12 N/m until end = 80 s would"):
            simulate(Scenario.rest(contact=contact), 80.0)


def test_way_to_rest_that_no_memory_holds_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^end asks for 5e\+11 samples"):
        analysis.simulate_to_rest(Scenario.rest(), 1e9)
    with pytest.raises(ValueError, match=r"^end asks for 5e\+11 samples"):
        mbs_models.simulate_to_rest(rest_scene(), 1e9)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(
    ("friction", "spin", "tolerance"),
    [
        (FRICTION, 300.0, 1e-8),
        (SmoothCoulomb(smoothing=1e-5), 40.0, 1e-6),
        (SmoothCoulomb(coefficient=10.0), 40.0, 1e-8),
        (FRICTION, 40.0, 1e-10),
    ],
)
def test_honest_runs_are_not_refused(
    level: Level, friction: SmoothCoulomb, spin: float, tolerance: float
) -> None:
    start = Start(spin=spin)
    times = np.linspace(0.0, 2.0, 201)
    scenario = model(level, friction=friction, start=start)
    effort.simulation_effort(scenario, times, tolerance=tolerance).check()
    for formulation in mbs_models.formulations(scenario):
        scene = Scene(scenario, formulation)
        engine_effort.simulation_effort(scene, times, tolerance=tolerance).check()


def test_stiff_methods_do_not_mind_steep_friction() -> None:
    steep = SmoothCoulomb(smoothing=1e-8)
    stiff, explicit = (in_house(steep, method=name)[1] for name in ("Radau", "DOP853"))
    stiff.check()
    assert explicit.steps > 1000.0 * stiff.steps


def test_smoothing_below_every_step_is_said_to_be_in_vain() -> None:
    scene = scene_of(2, friction=SmoothCoulomb(smoothing=1e-7))
    halved = Integrator(name="TrapezoidalIndex2")
    found = engine_effort.simulation_effort(scene, np.linspace(0.0, 2.0, 201), halved)
    assert "it needs steps of 4e-09 s, the shortest tried is 1e-06 s" in str(found)


SHORT = Effort(steps=100.0, seconds=1.0, cause="tolerance 1")


@pytest.mark.parametrize(
    ("found", "said"),
    [
        (SHORT, ""),
        (replace(SHORT, seconds=61.0), "about 1.0e+02 steps, roughly 61 s, for tolerance 1"),
        (
            replace(SHORT, seconds=600.0),
            "about 1.0e+02 steps, roughly 10 minutes, for",
        ),
        (replace(SHORT, seconds=36000.0), "about 1.0e+02 steps, roughly 10 hours, for"),
        (replace(SHORT, doubt="in vain"), "roughly 1 s, for tolerance 1; in vain"),
    ],
)
def test_long_runs_alone_are_announced(
    found: Effort, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    options.announce("simulate", found)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert said in shown.err
    assert shown.err.count("\n") == bool(said)


def test_limit_itself_is_allowed() -> None:
    replace(SHORT, steps=float(MOST_STEPS)).check()
    with pytest.raises(ValueError, match=r"^tolerance 1 would take about 1\.1e\+08 steps"):
        replace(SHORT, steps=1.1 * MOST_STEPS).check()
