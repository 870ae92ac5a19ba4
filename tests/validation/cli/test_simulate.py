"""`tippedisk simulate`."""

import json
from pathlib import Path

import numpy as np
import pytest

from analysis import Trajectory, load_run
from analysis.data.endings import INVERTED
from tests.calls import printed, run
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
