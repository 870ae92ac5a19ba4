"""Where the numbers and the picture of a command go."""

import json as text_of
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from validation.kit.tables import Table
from validation.parser.paths import PICTURES, file, writable

CsvOut = Annotated[Path | None, file(writable(".csv"))]
PictureOut = Annotated[Path | None, file(writable(*PICTURES), "PICTURE")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What a command has found.

    Parameters
    ----------
    tables : sequence of Table
        Printed, unless the numbers go elsewhere.
    values
        What JSON knows, or a function that makes it; by default the rows of the first table.
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

    def deliver(self, *, json: bool = False, csv: CsvOut = None, plot: PictureOut = None) -> int:
        """Store, draw and print what is asked for; returns the exit code.

        Parameters
        ----------
        json : bool
            Print everything as JSON in place of the table.
        csv : Path, optional
            Write the table with all digits, .csv or -.
        plot : Path, optional
            Draw it, .png, .svg, .pdf or -.
        """
        if csv is not None:
            (self.csv or partial(write, self.tables[0]))(csv)
        if plot is not None and self.draw is not None:
            save(self.draw(), plot)
        if json:
            values = self.values() if callable(self.values) else self.values
            print(text_of.dumps(self.tables[0].records() if values is None else values))
            return self.code
        for line in (*map(_text, self.tables if csv is None else ()), *self.notes):
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
    from analysis.motion.files import write_whole

    write_whole(path, table.to_csv())


def save(figure: Any, path: Path) -> None:
    """Write a figure in the format that its file's name ends in; a pipe gets a PNG."""
    from analysis.motion.files import whole_file

    suffix = path.suffix.lower()
    kind = suffix if suffix in PICTURES else PICTURES[0]
    with whole_file(path) as stream:
        figure.savefig(stream, format=kind[1:], dpi=150)


def pictured(runs: Sequence[tuple[str, Any]], axes: Any = None) -> Any:
    """Figure of labelled motions over each other, for which Matplotlib is loaded."""
    from validation.kit import figures

    return figures.comparison(runs, axes)
