"""Maps: refinement, outcomes, critical speeds, panels and the uncertainty exponent."""

import json
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from math import log
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import MODELS, STEEL_DISK, Body, Scenario, SmoothCoulomb
from analysis.mechanics.paper import critical_speed
from analysis.motion.files import AnyArray
from analysis.problem.checks import Array
from tests.bodies import ELLIPSE
from tests.calls import answer, printed
from tests.helpers import not_none
from tests.sweeps import direct, sweep
from validation.maps import figures, problems
from validation.maps import panel as room
from validation.maps.panel import cell, expected_cases, refine, run_panel
from validation.maps.problems import (
    DISTANCES,
    PROBLEMS,
    critical_points,
    panels,
    shifted_sweeps,
    uncertainty,
)
from validation.sweeps.results import Results
from validation.sweeps.sweep import Sweep

REDUCED = Scenario(constraints=MODELS[4])
SIZE = 65


def grid(name: str = "spin-friction", scenario: Scenario = REDUCED, **more: Any) -> Sweep:
    """The first panel of a small map."""
    how = {"cells": 2, "levels": 0, "end": 0.05, "witnesses": 0} | more
    return panels(PROBLEMS[name], scenario, **how)[0]


def refined(levels: int, inside: Callable[[int, int], bool]) -> set[int]:
    """Numbers of the cases that are run of a map that is known."""
    done: list[dict[str, Any]] = []

    def run_cases(numbers: Iterable[int]) -> list[dict[str, Any]]:
        done.extend({"number": n, "outcome": str(inside(*divmod(n, SIZE)))} for n in numbers)
        return done

    numbers = {each["number"] for each in refine((SIZE, SIZE), levels, run_cases)}
    assert len(numbers) == len(done)
    return numbers


def test_refinement_runs_every_case_beside_a_boundary_and_few_others() -> None:
    def disc(row: int, column: int) -> bool:
        return (row - 30) ** 2 + (column - 26) ** 2 < 17**2

    done = refined(3, disc)
    for row, column in np.ndindex(SIZE - 1, SIZE - 1):
        square = [(row + down, column + right) for down in (0, 1) for right in (0, 1)]
        if len({disc(*place) for place in square}) > 1:
            assert all(r * SIZE + c in done for r, c in square)
    assert len(done) < SIZE**2 / 4
    # Roughly as many are announced.
    assert 0.5 < expected_cases((SIZE - 1) >> 3, 3) / len(done) < 2.0
    assert len(refined(4, lambda *_: True)) == 25


DONE: dict[str, Any] = {"number": 0, "status": "done", "ending": None, "seconds": 0.1}
INVERSIONS: list[tuple[dict[str, Any], str]] = [
    ({"inversion": "inverted", "inverted_at": 0.5}, "inverted"),
    ({"inversion": "not inverted"}, "not inverted"),
    ({"inversion": "not inverted", "ending": "flat"}, "flat"),
    ({"inversion": "not inverted", "ending": "contact would pull"}, "pulls"),
    ({"status": "crashed"}, "failed"),
    ({"status": "refused"}, "refused"),
]


@pytest.mark.parametrize(("row", "expected"), INVERSIONS)
def test_outcomes_are_told_apart(row: dict[str, Any], expected: str) -> None:
    assert cell(grid(), DONE | row, by_face=False)["outcome"] == expected


FLAT = replace(ELLIPSE, eccentricity=0.0)
# Where both faces meet with the least energy, the centre of gravity is low or the side flattest.
LEAST = {STEEL_DISK: STEEL_DISK.radius - STEEL_DISK.eccentricity, FLAT: FLAT.other_radius}


