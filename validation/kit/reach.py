"""What a function depends on, read from the sources: every definition it can reach by name.

A function is followed through the names it and its callees, classes and constants mention,
across the modules of this project, and no further: other packages count by their versions. Text
that says what a result means changes no result, so docstrings do not count, and a change in a
caption or a figure leaves the runs beside it as they are.
"""

import ast
import hashlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

PROJECT = ("analysis", "mbs_models", "validation")
"""Packages that are followed."""

_DATA = (".csv", ".json", ".toml")
"""Suffixes of files beside a module that it may read."""

Name = tuple[str, str]
"""Module and name in it."""


@dataclass(frozen=True, slots=True)
class _Module:
    """A module taken apart.

    Parameters
    ----------
    definitions : dict
        Statements at its top level that define a name.
    imports : dict
        Where an imported name comes from: a module, or a module and a name in it.
    effects : list
        Statements at its top level that define nothing.
    data : list of Path
        Files in its folder that it may read.
    """

    definitions: dict[str, list[ast.stmt]] = field(default_factory=dict)
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)
    effects: list[ast.stmt] = field(default_factory=list)
    data: list[Path] = field(default_factory=list)


def fingerprint(seeds: Iterable[Callable[..., Any]]) -> str:
    """Hash of all definitions that functions and classes can reach.

    Parameters
    ----------
    seeds : iterable of callable
        Defined at the top level of a module; those of other packages than `PROJECT` count for
        nothing.

    Returns
    -------
    str
        Hexadecimal digest.
    """
    names = {(seed.__module__, seed.__qualname__.partition(".")[0]) for seed in seeds}
    digest = hashlib.sha256()
    reached = sorted(reach(names))
    for module, name in reached:
        digest.update(f"{module}.{name}={_text(module, name)};".encode())
    for module in sorted({module for module, _ in reached}):
        digest.update(_surroundings(module))
    return digest.hexdigest()


def by_module(seeds: Iterable[Callable[..., Any]]) -> dict[str, str]:
    """Short hash of what functions and classes can reach in each module, by its name.

    Parameters
    ----------
    seeds : iterable of callable
        As in `fingerprint`; data beside a module do not count here.
    """
    names = {(seed.__module__, seed.__qualname__.partition(".")[0]) for seed in seeds}
    digests: dict[str, Any] = {}
    for module, name in sorted(reach(names)):
        digest = digests.setdefault(module, hashlib.sha256())
        digest.update(f"{name}={_text(module, name)};".encode())
    return {module: digest.hexdigest()[:8] for module, digest in digests.items()}


def reach(seeds: Iterable[Name]) -> set[Name]:
    """All definitions that can be reached from some, each as module and name."""
    found: set[Name] = set()
    waiting = [name for seed in seeds for name in _resolve(*seed)]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += _mentioned(*name)
    return found


@cache
def _mentioned(module: str, name: str) -> frozenset[Name]:
    """Definitions that one definition, or its module on import, mentions."""
    taken = _take_apart(module)
    statements = [*taken.definitions[name], *taken.effects]
    return frozenset(each for node in statements for each in _names(module, node))


def _names(module: str, node: ast.AST, hidden: frozenset[str] = frozenset()) -> Iterator[Name]:
    """Definitions a node mentions, less what the arguments of a function around it hide."""
    match node:
        case ast.Attribute(value=ast.Name(id=base), attr=attribute) if base not in hidden:
            where, name = _take_apart(module).imports.get(base, ("", ""))
            if where and not name:
                # A name of an imported module.
                yield from _resolve(where, attribute)
            else:
                yield from _resolve(module, base)
        case ast.Name(id=name) if name not in hidden:
            yield from _resolve(module, name)
        case ast.FunctionDef() | ast.Lambda():
            own = frozenset(each.arg for each in ast.walk(node.args) if isinstance(each, ast.arg))
            for child in ast.iter_child_nodes(node):
                outside = isinstance(child, ast.arguments)
                yield from _names(module, child, hidden if outside else hidden | own)
        case _:
            for child in ast.iter_child_nodes(node):
                yield from _names(module, child, hidden)


def _resolve(module: str, name: str) -> Iterator[Name]:
    """Where a name that a module knows is defined; nothing for built-in and foreign names."""
    taken = _take_apart(module)
    if name in taken.definitions:
        yield module, name
    elif name in taken.imports:
        where, there = taken.imports[name]
        if there:
            yield from _resolve(where, there)
        else:
            # A module as a whole, which may be asked for anything.
            yield from ((where, each) for each in _take_apart(where).definitions)


@cache
def _take_apart(module: str) -> _Module:
    found = _Module()
    path = _source(module)
    if path is None:
        return found
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for statement in tree.body:
        names = list(_defined(statement))
        for name in names:
            found.definitions.setdefault(name, []).append(statement)
        if not names and not isinstance(statement, ast.Import | ast.ImportFrom):
            found.effects.append(statement)
    found.imports.update(_imports(tree))
    found.data.extend(sorted(each for each in path.parent.iterdir() if each.suffix in _DATA))
    return found


def _imports(tree: ast.Module) -> Iterator[tuple[str, tuple[str, str]]]:
    # Also those inside functions, which put off what is slow to import.
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if _source(alias.name) is not None:
                    yield alias.asname or alias.name.partition(".")[0], (alias.name, "")
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            for alias in node.names:
                yield alias.asname or alias.name, _imported(node.module, alias.name)


def _imported(module: str, name: str) -> tuple[str, str]:
    inner = f"{module}.{name}"
    return (inner, "") if _source(inner) is not None else (module, name)


def _defined(statement: ast.stmt) -> Iterator[str]:
    """Names that a statement at the top level defines."""
    match statement:
        case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
            yield name
        case ast.Assign(targets=targets):
            for target in targets:
                yield from (each.id for each in ast.walk(target) if isinstance(each, ast.Name))
        case ast.AnnAssign(target=ast.Name(id=name)) | ast.AugAssign(target=ast.Name(id=name)):
            yield name
        case _:
            pass


@cache
def _source(module: str) -> Path | None:
    """File of a module of the project; None for anything else."""
    if module.partition(".")[0] not in PROJECT:
        return None
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        # The parent is a module and no package: what follows it is a name.
        return None
    return None if spec is None or spec.origin is None else Path(spec.origin)


@cache
def _text(module: str, name: str) -> str:
    """Definitions of a name, without docstrings, comments and layout."""
    return ";".join(_bare(statement) for statement in _take_apart(module).definitions[name])


def _bare(statement: ast.stmt) -> str:
    for node in ast.walk(statement):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            body[:] = [each for each in body if not _is_text(each)]
    return ast.dump(statement)


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


@cache
def _surroundings(module: str) -> bytes:
    """What a module and the packages around it do on import, and the data beside it."""
    digest = hashlib.sha256()
    parts = module.split(".")
    for length in range(1, len(parts) + 1):
        for statement in _take_apart(".".join(parts[:length])).effects:
            if not _is_text(statement):
                digest.update(ast.dump(statement).encode())
    for path in _take_apart(module).data:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.digest()


@cache
def all_code() -> str:
    """Hash of all modules of the project and the data beside them."""
    digest = hashlib.sha256()
    for package in PROJECT:
        top = _source(package)
        folder = Path() if top is None else top.parent
        for path in sorted(folder.rglob("*")):
            if path.suffix in {".py", *_DATA}:
                digest.update(str(path.relative_to(folder)).encode() + path.read_bytes())
    return digest.hexdigest()
