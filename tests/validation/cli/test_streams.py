"""Standard output that cannot be written to, and the command line as a process."""

import subprocess
import sys
from pathlib import Path

import pytest

from analysis import Trajectory, load_run
from tests.calls import Capture, printed
from tests.helpers import mostly_slow

SCENE = "scene --model 2"
SIMULATE = "simulate --end 0.01 --samples 3 --out new.npz"


@pytest.fixture(autouse=True)
def _buffered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Output of a process is buffered, as it is by default."""
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)
    monkeypatch.setenv("PYTHONIOENCODING", "utf-8")


def process(call: str, streams: str = "") -> subprocess.CompletedProcess[str]:
    """Run a command line in a shell, which may redirect its streams."""
    line = f"{sys.executable} -W error -m validation {call} {streams}"
    return subprocess.run(["/bin/bash", "-c", line], capture_output=True, text=True, check=False)


def test_module_is_the_same_command(capsys: Capture) -> None:
    done = process(SCENE)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == printed(capsys, SCENE)


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
@pytest.mark.parametrize("case", mostly_slow(STREAMS, STREAMS[:3]), ids=str)
def test_lost_streams_are_said_in_one_line_and_hide_neither_a_run_nor_a_wrong_call(
    case: tuple[str, str, int, str],
) -> None:
    call, streams, code, said = case
    done = process(call, streams)
    assert done.returncode == code
    assert done.stderr.startswith(said)
    assert done.stderr.count("\n") == bool(said)
    if call == SIMULATE:
        assert load_run("new.npz", Trajectory).times.size == 3
        assert ("3 samples of Model 1" in done.stdout) == (code == 0)
