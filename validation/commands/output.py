"""Where the numbers and the picture of a command go."""

import argparse
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from validation.kit.tables import Table
from validation.parser.paths import PICTURES


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What a command has found.

    Parameters
    ----------
    tables : sequence of Table
        Printed, unless the numbers go elsewhere.
    values
        What JSON knows; by default the rows of the first table.
    csv : callable, optional
        Writes the table of the file to a path; by default that is the first table.
    draw : callable, optional
        Makes the figure.
    notes : sequence of str
        Lines that are printed in any case, beside a file that takes standard output.
    code : int
        Exit code: 1 if a check fails.
    """

    tables: Sequence[Table] = ()
    values: Any = None
    csv: Callable[[Path], object] | None = None
    draw: Callable[[], Any] | None = None
    notes: Sequence[str] = ()
    code: int = 0

    def deliver(self, options: argparse.Namespace) -> int:
        """Store, draw and print what is asked for; returns the exit code."""
        given = vars(options)
        if (path := given.get("csv")) is not None:
            (self.csv or partial(write, self.tables[0]))(path)
        if (path := given.get("plot")) is not None and self.draw is not None:
            save(self.draw(), path)
        if given.get("json"):
            print(json.dumps(self.tables[0].records() if self.values is None else self.values))
            return self.code
        tables = self.tables if given.get("csv") is None else ()
        for line in (*map(_text, tables), *self.notes):
            print(line)
        return self.code


def _text(table: Table) -> str:
    parts = (table.title, table.to_text() if table.rows else "none", table.note)
    return "\n".join(part for part in parts if part) + "\n"


def name_of(path: Path) -> str:
    """Name of a file without its suffix, with a mark in place of what cannot be shown."""
    name = os.fsencode(path.stem).decode("utf-8", "replace")
    return "".join(each if each.isprintable() else "\N{REPLACEMENT CHARACTER}" for each in name)


def write(table: Table, path: Path) -> None:
    """Write a table as comma-separated text with all digits."""
    with whole_file(path) as stream:
        stream.write(table.to_csv().encode())


def save(figure: Any, path: Path) -> None:
    """Write a figure in the format that its file's name ends in; a pipe gets a PNG."""
    suffix = path.suffix.lower()
    kind = suffix if suffix in PICTURES else PICTURES[0]
    with whole_file(path) as stream:
        figure.savefig(stream, format=kind[1:], dpi=150)
