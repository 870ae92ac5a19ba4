"""Simulation in the engine: by its own integrators, and on its accelerations."""

import gc
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import pi, radians
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import exudyn as exu
import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    CENTRED_DISK,
    LEVELS,
    LOADS,
    POSSIBLE_SETS,
    STEEL_DISK,
    Disk,
    EllipticDisk,
    Level,
    LubricatedCoulomb,
    PenaltyContact,
    PowerLawCoulomb,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    TimeLimitError,
    ToleranceError,
    ViscousFriction,
)
from analysis.mechanics.recorded import accelerations
from analysis.motion.endings import FLAT
from analysis.problem.checks import Array
from analysis.problem.start import FlatError, State
from analysis.problem.variations import changed
from mbs_models import EngineError, Formulation, Integrator, Scene, simulation
from mbs_models.effort import ways
from mbs_models.extrapolation import Ladder, apart
from mbs_models.inventory import inventory
from mbs_models.simulation import advice
from tests.bodies import EGG, ELLIPSE, of_six
from tests.helpers import model, mostly_slow, not_none, reaching
from tests.scenes import LOADED, SHORT, TIMES, rest_scene, scene_of, truth
from validation.comparison.differences import deviation, ending_error

# --- To a tolerance ------------------------------------------------------------------------------


def every(scenario: Scenario) -> list[Scene]:
    """Scenes of all formulations."""
    return [Scene(scenario, each) for each in mbs_models.formulations(scenario)]


TURNED, TURNING = reaching("alpha", -17.0), reaching("gamma", 6 * pi + 1.2)
LONG, COARSE = np.linspace(0.0, 0.6, 121), np.linspace(0.0, 0.2, 5)
UNEVEN = 8.0 + np.array([0.0, 0.003, 0.1, 0.1001, 0.13, 0.2])
SLOPE = Table(inclination=radians(2.0), downhill=0.7)
SOFT = PenaltyContact.damped(1e5, STEEL_DISK)
# Many turns before the start: a free body's angles are followed on from there.
WOUND = Scenario(start=Start(alpha=-20.0, gamma=-pi / 2 + 0.1 + 6 * pi))
FAST = Scenario(start=Start(gamma=pi / 2 - 0.01, spin=300.0))
# Its contact pulls for 0.4 ms, between two samples.
TUGGED = Scenario(start=Start(spin=51.3877, beta=1.0, gamma=0.0))
PULLED: list[Scenario] = [
    *(model(level, friction=SmoothCoulomb(load=load), start=Start(spin=150.0))
      for level in (1, 2) for load in LOADS),
    *(model(1, friction=law(load="contact"), start=Start(spin=200.0))
      for law in (PowerLawCoulomb, LubricatedCoulomb)),
]  # fmt: skip
SLENDER = of_six(0.045, 0.4, 0.005, 2e-5, 2e-4, 2.1e-4, kind=EllipticDisk, other_radius=0.0045)
TINY = 0.001365283619037153
STEPPED: dict[str, Any] = {"integrator": "TrapezoidalIndex2"}
ACCELERATED: dict[str, Any] = {"integrator": "DOP853"}