@pytest.mark.parametrize("disk", LEAST, ids=["round", "elliptic"])
@pytest.mark.parametrize("to_rest", [False, True])
def test_face_is_up_once_the_disk_cannot_stand_on_its_rim_in_its_own_case(
    disk: Body, *, to_rest: bool
) -> None:
    scenario = Scenario.rest(disk=disk) if to_rest else Scenario(disk=disk)
    wanted = sweep("gravity=1.62,9.81", scenario=scenario, to_rest=to_rest, spacing=1e-2)
    for number, gravity in enumerate((1.62, 9.81)):
        for part, face, ending, expected in (
            (1.0 + 1e-6, 0.9, None, "not decided"),
            (1.0 + 1e-6, 0.9, "flat", "upper face"),
            (1.0 - 1e-6, 0.9, None, "upper face"),
            (1.0 - 1e-6, -0.9, None, "lower face"),
        ):
            # On the rim its contact gives way under the weight.
            weight = gravity * disk.mass
            given_way = 0.5 * weight**2 / scenario.penalty_contact.stiffness if to_rest else 0.0
            energy = part * (weight * LEAST[disk] - given_way)
            row = DONE | {"number": number, "energy_end": energy, "face_end": face}
            row["ending"] = ending
            assert cell(wanted, row, by_face=True)["outcome"] == expected


def test_run_that_the_other_side_cannot_make_counts_as_unlike() -> None:
    row = DONE | {"inversion": "inverted", "inverted_at": 0.5}
    told = [(None, False, False), ("inverted", True, True), ("failed", True, False)]
    for other, seen, alike in told:
        found = cell(grid(), row | {"other_inversion": other}, by_face=False)
        assert (found["seen"], found["alike"]) == (seen, alike)
    pulls = DONE | dict.fromkeys(("inversion", "other_inversion"), "not inverted")
    for other in ("contact would pull", None):
        row = pulls | {"ending": "contact would pull", "other_ending": other}
        assert cell(grid(), row, by_face=False)["alike"] == (other is not None)
    # To rest, the face that is up in the end is compared.
    row |= {"other_inversion": "failed", "face_end": 0.9, "energy_end": 0.0}
    for face in (0.8, -0.8, None):
        found = cell(grid("rest", Scenario.rest()), row | {"other_face_end": face}, by_face=True)
        assert found["alike"] == (face == 0.8)


