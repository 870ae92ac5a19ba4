"""The command `rest` and its part of the report."""

from fractions import Fraction
from pathlib import Path

import pytest

from analysis import SpatialMotion
from validation import rest, rest_final, rest_starts
from validation.cli import main


@pytest.mark.parametrize("source", ["engine", "in-house"])
def test_command_simulates_stores_and_draws(
    source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, plot = tmp_path / "rest.npz", tmp_path / "rest.png"
    arguments = ["rest", "--source", source, "--rolling-viscous", "2e-3", "--pivoting", "2e-4"]
    assert main([*arguments, "--end", "1", "--out", str(out), "--plot", str(plot)]) == 0
    motion = SpatialMotion.load(out)
    assert motion.source == source
    assert motion.times[-1] == pytest.approx(1.0)
    assert plot.read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr().out
    assert "inversion        0.4" in printed
    assert "not at rest after 1 s" in printed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--rolling", "-1"], "rolling_dry must not be negative, got -1"),
        (["--stiffness", "nan"], "stiffness must be a finite number, got nan"),
        (["--half-thickness", "1"], "half_thickness must not exceed the radius"),
        (["--step", "1"], "step must not exceed"),
        (["--out", "rest.txt"], "--out must end in .npz, got 'rest.txt'"),
        (["--plot", "nowhere/rest.png"], "--plot must lie in an existing folder"),
    ],
)
def test_wrong_calls_answer_in_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["rest", *arguments]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1
    assert message in printed


def test_final_stage_table_holds_the_predicted_exponents() -> None:
    results = {job.key: job.function(*job.arguments) for job in rest_final.jobs()}
    for row in rest_final.table(results).rows:
        for theory, fitted in ((row[1], row[2]), (row[3], row[4])):
            assert fitted == pytest.approx(float(Fraction(str(theory))), abs=0.005)
    assert rest_final.draw(results).png


@pytest.mark.slow
def test_section_shows_engine_and_in_house_agreeing_until_rest() -> None:
    results = {job.key: job.function(*job.arguments) for job in rest.jobs(quick=True)}
    section = rest.section(results)
    differences = [row[-1] for row in section.tables[0].rows if row[-1] is not None]
    assert len(differences) == len(rest.CASES)
    assert max(float(value) for value in differences) < 1e-4
    assert len(section.pictures) == 3


def test_two_random_starts_come_to_rest() -> None:
    for seed in (1, 7):
        outcome = rest_starts.run(seed)
        assert outcome.rest is not None
        assert outcome.lowest_force >= 0.0
        assert outcome.residual < 1e-7