FOLLOWED: list[tuple[Scene, Array, float, dict[str, Any]]] = [
    # By its first steps, this disk turns at 3e4 rad/s; the search for pulling has to end.
    (scene_of(start=Start(spin=35.0, beta=0.2, gamma=0.0, beta_rate=-12.0, gamma_rate=15.0)),
     SHORT, 1e-6, {"allow_pulling": True, "time_limit": 60.0}),
    # With a contact that pulls, friction might call for a load of its own.
    (scene_of(friction=PowerLawCoulomb(load="contact"),
              start=Start(spin=-122.0, beta=0.7448, gamma=-2.1845)),
     SHORT, 1e-6, {"allow_pulling": True}),
    *((scene, TIMES, tolerance, {}) for tolerance in (1e-3, 1e-5, 1e-7, 1e-9)
      for scene in map(scene_of, LEVELS)),
    *((scene, SHORT, 1e-7, ACCELERATED) for held in POSSIBLE_SETS
      for scene in every(Scenario(constraints=held, table=SLOPE, start=Start(beta=1.3)))),
    *((Scene(Scenario(disk=body, friction=LOADED, start=Start(beta=1.3, gamma=0.4, spin=15.0))),
       SHORT, 1e-6, how) for body in (ELLIPSE, EGG) for how in (STEPPED, ACCELERATED)),
    # Nearly flat.
    *((Scene(model(level, start=Start(beta=1e-3))), np.linspace(0.0, 3e-3, 11), 1e-7, {})
      for level in LEVELS),
    (scene_of(1, "contact-tree"), UNEVEN, 1e-6, {"integrator": "RK67"}),
    (scene_of(1, "floating"), UNEVEN, 1e-5, STEPPED),
    (scene_of(1, "floating-lie"), UNEVEN, 1e-6, {}),
    # Runs of a call begin alike though they share a model.
    (scene_of(1, "floating-lie", contact=SOFT), SHORT[:6], 1e-5, {"integrator": "RK44"}),
    *((scene, times, tolerance, {"allow_pulling": True})
      for scenario, times, tolerance in ((FAST, COARSE, 1e-4), (TUGGED, LONG[:40:4], 1e-8))
      for scene in every(scenario)),
    *((scene, LONG, 1e-8, {"stop_when": each}) for scene in every(WOUND)
      for each in ("inverted", TURNED, TURNING)),
    *((Scene(WOUND, each), LONG, 1e-5, STEPPED | {"stop_when": TURNED})
      for each in ("floating", "floating-lie")),
    *((scene, LONG, 1e-6, how) for scenario in PULLED for scene in every(scenario)
      for how in (ACCELERATED, STEPPED)[: 2 if scene.formulation == "euler-tree" else 1]),
    # Of the smallest disks, the norm of a quaternion has a rate with larger last digits than all
    # forces: Newton's iteration must not be asked for less than rounding leaves of it.
    (Scene(Scenario(disk=Disk.ring(radius=TINY, hole_radius=TINY / 3, hole_distance=0.44 * TINY,
                                   thickness=TINY / 4.5),
                    start=Start(beta=1.2014047425307979, gamma=-0.41796035905012596,
                                spin=38.52367678259769)), "floating"),
     np.linspace(0.0, 0.05, 31), 1e-5, STEPPED),
    # Times of pulling are extrapolated as the motion is.
    (Scene(Scenario(constraints=("contact", "no-slip-along", "constant-spin"),
                    friction=ViscousFriction(), start=Start(spin=60.0, beta=0.9, gamma=-1.0))),
     np.array([0.0, 0.3]), 1e-8, STEPPED | {"allow_pulling": True}),
    # The contact point runs about the ends of a slender body faster than differences resolve.
    (Scene(Scenario(disk=SLENDER, start=Start(spin=20.0, beta=1.2, gamma=0.3))), SHORT, 1e-9, {}),
]  # fmt: skip
"""Scenes, times, tolerances, and how they are run else."""

QUICK = {number for number in range(107) if (number - 2) % 3} | {109, 111, 114, 123, 124, 125}


@pytest.mark.parametrize("case", mostly_slow(range(len(FOLLOWED)), QUICK))
def test_engine_follows_the_in_house_motion_to_its_end_and_knows_its_error(case: int) -> None:
    scene, times, tolerance, how = FOLLOWED[case]
    ends = {name: how[name] for name in ("stop_when", "allow_pulling") if name in how}
    finest = 1e-13 if scene.scenario.contact is None else 1e-11
    expected = truth(scene.scenario, times, local_tolerance=finest, **ends)
    run = mbs_models.simulate(scene, times, tolerance=tolerance, **how)
    assert deviation(run, expected) <= not_none(run.error_estimate) <= tolerance
    assert ending_error(run, expected) <= 0.1 * tolerance
    for name, part in (("coordinates", 1.0), ("rates", 100.0), ("multipliers", 10.0)):
        found, right = getattr(run, name), getattr(expected, name)
        np.testing.assert_allclose(found, right, rtol=0.0, atol=part * tolerance)
    np.testing.assert_array_equal(run.times[:-1], times[: run.times.size - 1])
    np.testing.assert_allclose(run.pulling, expected.pulling, rtol=0.0, atol=tolerance)
    if run.ending and run.ending.reason == "contact would pull":
        for each in (run, expected):
            assert np.all(each.normal_force[:-1] > 0.0)
            assert abs(each.normal_force[-1]) < 1e-4 * scene.scenario.weight
            assert not_none(each.ending).value == each.normal_force[-1]


