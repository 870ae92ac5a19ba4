"""Result files: written whole or not at all, read with suspicion."""

import csv
import io
import os
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex
from shutil import copyfileobj
from stat import S_IMODE, S_ISREG
from typing import Any, BinaryIO, cast

import numpy.typing as npt
from numpy.lib.npyio import NpzFile

from analysis.problem.checks import path_like
from analysis.problem.limits import LARGEST_STORAGE
from analysis.problem.names import OutputLostError

AnyArray = npt.NDArray[Any]

STANDARD_OUTPUT = Path("/dev/stdout")
"""Its name as a path; written to on every system."""

_IN_MEMORY = 100_000_000
"""Bytes that are held in memory for a pipe; a temporary file holds more."""

_UNREADABLE = (
    OSError, EOFError, ValueError, KeyError, TypeError, RuntimeError, ArithmeticError,
    MemoryError, SyntaxError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip
"""What NumPy, zipfile and JSON raise on damaged files."""


@contextmanager
def stored_arrays(path: str | os.PathLike[str]) -> Iterator[dict[str, AnyArray]]:
    """Arrays of the `.npz` file of a motion by name; whatever is wrong is told with its path.

    They are read without pickle, and none that is larger than `LARGEST_STORAGE`. Memory for what
    a header claims is filled only as far as the file goes.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is damaged, or what is done with its contents fails.
    """
    path_like("path", path)
    try:
        with Path(path).open("rb") as stream:
            archive: Any = NpzFile(stream)
            for info in archive.zip.infolist():
                if info.file_size > LARGEST_STORAGE:
                    raise ValueError(
                        f"{info.filename} has {info.file_size:.3g} bytes, and at most "
                        f"{LARGEST_STORAGE:.3g} are read"
                    )
            yield dict(archive)
    except FileNotFoundError:
        raise
    except _UNREADABLE as error:
        cause = f"lacks {error}" if isinstance(error, KeyError) else str(error)
        cause = " ".join(cause.split()) or type(error).__name__
        raise ValueError(f"{path} is not a readable motion: {cause}") from error


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file for writing that is there as a whole, or not at all.

    A regular file is written beside its place and moved there on success; on any error that draft
    is removed, and what stood there stays as it was. A link stays and what it leads to is
    replaced; a file that was there keeps its mode. A pipe or a device gets the content when all
    of it has been made, and so does standard output: `STANDARD_OUTPUT`, or any other name of it.

    Raises
    ------
    OSError
        If the folder does not exist or cannot be written; `OutputLostError` for standard output.
    """
    path_like("path", path)
    held, is_output = _held(path), is_standard_output(path)
    if not is_output and (held is None or S_ISREG(held.st_mode)):
        with _draft(Path(os.path.realpath(path)), held) as stream:
            yield stream
        return
    with tempfile.SpooledTemporaryFile(max_size=_IN_MEMORY) as content:
        yield cast("BinaryIO", content)
        content.seek(0)
        try:
            # Opened by its name, standard output would begin again at its start.
            opened = os.dup(_output()) if is_output else os.open(path, os.O_WRONLY)
            with os.fdopen(opened, "wb") as stream:
                copyfileobj(content, stream)
        except OSError as error:
            if not is_output:
                # Nor does a full device say its name.
                raise OSError(error.errno, error.strerror, str(path)) from error
            raise OutputLostError(f"standard output could not be written to: {error}") from error


def write_whole(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a file, text in UTF-8, whole or not at all; errors are those of `whole_file`."""
    with whole_file(path) as stream:
        stream.write(content.encode() if isinstance(content, str) else content)


def write_csv(
    path: str | os.PathLike[str], heads: Iterable[str], rows: Iterable[Iterable[Any]]
) -> None:
    """Write rows below their headings as comma-separated text; errors are those of `whole_file`.

    All digits of a number are written, nothing for None, and no row is held for long.
    """
    with whole_file(path) as stream:
        text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)
        text.flush()
        text.detach()


def is_standard_output(path: str | os.PathLike[str]) -> bool:
    """Whether a path is a name of standard output: `STANDARD_OUTPUT`, or where that leads."""
    if Path(path) == STANDARD_OUTPUT:
        return True
    try:
        held = _held(path)
        return held is not None and os.path.samestat(held, os.fstat(_output()))
    except OSError:
        return False


def _output() -> int:
    if sys.__stdout__ is None:
        raise OSError("standard output is closed")
    return sys.__stdout__.fileno()


def _held(path: str | os.PathLike[str]) -> os.stat_result | None:
    """What stands at a path, behind all links; None if there is nothing."""
    try:
        return Path(path).stat()
    except FileNotFoundError:
        return None


@contextmanager
def _draft(target: Path, held: os.stat_result | None) -> Iterator[BinaryIO]:
    """A temporary neighbour of a regular file, or of none, that takes its place on success."""
    draft = target.with_name(f".{target.name}.{token_hex(4)}")
    try:
        # A new result gets the permissions that any new file would get.
        mode = 0o666 if held is None else 0o600
        handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
    except OSError as error:
        # What is missing or closed is the folder, not the draft in it.
        raise OSError(error.errno, error.strerror, str(target.parent)) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
        if held is not None:
            draft.chmod(S_IMODE(held.st_mode))
        draft.replace(target)
    except BaseException as error:
        draft.unlink()
        if isinstance(error, OSError) and error.errno is not None and error.filename is None:
            # A full disk does not say where it is full.
            raise OSError(error.errno, error.strerror, str(target)) from error
        raise
