"""Sweeps that are killed or interrupted: what they have stored, and that they go on."""

import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import pytest

from tests.calls import ROOT
from tests.helpers import is_running
from tests.sweeps import sweep, swept
from validation.sweeps.case import CaseRow


def test_interrupt_ends_a_sweep_once_what_came_in_is_stored() -> None:
    done: list[int] = []

    def told(new: list[CaseRow]) -> None:
        if not done:
            signal.raise_signal(signal.SIGINT)
        done.append(len(new))

    # What runs in the background of a script is born deaf to Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    says = r"^\d+ of 30 cases are in .*a\.db; the same comm"
    try:
        with pytest.raises(KeyboardInterrupt, match=says):
            swept(sweep("spin=30:40:30"), told=told)
    finally:
        signal.signal(signal.SIGINT, before)
    assert [rows(Path("a.db"))] == done


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")
def test_interrupted_and_killed_sweeps_leave_no_process_and_go_on(tmp_path: Path) -> None:
    path = tmp_path / "a.db"
    # More cases than any machine runs between two commits.
    words = "sweep spin=30:40:1000000 --model 4 --formulation reduced --end 0.05 --workers 2 --out"
    call = ["env", "--default-signal=INT", sys.executable, "-m", "validation", *words.split()]
    count = 0
    for sent in (signal.SIGKILL, signal.SIGINT):
        process = subprocess.Popen([*call, str(path)], cwd=ROOT, stderr=subprocess.PIPE, text=True)
        while not path.exists() or rows(path) <= count:
            assert process.poll() is None
            time.sleep(0.05)
        workers = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        process.send_signal(sent)
        said = process.communicate(timeout=60.0)[1]
        assert process.returncode == (130 if sent == signal.SIGINT else -sent)
        if sent == signal.SIGINT:
            assert said.endswith(f" of 1000000 cases are in {path}; the same command goes on\n")
        limit = time.monotonic() + 60.0
        while any(is_running(int(worker)) for worker in workers):
            assert time.monotonic() < limit
            time.sleep(0.05)
        assert rows(path) >= count
        count = rows(path)


def rows(path: Path) -> int:
    with closing(sqlite3.connect(path, timeout=10.0)) as file:
        tables = file.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
        assert file.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        count = file.execute("SELECT count(*) FROM cases").fetchone()[0] if tables else 0
    return int(count)
