"""README and docs: links lead somewhere, code runs, commands are understood; what goes out."""

import doctest
import importlib
import inspect
import re
import shlex
import tomllib
from fnmatch import fnmatch
from importlib.resources import files
from pathlib import Path

import pytest

import analysis
import mbs_models
from analysis import Scenario, Start, simulate_to_rest
from tests.calls import ROOT, python
from validation.parser.commands import parsed

PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
LONG = ("report", "study", "rest", "map", "cycles", "heteroclinic", "passage")
"""Subcommands of more than some seconds, which other tests run."""


def blocks(language: str) -> dict[str, str]:
    """Fenced blocks of a language by page and number."""
    found: dict[str, str] = {}
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        fenced = re.findall(r"```([\w{}-]*)[^\n]*\n(.*?)```", text, flags=re.DOTALL)
        assert text.count("```") == 2 * len(fenced), page
        own = [code for named, code in fenced if named == language]
        found |= {f"{page.stem} {number}": code for number, code in enumerate(own, 1)}
    return found


def page_of(block: str) -> str:
    return block.rpartition(" ")[0]


def commands_by_page() -> dict[str, list[str]]:
    """Lines that call the command, of all shell blocks of a page."""
    found: dict[str, list[str]] = {}
    for block, code in blocks("sh").items():
        lines = [line for line in code.splitlines() if line.startswith("tippedisk ")]
        found.setdefault(page_of(block), []).extend(lines)
    return {page: lines for page, lines in found.items() if lines}


PYTHON, COMMANDS = blocks("python"), commands_by_page()


def reads_what_commands_wrote(block: str) -> bool:
    """Whether a block names a file that a command on its page writes."""
    lines = " ".join(COMMANDS.get(page_of(block), []))
    written = re.findall(r"(?:--out|--csv|--plot|>) (\S+)", lines)
    return any(f'"{name}"' in PYTHON[block] for name in written)


SCRIPTS = [name for name, code in PYTHON.items() if "__main__" in code]
LATER = [name for name in PYTHON if name not in SCRIPTS and reads_what_commands_wrote(name)]
ALONE = [name for name in PYTHON if name not in SCRIPTS and name not in LATER]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_to_files_that_are_there(page: Path) -> None:
    for link in re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")):
        file = page.parent / link.partition("#")[0]
        assert link.startswith("https://") or file.exists(), link


def test_every_public_name_has_a_task_and_every_page_a_place_in_the_contents() -> None:
    docs = ROOT / "docs"
    tasks, contents = (
        (docs / name).read_text(encoding="utf-8") for name in ("api.md", "index.md")
    )
    for package in (analysis, mbs_models):
        listed = re.findall(rf"^   {package.__name__}\.(\w+)$", tasks, re.MULTILINE)
        assert sorted(listed) == sorted(package.__all__)
    for module, name in re.findall(r"^   ((?:\w+\.){2,})(\w+)$", tasks, re.MULTILINE):
        assert hasattr(importlib.import_module(module[:-1]), name), f"{module}{name}"
    places = re.findall(r"^[\w/*-]+$", contents, re.MULTILINE)
    pages = [str(page.relative_to(docs).with_suffix("")) for page in docs.rglob("*.md")]
    assert {page for page in pages if not any(fnmatch(page, each) for each in places)} == {"index"}


@pytest.mark.parametrize("name", ALONE)
def test_code_runs_as_it_stands(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if "taylor" in PYTHON[name]:
        pytest.importorskip("heyoka")
    monkeypatch.chdir(tmp_path)
    exec(compile(PYTHON[name], name, "exec"), {"__name__": "recipe"})  # noqa: S102
    printed = capsys.readouterr().out
    assert ("print(" in PYTHON[name]) == bool(printed)
    assert "nan" not in printed


@pytest.mark.slow
@pytest.mark.parametrize("name", SCRIPTS)
def test_script_runs_as_it_stands(name: str, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(PYTHON[name])
    printed = python("script.py", folder=tmp_path).stdout
    assert ("print(" in PYTHON[name]) == bool(printed)


@pytest.mark.parametrize("page", COMMANDS)
def test_commands_are_understood(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for line in COMMANDS[page]:
        words = shlex.split(line, comments=True)
        for word in words:
            if word.endswith((".npz", ".toml")):
                Path(word).touch()
        parsed(words[1 : words.index(">") if ">" in words else None])


@pytest.mark.slow
@pytest.mark.parametrize("page", COMMANDS)
def test_commands_and_what_reads_their_files_run_in_turn(page: str, tmp_path: Path) -> None:
    simulate_to_rest(Scenario.rest(start=Start(spin=5.0)), 0.1).save(tmp_path / "rest.npz")
    for line in COMMANDS[page]:
        words = shlex.split(line, comments=True)[1:]
        if words[0] in LONG:
            continue
        *call, file = words if ">" in words else (*words, ">", "printed.txt")
        printed = python("-m", "validation", *call[:-1], folder=tmp_path).stdout
        (tmp_path / file).write_text(printed)
    for block in LATER:
        if page_of(block) == page:
            python("-c", PYTHON[block], folder=tmp_path)


FUNCTIONS = {
    f"{package.__name__}.{name}": found
    for package in (analysis, mbs_models)
    for name in package.__all__
    if inspect.isfunction(found := getattr(package, name))
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_public_function_has_an_example(name: str) -> None:
    assert doctest.DocTestParser().get_examples(FUNCTIONS[name].__doc__ or "")


def test_newest_release_is_the_version_that_is_built_and_cited() -> None:
    built = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    cited = dict(re.findall(r"^([\w-]+): (.*)$", citation, re.MULTILINE))
    newest = re.findall(r"^## \[(\d.*)\] - (.*)$", changes, re.MULTILINE)[0]
    assert newest == (built["version"], cited["date-released"])
    assert (cited["version"], cited["license"]) == (built["version"], built["license"])


@pytest.mark.parametrize("package", ["analysis", "mbs_models", "validation"])
def test_type_checkers_find_the_annotations(package: str) -> None:
    assert files(package).joinpath("py.typed").is_file()
