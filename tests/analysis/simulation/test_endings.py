"""Why a motion ends, and where: up or down again, flat, pulled, at a time limit, or as asked."""

from dataclasses import replace
from itertools import count, product
from math import cos, nan, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import mbs_models
from analysis import (
    CENTRED_DISK,
    Level,
    Method,
    PenaltyContact,
    PowerLawCoulomb,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    Table,
    TimeLimitError,
    Trajectory,
    simulate,
)
from analysis.mechanics.recorded import accelerations
from analysis.problem import limits
from analysis.problem.choices import SOURCES, Source
from analysis.problem.limits import LEAST_TILT
from analysis.solve import effort
from tests.helpers import EITHER_METHOD, angles_apart, model, not_none, reaching
from tests.scenes import LOADED, scene_of
from validation.comparison.differences import ending_error
from validation.run import run

TIMES = np.linspace(0.0, 0.6, 121)
IN_HOUSE: dict[str, Any] = {"source": "in-house"}
SIDES = (IN_HOUSE, {"formulation": "contact-tree"}, {"formulation": "euler-tree"})


def assert_ends(run: Trajectory, reason: str | None, time: float, within: float) -> None:
    assert (run.ending and run.ending.reason) == reason, run.scenario
    assert run.times[-1] == pytest.approx(time, abs=within), run.scenario
    assert run.ending is None or run.ending.time == run.times[-1], run.scenario


def slow(state: State) -> Any:
    # A number of NumPy is one as well.
    return state.vector[9] - 39.5


def test_a_run_ends_at_the_first_of_ones_own_conditions() -> None:
    first, named = (
        simulate(Scenario(), TIMES, tolerance=1e-9, stop_when=iter([each, "inverted"]))
        for each in (slow, f"{__name__}:slow")
    )
    ending = not_none(first.ending)
    assert ending == named.ending
    assert (ending.reason, str(ending)[-7:]) == ("slow", "s: slow")
    assert first.rate("alpha")[-1] == pytest.approx(39.5, abs=1e-7)
    assert ending.value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("side", SIDES[:2], ids=str)
@pytest.mark.parametrize("name", ["flat", "inverted", "at rest", "time limit"])
def test_no_condition_of_ones_own_takes_the_name_of_an_ending_there_is(
    name: str, side: dict[str, Any]
) -> None:
    def condition(_: State) -> float:
        return 1.0

    condition.__name__ = name
    with pytest.raises(ValueError, match=f"^stop_when must .*, got {name}: rename it$"):
        run(FALLS["high"], TIMES, stop_when=condition, **side)


@pytest.mark.parametrize("said", [nan, None])
@pytest.mark.parametrize("side", [*SIDES[:2], {"integrator": "RK44", "step": 1e-3}], ids=str)
def test_a_condition_that_says_no_number_on_the_way_is_told(
    side: dict[str, Any], said: Any
) -> None:
    def fading(state: State) -> Any:
        return said if state.rates[3] < 39.5 else 1.0

    with pytest.raises(ValueError, match=rf"^stop_when fading must say a number .*, got {said}"):
        run(Scenario(), TIMES, stop_when=fading, **side)


@pytest.mark.parametrize("method", EITHER_METHOD)
def test_a_run_may_start_on_a_condition_and_ends_where_it_comes_back(method: Method) -> None:
    # From Table 3, with a tilt rate of zero, the disk at first tilts in one direction.
    for how in (IN_HOUSE | {"method": method, "tolerance": 1e-8}, {}):
        for sign, time in ((-1.0, 0.395551676), (1.0, 0.565391838)):
            found = run(Scenario(), TIMES, stop_when=reaching("beta_rate", 0.0, sign), **how)
            assert_ends(found, "beta_rate 0.0", time, 2e-8)


def test_no_steps_are_wasted_on_an_early_reversal_of_slip() -> None:
    # Steps across the kink that friction has there would be short, and twice as many.
    scenario = model(4, start=Start(spin=37.25768, gamma=-1.761848, beta=1.823287))
    run = simulate(scenario, [0.0, 2.0], tolerance=1e-10, stop_when="inverted")
    assert run.counts["right_hand_sides"] < 2500


def test_a_pull_behind_the_end_of_a_run_in_the_same_step_is_not_noted() -> None:
    # It would last 2.2 ms.
    scenario = Scenario(start=Start(spin=139.0))
    before = simulate(scenario, [0.0, 0.1597], local_tolerance=1e-9).coordinate("gamma")
    assert before[-1] > np.max(before[:-1])
    far = reaching("gamma", float(before[-1]))
    how: dict[str, Any] = {"local_tolerance": 1e-3, "allow_pulling": True}
    run = simulate(scenario, [0.0, 1.0], stop_when=far, **how)
    assert_ends(run, far.__name__, 0.1597, 1e-4)
    assert run.pulling == ()


def test_conditions_say_nothing_of_what_comes_after_a_fall() -> None:
    start = Start(spin=9.4667, beta=1.18926, gamma=1.70513, beta_rate=-0.44891)
    how: dict[str, Any] = {"formulation": "reduced", "tolerance": 1e-3}
    run = simulate(model(4, start=start), [0.0, 1.5], stop_when="lost", **how)
    assert_ends(run, "flat", 0.148187, 1e-5)


