"""Break the code in random places and see whether the tests that mirror it fail.

    python -m tests.mutate --number 60 --seed 1 analysis/mechanics mbs_models

Each mutation is made in a copy of the project and tested by the folder of `tests` that mirrors
the file's, and if it survives these, by all quick tests, unless `--near` is given. One that
survives is either a check that is missing or a change that changes nothing; they are printed with
their places, to be looked at. The exit code is 1 above `ALLOWED`.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from validation.kit.progress import say

ROOT = Path(__file__).parents[1]

ROOMS = ("analysis", "mbs_models", *(f"validation/{each}" for each in (
    "cli.py", "commands", "kit", "maps", "page", "parser", "run.py", "study.py", "sweeps",
)))  # fmt: skip
"""Rooms that are tried by default."""

MIRRORS = {
    "validation/parser": "validation/cli",
    "validation/commands": "validation/cli",
    "validation/cli.py": "validation/cli",
    "validation/run.py": "validation/cli",
}
"""Where the tests of a room do not lie in a folder of its name."""

ALLOWED = 0.05
"""Part of the mutations that may survive."""

LIMIT = 600.0
"""Time in s after which tests count as failed: a loop without end is noticed, too."""

_OPERATORS = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.Lt: ">=",
    ast.LtE: ">",
    ast.Gt: "<=",
    ast.GtE: "<",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.In: "not in",
    ast.NotIn: "in",
    ast.Is: "is not",
    ast.IsNot: "is",
}


class Mutation(NamedTuple):
    """Text that takes the place of other text in a file."""

    path: Path
    line: int
    column: int
    end_line: int
    end_column: int
    text: str

    def applied(self, source: str) -> str:
        """The source with it; columns count bytes, as those of syntax trees do."""
        lines = [line.encode() for line in source.splitlines(keepends=True)]
        head = lines[self.line - 1][: self.column]
        tail = lines[self.end_line - 1][self.end_column :]
        lines[self.line - 1 : self.end_line] = [head + self.text.encode() + tail]
        return b"".join(lines).decode()


def mutations(path: Path) -> list[Mutation]:
    """All mutations of a file."""
    tree = ast.parse((ROOT / path).read_text("utf-8"))
    hints = {id(node) for hint in _annotations(tree) for node in ast.walk(hint)}
    found = []
    for node in ast.walk(tree):
        if id(node) in hints:
            continue
        for old, text in _replaced(node):
            place = (old.lineno, old.col_offset, old.end_lineno or 0, old.end_col_offset or 0)
            found.append(Mutation(path, *place, text))
    return found


def _annotations(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.walk(tree):
        hint = getattr(node, "annotation", None) or getattr(node, "returns", None)
        if isinstance(hint, ast.AST):
            yield hint


def _replaced(node: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """Parts of a node, and what they may become."""
    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            sides = ast.unparse(left), ast.unparse(right)
            yield node, f"(({sides[0]}) {_OPERATORS[type(op)]} ({sides[1]}))"
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _OPERATORS:
            sides = ast.unparse(left), ast.unparse(right)
            yield node, f"(({sides[0]}) {_OPERATORS[type(op)]} ({sides[1]}))"
        case ast.Constant(value=bool() as value):
            yield node, str(not value)
        case ast.Constant(value=int() | float() as value):
            yield node, repr(2 * value + 1 if abs(value) < 10 else 0.5 * value)
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield node, f"({ast.unparse(operand)})"
        case ast.If(test=test):
            yield test, f"(not ({ast.unparse(test)}))"
        case ast.Raise():
            yield node, "pass"
        case ast.BoolOp(op=op, values=values):
            other = " and " if isinstance(op, ast.Or) else " or "
            yield node, f"({other.join(f'({ast.unparse(each)})' for each in values)})"


def tests_of(path: Path) -> str:
    """Folder of the tests that mirror a file."""
    for room, mirror in MIRRORS.items():
        if path.is_relative_to(room):
            return f"tests/{mirror}"
    folder = Path("tests") / path.parent
    while not (ROOT / folder).is_dir():
        folder = folder.parent
    return str(folder)


def survives(mutation: Mutation, copy: Path, *, near: bool) -> bool:
    """Whether the tests pass with a mutation made in a copy of the project.

    `near` leaves it at those that mirror the file.
    """
    path = copy / mutation.path
    source = path.read_text("utf-8")
    path.write_text(mutation.applied(source), "utf-8")
    try:
        folders = [tests_of(mutation.path)] + ([] if near else ["tests"])
        return all(_pass(copy, folder) for folder in folders)
    finally:
        path.write_text(source, "utf-8")


def _pass(copy: Path, folder: str) -> bool:
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-n", "auto", folder]
    # Commands that tests start elsewhere are to be the copy's, too.
    surroundings = {**os.environ, "PYTHONPATH": str(copy)}
    try:
        done = subprocess.run(
            command, cwd=copy, env=surroundings, capture_output=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def _files(room: Path) -> list[Path]:
    return [room] if room.is_file() else sorted(room.rglob("*.py"))


def main(arguments: Sequence[str] | None = None) -> int:
    """Try some mutations; exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutate", description=__doc__)
    parser.add_argument("rooms", nargs="*", default=list(ROOMS), help="folders and files")
    parser.add_argument("--number", type=int, default=60, help="of mutations (60)")
    parser.add_argument("--seed", type=int, default=0, help="of their choice (0)")
    parser.add_argument("--near", action="store_true", help="run the mirroring tests alone")
    options = parser.parse_args(arguments)
    paths = [path for room in options.rooms for path in _files(ROOT / room)]
    every = [mutation for path in paths for mutation in mutations(path.relative_to(ROOT))]
    # Nothing secret hangs on them.
    chosen = random.Random(options.seed).sample(every, min(options.number, len(every)))  # noqa: S311
    alive = 0
    with TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
        for mutation in chosen:
            lives = survives(mutation, copy, near=options.near)
            alive += lives
            place = f"{mutation.path}:{mutation.line}"
            say(f"{'SURVIVES' if lives else 'dies'}: {place}: {mutation.text}")
    say(f"{alive} of {len(chosen)} mutations survive")
    return int(alive > ALLOWED * len(chosen))


if __name__ == "__main__":
    sys.exit(main())
