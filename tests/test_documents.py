"""README, docs and notebooks: links, code, commands and numbers are right; what goes out."""

import ast
import doctest
import importlib
import inspect
import io
import json
import re
import shlex
import tomllib
from contextlib import redirect_stdout
from fnmatch import fnmatch
from importlib.resources import files
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from matplotlib import pyplot as plt

import analysis
import mbs_models
from analysis import Scenario, Start, simulate_to_rest
from tests.calls import ROOT, python
from tests.helpers import mostly_slow
from tests.stated import chapter, missing, numbers, rows_below, stands, values, words
from validation.parser.commands import parsed
from validation.studies.robustness import section as robustness
from validation.studies.robustness.outcomes import CASES, explained
from validation.study import load

PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
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


def cells(path: Path, kind: str) -> list[dict[str, Any]]:
    """Cells of a kind of a notebook."""
    read = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in read if cell["cell_type"] == kind]


@pytest.mark.parametrize("page", [*PAGES, *NOTEBOOKS], ids=lambda page: page.stem)
def test_links_lead_to_files_that_are_there(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    if page in NOTEBOOKS:
        text = "".join(line for cell in cells(page, "markdown") for line in cell["source"])
    for link in re.findall(r"\]\(([^)]+)\)", text):
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


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("name", ALONE)
def test_code_runs_as_it_stands(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    if "taylor" in PYTHON[name]:
        pytest.importorskip("heyoka")
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


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("page", COMMANDS)
def test_commands_are_understood(page: str) -> None:
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


def test_newest_release_is_cited_and_what_is_built_is_that_or_the_next_one_to_be() -> None:
    built = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    cited = dict(re.findall(r"^([\w-]+): (.*)$", citation, re.MULTILINE))
    newest = re.findall(r"^## \[(\d.*)\] - (.*)$", changes, re.MULTILINE)[0]
    assert newest == (cited["version"], cited["date-released"])
    assert cited["license"] == built["license"]
    is_next = "## [Unreleased]\n\n#" in changes and built["version"].endswith(".dev0")
    assert built["version"] == newest[0] or is_next


@pytest.mark.parametrize("package", ["analysis", "mbs_models", "validation"])
def test_type_checkers_find_the_annotations(package: str) -> None:
    assert files(package).joinpath("py.typed").is_file()


# --- Notebooks -----------------------------------------------------------------------------------

LARGEST = 300_000
"""Bytes of a notebook with its outputs."""


def shown(cell: dict[str, Any]) -> str:
    """Text that is stored below a cell: what is printed, and tables; of pages their title."""
    made = [each for each in cell["outputs"] if each["output_type"] != "display_data"]
    return " ".join("".join(each.get("text") or each["data"]["text/plain"]) for each in made)


def run_cell(cell: dict[str, Any], names: dict[str, Any]) -> str:
    """What a cell prints, and its last expression, as a front end shows it."""
    source = "".join(cell["source"])
    tree = ast.parse(source)
    last = tree.body[-1]
    printed = io.StringIO()
    with redirect_stdout(printed):
        if isinstance(last, ast.Expr) and not source.endswith(";"):
            exec(compile(ast.Module(tree.body[:-1], []), "cell", "exec"), names)  # noqa: S102
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)  # noqa: S307
            printed.write("" if value is None else repr(value))
        else:
            exec(compile(tree, "cell", "exec"), names)  # noqa: S102
    return printed.getvalue()


@pytest.mark.parametrize("path", mostly_slow(NOTEBOOKS, NOTEBOOKS[:2]), ids=lambda path: path.stem)
def test_notebook_shows_what_comes_out_of_one_run(path: Path, folder: Path) -> None:
    if "to_xarray" in path.read_text(encoding="utf-8"):
        pytest.importorskip("xarray")
    mpl.use("Agg")
    names: dict[str, Any] = {"__name__": "notebook"}
    for number, cell in enumerate(cells(path, "code"), 1):
        assert cell["execution_count"] == number
        found, stored = run_cell(cell, names), shown(cell)
        assert words(found).split() == words(stored).split()
        # Differences and error estimates are of the size of the tolerance, 1e-6.
        assert values(found) == pytest.approx(values(stored), rel=1e-3, abs=1e-6)
    plt.close("all")
    assert not list(folder.iterdir())
    assert path.stat().st_size < LARGEST


# --- Stated numbers ------------------------------------------------------------------------------

README = (ROOT / "README.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
SAID = " ".join(README.split())

AGREEMENT = "| compared | over | largest difference |"


SHOWN = chapter(README, "What it shows").partition("\n\n[All")[0].replace("\n- ", " ")
STATED = [
    *(each for each in re.split(r"\.\s+(?=[A-Z])", SHOWN) if numbers(each)),
    *(row[-1] for row in rows_below(README, AGREEMENT) if "SymPy" not in row[0]),
    SAID.partition("come out more accurate than asked")[2].partition("since their")[0],
]
FOUND = [values(part) for part in re.split(r"\n- |\n\n", RESULTS)]
"""Numbers of each verdict, paragraph and table: in all of them together, most short numbers stand
somewhere."""


@pytest.mark.parametrize("said", STATED)
def test_what_the_readme_shows_stands_in_one_part_of_all_results(said: str) -> None:
    assert any(not missing(said, found) for found in FOUND)


def test_differences_in_the_runs_of_the_figures_are_the_largest_of_their_table() -> None:
    (head,) = (line for line in RESULTS.splitlines() if "| normal force apart in N |" in line)
    runs = rows_below(RESULTS, head)
    named = [name.strip() for name in head.strip("|").split("|")]
    (said,) = (row[-1] for row in rows_below(README, AGREEMENT) if "paper's figures" in row[0])
    for column, stated in zip(("β and γ apart", "normal force apart"), numbers(said), strict=True):
        place = next(at for at, name in enumerate(named) if name.startswith(column))
        assert stands(stated, [max(float(row[place]) for row in runs)]), column


def test_number_stands_to_the_digits_it_is_stated_with_or_if_it_is_small_to_its_size() -> None:
    right = (("0.9", 0.8812), ("−3", -3.0), ("5e-9", 3.2e-9))
    wrong = (("0.88", 0.8912), ("8e-5", 8.6e-5), ("5e-9", 8.0e-9), ("5e-9", 5.0e-10))
    assert all(stands(stated, [found]) for stated, found in right)
    assert not any(stands(stated, [found]) for stated, found in wrong)


def test_numbers_are_told_from_names() -> None:
    text = "Model 1, λ₃ at 30.92 rad/s to 1e-7, index-1, v2.0, −0.5 and 3."
    assert numbers(text) == ["30.92", "1e-7", "−0.5", "3"]


def test_hard_cases_are_those_of_the_stored_study() -> None:
    found = robustness.case_numbers(explained(load(CASES)))
    assert f"Of {found['total']} stiff and extreme cases" in SAID
    assert f"{found['without']} of the {found['total']} extreme cases" in SAID
    assert not found["broken"]
