"""Break the code in random places and see whether the tests that mirror it fail.

    python -m tests.mutate --number 60 --seed 1 analysis/mechanics mbs_models

Each mutation is made in a copy of the project and tested by the folder of `tests` that mirrors
the file's, and if it survives these, by all quick tests and the folder's slow ones, unless
`--near` is given. One that survives is either a check that is missing or a change that changes
nothing; they are printed with their places, to be looked at. The exit code is 1 above `ALLOWED`.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pytest

from tests.calls import ROOT
from validation.display.progress import say

ROOMS = ("analysis", "mbs_models", *(f"validation/{each}" for each in (
    "animation", "cli.py", "commands", "comparison", "display", "maps", "measurement", "page",
    "parser", "run.py", "study.py", "sweeps",
)))  # fmt: skip
"""Rooms that are tried by default."""

ALLOWED = 0.05
"""Part of the mutations that may survive."""

LIMIT = 600.0
"""Time in s after which quick tests count as failed: a loop without end is noticed, too."""

_PAIRS = (
    (ast.Add, ast.Sub),
    (ast.Mult, ast.Div),
    (ast.Lt, ast.GtE),
    (ast.LtE, ast.Gt),
    (ast.Eq, ast.NotEq),
    (ast.In, ast.NotIn),
    (ast.Is, ast.IsNot),
    (ast.And, ast.Or),
)
_OTHER: dict[Any, Any] = {**dict(_PAIRS), **{other: one for one, other in _PAIRS}}


def changed(node: ast.AST) -> ast.AST | None:  # noqa: PLR0911 # one for each kind
    """What a node may become, None if it stays."""
    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OTHER:
            return ast.BinOp(left, _OTHER[type(op)](), right)
        case ast.Compare(left=left, ops=[op], comparators=right) if type(op) in _OTHER:
            return ast.Compare(left, [_OTHER[type(op)]()], right)
        case ast.BoolOp(op=op, values=values):
            return ast.BoolOp(_OTHER[type(op)](), values)
        case ast.Constant(value=bool() as value):
            return ast.Constant(not value)
        case ast.Constant(value=int() | float() as value):
            return ast.Constant(2 * value + 1 if abs(value) < 10 else 0.5 * value)
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            return operand
        case ast.If(test=test, body=body, orelse=orelse):
            return ast.If(ast.UnaryOp(ast.Not(), test), body, orelse)
        case ast.Raise():
            return ast.Pass()
    return None


def places(source: str) -> tuple[ast.Module, list[Any]]:
    """Tree of a source, and its nodes that may become something else.

    Left out are annotations, options of decorators, which say how Python keeps an object, whether
    a zip is strict, which matters where lengths differ, what fills in the text of an error, how
    many cores a machine has that does not tell, and numbers in a file that draws: where things
    stand in a picture and how large they are is looked at.
    """
    tree = ast.parse(source)
    left_out: set[ast.AST] = set()
    for node in ast.walk(tree):
        for name in ("annotation", "returns"):
            if isinstance(hint := getattr(node, name, None), ast.AST):
                left_out |= set(ast.walk(hint))
        for decorator in getattr(node, "decorator_list", []):
            left_out |= set(ast.walk(decorator))
        if isinstance(node, ast.keyword) and node.arg == "strict":
            left_out.add(node.value)
        if isinstance(node, ast.BoolOp) and "cpu_count()" in ast.unparse(node):
            left_out |= set(ast.walk(node))
        if isinstance(node, ast.Raise):
            texts = (part for part in ast.walk(node) if isinstance(part, ast.JoinedStr))
            left_out |= {part for text in texts for part in ast.walk(text)}
        if isinstance(node, ast.Constant | ast.UnaryOp) and "from matplotlib" in source:
            left_out.add(node)
    every = ast.walk(tree)
    return tree, [node for node in every if node not in left_out and changed(node) is not None]


class Change(ast.NodeTransformer):
    """Change of one node of a tree."""

    def __init__(self, place: ast.AST) -> None:
        self.place = place

    def visit(self, node: ast.AST) -> Any:
        """The node itself, or what it becomes."""
        return changed(node) if node is self.place else self.generic_visit(node)


class Mutation(NamedTuple):
    """Change of the place of this number in a file."""

    path: Path
    number: int

    def applied(self, source: str) -> tuple[str, str]:
        """The source with it, and what it is."""
        tree, found = places(source)
        place = found[self.number]
        line, before = place.lineno, ast.unparse(place).partition("\n")[0]
        tree = ast.fix_missing_locations(Change(place).visit(tree))
        return ast.unparse(tree), f"{self.path}:{line}: {type(place).__name__} {before}"


def tests_of(path: Path) -> str:
    """Folder of the tests that mirror a file, or of those around it."""
    mirror = Path("tests") / path.parent
    return next(str(each) for each in (mirror, *mirror.parents) if (ROOT / each).is_dir())


def survives(mutation: Mutation, copy: Path, *, near: bool) -> bool:
    """Whether the tests pass with a mutation made in a copy of the project.

    `near` leaves it at those that mirror the file.
    """
    path = copy / mutation.path
    source = path.read_text("utf-8")
    text, told = mutation.applied(source)
    path.write_text(text, "utf-8")
    try:
        mirror = tests_of(mutation.path)
        calls = [[mirror], ["tests"], [mirror, "-m", "slow"]]
        lives = all(_pass(copy, words) for words in calls[: 1 if near else None])
    finally:
        path.write_text(source, "utf-8")
    say(f"{'SURVIVES' if lives else 'dies'}: {told}")
    return lives


def _pass(copy: Path, words: list[str]) -> bool:
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-n", "auto", *words]
    # Commands that tests start elsewhere are to be the copy's, too.
    surroundings = {**os.environ, "PYTHONPATH": str(copy)}
    try:
        done = subprocess.run(
            command, cwd=copy, env=surroundings, capture_output=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        # Slow tests take long anyway.
        return "slow" in words
    return done.returncode in {pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED}


def main() -> int:
    """Try some mutations; exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutate", description=__doc__)
    parser.add_argument("rooms", nargs="*", default=list(ROOMS), help="folders and files")
    parser.add_argument("--number", type=int, default=60, help="of mutations (60)")
    parser.add_argument("--seed", type=int, default=0, help="of their choice (0)")
    parser.add_argument("--near", action="store_true", help="run the mirroring tests alone")
    options = parser.parse_args()
    every = [
        Mutation(path.relative_to(ROOT), number)
        for room in options.rooms
        for path in sorted((ROOT / room).rglob("*.py")) or [ROOT / room]
        for number in range(len(places(path.read_text("utf-8"))[1]))
    ]
    # Nothing secret hangs on them.
    chosen = random.Random(options.seed).sample(every, min(options.number, len(every)))  # noqa: S311
    with TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
        alive = sum(survives(mutation, copy, near=options.near) for mutation in chosen)
    say(f"{alive} of {len(chosen)} mutations survive")
    return int(alive > ALLOWED * len(chosen))


if __name__ == "__main__":
    sys.exit(main())
