"""Where the numbers and the picture of a subcommand go."""

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from validation.kit.tables import Table
from validation.parser.paths import PICTURES


def as_text(options: argparse.Namespace) -> bool:
    """Whether the numbers are printed as tables: nothing else is asked for."""
    return not options.json and options.csv is None and options.plot is None


def deliver(
    options: argparse.Namespace, shown: Sequence[Table], values: Any, *, stored: int = 0
) -> None:
    """Store a table and print the values, or all tables if nothing else is asked for.

    Parameters
    ----------
    options : argparse.Namespace
        `csv`, `json` and `plot`.
    shown : sequence of Table
    values
        What JSON knows.
    stored : int
        Index of the table for the file.
    """
    if options.csv is not None:
        write(shown[stored], options.csv)
    if options.json:
        print(json.dumps(values))
    if as_text(options):
        for table in shown:
            parts = (table.title, table.to_text() if table.rows else "none", table.note)
            print("\n".join(part for part in parts if part), end="\n\n")


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