def test_quick_accelerations_of_a_free_body_bias_no_run_to_a_fine_tolerance() -> None:
    friction = SmoothCoulomb(coefficient=0.3, smoothing=0.03, load="contact")
    start = Start(spin=19.7, beta=1.494, gamma=-1.635)
    scenario, times = Scenario(friction=friction, start=start), np.linspace(0.0, 1.25, 6)
    run = mbs_models.simulate(Scene(scenario, "floating"), times, tolerance=1e-9)
    assert deviation(run, truth(scenario, times)) <= 1e-10


@pytest.mark.parametrize("level", LEVELS)
def test_the_engine_itself_steps_with_a_step_or_where_no_constraint_is_left(level: Level) -> None:
    accuracies: list[dict[str, Any]] = [{"tolerance": 1e-5}, {"step": 5e-3}]
    used = [mbs_models.simulate(scene_of(level), SHORT, **each) for each in accuracies]
    expected = ["RK67", "RK67"] if level == 1 else ["DOP853", "TrapezoidalIndex2"]
    assert [run.method["integrator"] for run in used] == expected
    assert used[0].method["tolerance"] == 1e-5


@pytest.mark.parametrize("level", [1, 2, 4])
@pytest.mark.parametrize("density", [1e-6, 1e60])
def test_a_motion_does_not_tell_how_heavy_the_disk_is(level: Level, density: float) -> None:
    usual = model(level, friction=SmoothCoulomb(load="contact"))
    run = mbs_models.simulate(changed(usual, {"disk.density": density}), SHORT, tolerance=1e-6)
    assert deviation(run, truth(usual, SHORT)) <= not_none(run.error_estimate) <= 1e-6


@pytest.mark.parametrize("smoothing", mostly_slow([1e-4, 1e-6, 1e-8], [1e-6]))
@pytest.mark.parametrize("level", mostly_slow(LEVELS, [1, 2]))
def test_stiff_friction_keeps_its_tolerance_in_few_steps(level: Level, smoothing: float) -> None:
    scenario = model(level, friction=SmoothCoulomb(smoothing=smoothing))
    expected = analysis.simulate(scenario, SHORT, method="Radau", tolerance=1e-8)
    run = mbs_models.simulate(Scene(scenario), SHORT, tolerance=1e-6)
    assert run.method["integrator"] == "Radau"
    assert deviation(run, expected) <= not_none(run.error_estimate) + 1e-8 <= 1.01e-6
    assert run.counts["steps"] < 4000


@pytest.mark.parametrize(
    ("stiffness", "height"),
    [(1e7, None), pytest.param(1e9, None, marks=pytest.mark.slow), (1e5, 5e-3)],
)
def test_a_stiff_contact_and_impacts_keep_their_tolerance_at_little_cost(
    stiffness: float, height: float | None
) -> None:
    contact, start = PenaltyContact.damped(stiffness, STEEL_DISK), Start(height=height)
    scenario = Scenario(friction=LOADED, contact=contact, start=start)
    run = mbs_models.simulate(scenario, SHORT[:11], tolerance=1e-6)
    assert deviation(run, truth(scenario, SHORT[:11], local_tolerance=1e-11)) <= 1e-6
    steps, evaluations = (run.counts[name] for name in ("steps", "right_hand_sides"))
    # Through impacts, fixed steps would lose their order.
    assert evaluations < 2.5 * steps if height is None else steps < 1000


