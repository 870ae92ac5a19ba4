"""`tippedisk sweep` on the command line."""

import shutil
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from analysis import MODELS, Scenario
from analysis.simulation.compiled import library
from tests.calls import answer, refusal, run
from tests.sweeps import sweep
from validation.sweeps.results import Results
from validation.sweeps.runner import run_sweep
from validation.sweeps.store import Store

SHORT = "--model 4 --formulation reduced --end 0.05 --tolerance 1e-4 --workers 1 --out a.db"
CALL = f"sweep spin=30:40:5 {SHORT}"


def test_sweep_fills_its_store_and_tells_what_failed() -> None:
    # An axis may stand behind options, too.
    said = answer(f"sweep spin=30:40:2 {SHORT} mu=0.2,-0.3 --csv a.csv")
    assert (said.code, said.out) == (0, "a.db: 4 cases, 2 of them refused\n")
    assert Path("a.csv").read_text().count("\n") == 5
    assert "2 of 4 cases looked at are refused, such as: coefficient must not be" in said.err
    again = f"sweep spin=30:40:2 {SHORT} mu=0.2,-0.3"
    assert "looked at are refused" not in answer(again).err
    assert "looked at are refused" in answer(again, "--retry").err
    assert Results.load(Path("a.db")).sweep.scenario == Scenario(constraints=MODELS[4])


def test_a_local_tolerance_of_the_engine_takes_the_integrator_that_is_given() -> None:
    stepped = "--local-tolerance 1e-9 --end 0.02 --workers 1 --out a.db"
    call = f"sweep spin=30 --model 4 --source engine {stepped}"
    assert "'DOPRI5' is explicit" in refusal(call)
    assert run(call, "--integrator DOP853 --witnesses 1") == 0
    found = Results.load(Path("a.db"))
    assert found.sweep.plan.integrator == "DOP853"
    assert found.columns["difference"][0] < 1e-7


def test_axes_come_from_a_file_as_well() -> None:
    Path("axes.toml").write_text(
        'layout = "sobol"\nnumber = 3\nseed = 5\n\n[axes]\nstart.spin = "30:40"\n'
        'friction.coefficient = "0.1:1:log"\nmodel = [1, 4]\n'
    )
    call = "sweep --axes axes.toml gamma=0,1 --seed 6 --end 0.01 --workers 1 --out a.db"
    assert run(call, "--keep beta,tilt") == 0
    results = Results.load(Path("a.db"))
    wanted, models = results.sweep, results.columns["model"]
    assert (models.dtype.kind, {*models.tolist()} <= {1, 4}) == ("i", True)
    assert wanted.plan.keep == ("beta", "tilt")
    design = wanted.design
    assert (design.layout, design.number, design.seed) == ("sobol", 3, 6)
    fields = [axis.field for axis in design.axes]
    assert fields == ["start.spin", "friction.coefficient", "model", "start.gamma"]
    Path("axes.toml").write_text("axes = 3")
    assert "axes.toml: axes must be a table, got 3" in refusal("sweep --axes axes.toml --out b.db")
    Path("axes.toml").write_text("[axes]\nmu = [0.1, true]\n")
    assert "must be a number, got 'True'" in refusal("sweep --axes axes.toml --out b.db")


def test_what_cannot_run_here_is_refused_before_anything_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(library, "find_spec", lambda _: None)
    said = refusal(CALL, "--method taylor")
    assert "method 'taylor' needs heyoka, which is not installed: pip install" in said
    with pytest.raises(ValueError, match=r"^method 'taylor' needs heyoka, which is not"):
        run_sweep(sweep("spin=30,31", method="taylor"), "a.db")
    with pytest.raises(ValueError, match=r"^sweep must be a Sweep, got None$"):
        run_sweep(cast("Any", None), "a.db")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=1000))
    assert "5 cases may take" in refusal(CALL)
    assert not Path("a.db").exists()


def test_map_is_refused_before_any_panel_if_one_store_is_of_another() -> None:
    Path("maps").mkdir()
    with Store("maps/basins-2.db", sweep("spin=30,31")):
        pass
    said = refusal("map basins --cells 1 --levels 0 --workers 1 --out maps")
    assert "basins-2.db holds results of another sweep" in said
    assert [each.name for each in Path("maps").iterdir()] == ["basins-2.db"]


@pytest.mark.parametrize("call", [CALL, "map attitude --workers 1 --out maps"])
@pytest.mark.parametrize(("executor", "module"), [("dask", "distributed"), ("mpi", "mpi4py")])
def test_missing_extra_is_told_in_one_line_and_nothing_is_made(
    call: str, executor: str, module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    said = refusal(call, f"--executor {executor}")
    assert f"the executor {executor} needs the extra" in said
    assert not Path("a.db").exists()
    assert not Path("maps").exists()
