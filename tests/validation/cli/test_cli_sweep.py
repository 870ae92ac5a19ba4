"""`tippedisk sweep` on the command line."""

import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from analysis.compiled import library
from tests.calls import refusal, run
from tests.sweeps import sweep
from tests.validation.cli.test_cli_scenario import chosen
from validation.commands.sweep import chosen_design
from validation.parser.top import parsed
from validation.sweeps.results import Results
from validation.sweeps.runner import run_sweep

SHORT = "--model 4 --formulation reduced --end 0.05 --tolerance 1e-4 --workers 1"


def test_sweep_fills_its_store_and_the_same_command_has_nothing_left(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, table = tmp_path / "a.db", tmp_path / "a.csv"
    call = f"sweep spin=30:40:2 mu=0.2,-0.3 {SHORT} --out {out} --csv {table}".split()
    assert run(*call) == 0
    said = capsys.readouterr()
    assert said.out == f"{out}: 4 cases, 2 of them failed\n"
    assert table.read_text().count("\n") == 5
    assert "2 of 4 cases looked at are refused, such as: coefficient" in said.err
    before = out.read_bytes()
    assert run(*call) == 0
    assert out.read_bytes() == before
    assert Results.load(out).sweep.scenario == chosen("--model 4")


def test_axes_come_from_a_file_as_well(tmp_path: Path) -> None:
    told, out = tmp_path / "axes.toml", tmp_path / "a.db"
    told.write_text(
        'layout = "sobol"\nnumber = 3\nseed = 5\n\n[axes]\nstart.spin = "30:40"\n'
        'friction.coefficient = "0.1:1:log"\nmodel = [1, 4]\n'
    )
    words = ["sweep", "--axes", str(told), "gamma=0,1", "--seed", "6", "--out", str(out)]
    design = chosen_design(parsed(words))
    assert (design.layout, design.number, design.seed) == ("sobol", 3, 6)
    assert [axis.field for axis in design.axes] == [
        "start.spin",
        "friction.coefficient",
        "model",
        "start.gamma",
    ]


def test_store_that_the_disk_cannot_hold_is_refused_before_it_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=1000))
    out = tmp_path / "a.db"
    assert "5 cases may take" in refusal(capsys, "sweep spin=30:40:5", SHORT, f"--out={out}")
    assert not out.exists()


def test_a_method_that_is_not_installed_is_refused_before_anything_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(library, "find_spec", lambda _: None)
    out = tmp_path / "a.db"
    said = refusal(capsys, f"sweep spin=30:40:5 {SHORT} --method taylor --out {out}")
    assert "method 'taylor' needs heyoka, which is not installed: pip install" in said
    with pytest.raises(ValueError, match=r"^method 'taylor' needs heyoka, which is not"):
        run_sweep(sweep("spin=30,31", method="taylor"), out)
    assert not out.exists()


@pytest.mark.parametrize(("executor", "module"), [("dask", "distributed"), ("mpi", "mpi4py")])
def test_missing_extra_is_told_in_one_line(
    executor: str,
    module: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    call = f"sweep spin=30:40:5 {SHORT} --executor {executor} --out {tmp_path / 'a.db'}"
    assert f"the executor {executor} needs the extra" in refusal(capsys, call)