def test_dop853_may_take_over_where_impacts_leave_lsoda_short_of_a_tolerance() -> None:
    stiff, soft = (
        Scene(Scenario(contact=PenaltyContact.damped(stiffness, STEEL_DISK)))
        for stiffness in (1e8, 1e5)
    )
    tried = [each.name for each in ways(stiff, SHORT, 1e-6)]
    assert tried == ["LSODA", "DOP853", "TrapezoidalIndex2"]
    assert [each.name for each in ways(soft, SHORT, 1e-6)] == tried[1:]


PROPOSED = {
    "integrator 'DOPRI5'": Scene(),
    "formulation 'contact-tree'": scene_of(1, "floating"),
    "the in-house equations": scene_of(3),
    "the in-house": scene_of(1, "floating", friction=LOADED),
}


@pytest.mark.parametrize("way", PROPOSED)
def test_a_tolerance_that_is_not_met_proposes_another_way(way: str) -> None:
    says = f"time limit met.*; try {way}.*, or a larger tolerance or step$"
    with pytest.raises(TimeLimitError, match=says):
        mbs_models.simulate(
            PROPOSED[way], np.linspace(0.0, 99.0, 991), tolerance=1e-9, time_limit=0.05
        )


def test_the_way_that_was_tried_first_is_told_where_the_last_one_comes_to_lie_flat(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    far, flat = ToleranceError("far off"), FlatError("flat", 0.1)
    monkeypatch.setattr(simulation, "_stepped", Mock(side_effect=far))
    monkeypatch.setattr(simulation, "extrapolated", Mock(side_effect=flat))
    with pytest.raises(ToleranceError, match="far off; try "):
        mbs_models.simulate(scene_of(3), [0.0, 0.1], tolerance=1e-6)


def test_nearly_flat_a_free_body_is_proposed_whose_accelerations_lose_fewer_digits() -> None:
    proposals: list[tuple[Formulation, float, str]] = [
        ("contact-tree", 1e-3, "formulation 'floating'"),
        ("contact-tree", 1.0, "integrator 'DOPRI5'"),
        ("floating", 1e-3, "the in-house equations"),
        ("floating", 1.0, "formulation 'contact-tree'"),
    ]
    for formulation, leaning, proposed in proposals:
        told = advice(Scene(formulation=formulation), Integrator(name="RK67"), leaning)
        assert told.startswith(f"try {proposed}")
    # No free body is held on the ideal contact but round ones.
    told = advice(Scene(Scenario(disk=ELLIPSE)), Integrator(name="DOP853"), 1e-3)
    assert told.startswith("try the in-house equations")
    fallen = Scenario(disk=ELLIPSE, start=Start(spin=0.0, beta=1e-3))
    with pytest.raises(ToleranceError, match=r"falls; try the in-house equations \(analysis\."):
        mbs_models.simulate(fallen, [0.0, 0.1], tolerance=1e-7)
    low = Scenario(start=Start(spin=10.0, beta=1e-3))
    state = low.initial_state
    right, _ = accelerations(low, state.coordinates, state.rates)
    errors = [
        np.abs(mbs_models.acceleration(Scene(low, each))[0] - right).max() / np.abs(right).max()
        for each in ("contact-tree", "floating")
    ]
    assert errors[0] > 1e-11
    assert errors[1] < 1e-12


@pytest.mark.parametrize("level", LEVELS[:2])
def test_a_run_that_comes_nearly_flat_goes_by_a_free_body_unless_its_formulation_is_given(
    level: Level,
) -> None:
    scenario, times = model(level, start=Start(spin=0.0, beta=0.3)), np.linspace(0.0, 0.1, 11)
    assert Scene(scenario).built_as != "floating"
    expected = analysis.simulate(scenario, times, tolerance=1e-10)
    # Between two of these it comes nearer to flat than where a tree is given up.
    assert expected.coordinates[:, 4].min() < 0.05
    hows: list[dict[str, Any]] = [{}, ACCELERATED]
    for how in hows:
        run = mbs_models.simulate(scenario, times, tolerance=1e-7, time_limit=60.0, **how)
        assert run.method["formulation"] == "floating"
        assert deviation(run, expected) < 1e-7
    given = mbs_models.simulate(
        Scene(scenario, "euler-tree"), times, tolerance=1e-3, time_limit=60.0, **ACCELERATED
    )
    assert given.method["formulation"] == "euler-tree"
    # One that falls straight down passes nowhere by flat.
    falling = model(level, start=Start(spin=0.0, beta=0.3, gamma=-np.pi / 2))
    known = analysis.simulate(falling, times, tolerance=1e-10).ending
    assert not_none(known).reason == FLAT
    run = mbs_models.simulate(Scene(falling, "euler-tree"), times, tolerance=1e-8, **ACCELERATED)
    assert not_none(run.ending).reason == FLAT
    assert not_none(run.ending).time == pytest.approx(not_none(known).time, abs=1e-8)
    # A tree would lose too many digits at the start.
    low = model(level, start=Start(beta=0.021, spin=0.0))
    run = mbs_models.simulate(low, 0.2 * times, tolerance=1e-9)
    assert run.method["formulation"] == "floating"
    assert deviation(run, truth(low, 0.2 * times)) < 1e-9


def test_a_run_that_goes_on_as_a_free_body_does_all_that_is_asked() -> None:
    scenario, times = Scenario(start=Start(spin=0.0, beta=0.3)), np.linspace(0.0, 0.1, 11)
    rising, told = reaching("beta_rate", 1.0), list[tuple[float, float]]()
    run = mbs_models.simulate(
        scenario, times, tolerance=1e-7, step=1e-4, stop_when=iter([rising]), time_limit=60.0,
        progress=lambda *at: told.append(at), **ACCELERATED,
    )  # fmt: skip
    known = not_none(analysis.simulate(scenario, times, stop_when=rising).ending)
    assert run.method["formulation"] == "floating"
    assert run.method["step"] == 1e-4
    assert not_none(run.ending).reason == "beta_rate 1.0"
    assert not_none(run.ending).time == pytest.approx(known.time, abs=1e-7)
    assert max(told)[0] == pytest.approx(known.time, abs=1e-3)
    start = Start(spin=40.0, beta=0.3, gamma=-1.4, beta_rate=-12.0, gamma_rate=0.0)
    pulled, how = Scenario(start=start), {"allow_pulling": True, **ACCELERATED}
    run = mbs_models.simulate(pulled, times, tolerance=1e-6, **how)
    assert run.method["formulation"] == "floating"
    pulling = analysis.simulate(pulled, times, allow_pulling=True).pulling
    np.testing.assert_allclose(run.pulling, pulling, rtol=0.0, atol=1e-6)
    with pytest.raises(TimeLimitError, match="try formulation 'contact-tree'"):
        mbs_models.simulate(pulled, [0.0, 5.0], tolerance=1e-9, time_limit=0.5, **how)


def test_gamma_counts_for_nothing_at_the_last_sample_of_a_disk_that_lies_flat_there() -> None:
    one, other = np.zeros((2, 3, 13))
    other[-1, 5], other[:, -1] = 1.0, 0.1
    other[-1, 11] = 5.0
    assert apart(one, other) == pytest.approx(1.5)
    assert apart(one, other, flat=True) == pytest.approx(0.1)
    other[1, 5] = 0.2
    assert apart(one, other, flat=True) == pytest.approx(0.3)


LADDERS: dict[str, tuple[float | None, tuple[float, ...]]] = {
    # A first-order error, which the extrapolation in even powers does not expect.
    "lost order": (None, (0.1, 0.05, 0.025, 0.0125)),
    # Two runs that agree by chance: their error may still be a quarter of that before.
    "chance": (0.1 / 4, (0.0, 0.1, 0.1)),
    # Two extrapolated runs that agree by chance: no better than the next order.
    "chance of extrapolated": (0.03 / 4, (0.16, 0.04, 0.01)),
}


@pytest.mark.parametrize("case", LADDERS)
def test_estimates_are_no_less_than_the_runs_before_let_expect(case: str) -> None:
    least, errors = LADDERS[case]
    scene = scene_of(1, "euler-tree", friction=SmoothCoulomb(coefficient=0.0))
    ladder = Ladder(scene, Integrator(name="TrapezoidalIndex2"))
    for halvings, error in enumerate(errors):
        ladder.add(np.full((3, 12), 1.0 + error), np.arange(3.0), 0.01 / 2**halvings)
        if least is None and ladder.estimate < np.inf:
            assert ladder.estimate >= float(np.max(np.abs(ladder.best[:, :-1] - 1.0)))
    assert ladder.estimate >= 0.999 * (least or 0.0)


def test_times_of_pulling_are_extrapolated_over_runs_alone_that_pull_as_often() -> None:
    scene = scene_of(1, "euler-tree", friction=SmoothCoulomb(coefficient=0.0))
    ladder = Ladder(scene, Integrator(name="TrapezoidalIndex2"))
    runs = np.array([0.1, 0.2, 0.3]), np.array([0.14, 0.24]), np.array([0.11, 0.21])
    for halvings, begins in enumerate(runs):
        values, edges = np.full((3, 12), 1.0 + 0.16 / 4**halvings), begins[:, None] + (0.0, 0.05)
        ladder.add(values, np.arange(3.0), 0.01 / 2**halvings, edges)
    np.testing.assert_allclose(ladder.best_edges, [(0.1, 0.15), (0.2, 0.25)], rtol=1e-12)


# --- Whatever the times --------------------------------------------------------------------------


def test_a_start_off_by_what_is_allowed_begins_without_an_impulse() -> None:
    exact = model(3).initial_state
    off = replace(exact, rates=tuple(np.add(exact.rates, [2e-8, 1e-8, 0, 0, 0, -3e-7]).tolist()))
    scene = Scene(model(3, start=off), "floating")
    found, expected = (
        mbs_models.simulate(scene, SHORT[:11], tolerance=1e-6, integrator=each).multipliers
        for each in ("TrapezoidalIndex2", "DOP853")
    )
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-6)


