"""Shells complete commands, options and their values."""

import shutil
import subprocess

import pytest

from tests.calls import Capture, printed
from validation.parser.commands import commands

COMPLETE = """
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_tippedisk; echo "${{COMPREPLY[@]}}"
"""

OFFERED = {
    "tippedisk sim": "simulate",
    "tippedisk simulate --source e": "engine",
    "tippedisk simulate --incl": "--inclination",
    "tippedisk map spin-": "spin-friction spin-eccentricity",
    "tippedisk rest --no-bil": "--no-bilateral",
}


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize("words", OFFERED)
def test_bash_offers_what_fits(words: str, capsys: Capture) -> None:
    script = printed(capsys, "completion bash") + COMPLETE.format(words=words)
    done = subprocess.run(["/bin/bash", "-c", script], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == (f"{OFFERED[words]}\n", "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_script_of_a_shell_knows_every_command_and_is_understood(
    shell: str, capsys: Capture
) -> None:
    script = printed(capsys, "completion", shell)
    for command in commands():
        assert f" {command.name} " in script or f":{command.name}:" in script
        for action in command.parser().actions:
            assert all(name.lstrip("-") in script for name in action.option_strings)
    if (found := shutil.which(shell)) is not None:
        subprocess.run([found, "-n", "-c", script], check=True)
