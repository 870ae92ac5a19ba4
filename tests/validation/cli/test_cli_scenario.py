"""A problem told by options, by a file, or by a stored run; its runs by `simulate` and `rest`."""

import re
import subprocess
import sys
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import (
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Start,
    State,
    Trajectory,
    load_run,
)
from analysis.problem.choices import SOURCES
from analysis.problem.scenario_file import scenario_text
from tests.calls import answer, printed, refusal, run
from tests.helpers import not_none
from tests.validation.cli.test_refusals import RING
from validation.studies import comparisons

PAPER = Scenario()
STATE = State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.1), rates=(0.0,) * 6)
SOFT = PenaltyContact(stiffness=1e5, damping=3.0, half_thickness=1e-4)
HEAVY = replace(PAPER.disk, mass=1.0)
FILES = {
    "soft": replace(PAPER, contact=SOFT),
    "state": replace(PAPER, start=STATE),
    "rolling": replace(PAPER, start=Start(gamma_rate=5.0)),
}

TOLD: dict[str, Scenario] = {
    "": PAPER,
    "--stiffness 1e5": replace(PAPER, contact=PenaltyContact.damped(1e5, PAPER.disk)),
    "--spin 35 --gamma -pi/2+0.2 --beta-rate -1e-3 --y-rate -.4": replace(
        PAPER, start=Start(spin=35.0, gamma=-pi / 2 + 0.2, beta_rate=-1e-3, y_rate=-0.4)
    ),
    # The damping of a file stays: it follows from the stiffness only where nobody tells it.
    "soft.toml --stiffness 1e6": replace(PAPER, contact=replace(SOFT, stiffness=1e6)),
    # The way to rest has defaults of its own.
    "--rest": Scenario.rest(),
    "--rest --stiffness 1e5 --mass 1": Scenario.rest(
        disk=HEAVY, contact=PenaltyContact.rounded(HEAVY, stiffness=1e5)
    ),
    "state.toml --rest": FILES["state"],
}


@pytest.fixture(autouse=True)
def _files(folder: Path) -> None:
    for name, scenario in FILES.items():
        (folder / f"{name}.toml").write_text(scenario_text(scenario))


@pytest.mark.parametrize("words", TOLD)
def test_options_change_what_they_name_and_nothing_else(words: str) -> None:
    assert printed("scenario", words) == scenario_text(TOLD[words])


@pytest.mark.skipif(not Path("/dev/stdin").exists(), reason="needs a file for standard input")
def test_a_scenario_comes_from_standard_input_as_well_and_where_output_goes_to_the_same() -> None:
    call = [sys.executable, "-m", "validation", "scenario", "-", "--spin", "35"]
    both, given = Path("terminal"), printed("scenario --mu 0.2")
    both.write_text(given)
    with both.open() as read, both.open("a") as written:
        subprocess.run(call, stdin=read, stdout=written, check=True)
    assert both.read_text() == given + printed("scenario --mu 0.2 --spin 35")


def test_no_option_is_blamed_for_what_a_file_tells() -> None:
    said = refusal("scenario rolling.toml --model 3")
    assert "error: gamma_rate must be 0 in Model 3" in said


@pytest.mark.parametrize("source", SOURCES)
def test_run_can_be_repeated_from_its_own_result(source: str) -> None:
    words = f"simulate --source {source} --end 0.05 --samples 6 --tolerance 1e-6"
    problem = f"{RING} --model 2 --law tanh --spin 30 --gamma -pi/2+0.3 --inclination 2deg"
    assert run(words, problem, "--out first.npz") == 0
    assert run(words, "--scenario first.npz --out again.npz") == 0
    first, again = (load_run(name, Trajectory) for name in ("first.npz", "again.npz"))
    assert again.source == first.source == source
    np.testing.assert_allclose(first.times, np.linspace(0.0, 0.05, 6))
    assert first.method["tolerance"] == 1e-6
    assert 0.0 < not_none(first.error_estimate) <= 1e-6
    assert scenario_text(again.scenario) == scenario_text(first.scenario)
    assert (first.coordinates == again.coordinates).all()
    assert printed("scenario", problem) == scenario_text(first.scenario)


VERDICTS = {
    "All 1 checks hold.": 1e-10,
    "1 checks FAIL.": 1e-3,
    "All 0 checks hold; 1 cannot be made.": None,
}


