"""The command line."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import Trajectory, load_run
from analysis.data.endings import CONDITIONS, INVERTED
from analysis.data.trajectory import SOURCES
from analysis.models.integration import METHODS
from mbs_models import INTEGRATORS
from tests.calls import printed, refusal, run
from tests.helpers import not_none
from validation.parser import commands, groups
from validation.studies import full_report


def test_choices_are_those_of_the_packages() -> None:
    assert groups.FORMULATIONS == mbs_models.FORMULATIONS
    assert groups.FORMS == analysis.FORMS
    assert groups.INTEGRATORS == INTEGRATORS
    assert groups.METHODS == METHODS
    assert tuple(CONDITIONS) == groups.CONDITIONS
    assert commands.INVERSION == analysis.data.inversion.DEFINITION
    assert groups.SOURCES == SOURCES
    assert tuple(study.name for study in full_report.STUDIES) == commands.SECTIONS


def test_help_teaches_by_example(capsys: pytest.CaptureFixture[str]) -> None:
    shown = printed(capsys, "--help")
    assert "tippedisk simulate --model 1" in shown
    for code in range(4):
        assert f"\n  {code}  " in shown


@pytest.mark.parametrize("source", groups.SOURCES)
def test_simulate_stores_arrays_and_all_parameters(source: str, tmp_path: Path) -> None:
    out = tmp_path / "run.npz"
    call = f"simulate --source {source} --model 2 --mu 0.2 --eps 0.05 --spin 35 --end 0.2"
    assert run(*call.split(), "--samples", "21", "--tolerance", "1e-6", "--out", str(out)) == 0
    with np.load(out, allow_pickle=False) as stored:
        assert stored["t"].shape == (21,)
        assert stored["q"].shape == stored["u"].shape == (21, 6)
        assert stored["normal_force"].shape == (21,)
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
    runs = []
    for source in groups.SOURCES:
        out = tmp_path / f"{source}.npz"
        assert run("simulate", "--source", source, "--end", "0.3", "--out", str(out)) == 0
        runs.append(load_run(out, Trajectory))
    np.testing.assert_allclose(runs[0].coordinates, runs[1].coordinates, atol=3e-8)
    np.testing.assert_allclose(runs[0].normal_force, runs[1].normal_force, atol=1e-6)


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


@pytest.mark.parametrize("source", groups.SOURCES)
def test_run_stops_where_it_is_told_to(
    source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.npz"
    assert run("simulate", "--source", source, "--stop-when", "inverted", "--out", str(out)) == 0
    assert "the centre of gravity is up, at 90% of its largest height" in capsys.readouterr().out
    ending = load_run(out, Trajectory).ending
    assert not_none(ending).reason == INVERTED


def test_an_error_that_nobody_foresaw_is_no_result(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(_: object) -> int:
        raise KeyError("speed")

    monkeypatch.setattr("validation.commands.scenario.scenario", broken)
    assert run("scenario") == 2
    shown = capsys.readouterr().err
    assert shown.startswith("Traceback")
    assert shown.endswith("KeyError: 'speed'\n")


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
    ("--model 2 --formulation contact-tree", "exists for Model 1 alone, got Model 2"),
    ("--formulation tree", "--formulation: invalid choice: 'tree'"),
    ("--formulation reduced", "formulation must be one of floating"),
    ("--source in-house --formulation euler-tree", "form must be one of index-1, reduced"),
    ("--source in-house --formulation reduced", "form 'reduced' exists for Model 4 alone"),
    ("--source in-house --step 0.01", "--step needs --source engine"),
    ("--model 3 --gamma-rate 5", "gamma_rate must be -2.44929e-15 in Model 3"),
    ("--end 0", "--end must be positive, got 0"),
    ("--samples 1", "--samples must be at least 2, got 1"),
    ("--tolerance 1e-17", "tolerance 1e-17 rad cannot be reached"),
    ("--tolerance 0", "tolerance must be positive, got 0"),
    ("--tolerance 1e-3 --step 1e-3", "not allowed with argument --tolerance"),
    ("--step -1", "step must be positive, got -1"),
    ("--step 1 --end 4 --samples 3 --formulation euler-tree", "engine run stopped at t ="),
    ("--load contact --formulation contact-tree", "has no contact constraint whose force"),
    ("--integrator Euler", "--integrator: invalid choice: 'Euler'"),
    ("--integrator RK44 --model 3", "integrator 'RK44' is explicit and cannot take"),
    ("--integrator DOPRI5 --tolerance 1e-6", "tolerance must be left out for integrator 'DOPRI5'"),
    ("--integrator RK44 --local-tolerance 1e-9", "--integrator must be DOPRI5 with --local-tol"),
    ("--source in-house --integrator RK44", "integrator must be left out for source 'in-house'"),
    ("--method Radau", "method must be left out for source 'engine'"),
    ("--local-tolerance 0", "local_tolerance must be positive, got 0"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=[bad[0] for bad in BAD])
def test_bad_input_is_one_line_and_code_2_and_writes_nothing(
    arguments: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.npz"
    assert message in refusal(capsys, "simulate", arguments, f"--out={out}")
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
    assert name in refusal(capsys, "show", str(path), f"--out={tmp_path / 'picture.png'}")
    assert not (tmp_path / "picture.png").exists()


@pytest.mark.parametrize("out", ["run.txt", "no-such-folder/run.npz"])
def test_bad_output_is_refused_before_computing(
    out: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert "argument --out: must" in refusal(capsys, "simulate --out", out)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "call",
    [
        "simulate --out run.txt",
        "simulate --scenario missing.toml --out run.npz",
        "rest --plot missing/picture.png",
        "show missing.npz",
        "animate missing.npz",
        "scenario missing.toml",
        "eigenvalues --spin 1 --csv missing/file.csv",
    ],
)
def test_path_that_will_not_do_is_refused_before_numerical_imports(
    call: str, tmp_path: Path
) -> None:
    code = (
        "import sys; from validation import cli; code = cli.main(sys.argv[1:]); "
        "sys.exit(9 if {'numpy', 'exudyn', 'matplotlib'} & set(sys.modules) else code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *call.split()],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert " must " in done.stderr


@pytest.mark.parametrize("command", ["report", "work-precision", "robustness"])
def test_folder_that_cannot_be_written_is_refused_before_computing(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").write_text("a file")
    said = refusal(capsys, command, f"--out={tmp_path / 'taken' / 'folder'}")
    assert "--out must be a folder that can be written to" in said
