"""The notebooks run as they stand, without a front end, and show what comes out."""

import ast
import io
import json
import re
from contextlib import redirect_stdout
from itertools import count
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from matplotlib import pyplot as plt

from tests.calls import ROOT
from tests.helpers import mostly_slow
from tests.stated import values, words

FOLDER = ROOT / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
QUICK = [path for path in NOTEBOOKS if path.stem != "sweep"]
LARGEST = 300_000
"""Bytes of a notebook with its outputs."""


def cells(path: Path, kind: str) -> list[dict[str, Any]]:
    read = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [cell for cell in read if cell["cell_type"] == kind]


def shown(cell: dict[str, Any]) -> str:
    """Text that is stored below a cell: what is printed, and tables; of pages their title."""
    made = [each for each in cell["outputs"] if each["output_type"] != "display_data"]
    return " ".join("".join(each.get("text") or each["data"]["text/plain"]) for each in made)


def run(cell: dict[str, Any], names: dict[str, Any]) -> str:
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


@pytest.mark.parametrize("path", mostly_slow(NOTEBOOKS, QUICK), ids=lambda path: path.stem)
def test_notebook_shows_what_comes_out(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "to_xarray" in path.read_text(encoding="utf-8"):
        pytest.importorskip("xarray")
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "notebook"}
    for cell in cells(path, "code"):
        found, stored = run(cell, names), shown(cell)
        assert words(found).split() == words(stored).split()
        # Differences and error estimates are of the size of the tolerance, 1e-6.
        assert values(found) == pytest.approx(values(stored), rel=1e-3, abs=1e-6)
    plt.close("all")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_stored_as_one_run_has_left_it(path: Path) -> None:
    for number, cell in zip(count(1), cells(path, "code"), strict=False):
        assert cell["execution_count"] == number
        assert all(each["output_type"] != "error" for each in cell["outputs"])
    assert path.stat().st_size < LARGEST
    for cell in cells(path, "markdown"):
        for link in re.findall(r"\]\(([^)]+)\)", "".join(cell["source"])):
            assert (FOLDER / link).is_file(), link
