"""Laws and conditions of one's own that are none or end the program: no command succeeds so."""

from math import inf
from pathlib import Path
from typing import Any

import pytest

import analysis
import mbs_models
from analysis import Scenario
from tests.calls import refusal, run
from tests.sweeps import sweep
from tests.wayward_law import EXITS, EXITS_AT_ONCE, Answering, Wayward
from validation.sweeps.case import run_chunk

WAYWARD = "--law tests.wayward_law:Wayward,coefficient={}"

CALLS = (
    "simulate --out new.npz --end 0.1",
    "rest --out new.npz --end 0.01 --source in-house",
    "sweep spin=30,31 --end 0.01 --workers 1 --out new.db",
)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working directory of a call, where its modules lie."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "exits_on_import.py").write_text("import sys\nsys.exit()\n")
    return tmp_path


def written(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if path.name.startswith("new")]


SAID = {
    "--law exits_on_import:Law": "--law: friction law 'exits_on_import:Law' cannot be loaded: "
    "SystemExit: , in line 2 of exits_on_import.py",
    WAYWARD.format(EXITS_AT_ONCE): "law:Wayward' cannot be made: SystemExit",
    "--stop-when exits_on_import:Law": "--stop-when: stop_when 'exits_on_import:Law' cannot be lo",
    "--stop-when os:getcwd": "--stop-when: stop_when getcwd must say a number of a State: Type",
}
"""What a module, a law or a function of one's own that is none is refused with."""


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("option", SAID)
def test_what_is_no_law_or_condition_is_refused(call: str, option: str, folder: Path) -> None:
    assert SAID[option] in refusal(call, option)
    assert written(folder) == []


@pytest.mark.parametrize("call", CALLS[:2])
def test_a_law_that_exits_where_the_disk_slips_is_no_success(
    call: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(call, WAYWARD.format(EXITS)) == 70
    assert "SystemExit" in capsys.readouterr().err
    assert written(folder) == []


def test_a_case_whose_law_exits_is_a_row_that_says_so() -> None:
    law = Wayward(coefficient=EXITS)
    (row,) = run_chunk(sweep("spin=30,31", scenario=Scenario(friction=law)), [0])
    assert (row["status"], row["reason"]) == ("failed", "SystemExit 3")


@pytest.mark.parametrize("said", [inf, -1.0])
@pytest.mark.parametrize("side", ["in-house", "engine", "in-house to rest", "engine to rest"])
def test_a_law_that_says_no_number_where_the_disk_slips_is_blamed(side: str, said: float) -> None:
    law = Answering(says=lambda speed: said if speed > 0.05 else 3.0)
    ideal, soft = Scenario(friction=law), Scenario.rest(friction=law)
    runs: dict[str, Any] = {
        "in-house": lambda: analysis.simulate(ideal, [0.0, 0.1]),
        "engine": lambda: mbs_models.simulate(ideal, [0.0, 0.1]),
        "in-house to rest": lambda: analysis.simulate_to_rest(soft, 0.1),
        "engine to rest": lambda: mbs_models.simulate_to_rest(soft, 0.1),
    }
    with pytest.raises(ValueError, match=r"^Answering.force\(0\.0955, 0\.0296, 0\.1\) must"):
        runs[side]()
