"""Where results go: links, pipes, modes of files, streams that are lost, names in any case."""

import io
import json
import os
import re
import stat
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from analysis import load_run
from tests.calls import Capture, printed, refusal, run
from tests.helpers import mostly_slow
from validation.parser.files import Result

posix = pytest.mark.skipif(os.name != "posix", reason="links, pipes and modes of POSIX")

SPINS = "eigenvalues --system reduced --spin 30 40"

WAYS = {
    "run.csv": "show run.npz --csv",
    "new.npz": "simulate --source in-house --end 0.01 --samples 3 --out",
    "picture.png": f"{SPINS} --plot",
    "page.html": "animate run.npz --out",
    "play.html": "play --out",
}
"""Calls that write each kind of file."""

every = pytest.mark.parametrize("name", WAYS)


def save(name: str, path: Path | str = "") -> None:
    assert run(WAYS[name], str(path or name)) == 0


def test_json_stands_alone_whatever_the_engine_says_as_it_is_loaded() -> None:
    command = [sys.executable, "-m", "validation", "scene", "--model", "1", "--json"]
    env = os.environ | {"EXUDYN_MODULE": "fast"}
    shown = subprocess.run(command, env=env, capture_output=True, check=True)
    assert b"fast" in shown.stderr
    assert json.loads(shown.stdout)


def test_engine_that_cannot_be_loaded_is_told_in_one_line_with_what_it_lacks(
    tmp_path: Path,
) -> None:
    (tmp_path / "exudyn.py").write_text("raise ImportError('tried:\\n  libGL.so.1: not found')")
    command = [sys.executable, "-m", "validation", "simulate", "--end", "0.1"]
    env = os.environ | {"PYTHONPATH": str(tmp_path)}
    shown = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
    assert shown.returncode == 2
    (line,) = shown.stderr.splitlines()
    assert "exudyn cannot be loaded: tried: libGL.so.1: not found; " in line
    assert "libgl1" in line


def test_json_has_nothing_in_place_of_what_is_no_finite_number(capsys: Capture) -> None:
    assert Result(values={"apart": [np.inf, -np.inf, np.nan, 1e300]}).deliver(json=True) == 0
    assert capsys.readouterr().out == '{"apart": [null, null, null, 1e+300]}\n'


@posix
@every
def test_link_stays_and_what_it_leads_to_is_replaced_with_its_mode(name: str) -> None:
    target, link = Path("elsewhere") / name, Path(name)
    target.parent.mkdir()
    link.symlink_to(target)
    save(name)
    target.write_bytes(b"an older result")
    target.chmod(0o640)
    save(name)
    assert link.is_symlink()
    assert [each.name for each in target.parent.iterdir()] == [name]
    assert target.stat().st_size > 100
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


def assert_written(name: str, content: bytes) -> None:
    """What has come out is what stands in a plain file."""
    read, plain = Path(f"read-{name}"), Path(f"plain-{name}")
    read.write_bytes(content)
    save(name, plain)
    if name.endswith(".npz"):
        # An archive that cannot be gone back in says how long its members are behind them.
        np.testing.assert_array_equal(load_run(read).times, load_run(plain).times)
    else:
        assert content == plain.read_bytes()


