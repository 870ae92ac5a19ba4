"""A problem told by options, by a file, or by a stored run."""

from collections.abc import Callable
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import pytest

from analysis import (
    ROUNDED_STEEL_DISK,
    Disk,
    Dissipation,
    PenaltyContact,
    Scenario,
    SpatialMotion,
    Start,
    State,
    Table,
    TanhCoulomb,
    Trajectory,
    ViscousFriction,
    load_run,
)
from analysis.data.scenario_file import load_scenario
from analysis.data.scenario_text import scenario_text
from tests.calls import printed, refusal
from tests.scenario_texts import with_key
from tests.validation.cli.test_refusals import RING
from validation import cli
from validation.commands.scenarios import chosen_scenario
from validation.parser.top import parsed
from validation.studies import crosscheck

ROOT = Path(__file__).parents[3]
PAPER = Scenario()
STATE = State(coordinates=(0.0, 0.0, 0.045, 0.0, 1.5, 0.1), rates=(0.0,) * 6)
SOFT = PenaltyContact(stiffness=1e5, damping=3.0, half_thickness=1e-4)
TANH = TanhCoulomb(coefficient=0.7, load="contact")
COMPLIANT = Scenario(
    contact=SOFT,
    dissipation=Dissipation(pivoting=1e-5),
    friction=TANH,
    table=Table(inclination=0.1),
)


def chosen(words: str, *, rest: bool = False) -> Scenario:
    """Scenario of a command line."""
    return chosen_scenario(parsed(["scenario", *words.split()]), rest=rest)


@pytest.fixture
def file(tmp_path: Path) -> Callable[[Scenario], str]:
    """Write the file of a scenario."""

    def write(scenario: Scenario) -> str:
        path = tmp_path / "my.toml"
        path.write_text(scenario_text(scenario))
        return str(path)

    return write


OPTIONS: list[tuple[str, Scenario]] = [
    ("", PAPER),
    (
        "--constraints no-slip-along,contact",
        replace(PAPER, constraints=("contact", "no-slip-along")),
    ),
    (
        "--disk steel-rounded --mass 0.5 --inertia-z 4.7e-4",
        replace(PAPER, disk=replace(ROUNDED_STEEL_DISK, mass=0.5, inertia_z=4.7e-4)),
    ),
    ("--hole-distance 0.01", replace(PAPER, disk=Disk.ring(hole_distance=0.01))),
    ("--law tanh --mu 0.2", replace(PAPER, friction=TanhCoulomb(coefficient=0.2))),
    ("--stiffness 1e5", replace(PAPER, contact=PenaltyContact.damped(1e5, PAPER.disk))),
    (
        "--spin 35 --gamma -pi/2+0.2 --beta-rate -1e-3 --y-rate -.4",
        replace(PAPER, start=Start(spin=35.0, gamma=-pi / 2 + 0.2, beta_rate=-1e-3, y_rate=-0.4)),
    ),
]


@pytest.mark.parametrize(("words", "expected"), OPTIONS, ids=[words for words, _ in OPTIONS])
def test_options_change_what_they_name_and_nothing_else(
    words: str, expected: Scenario, capsys: pytest.CaptureFixture[str]
) -> None:
    assert printed(capsys, "scenario", *words.split()) == scenario_text(expected)


def test_options_override_the_file_and_the_rest_stays(file: Callable[[Scenario], str]) -> None:
    path = file(COMPLIANT)
    assert chosen(path) == COMPLIANT
    assert chosen(f"{path} --mu 0.1").friction == replace(TANH, coefficient=0.1)
    assert chosen(f"{path} --law viscous").friction.load == "contact"
    # The damping of a file stays, too: it follows from the stiffness only where nobody tells it.
    assert chosen(f"{path} --stiffness 1e6") == replace(
        COMPLIANT, contact=replace(SOFT, stiffness=1e6)
    )
    assert chosen(f"{path} --spin 30 --downhill 1").start == Start(spin=30.0)
    assert chosen(f"{path} --mass 0.5").contact == COMPLIANT.contact