def test_runs_print_nothing_and_write_nothing(
    folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    mbs_models.simulate(scene_of(2, friction=LOADED), SHORT, step=2e-4)
    mbs_models.simulate_to_rest(rest_scene(), 0.01)
    # A lamina but for rounding, which the engine would warn of.
    inertia = {"inertia_x": 1.51875e-4, "inertia_y": 1.81875e-4, "inertia_z": 3.3375e-4}
    lamina = Disk(radius=0.045, mass=0.3, eccentricity=0.01, **inertia)
    mbs_models.simulate(scene_of(1, "floating", disk=lamina), SHORT, step=1e-3)
    with pytest.raises(EngineError):
        mbs_models.simulate(scene_of(1, "euler-tree"), [0.0, 2.0], step=1.0)
    assert capfd.readouterr() == ("", "")
    assert not list(folder.iterdir())


def test_the_engine_prints_again_after_calls_from_several_threads() -> None:
    before, exu.config.printToConsole = exu.config.printToConsole, True
    try:
        with ThreadPoolExecutor(4) as pool:
            runs = list(pool.map(lambda _: mbs_models.simulate(Scenario(), SHORT), range(4)))
        assert exu.config.printToConsole
    finally:
        exu.config.printToConsole = before
    for run in runs[1:]:
        np.testing.assert_array_equal(run.coordinates, runs[0].coordinates)


def test_turns_of_a_nearly_flat_disk_are_those_of_the_in_house_motion_or_are_refused() -> None:
    still, soft = SmoothCoulomb(coefficient=0.0), PenaltyContact(stiffness=1e5)
    start = Start(beta=0.3, spin=3.0, gamma_rate=0.0)
    bounce = Scenario(disk=CENTRED_DISK, friction=still, contact=soft, start=start)
    scene, times = Scene(bounce, "floating-lie"), np.linspace(0.0, 0.15, 1501)
    run = mbs_models.simulate(scene, times, step=1e-5)
    np.testing.assert_allclose(run.coordinates, truth(bounce, times).coordinates, atol=0.01)
    assert np.ptp(run.coordinate("alpha")) > 4.0 * np.pi
    with pytest.raises(FlatError, match=r"alpha and gamma may turn unseen after t = 0\.05 s"):
        mbs_models.simulate(scene, times[::500], step=1e-5)


UPRIGHT = Scenario(start=Start.stationary(31.0))
BROKEN = State(coordinates=(0.0, 0.0, 1.0, 0.0, 1.5, 0.0), rates=(0.0,) * 6)


def refused(call: Callable[..., Any], *given: Any, **how: Any) -> None:
    with pytest.raises(ValueError, match=r"^start breaks the constraint|^step must not"):
        call(*given, **how)


CALLS: dict[str, Callable[[], Any]] = {
    "steps": lambda: mbs_models.simulate(scene_of(1, "floating"), SHORT, step=1e-3),
    "tolerance": lambda: mbs_models.simulate(Scene(), SHORT, tolerance=1e-6, stop_when="lost"),
    "friction under the contact force": lambda: mbs_models.simulate(
        scene_of(2, friction=LOADED), SHORT, step=1e-3
    ),
    "to rest": lambda: mbs_models.simulate_to_rest(rest_scene(), 0.01),
    "to rest by steps": lambda: mbs_models.simulate_to_rest(rest_scene(), 0.01, step=1e-4),
    "acceleration": lambda: mbs_models.acceleration(scene_of(3)),
    "eigenvalues": lambda: mbs_models.eigenvalues(Scene(UPRIGHT, "euler-tree")),
    "stock eigenvalues": lambda: mbs_models.stock_eigenvalues(Scene(UPRIGHT)),
    "inventory": lambda: inventory(scene_of(2)),
    "refused": lambda: refused(mbs_models.acceleration, Scene(), BROKEN),
    "refused, to rest": lambda: refused(mbs_models.simulate_to_rest, rest_scene(), 0.01, step=1.0),
    "build": lambda: mbs_models.build(Scene()).close(),
}


def test_nothing_of_a_call_stays_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    begin, running = mbs_models.Model.__init__, [""]
    models: dict[str, list[weakref.ref[mbs_models.Model]]] = {name: [] for name in CALLS}

    def noted(self: mbs_models.Model, *given: Any) -> None:
        models[running[0]].append(weakref.ref(self))
        begin(self, *given)

    monkeypatch.setattr(mbs_models.Model, "__init__", noted)
    for running[0], call in CALLS.items():
        call()
    gc.collect()
    assert all(models.values())
    assert not [name for name, made in models.items() if any(model() for model in made)]


ALONE: list[tuple[Scene, float, int, str]] = [
    (Scene(), 0.5, 500, "RK44"),
    *((scene_of(level, "floating-lie", friction=SmoothCoulomb(load=load)), 0.05, 400,
       "TrapezoidalIndex2") for level in (2, 3, 4) for load in LOADS),
]  # fmt: skip
"""Scenes, ends in s, numbers of steps, and solvers of the engine."""


@pytest.mark.parametrize(("scene", "end", "steps", "solver"), ALONE)
def test_a_built_system_is_the_scenario_at_its_start_and_runs_in_the_engine_alone(
    scene: Scene, end: float, steps: int, solver: str
) -> None:
    model = mbs_models.build(scene)
    if scene.has_constraints:
        mbs_models.settle(model)
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = end, steps
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = False
    settings.solution.file.write = settings.show.statistics = False
    model.system.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, solver))
    record, expected = model.record()[None], truth(scene.scenario, [0.0, end])
    state = coordinates, rates = model.decode(record)
    np.testing.assert_allclose(coordinates[0], expected.coordinates[-1], rtol=0.0, atol=1e-7)
    found = (rates, model.multipliers(record, *state))
    for each, right in zip(found, (expected.rates, expected.multipliers), strict=True):
        np.testing.assert_allclose(each[0], right[-1], rtol=0.0, atol=1e-5)
    model.close()
