"""Many runs at once, told by arrays or listed, are those of single members; their outcomes."""

import os
import pickle
import re
import sys
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import fields
from functools import partial
from math import nan, pi
from typing import Any, cast

import numpy as np
import pytest
from scipy.integrate import simpson

from analysis import (
    LAWS,
    LEVELS,
    MODELS,
    ConstraintSet,
    Ensemble,
    Scenario,
    Start,
    State,
    TimeLimitError,
    Trajectories,
    Trajectory,
    outcomes,
    simulate,
    simulate_many,
    simulate_to_rest,
)
from analysis.motion.outcomes import DONE, OUTCOMES, Row
from analysis.problem.friction import LawError
from analysis.problem.variations import changed
from analysis.simulation import ensemble as many
from analysis.simulation.compiled.systems import Structure
from analysis.simulation.request import Request
from analysis.solve.effort import simulation_effort
from tests.calls import python
from tests.helpers import EITHER_METHOD, TILTED, assert_close, model, needs_heyoka, not_none
from tests.sweeps import sweep
from tests.wayward_law import Answering
from validation.sweeps.case import COLUMNS, NUMBERS, run_chunk

TIMES = np.linspace(0.0, 1.0, 51)
SHORT = TIMES[:11]
SOME = 6
REDUCED: dict[str, Any] = {"formulation": "reduced"}


def spins(*values: float, **fields: Any) -> Ensemble:
    return Ensemble(scenario=model(4), fields={"spin": np.array(values), **fields})


QUANTITIES = (
    *("tilt", "cog_height", "cog_velocities", "cog_direction_rate"),
    *("contact_points", "contact_speed", "normal_force"),
)


def assert_same_as_alone(runs: Trajectories, relative: float, **how: Any) -> None:
    """Every member is what `simulate` makes of it, in the arrays and by itself."""
    for member, scenario in enumerate(runs.ensemble):
        single = simulate(scenario, runs.times, **how)
        found, count = runs[member], int(np.sum(runs.times <= single.times[-1]))
        assert found.scenario == scenario
        assert dict(found.method) == dict(single.method)
        assert found.error_estimate == pytest.approx(single.error_estimate, abs=1e-11)
        assert found.inversion.outcome == single.inversion.outcome
        assert runs.inversions[member] == found.inversion
        for each in (found, single):
            assert (each.ending and each.ending.reason) == runs.endings[member]
        assert runs.ends[member] == found.times[-1] == pytest.approx(single.times[-1], abs=1e-10)
        for name in ("coordinates", "rates", "multipliers"):
            assert_close(getattr(found, name), getattr(single, name), relative=100 * relative)
        for name in ("coordinates", "rates", *QUANTITIES):
            whole = getattr(runs, name)[member]
            assert_close(whole[:count], getattr(single, name)[:count], relative=relative)
            assert np.isnan(whole[count:]).all()


@pytest.mark.parametrize("method", EITHER_METHOD)
def test_members_of_an_ensemble_are_those_of_single_runs(method: str) -> None:
    # More than one compiled batch, and members that end: inverted, or flat.
    ensemble = spins(
        *(20.0, 33.0, 36.0, 40.0, 44.0, 48.0, 52.0, 56.0, 0.0),
        beta=np.append(np.full(8, 1.5), 1.0),
        gamma=np.append(np.full(8, 0.1 - pi / 2), pi / 2),
        radius=np.linspace(0.045, 0.05, 9),
    )
    how: dict[str, Any] = {"stop_when": "inverted", "method": method, "tolerance": 1e-8, **REDUCED}
    runs = simulate_many(ensemble, TIMES, workers=1, **how)
    assert_same_as_alone(runs, 1e-10 if method == "taylor" else 1e-15, **how)
    assert set(runs.endings) == {None, "inverted", "flat"}
    again = pickle.loads(pickle.dumps(runs))  # noqa: S301 - as worker processes do
    np.testing.assert_array_equal(again.coordinates, runs.coordinates)
    np.testing.assert_array_equal(again[3].multipliers, runs[3].multipliers)
    # What is compiled does not come along: it takes longer than what is told.
    for found, sent in zip(again.compiled, runs.compiled, strict=True):
        assert found.group.code is sent.group.code


