"""README and docs: links lead somewhere, code runs as it stands, commands are understood."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from analysis import Scenario, Start, simulate_to_rest
from validation.parser.top import parser

ROOT = Path(__file__).parent.parent
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")])
LONG = ("report", "work-precision", "robustness", "rest", "cycles", "heteroclinic", "map")
"""Subcommands of more than some seconds, which other tests run."""


def blocks(language: str) -> dict[str, str]:
    """Fenced blocks of a language by page and number."""
    found: dict[str, str] = {}
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        fenced = re.findall(r"```(\w*)\n(.*?)```", text, flags=re.DOTALL)
        assert text.count("```") == 2 * len(fenced), page
        own = [code for named, code in fenced if named == language]
        found |= {f"{page.stem} {number}": code for number, code in enumerate(own, 1)}
    return found


PYTHON, SHELL = blocks("python"), blocks("sh")
SCRIPTS = {name: code for name, code in PYTHON.items() if "__main__" in code}
COMMANDS = {
    name: [line for line in code.splitlines() if line.startswith("tippedisk ")]
    for name, code in SHELL.items()
    if "\ntippedisk " in f"\n{code}"
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_to_files_that_are_there(page: Path) -> None:
    for link in re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")):
        assert link.startswith("https://") or (page.parent / link).is_file(), link


@pytest.mark.parametrize("name", sorted(PYTHON.keys() - SCRIPTS.keys()))
def test_code_runs_as_it_stands(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(PYTHON[name], name, "exec"), {"__name__": "recipe"})  # noqa: S102
    printed = capsys.readouterr().out
    assert ("print(" in PYTHON[name]) == bool(printed)
    assert "nan" not in printed


@pytest.mark.slow
@pytest.mark.parametrize("name", SCRIPTS)
def test_script_runs_as_it_stands(name: str, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(SCRIPTS[name])
    done = subprocess.run(
        [sys.executable, "script.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_are_understood(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for line in COMMANDS[name]:
        words = shlex.split(line, comments=True)
        for word in words:
            if word.endswith((".npz", ".toml")):
                Path(word).touch()
        parser().parse_args(words[1 : words.index(">") if ">" in words else None])


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_commands_run_one_after_the_other(name: str, tmp_path: Path) -> None:
    simulate_to_rest(Scenario.rest(start=Start(spin=5.0)), 0.1).save(tmp_path / "rest.npz")
    for line in COMMANDS[name]:
        if line.split()[1] in LONG:
            continue
        call = f'"{sys.executable}" -m validation {line.removeprefix("tippedisk ")}'
        done = subprocess.run(
            ["/bin/sh", "-c", call],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