@pytest.mark.parametrize("method", EITHER_METHOD)
@pytest.mark.parametrize("order", [1, -1])
def test_of_two_endings_within_1e_11_s_the_earlier_one_counts(order: int, method: Method) -> None:
    # Gamma turns at 15 rad/s there; a step is some milliseconds long.
    both = [reaching("gamma", Start().gamma + angle) for angle in (0.5, 0.5 + 1e-10)]
    how: dict[str, Any] = {"formulation": "reduced", "method": method, "local_tolerance": 1e-9}
    run = simulate(model(4, start=Start(beta=2.0)), [0.0, 1.0], stop_when=both[::order], **how)
    assert_ends(run, both[0].__name__, 0.03129032383, 1e-9)


STILL = SmoothCoulomb(coefficient=0.0)
FALLS = {
    "centred": Scenario(disk=CENTRED_DISK, friction=STILL, start=Start(spin=0.0, beta=0.1)),
    "low": Scenario(friction=STILL, start=Start(spin=0.0, beta=0.1, gamma=-pi / 2)),
    "high": Scenario(friction=STILL, start=Start(spin=0.0, beta=1.0, gamma=-pi / 2)),
}
"""Without friction and spin, and with the centre of gravity right above the contact's edge."""

HIDDEN = Scenario(start=Start(spin=0.0, beta=0.1))
"""It seems to fall flat, passes within 1.4e-4 rad of it and rises again."""


def time_of_fall(scenario: Scenario) -> float:
    """Time in s in which a disk falls flat without turning, from its energy, by quadrature."""
    disk, gravity = scenario.disk, scenario.table.gravity
    first = scenario.initial_state.coordinates[4]
    arm = disk.radius - disk.eccentricity
    inertia = disk.inertia_about_cog[1 if disk.eccentricity else 0] / disk.mass

    def slowness(root: float) -> float:
        tilt = first - root**2
        drop = sin(first) - sin(tilt)
        return 2.0 * root * sqrt((inertia + (arm * cos(tilt)) ** 2) / (2.0 * gravity * arm * drop))

    return float(quad(slowness, 0.0, sqrt(first - LEAST_TILT), epsabs=1e-13, epsrel=1e-13)[0])


@pytest.mark.parametrize("side", SIDES, ids=str)
@pytest.mark.parametrize("scenario", FALLS.values(), ids=FALLS)
@pytest.mark.parametrize("count", [2, 201])
def test_disk_ends_flat_when_it_lies_flat(
    side: dict[str, Any], scenario: Scenario, count: int
) -> None:
    found = run(scenario, np.linspace(0.0, 1.0, count), **side)
    assert_ends(found, "flat", time_of_fall(scenario), 1e-7)


GENTLE = PowerLawCoulomb(coefficient=0.03, smoothing=6e-3, load="contact", reference_load=0.25)
LETTING_GO = Scenario(
    constraints=("contact", "fixed-cog"),
    disk=CENTRED_DISK,
    table=Table(gravity=0.13),
    start=Start(beta=1.3, gamma=2.8, spin=-39.0),
)


@pytest.mark.parametrize("side", [IN_HOUSE, IN_HOUSE | {"method": "LSODA"}, {}], ids=str)
# With a tenth of the power, the load falls below 1e-80 N before; with others, it is the flattest.
@pytest.mark.parametrize(("exponent", "tolerance"), [(0.1, None), (0.38, 1e-4), (0.4, 1e-4)])
def test_contact_pulls_where_it_would_without_friction_that_hardly_falls_with_the_load(
    exponent: float, tolerance: float | None, side: dict[str, Any]
) -> None:
    scenario = replace(LETTING_GO, friction=replace(GENTLE, exponent=exponent))
    last = run(scenario, [0.0, 0.06], tolerance=tolerance, **side)
    assert last.ending is not None
    assert last.ending.reason == "contact would pull"
    free = replace(LETTING_GO, friction=SmoothCoulomb(coefficient=0.0))
    _, forces = accelerations(free, last.coordinates[-1], last.rates[-1])
    assert abs(forces[0]) < 1e-9


@pytest.mark.parametrize("side", [IN_HOUSE, {}], ids=str)
def test_a_contact_that_only_touches_at_the_start_pulls_by_no_rounding(
    side: dict[str, Any],
) -> None:
    for damping, spin in product((0.0, 30.0, 300.0), np.linspace(-50.0, 50.0, 12)):
        contact = PenaltyContact(stiffness=1e6, damping=damping, bilateral=True)
        touching = Scenario(contact=contact, start=Start(beta=1.2, height=0.0, spin=float(spin)))
        assert run(touching, [0.0, 5e-4], **side).ending is None
    state = touching.initial_state
    lifted = State(coordinates=state.coordinates, rates=(0.0, 0.0, 0.1, *state.rates[3:]))
    for damping, fault in ((0.0, "pulls at once"), (300.0, "pulls, with a normal force of -30 N")):
        pulled = replace(touching, contact=replace(contact, damping=damping), start=lifted)
        with pytest.raises(ValueError, match=f"^start needs a contact that {fault}; allow"):
            run(pulled, [0.0, 5e-4], **side)


