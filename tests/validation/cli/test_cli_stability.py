"""The command line's eigenvalues and critical speeds."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.calls import printed, refusal, run
from validation.parser import runs


@pytest.mark.parametrize(
    ("system", "size"),
    [
        ("", 8),
        ("--system full", 8),
        ("--system reduced", 3),
        ("--model 4", 3),
        ("--model 2", 4),
        ("--system numeric --model 3", 3),
        ("--constraints contact,no-slip-along", 7),
    ],
)
@pytest.mark.parametrize("source", runs.SOURCES)
def test_json_holds_every_eigenvalue(
    system: str, size: int, source: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(f"eigenvalues {system} --source {source} --spin 0:40:3 --json") == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["spin"] for row in rows] == [0.0, 20.0, 40.0]
    assert all(len(row["real"]) == len(row["imag"]) == size for row in rows)


def test_sources_agree(capsys: pytest.CaptureFixture[str]) -> None:
    values = []
    for source in runs.SOURCES:
        run(f"eigenvalues --system reduced --source {source} --spin 35 --mu 0.2 --json")
        row = json.loads(capsys.readouterr().out)[0]
        values.append(np.sort_complex(np.array(row["real"]) + 1j * np.array(row["imag"])))
    np.testing.assert_allclose(values[0], values[1], rtol=1e-6)


def test_csv_plot_and_json_go_together(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table, picture = tmp_path / "eigenvalues.csv", tmp_path / "eigenvalues.png"
    assert run(f"eigenvalues --spin 0:50:11 --csv {table} --plot {picture} --json") == 0
    rows = json.loads(capsys.readouterr().out)
    assert len(rows) == 11
    with table.open() as stream:
        stored = list(csv.reader(stream))
    assert len(stored) == 12
    assert len(stored[0]) == 17
    assert float(stored[-1][1]) == rows[-1]["real"][0]
    assert picture.stat().st_size > 100


def test_critical_speeds_go_to_csv_plot_and_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, picture = tmp_path / "critical.csv", tmp_path / "critical.svg"
    assert run(f"critical --model 4 --csv {table} --plot {picture} --json") == 0
    found = json.loads(capsys.readouterr().out)
    (crossing,) = found["crossings"]
    assert crossing["spin"] == pytest.approx(found["closed_form"]["spin"], rel=1e-9)
    assert found["stable"] == [[pytest.approx(crossing["spin"], abs=1e-6), 60.0]]
    with table.open() as stream:
        assert float(list(csv.reader(stream))[1][1]) == crossing["spin"]
    assert "<svg" in picture.read_text()


def test_critical_says_first_where_the_motion_is_stable_and_last_the_closed_form(
    capsys: pytest.CaptureFixture[str],
) -> None:
    shown = printed(capsys, "critical")
    assert shown.startswith("Model 1: inverted spinning is stable nowhere.\n")
    assert re.search(r"^Model 3 +30\.9168 to 60$", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes unstable +26\.8736 ", shown, re.MULTILINE)
    assert re.search(r"^this pair becomes stable +30\.1049 ", shown, re.MULTILINE)
    assert shown.index("nowhere") < shown.index("26.8736")
    assert "Closed form of the reduced system with any friction, Eq. (126): 30.9168 rad/s" in shown


def test_critical_says_why_there_is_no_crossing(capsys: pytest.CaptureFixture[str]) -> None:
    assert "no friction: undamped" in printed(capsys, "critical --system full --mu 0")


BAD = [
    ("eigenvalues --spin 1 --system full --model 2", "Model 2"),
    ("eigenvalues --spin 1 --system reduced --model 1", "Model 1"),
    ("eigenvalues --spin 1 --inclination 1deg", "needs a horizontal table, got an inclination"),
    ("eigenvalues --spin 1 --source engine --inclination 1deg", "needs a horizontal table"),
    ("critical --inclination 1deg", "needs a horizontal table, got an inclination of 0.0174533"),
    ("eigenvalues --spin 5:5:10", "--spin: spin must be a value or first:last:number, of diff"),
    ("eigenvalues --spin 0:1:1", "and at least 2 and at most 100000 spins, got '0:1:1'"),
    ("eigenvalues --spin 0:1:2:3", "--spin: spin must be a value or first:last:number"),
    ("eigenvalues --spin nan", "--spin: spin must be a finite number, got nan"),
    ("eigenvalues --spin 30,", "--spin: spin must be a number in rad/s, got ''"),
    ("eigenvalues --spin 1 --formulation floating", "--formulation: formulation needs --source"),
    ("critical --spin 5", "interval must have 0 <= lowest < highest spin"),
]


@pytest.mark.parametrize(("call", "message"), BAD, ids=[bad[0] for bad in BAD])
def test_bad_input_is_one_line_and_code_2(
    call: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refusal(capsys, call)