@needs_heyoka
def test_ensemble_in_pieces_is_the_same_told_by_arrays_or_listed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(many, "COMPILED_CHUNK", 3)
    turning, leaning = np.array([[0.0, 0.0, 30.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.1, 0.0]])
    ensemble = spins(30.0, 40.0, 60.0, 50.0, 50.0, beta_rate=turning, inclination=leaning)
    how: dict[str, Any] = {"tolerance": 1e-6, **REDUCED}
    told: list[tuple[int, int]] = []
    with ThreadPoolExecutor(1) as thread:
        elsewhere = how | {"executor": thread, "progress": lambda *counts: told.append(counts)}
        runs = simulate_many(ensemble, TIMES, **elsewhere)
        listed = simulate_many(list(ensemble), TIMES, **elsewhere)
    assert told == 2 * [(3, 5), (5, 5)]
    whole = simulate_many(ensemble, TIMES, workers=1, **how)
    np.testing.assert_allclose(runs.coordinates, whole.coordinates, rtol=0.0, atol=1e-12)
    for each in (runs, whole):
        assert set(each.failures) == {2, 3}
        assert np.isnan(each.coordinates[2:4]).all()
        for member, message in ((2, "start needs a contact that pulls"), (3, "horizontal table")):
            assert str(each.failures[member]) == str(listed[member])
            with pytest.raises(ValueError, match=message):
                each[member]
    for member in (0, 1, 4):
        outcome = listed[member]
        assert isinstance(outcome, Trajectory)
        assert outcome.scenario == runs[member].scenario == ensemble[member]
        np.testing.assert_array_equal(outcome.coordinates, runs[member].coordinates)


RANGES: dict[str, tuple[float, ...]] = {
    "start.spin": (20.0, -3.0, 2e5),
    "start.beta": (1.2, 0.0, 1e-9, np.nan),
    "start.beta_rate": (0.0, 0.0, 2.0, np.inf),
    "start.gamma_rate": (0.3,),
    "start.x": (0.0, 0.01),
    "start.height": (0.0, 0.01, -1.0),
    "friction.smoothing": (0.1, 0.0, 1e-13),
    "disk.eccentricity": (2e-3, 0.0, 0.05, -1.0),
    "disk.inertia_y": (2.2e-4, 1e-3, 1e-9),
    "table.inclination": (0.0, 0.1, 2.0),
    "dissipation.pivoting": (0.0, 1e-6, 2.0),
}


def test_members_whose_numbers_differ_alone_go_together() -> None:
    varied = [(Scenario.rest(), name, usual or 1e-3) for name, (usual, *_) in RANGES.items()]
    for law in (kind() for kind in LAWS.values()):
        numbers = [each.name for each in fields(law)[1:]]
        varied += [(Scenario(friction=law), name, getattr(law, name)) for name in numbers]
    for scenario, name, usual in varied:
        values = usual * np.linspace(1.0, 1.01, SOME)
        ensemble = Ensemble(scenario=scenario, fields={name: values})
        ((rows, _),) = ensemble.map_groups(lambda each: simulation_effort(each, TIMES))
        assert rows.tolist() == list(range(SOME)), name


@needs_heyoka
def test_members_whose_numbers_differ_alone_are_made_ready_to_be_compiled_together() -> None:
    usual = {"radius": 0.045, "gravity": 9.81, "mass": 0.4, "mu": 0.3, "spin": 40.0, "beta": 1.5}
    whole = partial(Structure.of, formulation="index-1", request=Request(TIMES))
    for name, number in usual.items():
        values = number * np.linspace(1.0, 1.01, SOME)
        ((rows, _),) = Ensemble(scenario=Scenario(), fields={name: values}).map_groups(whole)
        assert rows.tolist() == list(range(SOME)), name


def first_refusal(base: Scenario, fields: dict[str, Any]) -> str | None:
    """What the rules of one scenario say, member by member."""
    for member in range(SOME):
        try:
            changed(base, {name: values[member] for name, values in fields.items()})
        except ValueError as error:
            return f"member {member} of fields: {error}"
    return None


@pytest.mark.parametrize("level", LEVELS)
def test_ensemble_refuses_what_a_scenario_refuses(level: Any) -> None:
    random, refused = np.random.default_rng(level), 0
    for _ in range(60):
        names = random.choice(list(RANGES), size=2, replace=False)
        fields = {name: random.choice(RANGES[name], size=SOME) for name in names}
        wanted = first_refusal(model(level), fields)
        if wanted is None:
            assert len(Ensemble(scenario=model(level), fields=fields)) == SOME
            continue
        refused += 1
        with pytest.raises(ValueError, match=r"^member") as told:
            Ensemble(scenario=model(level), fields=fields)
        assert str(told.value) == wanted
    assert refused > 10