def test_critical_speed_of_the_reduced_system_is_drawn_at_every_friction(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(problems, "THEORY_SAMPLES", 3)
    points, static = critical_points(grid()).values()
    assert not static.size
    np.testing.assert_allclose(points[:, 0], critical_speed(REDUCED).spin, rtol=1e-9)
    assert points[[0, -1], 1].tolist() == [0.02, 0.6]
    for none in (grid("attitude"), grid("rest"), grid(scenario=Scenario(disk=ELLIPSE))):
        assert not any(each.size for each in critical_points(none).values())


def test_each_model_and_body_runs_where_it_can_be_built_and_is_quickest() -> None:
    assert grid(scenario=Scenario(disk=ELLIPSE)).plan.source == "in-house"
    assert grid("rest", Scenario.rest()).plan.to_rest
    how: Any = {"cells": 2, "levels": 1, "witnesses": 9, "end": 4.0, "time_limit": 7.0}
    plans = [each.plan for each in panels(PROBLEMS["basins"], Scenario(), **how)]
    assert [plan.source for plan in plans] == ["engine", *["in-house"] * 3]
    assert [plan.formulation for plan in plans] == ["contact-tree", None, None, "reduced"]
    loaded = grid(scenario=Scenario(friction=SmoothCoulomb(load="contact")))
    assert loaded.plan.source == "in-house"
    assert {(plan.witnesses, plan.time_limit) for plan in plans} == {(25, 7.0)}
    compiled = panels(PROBLEMS["basins"], Scenario(), compiled=True, **how)
    assert all(each.plan.runs_in_batches for each in compiled)


@pytest.mark.parametrize("name", ["attitude", "tilting", "rest"])
def test_maps_of_the_tilt_are_even_about_upright(name: str) -> None:
    sweep = grid(name)
    low, high = (
        sweep.scenario_of(number).initial_state.coordinates[4]
        for number in (0, sweep.design.size - 1)
    )
    assert 0.5 < low < high == pytest.approx(np.pi - low)


def test_gaps_take_the_outcome_of_the_nearest_run() -> None:
    sweep = grid(cells=1, levels=2)
    cells = pd.DataFrame({"number": [0, 4, 20, 24], "outcome": ["a", "b", "a", "a"]})
    filled = room.Panel(sweep=sweep, cells=cells).outcomes
    assert filled[1].tolist() == ["a", "a", filled[1][2], "b", "b"]
    assert set(filled[4]) == {"a"}


@pytest.mark.parametrize("inverted", [(), (4,), (3, 4), (0, 4, 8), (0, 1, 4)])
def test_map_is_drawn_wherever_its_inversions_lie(inverted: tuple[int, ...]) -> None:
    how = {"outcome": "flat", "time": np.nan, "seen": False, "alike": False}
    cells = pd.DataFrame([{"number": number, **how} for number in range(9)])
    cells.loc[[*inverted], ["outcome", "time"]] = ["inverted", 0.5]
    (axes, *_) = figures.draw({"": room.Panel(sweep=grid("attitude"), cells=cells)}).axes
    _, times = axes.collections
    assert np.ma.count(not_none(times.get_array())) == len(inverted)


def test_colours_tell_of_no_time_before_the_start() -> None:
    how = {"outcome": "inverted", "time": 0.0, "seen": False, "alike": False}
    cells = pd.DataFrame([{"number": number, **how} for number in range(9)])
    drawn = figures.draw({"": room.Panel(sweep=grid("attitude"), cells=cells)})
    (scale,) = (axes for axes in drawn.axes if axes.get_ylabel() == "time to inversion in s")
    low, high = scale.get_ylim()
    assert low == 0.0 < high


def test_store_of_a_map_is_refined_where_outcomes_differ_and_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sweep, path = grid(levels=1), Path("a.db")
    monkeypatch.setattr(
        room, "became", lambda _, row, **__: str(row.get("start.spin", 0.0) > 45.0)
    )
    panel = run_panel(sweep, path, direct(), by_face=False, levels=1)
    spins = panel.values[1][panel.places(panel.cells)[:, 1]]
    # Left of 40 rad/s the coarse grid alone, on the right every value.
    assert sorted(set(spins)) == [20.0, 40.0, 50.0, 60.0]
    again = run_panel(sweep, path, direct(), by_face=False, levels=1)
    pd.testing.assert_frame_equal(again.cells, panel.cells)
    assert Results.load(path).columns["number"].size == 3 + 3 * 5


def test_uncertainty_exponent_of_a_cantor_set_is_1_less_its_dimension() -> None:
    def gap(x: AnyArray) -> AnyArray:
        """Which gap of the set numbers of 20 digits lie in: digits to base 3 up to the first 1."""
        first = np.argmax(x[:, None] // 3 ** np.arange(20)[::-1] % 3 == 1, axis=1)
        return (3**20 + x) // 3 ** (19 - first)

    starts = np.random.default_rng(2).integers(3**20, size=20_000)
    shifts = 3 ** np.arange(16, 11, -1)
    outcomes = [gap(np.minimum(starts + each, 3**20 - 1)) for each in (0, *shifts)]
    found = not_none(uncertainty(np.array(outcomes).astype(str), (shifts / 3**20).tolist()))
    assert abs(found.exponent - (1.0 - log(2.0) / log(3.0))) < 3.0 * found.error < 0.03


def test_pairs_are_the_same_starts_shifted() -> None:
    first, *others = shifted_sweeps(
        PROBLEMS["rest"], Scenario(), number=20, end=1.0, time_limit=7.0
    )
    assert first.plan.time_limit == 7.0

    def starts(sweep: Sweep) -> Array:
        return np.array([[*sweep.design.values_of(index).values()] for index in range(20)])

    for distance, other in zip(DISTANCES, others, strict=True):
        moved = starts(other) - starts(first)
        np.testing.assert_allclose(moved, [[12.0 * distance, 0.0]] * 20, atol=1e-12)


def test_exponent_is_that_of_starts_that_are_decided() -> None:
    # Two more of the starts are not.
    rows = [list("aaaaaaaaab"), list("aaaabbbbbb"), list("aaaaaabbbb")]
    rows[0][-2], rows[2][-1] = "failed", "not decided"
    found = not_none(uncertainty(rows, (0.2, 0.1)))
    assert found.parts.tolist() == [0.5, 0.25]
    assert found.exponent == pytest.approx(1.0)
    assert uncertainty(rows[:2], (0.2,)) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "panels", "pairs", "seen"),
    [("spin-friction", 1, 3, 2), ("basins", 4, 0, 0), ("rest", 1, 0, 0)],
)
def test_map_is_drawn_and_told(name: str, panels: int, *, pairs: int, seen: int) -> None:
    call = f"map {name} --out . --cells 1 --levels 1 --end 1.2 --csv map.csv"
    code, said, beside = answer(call, f"--witnesses {seen} --pairs {pairs}")
    assert code == 0
    starts = 1 + len(DISTANCES) if pairs else 0
    cases = 9 * panels + pairs * starts
    assert re.match(rf"tippedisk map: some {cases} cases, roughly \S+ \w+ on ", beside)
    rows = pd.read_csv("map.csv")
    assert rows["in place of"].tolist() == [9] * panels
    assert rows["seen by the other side"].between(seen, 2 * seen).all()
    assert rows["of them alike"].tolist() == rows["seen by the other side"].tolist()
    assert f"{name}.png" in said
    assert Path(f"{name}.svg").stat().st_size > 5000
    stores = {f"{name}-{index}.db" for index in range(1, 1 + panels + starts)}
    written = {f"{name}.png", f"{name}.svg", "map.csv"}
    assert {path.name for path in Path().iterdir()} == stores | written


