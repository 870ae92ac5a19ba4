"""The command line's cycles and heteroclinic connection."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from tests.calls import printed, refusal, run


def test_cycles_at_spins_go_to_csv_plot_and_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, picture = tmp_path / "cycles.csv", tmp_path / "cycles.svg"
    call = f"cycles --spin 30.9 30.91 --json --csv {table} --plot {picture}"
    motions = json.loads(printed(capsys, call))["motions"]
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [float(row["spin in rad/s"]) for row in rows] == [each["spin"] for each in motions]
    assert [each["spin"] for each in motions] == pytest.approx([30.9, 30.91])
    assert all(each["stable"] and 0.0 < each["multiplier"] < 1.0 for each in motions)
    assert "<svg" in picture.read_text()


def test_a_cycle_is_followed_over_a_parameter(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run("cycles --over hole-distance=0.02,0.021 --amplitude 0.3 --json") == 0
    first, second = json.loads(capsys.readouterr().out)["motions"]
    assert (first["disk.hole_distance"], second["disk.hole_distance"]) == (0.02, 0.021)
    # The Hopf point goes up with the eccentricity; the hole's distance changes the inertia, too.
    assert 0.2 < second["spin"] - first["spin"] < 0.3
    picture = tmp_path / "over.svg"
    assert run(f"cycles --over eps=0.1,0.11 --amplitude 0.3 --plot {picture}") == 0
    assert "<svg" in picture.read_text()


@pytest.mark.slow
def test_cycles_without_symmetry_are_followed_from_where_they_are_born(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.nonlinear.families._amplitudes", lambda _: (0.5, 1.0, 1.5, 1.9))
    monkeypatch.setattr("analysis.nonlinear.families.BEYOND", np.array((0.2, 0.4, 0.6)))
    picture = tmp_path / "asymmetric.svg"
    call = "cycles --asymmetric --mu 0.1 --eps 0.4"
    found = json.loads(printed(capsys, f"{call} --json --plot {picture}"))
    born, change = found["events"]
    assert (born["kind"], round(born["amplitude"], 5)) == ("symmetry-breaking", 1.78157)
    assert [each["stable"] for each in found["motions"]] == [True, True, False]
    assert (change["kind"], round(change["spin"], 3)) == ("period-doubling", 29.969)
    assert "<svg" in picture.read_text()
    assert run("cycles --asymmetric") == 1
    assert "no cycle of the family loses its symmetry" in capsys.readouterr().err


@pytest.mark.slow
def test_the_connection_is_followed_over_a_parameter(capsys: pytest.CaptureFixture[str]) -> None:
    ends = json.loads(printed(capsys, "heteroclinic --over mu=0.1,0.3 --json"))["ends"]
    assert [end["friction.coefficient"] for end in ends] == [0.1, 0.3]
    assert ends[0]["hopf"] == ends[1]["hopf"]
    assert ends[1]["connection"]["spin"] == pytest.approx(30.120961805, abs=1e-8)
    assert ends[1]["prediction"] == pytest.approx(30.197778035, abs=1e-8)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("cycles --spin 31", "spin must lie between"),
        ("cycles --model 1", "Model 4"),
        ("cycles --mu 0", "friction must have a positive gradient"),
        ("cycles --eccentricity 0", "eccentricity must be positive"),
        ("cycles --mu 1e9", "gradient of at most 10000 s/m"),
        ("cycles --amplitude 1", "--amplitude: amplitude belongs to --over"),
        ("cycles --asymmetric --spin 30", "--spin: spin does not go together with asymmetric"),
        ("cycles --rotating --spin 30", "--spin: spin does not go together with rotating"),
        ("cycles --asymmetric --rotating", "--asymmetric: asymmetric does not go together with"),
        ("cycles --over mu=0.1:1:3", "--over: over needs what is held"),
        ("cycles --over mu=0.1:1 --spin 30", "needs a count"),
        ("cycles --over start.spin=1,2 --amplitude 1", "a number of disk, friction or table"),
        ("heteroclinic --over mu=0,1", "friction must have a positive gradient"),
        ("heteroclinic --mu 1e9", "gradient of at most 100000 s/m"),
        ("heteroclinic --load contact", "load must be 'weight'"),
    ],
)
def test_bad_calls_say_why(
    call: str,
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("analysis.nonlinear.families.AMPLITUDES", [0.3])
    assert message in refusal(capsys, call)


@pytest.mark.slow
def test_the_connection_is_told_beside_its_prediction_and_drawn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    picture = tmp_path / "heteroclinic.svg"
    found = json.loads(printed(capsys, f"heteroclinic --json --plot {picture}"))
    assert found["spin"] == pytest.approx(30.120961805, abs=1e-8)
    assert found["prediction"] == pytest.approx(30.197778035, abs=1e-8)
    assert "<svg" in picture.read_text()


@pytest.mark.slow
def test_the_whole_family_is_printed_and_drawn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.nonlinear.families.AMPLITUDES", [0.2, 0.4, 0.6, 0.8, 1.0])
    picture = tmp_path / "cycles.svg"
    text = printed(capsys, f"cycles --plot {picture}")
    assert "Hopf bifurcation of inverted spinning is supercritical" in text
    assert "stability does not change" in text
    assert "<svg" in picture.read_text()


@pytest.mark.slow
def test_rotating_motions_are_told_and_drawn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.nonlinear.families.TILTS", np.array((0.1, 0.12, 0.14)))
    picture = tmp_path / "rotating.svg"
    found = json.loads(printed(capsys, f"cycles --rotating --json --plot {picture}"))
    assert [each["tilt"] for each in found["motions"]] == [0.1, 0.12, 0.14]
    assert [each["stable"] for each in found["motions"]] == [True, True, False]
    assert found["events"][0]["spin"] == pytest.approx(30.0820066, abs=1e-6)
    assert found["connection"] == pytest.approx(30.120961805, abs=1e-8)
    assert "<svg" in picture.read_text()