def test_way_to_rest_has_its_own_defaults(
    file: Callable[[Scenario], str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert chosen("", rest=True) == Scenario.rest()
    heavy = replace(PAPER.disk, mass=1.0)
    assert chosen("--mass 1", rest=True) == Scenario.rest(disk=heavy)
    assert chosen("--stiffness 1e5", rest=True).contact == PenaltyContact.rounded(
        PAPER.disk, stiffness=1e5
    )
    assert chosen(f"{file(PAPER)}", rest=True) == PAPER
    assert printed(capsys, "scenario", "--rest") == scenario_text(Scenario.rest())


def test_a_law_named_again_keeps_its_parameters(file: Callable[[Scenario], str]) -> None:
    own = file(Scenario(friction=TANH))
    assert chosen(f"{own} --law tanh").friction == TANH
    assert chosen(f"{own} --law tanh,smoothing=0.2").friction == replace(TANH, smoothing=0.2)
    assert chosen(f"{own} --law viscous").friction == ViscousFriction(load=TANH.load)


def test_start_told_by_coordinates_takes_no_options(
    file: Callable[[Scenario], str], capsys: pytest.CaptureFixture[str]
) -> None:
    path = file(replace(PAPER, start=STATE))
    assert cli.main(["scenario", path, "--mu", "0.1"]) == 0
    assert "coordinates = [0.0, 0.0, 0.045, 0.0, 1.5, 0.1]" in capsys.readouterr().out
    said = refusal(capsys, "scenario", path, "--spin 30")
    assert "--spin: spin cannot change: the start is told by its coord" in said


def test_option_that_was_not_given_is_not_blamed(
    file: Callable[[Scenario], str], capsys: pytest.CaptureFixture[str]
) -> None:
    path = file(replace(PAPER, start=Start(gamma_rate=5.0)))
    said = refusal(capsys, "scenario", path, "--model 3")
    assert "error: gamma_rate must be -2.44929e-15 in Model 3" in said


COMMANDS = [
    "simulate --end 0.01 --samples 3 --out {out}",
    "simulate --end 0.01 --samples 3 --source in-house --out {out}",
    "rest --end 0.01",
    "eigenvalues --spin 30",
    "critical --spin 20:40",
    "scene",
    "check",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_that_runs_a_problem_says_what_is_wrong_with_its_file(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = with_key(scenario_text(PAPER), "table", "gravity", "0")
    path = tmp_path / "my.toml"
    path.write_text(text)
    line = text.split("\n").index("gravity = 0") + 1
    said = refusal(capsys, command.format(out=tmp_path / "run.npz"), f"--scenario={path}")
    assert said.endswith(f": error: {path}, line {line}: gravity must be positive, got 0\n")
    assert [entry.name for entry in tmp_path.iterdir()] == ["my.toml"]


@pytest.mark.parametrize("source", ["engine", "in-house"])
def test_run_can_be_repeated_from_its_own_result(source: str, tmp_path: Path) -> None:
    words = f"simulate --source {source} --end 0.05 --samples 6 --tolerance 1e-6"
    problem = f"{RING} --model 2 --law tanh --spin 30 --gamma -pi/2+0.3 --inclination 2deg"
    first, again = tmp_path / "first.npz", tmp_path / "again.npz"
    assert cli.main([*words.split(), *problem.split(), f"--out={first}"]) == 0
    assert cli.main([*words.split(), f"--scenario={first}", f"--out={again}"]) == 0
    runs = [load_run(path, Trajectory) for path in (first, again)]
    assert runs[0].scenario == runs[1].scenario == chosen(problem)
    assert (runs[0].coordinates == runs[1].coordinates).all()


def test_scenario_of_a_stored_run_of_either_kind_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trajectory, motion = tmp_path / "run.npz", tmp_path / "rest.npz"
    cli.main(["simulate", "--mu=0.2", "--end=0.01", "--samples=3", f"--out={trajectory}"])
    rest = ["rest", "--source=in-house", "--pivoting=1e-4", "--height=0.001", "--end=0.01"]
    cli.main([*rest, f"--out={motion}"])
    for path, kind in ((trajectory, Trajectory), (motion, SpatialMotion)):
        capsys.readouterr()
        assert cli.main(["scenario", str(path)]) == 0
        again = tmp_path / "my.toml"
        again.write_text(capsys.readouterr().out)
        assert load_scenario(again) == load_run(path, kind).scenario
    assert load_run(motion, SpatialMotion).scenario.start == Start(height=0.001)


@pytest.mark.parametrize("source", ["engine", "in-house"])
def test_way_to_rest_on_an_ideal_contact_is_refused_with_the_way_out(
    source: str, file: Callable[[Scenario], str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["rest", "--source", source, "--scenario", file(PAPER)]) == 2
    assert "give --stiffness and --half-thickness, or the table [co" in capsys.readouterr().err


def test_scene_lists_a_scenario_of_ones_own(
    file: Callable[[Scenario], str], capsys: pytest.CaptureFixture[str]
) -> None:
    path = file(replace(PAPER, constraints=("contact", "no-slip-along")))
    assert cli.main(["scene", "--scenario", path, "--formulation", "floating"]) == 0
    assert capsys.readouterr().out.startswith("contact + no-slip-along, formulation floating\n")


@pytest.mark.parametrize(
    ("differences", "code", "verdict"),
    [([1e-9, 1e-10], 0, "All 2 checks hold."), ([1e-9, 1e-3], 1, "1 checks FAIL.")],
)
def test_check_answers_by_its_exit_code(
    differences: list[float],
    code: int,
    verdict: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked: list[Scenario] = []

    def answer(scenario: Scenario, **how: float) -> list[crosscheck.Check]:
        assert how == {"states": 10, "end": 2.0}
        asked.append(scenario)
        about: Any = {"quantity": "accelerations", "formulation": "floating", "detail": "relative"}
        return [crosscheck.Check(criterion=1e-8, difference=each, **about) for each in differences]

    monkeypatch.setattr(crosscheck, "check_scenario", answer)
    assert cli.main(["check", "--mu", "0.2", "--states", "10"]) == code
    assert capsys.readouterr().out.endswith(f"{verdict}\n")
    assert asked == [chosen("--mu 0.2")]


@pytest.mark.slow
@pytest.mark.parametrize(
    "problem",
    ["--model 3 --law tanh", "--constraints contact,no-slip-along --inclination 2deg", RING],
)
def test_check_of_ones_own_problem_holds(problem: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "checks hold" in printed(capsys, "check", *problem.split())