def killer(_: State) -> float:
    os._exit(1)


def of_list(_: float) -> Any:
    return dict[str, Any]()["slip"]


OF_LAW = r"^friction law 'tests.wayward_law:Answering': per_speed\(0.01\d*\) "
PLACE = r", in line \d+ of wayward_law.py$"
FAILING: dict[str, tuple[Callable[[float], Any], type[Exception]]] = {
    f"{OF_LAW}fails: KeyError: 'slip'{PLACE}": (of_list, KeyError),
    f"{OF_LAW}fails: ZeroDivisionError: .*{PLACE}": (lambda speed: speed / 0.0, LawError),
    f"{OF_LAW}must say finite numbers, got nan$": (lambda _: nan, LawError),
    f"{OF_LAW}must say finite numbers, got None$": (lambda _: None, LawError),
    f"{OF_LAW}must say finite numbers, got 1j$": (lambda _: 1j, LawError),
    rf"{OF_LAW}must say finite numbers, got array\(": (lambda _: np.ones(2), LawError),
    "^SystemExit: stuck$": (lambda _: sys.exit("stuck"), RuntimeError),
}


@pytest.mark.parametrize("method", ["DOP853", "Radau", "LSODA"])
@pytest.mark.parametrize("reason", FAILING)
def test_a_law_that_fails_on_the_way_ends_its_member_alone_and_is_blamed(
    reason: str, method: str
) -> None:
    fails, error = FAILING[reason]
    law = Answering(says=lambda v: fails(v) if 0.011 < v < 0.02 else 0.3 / (v + 0.1))
    how: dict[str, Any] = {"workers": 1, "method": method, "tolerance": 1e-7}
    good, failed = simulate_many([model(1), model(1, friction=law)], TIMES, **how)
    assert isinstance(good, Trajectory)
    assert type(failed) is error
    assert re.match(reason, cast("str", outcomes([failed]).columns["reason"][0]))
    one = Ensemble(scenario=model(1, friction=law), fields={"spin": np.array([40.0])})
    runs = simulate_many(one, TIMES, **how)
    assert type(runs.outcome(0)) is type(runs.failures[0]) is error


def lost_on_the_way(state: State) -> Any:
    return {True: 1.0}[state.coordinates[3] < 1.0]


@pytest.mark.parametrize(
    ("condition", "reason"),
    [
        (lost_on_the_way, "stop_when lost_on_the_way fails: KeyError: False for State"),
        (lambda _: 1j, "stop_when <lambda> must say a number of a State: it must be a finite"),
    ],
)
def test_a_condition_that_fails_is_blamed_for_it(condition: Any, reason: str) -> None:
    how: dict[str, Any] = {"workers": 1, "stop_when": condition}
    (row,) = outcomes(simulate_many([model(1)], TIMES, **how)).rows()
    assert str(row["reason"]).startswith(reason)
    # Any real number will do.
    how["stop_when"] = lambda _: np.float32(1.0)
    assert outcomes(simulate_many([model(1)], TIMES, **how)).columns["status"] == [DONE]


def test_what_lies_in_no_file_is_not_sent_to_workers() -> None:
    code = """
from analysis import Scenario, SmoothCoulomb, simulate_many
class Typed(SmoothCoulomb): pass
members = 2 * [Scenario(friction=Typed())]
for workers in 1, 2:
    print(len(simulate_many(members, [0.0, 0.1], workers=workers, method="RK45")))
"""
    done = python("-c", code, code=1)
    assert done.stdout == "2\n"
    assert "write it in a file of its own: what is typed in" in done.stderr.splitlines()[-1]


@pytest.mark.slow
def test_members_of_a_killed_process_say_so() -> None:
    outcomes = simulate_many([model(4)] * 3, SHORT, method="DOP853", stop_when=killer, workers=2)
    assert [type(outcome) for outcome in outcomes] == [BrokenProcessPool] * 3