@posix
@every
def test_pipe_is_written_to_and_stays_one(name: str) -> None:
    pipe = Path(name)
    os.mkfifo(pipe)
    with ThreadPoolExecutor() as threads:
        reader = threads.submit(pipe.read_bytes)
        save(name)
        assert_written(name, reader.result(timeout=20.0))
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@posix
@every
def test_a_file_on_a_device_needs_no_suffix_and_stands_on_standard_output_alone(
    name: str, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    save(name, os.devnull)
    capfdbinary.readouterr()
    save(name, "/dev/stdout" if name == "new.npz" else "-")
    shown = capfdbinary.readouterr()
    assert (b"/dev/stdout" in shown.err) == name.startswith(("new", "play", "page"))
    assert_written(name, shown.out)


CLOSED = {
    **{f"/proc/{name}": call for name, call in WAYS.items()},
    "/proc/new.db": "sweep spin=1,2 --out",
    "/proc/folder": "report --out",
}


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder that nobody can fill")
@pytest.mark.parametrize("path", CLOSED)
def test_a_folder_that_says_it_can_be_written_to_and_cannot_is_refused_by_the_option(
    path: str,
) -> None:
    option = CLOSED[path].rpartition(" ")[2]
    assert f"error: argument {option}: must be a f" in refusal(CLOSED[path], path)


LOCKED = {
    "show run.npz": "FILE: must be an existing file that can be read, got 'run.npz'",
    "check --scenario run.npz": "--scenario: must be an existing file that can be read",
    "sweep spin=1,2 --out old.db": "--out: must be a regular file that can be written",
}


@pytest.mark.parametrize("call", LOCKED)
def test_a_file_that_may_not_be_read_or_written_is_refused_by_the_option(
    call: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("old.db").touch()
    # Whoever runs the tests may be allowed everything.
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert f"error: argument {LOCKED[call]}" in refusal(call)


SIMULATE = "simulate --end 0.01 --samples 3 --out new.npz"
WRONG = "simulate --model 5 --out new.npz"
LOST = "tippedisk: standard output "
NO_FILE = r"tippedisk \w+: error: standard output could not be written to: "
NO_STREAM = "tippedisk show: error: argument --csv: needs standard output"

STREAMS = [
    (WRONG, ">/dev/full", 2, "tippedisk simulate: error: "),
    (WRONG, "2>/dev/full", 2, ""),
    (WRONG, "2>&-", 2, ""),
    (WAYS["run.csv"], "/dev/full", 2, "tippedisk show: error: .*: '/dev/full'$"),
    ("simulate --help", ">/dev/full", 3, LOST),
    (f"{WAYS['new.npz']} - --csv beside.csv", ">/dev/full", 3, NO_FILE),
    (f"{WAYS['run.csv']} -", ">&-", 2, NO_STREAM),
    (f"{WAYS['picture.png']} - --csv beside.csv", ">/dev/full", 3, NO_FILE),
    *((f"{WAYS[name]} -", ">/dev/full", 3, NO_FILE) for name in ("run.csv", "page.html")),
    (SIMULATE, ">/dev/full", 3, LOST),
    (SIMULATE, ">&-", 3, LOST),
    (SIMULATE, "| true; exit ${PIPESTATUS[0]}", 3, LOST),
    *((SIMULATE, streams, 0, "") for streams in ("2>/dev/full", "2>&-")),
    (f"{WAYS['page.html']} -", ">page.html 2>/dev/full", 0, ""),
]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
@pytest.mark.parametrize("case", mostly_slow(STREAMS, STREAMS[:7]), ids=str)
def test_lost_streams_are_said_in_one_line_and_hide_neither_a_run_nor_a_wrong_call(
    case: tuple[str, str, int, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # What a process prints is buffered, as it is by default.
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)
    call, streams, code, said = case
    line = f"{sys.executable} -W error -m validation {call} {streams}"
    done = subprocess.run(["/bin/bash", "-c", line], capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert re.match(said, done.stderr)
    assert done.stderr.count("\n") == bool(said)
    assert Path("beside.csv").exists() == ("beside" in call)
    if call == SIMULATE:
        assert load_run("new.npz").times.size == 3
        assert ("3 samples of Model 1" in done.stdout) == (code == 0)


def test_suffixes_are_known_in_any_case() -> None:
    save("new.npz", "RUN.NPZ")
    assert "RUN: Trajectory(" in printed("show RUN.NPZ --plot RUN.PNG")
    told = printed("animate RUN.NPZ --speed 0.01 --fps 10 --width 100 --out RUN.GIF")
    assert told.startswith("RUN.GIF: 0 to 0.01 s, 11 frames, ")
    assert ", 1 frame, " in printed("animate RUN.NPZ --end 0.001 --width 100 --out RUN.GIF")
    assert printed("animate RUN.NPZ --out RUN.HTML").endswith(" KB; open it in a browser\n")


def test_output_without_greek_letters_gets_the_table_with_replacements(
    capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = printed(SPINS)
    assert whole.startswith("Eigenvalues of Model 4 in 1/s\n")
    assert "λ" in whole
    narrow = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(narrow, encoding="ascii"))
    assert run(SPINS) == 0
    assert narrow.getvalue().decode("ascii") == whole.replace("λ", "?")
    assert capsys.readouterr().err == ""
