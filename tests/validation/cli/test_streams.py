"""Standard output that cannot be written to, and the command line as a process."""

import subprocess
import sys
from pathlib import Path

import pytest

from analysis import Trajectory, load_run
from tests.helpers import mostly_slow

SIMULATE = "simulate --end 0.01 --samples 3 --out new.npz"


LOST = "tippedisk: standard output "
WRONG = "simulate --model 5 --out new.npz"

STREAMS = [
    (WRONG, ">/dev/full", 2, "tippedisk simulate: error: "),
    (WRONG, "2>/dev/full", 2, ""),
    (WRONG, "2>&-", 2, ""),
    ("simulate --help", ">/dev/full", 3, LOST),
    (SIMULATE, ">/dev/full", 3, LOST),
    (SIMULATE, ">&-", 3, LOST),
    (SIMULATE, "| true; exit ${PIPESTATUS[0]}", 3, LOST),
    (SIMULATE, "2>/dev/full", 0, ""),
    (SIMULATE, "2>&-", 0, ""),
]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("case", mostly_slow(STREAMS, STREAMS[:4]), ids=str)
def test_lost_streams_are_said_in_one_line_and_hide_neither_a_run_nor_a_wrong_call(
    case: tuple[str, str, int, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # What a process prints is buffered, as it is by default.
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)
    call, streams, code, said = case
    line = f"{sys.executable} -W error -m validation {call} {streams}"
    done = subprocess.run(["/bin/bash", "-c", line], capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert done.stderr.startswith(said)
    assert done.stderr.count("\n") == bool(said)
    if call == SIMULATE:
        assert load_run("new.npz", Trajectory).times.size == 3
        assert ("3 samples of Model 1" in done.stdout) == (code == 0)