ENDING: dict[str, np.ndarray[Any, Any]] = {
    "spin": np.array([36.0, 40.0, 44.0, 40.0, 0.0, 40.0]),
    "beta": np.append(np.full(4, 1.5), [1.0, 1.5]),
    "gamma": np.append(np.full(4, 0.1 - pi / 2), [pi / 2, 0.1]),
    "beta_rate": np.array([0.0, 0.0, 0.0, 30.0, 0.0, 0.0]),
    "eccentricity": np.array([2e-3, 2e-3, 0.0, 2e-3, 2e-3, 2e-3]),
}
"""Members that are inverted, are not, fall flat, and have no motion."""


def assert_alike(found: Row, expected: Row, relative: float) -> None:
    for name in set(found) | set(expected):
        cell, other = found.get(name), expected.get(name)
        if isinstance(other, float) and name != "seconds":
            # An error estimate is a difference of nearly the same numbers.
            tiny = 1e-10 if name == "error_estimate" else 1e-13
            assert cell == pytest.approx(other, rel=relative, abs=tiny), name
        elif name not in ("seconds", "number"):
            assert cell == other, name


@pytest.mark.parametrize("method", EITHER_METHOD)
def test_outcomes_of_arrays_are_those_of_single_motions(method: str) -> None:
    ensemble = Ensemble(scenario=model(4), fields=ENDING)
    how: dict[str, Any] = {"tolerance": 1e-6, "method": method, "workers": 1, **REDUCED}
    runs = simulate_many(ensemble, np.linspace(0.0, 2.0, 201), **how)
    table = outcomes(runs)
    assert list(table.columns) == ["number", *ensemble.fields, *OUTCOMES]
    assert list(COLUMNS)[: len(OUTCOMES)] == list(OUTCOMES)
    assert (table.units["start.spin"], table.units["force_least"]) == ("rad/s", "N")
    assert table.columns["start.spin"].tolist() == ENDING["spin"].tolist()
    assert set(table.columns["ending"]) == {None, "flat"}
    assert set(table.columns["status"]) == {DONE, "refused"}
    assert {"inverted", "not inverted"} <= set(table.columns["inversion"])
    assert np.all(table.columns["seconds"] > 0.0)
    motions = outcomes([runs.outcome(member) for member in range(len(runs))])
    for found, expected in zip(table.rows(), motions.rows(), strict=True):
        assert_alike({name: found[name] for name in OUTCOMES}, expected, 1e-11)


def test_row_of_a_motion_in_a_list_is_to_the_last_digit_what_it_is_alone() -> None:
    starts = [model(4, start=Start(spin=spin)) for spin in np.linspace(20.0, 60.0, 15)]
    motions = simulate_many(starts, np.linspace(0.0, 2.0, 201), local_tolerance=1e-6, workers=1)
    for number, row in enumerate(outcomes(motions).rows()):
        (alone,) = outcomes([motions[number]]).rows()
        assert row == alone | {"number": number}


@needs_heyoka
def test_rows_of_a_batch_are_those_of_its_cases() -> None:
    axes = ("spin=25,45", "mu=0.3,-0.1,0.6", "beta_rate=0,30")
    wanted = sweep(*axes, method="taylor", tolerance=1e-6, end=1.5, keep=("beta",))
    numbers = range(wanted.design.size)
    for number, row in zip(numbers, run_chunk(wanted, numbers), strict=True):
        (alone,) = run_chunk(wanted, [number])
        assert row["number"] == number
        kept, expected = (each.pop("series", {}) for each in (row, alone))
        assert kept.keys() == expected.keys()
        for name in kept:
            found, known = (np.frombuffer(each[name], NUMBERS) for each in (kept, expected))
            np.testing.assert_allclose(found, known, rtol=1e-9)
        assert_alike(row, alone, 1e-9)


def test_a_row_holds_what_the_motion_says_and_its_spin_a_second_after_the_inversion() -> None:
    motion = simulate(model(1), np.linspace(0.0, 2.0, 101), tolerance=1e-6)
    (row,) = outcomes([motion]).rows()
    assert row["error_estimate"] == motion.error_estimate
    forces = motion.normal_force
    assert (row["force_least"], row["force_largest"]) == (forces.min(), forces.max())
    assert row["spin_end"] == motion.rates[-1, 3]
    beta, gamma = motion.coordinates[-1, 4:]
    assert row["face_end"] == pytest.approx(np.cos(beta), abs=1e-12)
    assert row["cog_direction_end"] == pytest.approx(np.sin(beta) * np.sin(gamma), abs=1e-12)
    inversion = motion.inversion
    assert row["inverted_at"] == inversion.time
    assert row["inverted_at_error"] == inversion.time_error
    later, then = (motion.at(not_none(inversion.time) + after).rates[3] for after in (1.0, 0.0))
    assert abs(later - then) > 1.0
    assert row["spin_after"] == pytest.approx(later, abs=1e-4)


