"""Shells complete commands, options and their values."""

import shutil
import subprocess

import pytest

from tests.calls import printed
from validation.parser.commands import COMMANDS, SHELLS

COMPLETE = """
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_tippedisk; echo "${{COMPREPLY[@]}}"
"""


BASH = shutil.which("bash")


@pytest.mark.skipif(BASH is None, reason="needs bash")
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("tippedisk sim", "simulate"),
        ("tippedisk simulate --source e", "engine"),
        ("tippedisk simulate --incl", "--inclination"),
        ("tippedisk simulate --csv ''", ""),
        ("tippedisk map spin-", "spin-friction spin-eccentricity"),
        ("tippedisk rest --no-bil", "--no-bilateral"),
    ],
)
def test_bash_offers_what_fits(
    words: str, offered: str, capsys: pytest.CaptureFixture[str]
) -> None:
    script = printed(capsys, "completion bash") + COMPLETE.format(words=words)
    done = subprocess.run([str(BASH), "-c", script], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == (f"{offered}\n", "")


@pytest.mark.parametrize("shell", SHELLS)
def test_script_of_a_shell_knows_every_command_and_is_understood(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    script = printed(capsys, "completion", shell)
    for command in COMMANDS:
        assert f" {command.name} " in script or f":{command.name}:" in script
        for action in command.parser().actions:
            assert all(name.lstrip("-") in script for name in action.option_strings)
    if (found := shutil.which(shell)) is not None:
        subprocess.run([found, "-n", "-c", script], check=True)
