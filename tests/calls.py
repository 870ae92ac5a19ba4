"""Calls of the command line, in this process and in one of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from validation import cli

Capture = pytest.CaptureFixture[str]

ROOT = Path(__file__).parents[1]


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


def refusal(capsys: Capture, *words: str, code: int = 2) -> str:
    """The one line in which a call is refused, with this code and nothing else said."""
    assert run(*words) == code
    shown = capsys.readouterr()
    assert shown.out == ""
    command = words[0].partition(" ")[0]
    assert shown.err.startswith(f"tippedisk {command}: error: ")
    assert shown.err.count("\n") == 1
    return shown.err


def printed(capsys: Capture, *words: str) -> str:
    """What a call prints that succeeds."""
    assert run(*words) == 0
    return capsys.readouterr().out
