"""Files of the command line: which may be named, and where the numbers and the picture go.

Paths are looked at before anything is imported or computed.
"""

import json as text_of
import os
import sys
from argparse import ArgumentTypeError
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from shutil import get_terminal_size
from typing import Annotated, Any, NamedTuple

from analysis.problem.quantities import listed
from validation.display.tables import Table

STANDARD_INPUT = Path("/dev/stdin")

PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of pictures that can be written."""


def file(check: Callable[..., Path], *suffixes: str, **how: Any) -> dict[str, Any]:
    """Keywords of `argparse` for an option that takes a path, with one of some suffixes or any."""

    def checked(value: str) -> Path:
        try:
            # Paths of Python 3.14 on say no where they cannot be looked at.
            with suppress(FileNotFoundError, NotADirectoryError):
                os.lstat(value)
            return check(value, *suffixes)
        except OSError as error:
            # A name that is too long, or a folder that may not be looked into.
            fault = f"is no path here, got {value!r} ({error.strerror})"
            raise ArgumentTypeError(fault) from error

    return {"type": checked, "metavar": "FILE"} | how


def folder(value: str) -> Path:
    """Type of an argument that names a folder to write to, which is made if there is none."""
    path = _with_suffix(value)
    there = next(each for each in (path, *path.absolute().parents) if os.path.lexists(each))
    if not there.is_dir() or not _is_writable(there):
        raise ArgumentTypeError(f"must be a folder that can be written to, got {value!r}")
    return path


def existing(value: str, *suffixes: str) -> Path:
    """Type of an argument that names a file to read, with one of these suffixes or any.

    Where any will do, `-` is standard input, on systems that have a file for it.
    """
    is_input = value == "-" and not suffixes
    path = STANDARD_INPUT if is_input else _with_suffix(value, *suffixes)
    if path.is_dir() or not os.access(path, os.R_OK):
        raise ArgumentTypeError(f"must be an existing file that can be read, got {value!r}")
    return path


def writable(value: str, *suffixes: str) -> Path:
    """Type of an argument that names a file to write, with one of these suffixes.

    A pipe, a device or standard output, `-`, needs no suffix, and is taken for a file with the
    first.
    """
    if value == "-":
        if sys.__stdout__ is None:
            raise ArgumentTypeError("needs standard output, which is closed")
        # Known by this name also on systems that have no such file.
        return Path("/dev/stdout")
    path = Path(value)
    if path.exists() and (not path.is_file() or path.is_relative_to("/dev")):
        target = path
    else:
        # A link leads to the file that is replaced.
        path = _with_suffix(value, *suffixes)
        led = Path(os.path.realpath(path))
        target = led.parent
        if led.is_symlink():
            raise ArgumentTypeError(f"must lead to a file, and leads in a circle: {value!r}")
        if not target.is_dir():
            raise ArgumentTypeError(f"must lie in an existing folder, got {value!r}")
    if path.is_dir() or not _is_writable(target):
        raise ArgumentTypeError(f"must be a file that can be written, got {value!r}")
    return path


def _is_writable(place: Path) -> bool:
    """Whether a file, or a folder, can be written to; a folder such as /proc only says so."""
    if not place.is_dir():
        return os.access(place, os.W_OK)
    # No help should wait for it.
    from tempfile import TemporaryFile

    with suppress(OSError), TemporaryFile(dir=place):
        return True
    return False


def store(value: str) -> Path:
    """Type of an argument that names a database to write, which can be no pipe."""
    path = writable(value, ".db")
    if path.exists() and not (path.is_file() and _is_writable(path)):
        raise ArgumentTypeError(f"must be a regular file that can be written, got {value!r}")
    return _with_suffix(value, ".db")


def _with_suffix(value: str, *suffixes: str) -> Path:
    if not value:
        # It would be the working directory.
        raise ArgumentTypeError("must not be empty")
    path = Path(value)
    if suffixes and path.suffix.lower() not in suffixes:
        raise ArgumentTypeError(f"must end in {listed(suffixes)}, got {value!r}")
    return path


CsvOut = Annotated[Path | None, file(writable, ".csv")]
PictureOut = Annotated[Path | None, file(writable, *PICTURES, metavar="PICTURE")]


class Result(NamedTuple):
    """What a command has found.

    Parameters
    ----------
    tables : sequence of Table
        Printed, unless the numbers go elsewhere.
    values
        What JSON knows, or a function that makes it; by default the rows of the first table.
    csv : Table or callable, optional
        Table of the file, in place of which the others are printed; by default the first. Or what
        writes it to a path, in place of all.
    draw : callable, optional
        Makes the figure.
    files : sequence of (path, callable)
        What else is written, and by what; None is the path of nothing.
    notes : sequence of str
        Lines that are printed in any case, beside a file that takes standard output.
    code : int
        Exit code: 1 if a check fails.
    """

    tables: Sequence[Table] = ()
    values: Any = None
    csv: Table | Callable[[Path], object] | None = None
    draw: Callable[[], Any] | None = None
    files: Sequence[tuple[Path | None, Callable[[Path], object]]] = ()
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
        from analysis.motion.files import is_standard_output

        held = self.csv or next(iter(self.tables), None)
        write: Any = held.to_csv if isinstance(held, Table) else held
        files = [*self.files, (csv, write), (plot, self._draw)]
        asked = [(path, written) for path, written in files if path is not None]
        # Standard output comes last: where it is lost, all else is there.
        for path, written in sorted(asked, key=lambda each: is_standard_output(each[0])):
            written(path)
        if json:
            values = self.values() if callable(self.values) else self.values
            text = text_of.dumps(self.tables[0].records() if values is None else values)
            # JSON has no word for infinity or for what is no number, and its readers stop there.
            print(text_of.dumps(text_of.loads(text, parse_constant=lambda _: None)))
            return self.code
        width, _ = get_terminal_size((100, 24))
        is_one = isinstance(held, Table)
        shown = [each for each in self.tables if csv is None or (is_one and each is not held)]
        for line in (*(each.to_text(width) for each in shown), *self.notes):
            print(line)
        return self.code

    def _draw(self, path: Path) -> None:
        if self.draw is not None:
            save(self.draw(), path)


def names_of(paths: Sequence[Path]) -> list[str]:
    """Names of files without suffix, or their paths where some have one name.

    With a mark in place of what cannot be shown.

    Raises
    ------
    ValueError
        If one is given twice.
    """
    stems = [path.stem for path in paths]
    told = stems if len({*stems}) == len(stems) else list(map(str, paths))
    if len({path.resolve() for path in paths}) < len(paths):
        raise ValueError(f"files must be different ones, got {', '.join(map(str, paths))}")
    mark = "\N{REPLACEMENT CHARACTER}"
    return ["".join(each if each.isprintable() else mark for each in name) for name in told]


def save(figure: Any, path: Path) -> None:
    """Write a figure in the format that its file's name ends in; a pipe gets a PNG."""
    from analysis.motion.files import whole_file

    suffix = path.suffix.lower()
    kind = suffix if suffix in PICTURES else PICTURES[0]
    with whole_file(path) as stream:
        figure.savefig(stream, format=kind[1:], dpi=150)
