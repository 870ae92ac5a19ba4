"""Which code results come from, told by what it does and not by how it reads."""

import ast
from collections.abc import Iterable, Iterator
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

PROJECT = ("analysis", "mbs_models", "validation")
"""Packages of the project."""

MECHANICS = PROJECT[:2]
"""Those that every result is taken to come from, whole."""


def digest(paths: Iterable[Path]) -> str:
    """Digest of Python files that comments, docstrings and layout leave as it is.

    It depends on the version of Python, whose syntax trees differ.

    Parameters
    ----------
    paths : iterable of Path
        Files, and folders whose modules all count. Names do, too, but not where they lie.

    Raises
    ------
    OSError, SyntaxError
        If a file cannot be read.
    """
    found = sha256()
    for path in paths:
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        for file in files:
            name = file.relative_to(path.parent).as_posix()
            found.update(f"{name}\0{_text(file, file.stat().st_mtime_ns)}\0".encode())
    return found.hexdigest()[:16]


def behind(module: str) -> str:
    """Digest of the code behind the results of functions in a module.

    That of the mechanics, of the module, and of all it imports of this project, at whatever
    place.

    Parameters
    ----------
    module : str
    """
    files = [file for name in sorted(modules(module)) if (file := _file(name)) is not None]
    return digest([*(Path(__file__).parents[2] / name for name in MECHANICS), *files])


@cache
def modules(module: str) -> frozenset[str]:
    """A module and all that it imports of this project, beside the mechanics."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        file = _file(name)
        if file is not None and name not in found and name.partition(".")[0] not in MECHANICS:
            found.add(name)
            waiting += _imports(ast.parse(file.read_bytes()))
    return frozenset(found)


def _imports(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield node.module
            # What is imported from a package may be a module.
            yield from (f"{node.module}.{each.name}" for each in node.names)


@cache
def _file(module: str) -> Path | None:
    """File of a module of the project or its tests; None for anything else."""
    if module.partition(".")[0] not in (*PROJECT, "tests"):
        return None
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        # The parent is a module and no package: what follows it is a name.
        return None
    return None if spec is None or spec.origin is None else Path(spec.origin)


@cache
def _text(path: Path, _changed: int) -> str:
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            del node.body[0]
    return ast.dump(tree)
