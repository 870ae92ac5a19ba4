"""`tippedisk simulate`."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import Trajectory, load_run
from analysis.data.endings import INVERTED
from tests.calls import printed, refusal, run
from tests.helpers import not_none
from validation.parser import runs


@pytest.mark.parametrize("source", runs.SOURCES)
def test_simulate_stores_arrays_and_all_parameters(source: str, tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    call = f"simulate --source {source} --model 2 --mu 0.2 --eps 0.05 --spin 35 --end 0.2"
    assert run(*call.split(), "--samples", "21", "--tolerance", "1e-6", "--out", str(out)) == 0
    with np.load(out, allow_pickle=False) as stored:
        assert stored["times"].shape == (21,)
        assert stored["coordinates"].shape == stored["rates"].shape == (21, 6)
        meta = json.loads(str(stored["meta"]))
    assert meta["source"] == source
    assert meta["scenario"]["constraints"] == ["contact", "fixed-cog"]
    assert meta["scenario"]["friction"] == {
        "law": "smooth-coulomb",
        "coefficient": 0.2,
        "smoothing": 0.05,
        "load": "weight",
    }
    assert meta["scenario"]["disk"]["radius"] == 0.045
    assert 0 < meta["error_estimate"] <= 1e-6
    assert "numpy" in meta["versions"]


def test_engine_and_in_house_files_agree(tmp_path: Path) -> None:
    found = []
    for source in runs.SOURCES:
        out = tmp_path / f"{source}.npz"
        assert run("simulate", "--source", source, "--end", "0.3", "--out", str(out)) == 0
        found.append(load_run(out, Trajectory))
    np.testing.assert_allclose(found[0].coordinates, found[1].coordinates, atol=3e-8)
    np.testing.assert_allclose(found[0].normal_force, found[1].normal_force, atol=1e-6)


def test_fixed_step_run_has_no_estimate(tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    call = f"simulate --step 0.005 --end 0.1 --samples 11 --out {out}"
    assert run(*call.split()) == 0
    stored = load_run(out, Trajectory)
    assert stored.error_estimate is None
    assert stored.method["step"] == 0.005


@pytest.mark.parametrize("source", ["engine", "in-house"])
def test_run_from_an_unstable_stationary_motion_says_so(
    source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    call = ["simulate", "--source", source, "--end", "0.1", "--out", str(tmp_path / "run.npz")]
    assert run(*call, "--gamma", "pi/2", "--spin", "20") == 0
    assert "start is exactly inverted spinning, which is unstable" in capsys.readouterr().out
    assert "which is unstable" not in printed(capsys, *call, "--gamma", "1.57", "--spin", "20")


@pytest.mark.parametrize(
    ("how", "estimated"),
    [
        ("--integrator RK44 --tolerance 1e-6", True),
        ("--local-tolerance 1e-10", False),
        ("--source in-house --method Radau --tolerance 1e-6", True),
        ("--source in-house --local-tolerance 1e-9", False),
    ],
)
def test_solver_can_be_chosen(how: str, estimated: bool, tmp_path: Path) -> None:
    asked, usual = tmp_path / "asked.npz", tmp_path / "usual.npz"
    for out, options in ((asked, how), (usual, "")):
        assert run("simulate --end 0.5 --samples 21", options, "--out", str(out)) == 0
    found, known = (load_run(out, Trajectory) for out in (asked, usual))
    assert (found.error_estimate is not None) == estimated
    assert 0.0 < np.max(np.abs(found.coordinates - known.coordinates)) < 1e-6


@pytest.mark.parametrize("source", runs.SOURCES)
def test_run_stops_where_it_is_told_to(
    source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.npz"
    assert run("simulate", "--source", source, "--stop-when", "inverted", "--out", str(out)) == 0
    assert "the centre of gravity is up, at 90% of its largest height" in capsys.readouterr().out
    ending = load_run(out, Trajectory).ending
    assert not_none(ending).reason == INVERTED


def test_what_cannot_be_written_is_refused_before_anything_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder.npz").mkdir()
    assert run("simulate", "--out", str(tmp_path / "folder.npz")) == 2
    monkeypatch.setattr("os.access", lambda *_: False)
    assert run("simulate", "--out", str(tmp_path / "run.npz")) == 2
    shown = capsys.readouterr().err
    assert shown.count("--out: must be a file that can be written, got") == 2


BAD = [
    ("--model 2 --formulation contact-tree", 2, "exists for Model 1 alone, got Model 2"),
    ("--formulation reduced", 2, "formulation must be one of floating"),
    ("--source in-house --formulation euler-tree", 2, "form must be one of index-1, reduced"),
    ("--source in-house --formulation reduced", 2, "form 'reduced' exists for Model 4 alone"),
    ("--source in-house --step 0.01", 2, "--step: step must be left out for source 'in-house'"),
    ("--method Radau", 2, "--method: method must be left out for source 'engine'"),
    ("--tolerance 1e-3 --step 1e-3", 2, "--step: step must be left out for a run with its tol"),
    ("--samples 1", 2, "--samples: samples must be at least 2, got 1"),
    ("--end nan", 2, "--end: end must be a finite number, got nan"),
    ("--load contact --formulation contact-tree", 2, "has no contact constraint whose force"),
    ("--integrator RK44 --model 3", 2, "integrator 'RK44' is explicit and cannot take"),
    ("--integrator DOPRI5 --tolerance 1e-6", 2, "must be left out for integrator 'DOPRI5'"),
    ("--integrator RK44 --local-tolerance 1e-9", 2, "--integrator: integrator must be DOPRI5"),
    ("--local-tolerance 0", 2, "--local-tolerance: local_tolerance must be positive, got 0"),
    ("--tolerance 1e-17", 1, "tolerance 1e-17 rad cannot be reached"),
    ("--step 1 --end 4 --samples 3 --formulation euler-tree", 1, "engine run stopped at t ="),
]


@pytest.mark.parametrize(("arguments", "code", "message"), BAD, ids=[bad[0] for bad in BAD])
def test_what_does_not_run_is_one_line_and_writes_nothing(
    arguments: str, code: int, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.npz"
    assert run("simulate", arguments, f"--out={out}") == code
    shown = capsys.readouterr()
    assert message in shown.err
    assert (shown.out, shown.err.count("\n")) == ("", 1)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("missing.npz", None),
        ("picture.jpg", b"of another kind"),
        ("text.npz", b"not an archive"),
        ("empty.npz", b""),
        ("truncated.npz", "half"),
    ],
)
def test_unreadable_run_is_one_line_and_code_2(
    name: str, content: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    if content == "half":
        whole = tmp_path / "whole.npz"
        run("simulate", "--end", "0.1", "--out", str(whole))
        content = whole.read_bytes()[: whole.stat().st_size // 2]
        capsys.readouterr()
    if content is not None:
        path.write_bytes(content)
    assert name in refusal(capsys, "show", str(path), f"--plot={tmp_path / 'picture.png'}")
    assert not (tmp_path / "picture.png").exists()
