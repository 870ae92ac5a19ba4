"""Standard output that cannot be written to, and the command line as a process."""

import subprocess
import sys
from pathlib import Path

import pytest

from analysis import Trajectory, load_run
from tests.calls import Capture, printed

SCENE = "scene --model 2"
SIMULATE = "simulate --end 0.01 --samples 3 --out new.npz"

needs_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")


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


@pytest.mark.slow
@needs_full
@pytest.mark.parametrize(
    ("call", "streams"),
    [
        (SIMULATE, ">/dev/full"),
        (SIMULATE, ">&-"),
        (SIMULATE, "| true; exit ${PIPESTATUS[0]}"),
        ("simulate --help", ">/dev/full"),
    ],
)
def test_output_that_is_lost_is_said_in_one_line_and_is_no_failed_run(
    call: str, streams: str
) -> None:
    done = process(call, streams)
    assert done.returncode == 3
    assert done.stderr.startswith("tippedisk: standard output ")
    assert done.stderr.count("\n") == 1
    if call == SIMULATE:
        assert load_run("new.npz", Trajectory).times.size == 3


@needs_full
@pytest.mark.parametrize("streams", [">/dev/full", "2>/dev/full", "2>&-"])
def test_streams_that_are_lost_do_not_hide_a_wrong_call(streams: str) -> None:
    done = process("simulate --model 5 --out new.npz", streams)
    assert done.returncode == 2
    assert done.stderr.count("\n") == streams.startswith(">")


@pytest.mark.slow
@needs_full
@pytest.mark.parametrize("streams", ["2>/dev/full", "2>&-"])
def test_a_run_needs_no_standard_error(streams: str) -> None:
    done = process(SIMULATE, streams)
    assert (done.returncode, done.stderr) == (0, "")
    assert "3 samples of Model 1" in done.stdout
