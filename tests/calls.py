"""Calls of the command line, in this process and in one of its own."""

import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import pytest

from validation import cli

Capture = pytest.CaptureFixture[str]

ROOT = Path(__file__).parents[1]


class Answer(NamedTuple):
    """Exit code of a call, and what it prints."""

    code: int
    out: str
    err: str


def python(*words: str, folder: Path = ROOT, code: int = 0) -> subprocess.CompletedProcess[str]:
    """A call of Python with the project at hand, which ends with this code."""
    call, known = [sys.executable, *words], os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(call, cwd=folder, env=known, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout + done.stderr
    return done


def run(*words: str) -> int:
    """Exit code of a call; text with spaces is several words."""
    try:
        return cli.main([word for each in words for word in each.split()])
    except SystemExit as stop:
        return int(stop.code or 0)


def answer(*words: str) -> Answer:
    """Exit code of a call with what it prints."""
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as err:
        code = run(*words)
    return Answer(code, out.getvalue(), err.getvalue())


def refusal(*words: str, code: int = 2) -> str:
    """The one line in which a call is refused, with this code and nothing else said."""
    shown, command = answer(*words), words[0].partition(" ")[0]
    assert (shown.code, shown.out) == (code, "")
    assert shown.err.startswith(f"tippedisk {command}: error: ")
    assert shown.err.count("\n") == 1
    return shown.err


def printed(*words: str) -> str:
    """What a call prints that succeeds."""
    shown = answer(*words)
    assert shown.code == 0, shown.err
    return shown.out