@pytest.mark.slow
def test_disk_that_passes_nearly_flat_goes_on_alike_on_both_sides() -> None:
    asked = zip(SIDES, (1e-6, 1e-4), strict=False)
    one, other = (run(HIDDEN, [0.0, 0.05], tolerance=each, **side) for side, each in asked)
    assert one.ending is None is other.ending
    assert angles_apart(one, other) < 2e-6


@pytest.mark.parametrize("level", [1, 2, 3])
def test_rates_that_grow_near_flat_are_in_the_way_of_no_tolerance(level: Level) -> None:
    low = model(level, start=Start(spin=0.0, beta=0.1))
    coarse, fine = (simulate(low, [0.0, 0.1], tolerance=each) for each in (1e-5, 1e-9))
    assert fine.counts["right_hand_sides"] < 100_000
    assert coarse.ending is None is fine.ending
    assert angles_apart(coarse, fine) < 1e-5


@pytest.mark.parametrize("how", [IN_HOUSE, SIDES[1] | {"local_tolerance": 1e-12}], ids=str)
def test_run_that_takes_far_more_steps_than_expected_says_where_unless_it_has_a_time_limit(
    how: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limits, "SPARE_SECONDS", 1e-3)
    monkeypatch.setattr(effort, "FALLS", 0.0)
    said = set()
    for _ in range(2):
        with pytest.raises(ArithmeticError, match=r"at t = 0\.0.* steps, far more than") as told:
            run(HIDDEN, [0.0, 0.05], **how)
        said.add(str(told.value))
    assert len(said) == 1
    assert simulate(HIDDEN, [0.0, 0.05], time_limit=1e6).ending is None


SHORT = np.linspace(0.0, 0.2, 21)
FAST = Start(spin=150.0)
EITHER = pytest.mark.parametrize("source", SOURCES)


@pytest.mark.parametrize("formulation", ["euler-tree", "floating-lie"])
def test_a_penalty_contact_that_holds_down_ends_as_the_ideal_one(formulation: Any) -> None:
    contact = PenaltyContact(stiffness=1e6, damping=300.0, bilateral=True)
    scene = scene_of(1, formulation, contact=contact, friction=LOADED, start=FAST)
    held = mbs_models.simulate(scene, SHORT, step=5e-5)
    ideal = simulate(replace(scene.scenario, contact=None), SHORT)
    assert held.ending is not None
    assert ending_error(held, ideal) < 2e-4


@EITHER
def test_a_run_ends_at_its_time_limit_or_raises_where_no_tolerance_was_met(source: Source) -> None:
    times = np.linspace(0.0, 1000.0, 100_001)
    how: dict[str, Any] = {"step": 1e-3} if source == "engine" else {"local_tolerance": 1e-8}
    found = run(model(2), times, source=source, time_limit=0.2, **how)
    assert not_none(found.ending).reason == "time limit"
    assert not_none(found.ending).value > 0.2
    assert found.times.size < times.size
    np.testing.assert_array_equal(found.times[:-1], times[: found.times.size - 1])
    with pytest.raises(TimeLimitError, match="time limit met"):
        run(model(2), times, source=source, tolerance=1e-6, time_limit=0.1)


@EITHER
def test_solver_seconds_are_those_of_the_last_run_to_a_tolerance(
    source: Source, monkeypatch: pytest.MonkeyPatch
) -> None:
    readings = count()
    monkeypatch.setattr("analysis.solve.stepping.time.thread_time", lambda: float(next(readings)))
    assert run(model(2), SHORT, source=source, tolerance=1e-4).solver_seconds == 1.0
    # Each run reads the clock twice.
    assert next(readings) >= 4


def test_two_runs_that_agree_up_to_a_time_limit_are_a_result_up_to_the_samples_of_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    steps = count()
    monkeypatch.setattr("analysis.solve.watch.time.process_time", lambda: float(next(steps)))
    whole = simulate(model(2), SHORT, tolerance=1e-3, time_limit=1e9)
    taken = next(steps)
    part = simulate(model(2), SHORT, tolerance=1e-3, time_limit=0.75 * taken)
    last = part.times.size
    assert not_none(part.ending).reason == "time limit"
    assert 1 < last < SHORT.size
    np.testing.assert_array_equal(part.times, SHORT[:last])
    assert np.max(np.abs(part.coordinates - whole.coordinates[:last])[:, 4:]) < 1e-6
    assert not_none(part.error_estimate) <= 1e-3


@pytest.mark.parametrize("method", EITHER_METHOD)
def test_a_contact_has_pulled_no_longer_than_up_to_a_time_limit(method: Method) -> None:
    pulled = Scenario(start=Start(beta=0.5, spin=0.0, beta_rate=-40.0, gamma_rate=0.0))
    how: dict[str, Any] = {"method": method, "local_tolerance": 1e-9, "time_limit": 1e-9}
    found = simulate(pulled, TIMES, allow_pulling=True, **how)
    assert found.pulling == ((0.0, found.times[-1]),)
