"""The command line's cycles and heteroclinic connection."""

import csv
import json
from pathlib import Path

import pytest

from tests.test_cli_stability import run


def test_json_holds_the_cycle_at_a_spin(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("cycles --spin 30.85 --json") == 0
    (cycle,) = json.loads(capsys.readouterr().out)["cycles"]
    assert cycle["spin"] == pytest.approx(30.85)
    assert cycle["stable"] is True
    assert 0.0 < cycle["multiplier"] < 1.0


def test_a_table_and_a_picture_hold_the_cycles(tmp_path: Path) -> None:
    table, picture = tmp_path / "cycles.csv", tmp_path / "cycles.png"
    assert run(f"cycles --spin 30.9 30.91 --csv {table}") == 0
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [float(row["spin in rad/s"]) for row in rows] == pytest.approx([30.9, 30.91])
    assert run(f"cycles --spin 30.9 --plot {picture}") == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("cycles --spin 31", "spin must lie between"),
        ("cycles --model 1", "Model 4"),
        ("cycles --mu 0", "friction must have a positive gradient"),
        ("cycles --eccentricity 0", "eccentricity must be positive"),
        ("cycles --plot cycles.txt", "--plot: must end in"),
        ("heteroclinic --eps 0.4", "no saddle with one growing"),
        ("heteroclinic --load contact", "load must be 'weight'"),
    ],
)
def test_bad_calls_say_why(
    call: str,
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("analysis.nonlinear.family.AMPLITUDES", [0.3])
    assert run(call) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_the_connection_is_printed_beside_its_prediction(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    picture = tmp_path / "heteroclinic.svg"
    assert run(f"heteroclinic --json --plot {picture}") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["spin"] == pytest.approx(30.120961805, abs=1e-8)
    assert found["prediction"] == pytest.approx(30.197778035, abs=1e-8)
    assert "<svg" in picture.read_text()


@pytest.mark.slow
def test_the_whole_family_is_printed_and_drawn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.nonlinear.family.AMPLITUDES", [0.2, 0.4, 0.6, 0.8, 1.0])
    assert run("cycles") == 0
    text = capsys.readouterr().out
    assert "Hopf bifurcation of inverted spinning is supercritical" in text
    assert "stability does not change" in text
    picture = tmp_path / "cycles.png"
    assert run(f"cycles --plot {picture}") == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
