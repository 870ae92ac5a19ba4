"""Maps: refinement, classes, critical speeds and the uncertainty exponent."""

import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from math import log
from pathlib import Path

import numpy as np
import pytest

from analysis import MODELS, Scenario
from analysis.data.checks import Array
from analysis.data.outcomes import Row
from analysis.stability.linear_reduced import critical_speed
from tests import helpers
from tests.calls import refusal, run
from tests.sweeps import direct
from validation.kit import shipped
from validation.kit.plain import unpack
from validation.maps import problems
from validation.maps import run as maps_run
from validation.maps.problems import (
    PROBLEMS,
    critical_points,
    face_class,
    inversion_class,
    models_beside,
    quickest_plan,
    sweep_of,
)
from validation.maps.refinement import expected_cases, refine
from validation.maps.run import panels, run_pairs, run_panel
from validation.maps.ship import CELLS, LEVELS, sweeps
from validation.maps.uncertainty import DISTANCES, shifted_sweeps, uncertainty
from validation.parser import commands as parser
from validation.sweeps.plan import Plan
from validation.sweeps.results import Results
from validation.sweeps.sweep import Sweep, look_ahead

REDUCED = Scenario(constraints=MODELS[4])


def not_none(
    inside: Callable[[int, int], bool], size: int
) -> tuple[Callable[[Iterable[int]], dict[int, str]], dict[int, str]]:
    """A run of a map that is known, and what it has run so far."""
    done: dict[int, str] = {}

    def run_cases(numbers: Iterable[int]) -> dict[int, str]:
        for number in numbers:
            assert number not in done
            done[number] = str(inside(*divmod(number, size)))
        return done

    return run_cases, done


def disc(row: int, column: int) -> bool:
    return (row - 30) ** 2 + (column - 26) ** 2 < 17**2


def test_refinement_runs_every_case_beside_a_boundary_and_few_others() -> None:
    size = 65
    run_cases, done = not_none(disc, size)
    refine((size, size), 3, run_cases)
    for row in range(size - 1):
        for column in range(size - 1):
            square = [(row + down, column + right) for down in (0, 1) for right in (0, 1)]
            if len({disc(*place) for place in square}) > 1:
                assert all(r * size + c in done for r, c in square)
    assert len(done) < size**2 / 4


def test_uniform_map_stays_coarse() -> None:
    run_cases, done = not_none(lambda *_: True, 17)
    refine((17, 17), 2, run_cases)
    assert len(done) == 25


@pytest.mark.parametrize(("shape", "levels"), [((16, 17), 2), ((4, 9), 3), ((9, 9), -1)])
def test_shape_that_cannot_be_halved_is_refused(shape: tuple[int, int], levels: int) -> None:
    with pytest.raises(ValueError, match="shape must be cells"):
        refine(shape, levels, lambda _: {})


def test_choices_of_the_command_are_the_maps() -> None:
    assert tuple(PROBLEMS) == parser.MAPS


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        ({"status": "done", "inversion": "inverted"}, "inverted"),
        ({"status": "done", "inversion": "not inverted", "ending": None}, "not inverted"),
        ({"status": "done", "inversion": "not inverted", "ending": "flat"}, "flat"),
        (
            {"status": "done", "inversion": "not inverted", "ending": "contact would pull"},
            "pulls",
        ),
        ({"status": "crashed"}, "failed"),
        ({"status": "refused"}, "refused"),
    ],
)
def test_outcomes_are_told_apart(row: Row, expected: str) -> None:
    assert inversion_class(Scenario(), row) == expected


def test_face_is_decided_once_the_energy_cannot_lift_the_disk_on_its_rim() -> None:
    scenario = Scenario()
    disk = scenario.disk
    # Upright with the centre of gravity low, the least energy in which both faces meet.
    barrier = disk.mass * 9.81 * (disk.radius - disk.eccentricity)

    def face(energy: float, up: float) -> str:
        row: Row = {"status": "done", "ending": None}
        return face_class(scenario, row | {"energy_end": energy, "face_end": up})

    assert face(1.001 * barrier, 0.9) == "not decided"
    assert face(0.999 * barrier, 0.9) == "upper face"
    assert face(0.999 * barrier, -0.9) == "lower face"


