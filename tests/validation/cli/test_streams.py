"""Standard output that cannot be written to, and the command line as a process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from analysis import Trajectory, load_run
from validation import cli

ROOT = Path(__file__).parents[3]
FULL = Path("/dev/full")
SCENE = "scene --model 2"
LOST = "tippedisk: standard output "

needs_full = pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full")


def environment(encoding: str) -> dict[str, str]:
    """Environment of a process whose output is buffered, as it is by default."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    return kept | {"PYTHONIOENCODING": encoding}


def process(call: str, *, streams: str = "") -> subprocess.CompletedProcess[str]:
    """Run a command line in a shell, which may redirect its streams."""
    return subprocess.run(
        ["/bin/bash", "-c", f"{sys.executable} -W error -m validation {call} {streams}"],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env=environment("utf-8"),
    )


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Arguments of a short simulation that writes a file."""
    return f"simulate --end 0.01 --samples 3 --out {tmp_path_factory.mktemp('streams')}/run.npz"


def test_module_is_the_same_command(capsys: pytest.CaptureFixture[str]) -> None:
    done = process(SCENE)
    assert (done.returncode, done.stderr) == (0, "")
    assert cli.main(SCENE.split()) == 0
    assert done.stdout == capsys.readouterr().out


@pytest.mark.slow
@needs_full
@pytest.mark.parametrize(
    "redirection", [">/dev/full", ">&-", "| true; exit ${PIPESTATUS[0]}", ">&- <&-"]
)
def test_run_that_was_written_is_no_failed_run(redirection: str, simulated: str) -> None:
    out = Path(simulated.rsplit(maxsplit=1)[-1])
    out.unlink(missing_ok=True)
    done = process(simulated, streams=redirection)
    assert done.returncode == 3
    assert done.stderr.startswith(LOST)
    assert done.stderr.count("\n") == 1
    assert load_run(out, Trajectory).times.size == 3


@pytest.mark.slow
@needs_full
@pytest.mark.parametrize("call", ["--help", "--version", "simulate --help", SCENE])
def test_text_that_is_lost_is_said_in_one_line(call: str) -> None:
    done = process(call, streams=">/dev/full")
    assert done.returncode == 3
    assert done.stderr.startswith(LOST)
    assert done.stderr.count("\n") == 1


@needs_full
def test_full_output_does_not_hide_a_wrong_call() -> None:
    done = process("simulate --model 5 --out run.npz", streams=">/dev/full")
    assert done.returncode == 2
    assert "--model: invalid choice: '5'" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.slow
@needs_full
@pytest.mark.parametrize("redirection", ["2>/dev/full", "2>&-"])
def test_full_standard_error_keeps_the_exit_code(redirection: str) -> None:
    assert process("eigenvalues --spin 1 --mu -1", streams=redirection).returncode == 2
    assert process("simulate --model 5", streams=redirection).returncode == 2


def test_failed_check_outranks_lost_output(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "_run", lambda _: 1)
    monkeypatch.setattr(cli, "_deliver", lambda _: False)
    assert cli.main([]) == 1


@pytest.mark.slow
@pytest.mark.parametrize("redirection", ["2>/dev/full", "2>&-"])
def test_run_does_not_need_a_standard_error(redirection: str, simulated: str) -> None:
    done = process(simulated, streams=redirection)
    assert (done.returncode, done.stderr) == (0, "")
    assert "3 samples of Model 1" in done.stdout
    assert process("rest --end 0.01", streams=redirection).returncode == 0