@pytest.mark.slow
def test_an_exponent_or_that_pairs_tell_none_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    call = "map rest --out . --cells 1 --levels 0 --end 0.1 --witnesses 0 --pairs 1"
    assert "no uncertainty exponent: pairs of starts end" in printed(call)
    parts = np.array((0.04, 0.4, 0.5, 0.6))
    found = SimpleNamespace(exponent=0.5, error=0.1, parts=parts)
    monkeypatch.setattr("validation.commands.maps.uncertainty", lambda _: found)
    said = " ".join(printed(call).split())
    assert re.search(r"exponent 0\.50 ± 0\.10: .* apart, 4 %, 40 %, 50 %, 60 % end", said)
    (told,) = json.loads(printed(call, "--json"))
    assert (told["uncertainty exponent"], told["standard deviation"]) == (0.5, 0.1)
    assert [told[name] for name in told if name.startswith("part at")] == parts.tolist()
    # Nothing is printed that is written.
    assert printed(call, "--csv map.csv") == "rest.png\n"
    assert pd.read_csv("map.csv")["uncertainty exponent"].tolist() == [0.5]


def test_cells_that_failed_are_told_of_and_run_again_where_asked() -> None:
    sweep = grid(levels=1)
    sweep = replace(sweep, plan=replace(sweep.plan, witnesses=9))
    slow = replace(sweep, plan=replace(sweep.plan, time_limit=1e-9))
    first, same, again = (
        run_panel(each, Path("a.db"), direct(), by_face=False, levels=1, retry=retry)
        for each, retry in ((slow, False), (sweep, False), (sweep, True))
    )
    assert set(first.cells["outcome"]) == {"failed"}
    pd.testing.assert_frame_equal(same.cells, first.cells)
    assert first.failures == same.failures == {"too slow": len(first.cells)}
    assert not again.failures
    assert not set(again.cells["outcome"]) & {"failed"}