def test_critical_speed_of_the_reduced_system_is_drawn_at_every_friction(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(problems, "THEORY_SAMPLES", 3)
    points = critical_points(PROBLEMS["spin-friction"], REDUCED)
    np.testing.assert_allclose(points[:, 0], critical_speed(REDUCED).spin, rtol=1e-9)
    assert points[0, 1] == 0.02
    assert points[-1, 1] == 0.6
    assert critical_points(PROBLEMS["attitude"], REDUCED).size == 0


def test_each_model_runs_where_it_is_quickest() -> None:
    plans = [quickest_plan(each, 4.0, 0) for each in models_beside(Scenario())]
    assert [plan.source for plan in plans] == ["engine", *["in-house"] * 3]
    assert [plan.formulation for plan in plans] == [None, None, None, "reduced"]
    compiled = [quickest_plan(each, 4.0, 0, compiled=True) for each in models_beside(Scenario())]
    assert all(plan.runs_in_batches for plan in compiled)
    assert [plan.witness_step for plan in compiled] == [problems.ENGINE_STEP, None, None, None]


def test_gaps_take_the_class_of_the_nearest_run(tmp_path: Path) -> None:
    problem = PROBLEMS["spin-friction"]
    sweep = sweep_of(problem, REDUCED, count=5, plan=Plan(end=0.05, formulation="reduced"))
    panel = run_panel(problem, sweep, tmp_path / "a.db", levels=2, pool=direct())
    assert sorted(panel.classes) == [0, 4, 20, 24]
    made = replace(panel, classes={0: "a", 4: "b", 20: "a", 24: "a"})
    assert made.filled[1].tolist() == ["a", "a", made.filled[1][2], "b", "b"]
    assert set(made.filled[4]) == {"a"}


def test_store_of_a_map_is_refined_where_classes_differ(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = PROBLEMS["spin-friction"]
    (sweep,) = panels(problem, REDUCED, cells=2, levels=1, end=0.05, witnesses=0)
    monkeypatch.setattr(
        maps_run,
        "classify",
        lambda _: lambda _, row: str(float(row["start.spin"]) > 45.0),
    )
    path = tmp_path / "a.db"
    panel = run_panel(problem, sweep, path, levels=1, pool=direct())
    spins = panel.values()[1][panel.places(list(panel.classes))[:, 1]]
    # Left of 40 rad/s the coarse grid alone, on the right every value.
    assert sorted(set(spins)) == [20.0, 40.0, 50.0, 60.0]
    again = run_panel(problem, sweep, path, levels=1, pool=direct())
    assert again.classes == panel.classes
    assert Results.load(path).columns["number"].size == 3 + 3 * 5


def test_uncertainty_exponent_of_a_smooth_boundary_is_1() -> None:
    starts = np.random.default_rng(1).random(20_000)
    distances = np.array(DISTANCES)
    differs = np.array([(starts < 0.5) != (starts + each < 0.5) for each in distances])
    found = uncertainty(distances, differs)
    assert found is not None
    assert abs(found.exponent - 1.0) < 3.0 * found.error
    assert found.error < 0.1


def test_uncertainty_exponent_of_a_cantor_set_is_1_less_its_dimension() -> None:
    def measure(x: Array) -> Array:
        """Cantor's function, which rises on the set alone."""
        x, value, weight = np.clip(x, 0.0, 1.0 - 1e-12), np.zeros_like(x), 0.5
        stopped = np.zeros(x.shape, dtype=bool)
        for _ in range(40):
            digit = np.floor(3.0 * x)
            value += np.where(stopped, 0.0, weight * (digit > 0.0))
            stopped |= digit == 1.0
            x, weight = 3.0 * x - digit, weight / 2.0
        return value

    starts = np.random.default_rng(2).random(20_000)
    distances = 3.0 ** -np.arange(4.0, 9.0)
    differs = np.array([measure(starts + each) > measure(starts) for each in distances])
    found = uncertainty(distances, differs)
    assert found is not None
    assert found.exponent == pytest.approx(1.0 - log(2.0) / log(3.0), abs=0.03)


def test_map_without_boundaries_has_no_exponent() -> None:
    assert uncertainty(np.array(DISTANCES), np.zeros((4, 10), dtype=bool)) is None


def test_pairs_are_the_same_starts_shifted() -> None:
    problem = PROBLEMS["rest"]
    first, *others = shifted_sweeps(problem, Scenario(), number=20, end=1.0)
    base = np.array([first.design.case(index) for index in range(20)])
    for distance, other in zip(DISTANCES, others, strict=True):
        moved = np.array([other.design.case(index) for index in range(20)])
        np.testing.assert_allclose(moved - base, [[12.0 * distance, 0.0]] * 20, atol=1e-12)
    assert shifted_sweeps(problem, Scenario(), number=0, end=1.0) == []


def test_pairs_that_are_not_decided_do_not_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = PROBLEMS["spin-friction"]
    pairs = shifted_sweeps(problem, REDUCED, number=8, end=0.01)

    def judge(_: Scenario, row: dict[str, float]) -> str:
        return "not decided" if row["number"] < 4 else str(int(row["start.spin"]))

    monkeypatch.setattr(maps_run, "classify", lambda _: judge)
    found = run_pairs(problem, pairs, tmp_path, pool=direct())
    assert found is not None
    # Four pairs are left, all of which the longest shift takes over a whole number.
    assert found.parts[0] == 1.0
    assert set(4 * found.parts) <= {0.0, 1.0, 2.0, 3.0, 4.0}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("spin-friction --cells 0", "cells must lie from 1 to 10000, got 0"),
        ("spin-friction --levels -1", "levels must lie from 0 to 12, got -1"),
        ("rest --pairs -1", "--pairs: pairs must be a number of starts, got -1"),
        ("spin-mu", "invalid choice"),
        ("rest --end -1", "--end: end must be positive"),
    ],
)
def test_wrong_call_is_told_in_one_line(
    words: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refusal(capsys, "map", words, f"--out={tmp_path / 'maps'}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "stores", "seen"),
    [("spin-friction", 1, 2), ("basins", 4, 0), ("rest", 1, 0)],
)
def test_map_is_drawn_and_told(
    name: str, stores: int, seen: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    call = f"map {name} --out {tmp_path} --cells 1 --levels 1 --end 1.2 --witnesses {seen}"
    assert run(*call.split()) == 0
    said, beside = capsys.readouterr()
    assert re.match(rf"tippedisk map: some {9 * stores} cases, roughly \S+ \w+ on ", beside)
    assert said.count("runs in place of 9") == stores
    assert ("  other side: " in said) == (seen > 0)
    assert f"{tmp_path / name}.png" in said
    assert (tmp_path / f"{name}.svg").stat().st_size > 5000
    assert len(list(tmp_path.glob("*.db"))) == stores


def test_cases_of_a_map_and_their_time_are_told_ahead_to_within_a_factor_of_four() -> None:
    parts = helpers.not_none(shipped.of("maps")).parts.values()
    made = [(unpack(result), seconds) for result, seconds in parts]
    for name, levels in LEVELS.items():
        shown = [(panel, seconds) for (where, panel), seconds in made if where == name]
        for sweep, (panel, seconds) in zip(sweeps(name), shown, strict=True):
            told = expected_cases(CELLS, levels)
            assert 0.25 < told / len(panel.classes) < 4.0
            assert 0.25 < told * look_ahead(sweep).seconds / helpers.not_none(seconds) < 4.0


def test_plan_of_a_map_is_kept_with_its_store() -> None:
    (sweep,) = panels(PROBLEMS["tilting"], Scenario(), cells=2, levels=1, end=1.0, witnesses=9)
    assert sweep.plan.witnesses == 25
    assert Sweep.from_values(sweep.to_values()) == sweep