@pytest.mark.parametrize(
    ("held", "torque", "angle"),
    [(MODELS[4], "spin_torque", "alpha"), (TILTED[0], "tilt_torque", "beta")],
)
def test_sliding_took_what_a_held_rate_brought(
    held: ConstraintSet, torque: str, angle: str
) -> None:
    start = Start(beta_rate=0.5 if angle == "beta" else None)
    scenario = Scenario(constraints=held, start=start)
    motion = simulate(scenario, np.linspace(0.0, 0.2, 41), local_tolerance=1e-6)
    assert np.ptp(motion.rate(angle)) < 1e-9
    (row,) = outcomes([motion]).rows()
    brought = simpson(motion.multiplier(torque) * motion.rate(angle), x=motion.times)
    assert abs(brought) > 1e-5
    assert row[f"brought_by_{torque}"] == pytest.approx(brought)
    lost = cast("float", row["energy_start"]) - cast("float", row["energy_end"])
    assert row["taken_sliding"] == pytest.approx(lost + brought, rel=1e-12)


def test_work_that_the_samples_do_not_tell_is_left_empty() -> None:
    start = Start(spin=60.0, beta=1.3, gamma=-1.0)
    scenario = Scenario(constraints=("contact", "constant-spin"), start=start)
    counts = (2, 3, 11, 21, 51, 101, 201, 801)
    motions = [simulate(scenario, np.linspace(0.0, 1.0, count)) for count in counts]
    columns = outcomes(motions).columns
    known = np.isfinite(columns["taken_sliding"])
    assert known.tolist() == np.isfinite(columns["brought_by_spin_torque"]).tolist()
    assert known.tolist() == [False] * 6 + [True] * 2
    # By an integration along with the motion.
    np.testing.assert_allclose(columns["taken_sliding"][known], 0.178233, atol=5e-5)


def test_work_is_not_told_by_sums_that_agree_by_chance() -> None:
    start = Start(spin=33.912082862, beta=1.051168439, gamma=1.983315193, beta_rate=1.493749797)
    scenario = Scenario(constraints=TILTED[0], start=start)
    motions = [simulate(scenario, np.linspace(0.0, 0.4, count)) for count in (3, 5, 7, 1001)]
    taken = outcomes(motions).columns["taken_sliding"]
    assert np.isfinite(taken).tolist() == [False] * 3 + [True]
    # By power integrated along the motion, with other equations.
    assert taken[-1] == pytest.approx(0.00505043, abs=1e-8)


def test_budget_of_a_motion_to_rest_is_told_from_its_first_sample_to_its_last() -> None:
    whole = simulate_to_rest(Scenario.rest(), 0.05, spacing=0.01, local_tolerance=1e-9)
    motion = whole.resampled(whole.times[2:], tolerance=1.0)
    (row,) = outcomes([motion]).rows()
    totals = [row[name] for name in ("energy_start", "energy_end")]
    assert totals == motion.energies.sum(axis=1)[[0, -1]].tolist()
    taken = sum(cast("float", row[name]) for name in row if name.startswith("taken_"))
    assert taken == pytest.approx(np.ptp(motion.dissipated.sum(axis=1)))
    assert taken > 0.0


def test_errors_are_rows_that_say_why() -> None:
    errors = [ValueError("no\n such"), ArithmeticError(), TimeLimitError("late"), BrokenExecutor()]
    motion = simulate(model(1), np.linspace(0.0, 0.1, 3), local_tolerance=1e-6)
    table = outcomes([*errors, motion])
    assert table.columns["status"].tolist() == ["refused", "failed", "too slow", "crashed", DONE]
    assert table.columns["reason"][:2].tolist() == ["no such", "ArithmeticError"]
    assert np.isnan(table.columns["end"]).tolist() == [True] * 4 + [False]
    late = simulate_many(
        spins(30.0), SHORT, method="DOP853", time_limit=1e-9, local_tolerance=1e-6
    )
    assert outcomes(late).columns["status"].tolist() == ["too slow"]
