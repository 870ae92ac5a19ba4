"""Which code results come from, told by what it does and not by how it reads."""

import ast
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.util import find_spec, resolve_name
from pathlib import Path
from site import getsitepackages
from sysconfig import get_paths

PROJECT = ("analysis", "mbs_models", "validation")
"""Packages of the project."""

MECHANICS = PROJECT[:2]
"""Those that every result is taken to come from, whole."""


_INSTALLED = (*(get_paths()[each] for each in ("stdlib", "platstdlib")), *getsitepackages())
"""Folders of what is installed."""


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


@cache
def behind(module: str) -> str:
    """Digest of the code behind the results of functions in a module, as it is asked for first.

    That of the mechanics, of the module, and of all it imports of this project, at whatever
    place.

    Parameters
    ----------
    module : str
    """
    files = _reached([module], lambda top: top in {*PROJECT, "tests"} - {*MECHANICS})
    return digest([*(Path(__file__).parents[2] / name for name in MECHANICS), *files])


def own_files(names: Iterable[str]) -> list[Path]:
    """Files of imported modules of a user's own, and of what they import that is not installed."""

    def is_own(top: str) -> bool:
        file = None if top in PROJECT else _file(top)
        return file is not None and not any(file.is_relative_to(each) for each in _INSTALLED)

    return _reached(names, is_own)


def _reached(names: Iterable[str], follows: Callable[[str], bool]) -> list[Path]:
    """Files of modules and of all that they import, of packages that are followed."""
    known, found, waiting = set[str](), list[Path](), [*names]
    while waiting:
        name = waiting.pop()
        if name not in known and follows(name.partition(".")[0]):
            known.add(name)
            if (file := _file(name)) is not None:
                found.append(file)
                package = name if file.name == "__init__.py" else name.rpartition(".")[0]
                waiting += _imports(ast.parse(file.read_bytes()), package)
    return sorted(found)


def _imports(tree: ast.Module, package: str) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            place = "." * node.level + (node.module or "")
            if node.level:
                place = resolve_name(place, package)
            yield place
            # What is imported from a package may be a module.
            yield from (f"{place}.{each.name}" for each in node.names)


@cache
def _file(module: str) -> Path | None:
    """File of a module; None if it has none that can be read."""
    place = getattr(sys.modules.get(module), "__file__", None)
    if place is None:
        # Where the parent is a module and no package, what follows it is a name.
        with suppress(ImportError, ValueError):
            place = getattr(find_spec(module), "origin", None)
    return Path(place) if place is not None and place.endswith(".py") else None


@cache
def _text(path: Path, _changed: int) -> str:
    return ast.dump(_Undocumented().visit(ast.parse(path.read_bytes())))


class _Undocumented(ast.NodeTransformer):
    """Takes docstrings away, those behind constants as well."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        return None if isinstance(node.value, ast.Constant) else node