@pytest.mark.parametrize("verdict", VERDICTS)
def test_check_answers_by_its_exit_code(verdict: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def compared(scenario: Scenario, **how: float) -> list[comparisons.Comparison]:
        assert how == {"states": 10, "end": 2.0}
        assert scenario == replace(PAPER, friction=SmoothCoulomb(coefficient=0.2))
        about: Any = {"quantity": "accelerations", "formulation": "floating", "detail": ""}
        apart = VERDICTS[verdict]
        return [comparisons.Comparison(criterion=1e-8, difference=apart, **about)]

    monkeypatch.setattr(comparisons, "compare_scenario", compared)
    shown = answer("check --mu 0.2 --states 10 --plot check.svg")
    assert shown.code == ("FAIL" in verdict)
    # A row of the picture that has no mark says why.
    assert ("not defined" in Path("check.svg").read_text()) == (VERDICTS[verdict] is None)
    assert shown.out.endswith(f"{verdict}\n")


def test_pictures_tell_that_a_table_leans_which_they_draw_level_in_lines_that_fit() -> None:
    every = "contact,no-slip-along,no-slip-across,constant-spin,held-tilt-rate"
    told = "seen from a table leaning by 0.0873 rad"
    for which in ("", f"--constraints {every}"):
        printed(f"scene {which} --inclination 5deg --plot scene.svg")
        lines = re.findall("<!-- (.*) -->", Path("scene.svg").read_text(encoding="utf-8"))
        assert f"at its start, {told}" in " ".join(lines)
        assert max(map(len, lines)) <= 62
    printed("simulate --samples 6 --end 0.1 --inclination 5deg --out leaning.npz")
    printed("animate leaning.npz")
    assert told in Path("leaning.html").read_text(encoding="utf-8")


SIMULATE = "simulate --samples 6 --end 0.1 --tolerance 1e-6"
SHORT = "rest --source in-house --end 0.02"


def test_way_to_rest_is_stored_drawn_with_its_phases_and_told() -> None:
    call = "rest --source in-house --rolling-viscous 2e-3 --pivoting 2e-4 --end 1.6"
    shown = printed(call, "--out rest.npz --plot rest.svg")
    assert "<!-- inversion -->" in Path("rest.svg").read_text()
    motion = load_run("rest.npz", SpatialMotion)
    assert (motion.source, motion.times[-1]) == ("in-house", pytest.approx(1.6))
    assert re.search(r"^inverted_at +0\.4\d+ +s$", shown, re.MULTILINE)
    assert re.search(r"^taken_sliding +0\.0\d+ +J$", shown, re.MULTILINE)
    assert "not at rest after 1.6 s" in shown
    assert "not decided" not in shown


SAID = {
    f"{SIMULATE} --spin 20 --gamma pi/2": "exactly inverted spinning, which is unstable",
    f"{SIMULATE} --spin 20 --gamma pi/2 --json": "inverted spinning, which is unstable",
    f"{SIMULATE} --spin 20 --gamma 1.57": "6 samples of Model 1, estimated error ",
    "simulate --samples 6 --end 0.1 --step 5e-3": "6 samples of Model 1\n",
    "simulate --stop-when inverted": "the centre of gravity is up, at 90% of its",
    "simulate --stop-when inverted --stop-when lost": "the centre of gravity is up, at 90% of its",
    "rest --source in-house --end 0.8": "inversion not decided",
    "rest --step 1e-4 --end 50 --time-limit 0.4": " s: time limit",
    f"{SHORT} --gamma pi/2 --spin 20": "exactly inverted spinning, which is unstable",
    f"{SHORT} --gamma pi/2 --spin 20 --json": "inverted spinning, which is unstable",
    # What the disk has is not asked for.
    f"{SHORT} --rolling-viscous 5e-3": " rad; lying still needs --pivoting",
    f"{SHORT} --body sphere": " rad; lying still needs --pivoting",
    f"{SHORT} --inclination 5deg": " rad; downhill it creeps, since friction takes some slip",
}


@pytest.mark.parametrize("call", SAID)
def test_command_says_how_far_it_came_and_what_it_lacks(call: str) -> None:
    shown = printed(call)
    assert SAID[call] in shown
    assert ("unstable" in shown) == ("unstable" in SAID[call])
