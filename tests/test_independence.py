"""The two sides share data types, never mechanics, and load nothing they do not need."""

import ast
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from tests.calls import ROOT, python


@cache
def imported_modules(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


SHARED = {
    "mbs_models": {"problem", "motion", "solve"},
    "analysis/problem": {"problem"},
    "analysis/motion": {"problem", "motion"},
    "analysis/solve": {"problem", "motion", "solve"},
}
"""Folders of `analysis` that both sides use, by who uses them: the engine's side, and they
themselves. They hold the description of a problem and of a motion, and how any initial value
problem is solved step by step. A solver of differential equations knows no disk, so that it is no
mechanics; what it is given to solve comes from either side alone."""


@pytest.mark.parametrize("folder", SHARED)
def test_engine_side_and_what_is_shared_import_what_is_shared_only(folder: str) -> None:
    files = list((ROOT / folder).rglob("*.py"))
    assert files
    for path in files:
        for name in imported_modules(path):
            package, _, rest = name.partition(".")
            assert package != "validation", f"{path} imports {name}"
            if package == "analysis":
                assert rest.partition(".")[0] in SHARED[folder], f"{path} imports {name}"


def test_in_house_side_imports_numpy_and_scipy_only() -> None:
    known = set(sys.stdlib_module_names) | {"analysis", "numpy", "scipy"}
    for path in (ROOT / "analysis").rglob("*.py"):
        packages = {name.partition(".")[0] for name in imported_modules(path)}
        library = {"heyoka"} if path.match("simulation/compiled/library.py") else set()
        assert packages <= known | library, path


IN_HOUSE = "validation.run.run(analysis.Scenario(), [0.0, 0.01], source='in-house')"

LIGHT = ("exudyn", "matplotlib", "pandas")

ABSENT = {
    "analysis": ("exudyn", "heyoka", "matplotlib", "pandas", "xarray"),
    "mbs_models": ("matplotlib",),
    "validation.commands.stability; from validation.nonlinear import passage, tables": LIGHT,
    f"analysis, validation.run; {IN_HOUSE}": ("exudyn",),
}


@pytest.mark.parametrize("module", ABSENT)
def test_import_loads_nothing_it_does_not_need(module: str) -> None:
    named = f"[name for name in {ABSENT[module]} if name in sys.modules]"
    code = f"import sys, {module}; print({named})"
    assert python("-c", code).stdout.strip() == "[]"


def test_names_complete_before_any_of_them_is_used() -> None:
    found = python("-c", "import analysis; print(dir(analysis) == sorted(analysis.__all__))")
    assert found.stdout.strip() == "True"


def test_modules_import_each_other_in_no_circle() -> None:
    files = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): path
        for package in ("analysis", "mbs_models", "validation")
        for path in (ROOT / package).rglob("*.py")
        if path.name != "__init__.py"
    }
    graph = {
        module: {
            known
            for name in imported_modules(path)
            for known in (name, name.rpartition(".")[0])
            if known in files and known != module
        }
        for module, path in files.items()
    }
    # Raises where there is one, and names it.
    assert len(list(TopologicalSorter(graph).static_order())) == len(files)
