"""Which code results come from, told by what it does and not by how it reads."""

import ast
from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from pathlib import Path


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
            found.update(f"{name}\0{_tree(file, file.stat().st_mtime_ns)}\0".encode())
    return found.hexdigest()[:16]


@cache
def _tree(path: Path, _changed: int) -> str:
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            del node.body[0]
    return ast.dump(tree)
