"""Paths on the command line, looked at before anything is imported or computed."""

import os
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path
from typing import Any

PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of pictures that can be written."""


def file(check: Callable[[str], str | Path], metavar: str = "FILE", **how: Any) -> dict[str, Any]:
    """Keywords of `argparse` for an option that takes a path."""
    return {"type": check, "metavar": metavar} | how


def filled(value: str) -> str:
    """Type of an argument that names a place; an empty one would be the working directory."""
    if not value:
        raise ArgumentTypeError("must not be empty")
    return value


def existing(*suffixes: str) -> Callable[[str], Path]:
    """Type of an argument that names a file to read, with one of these suffixes or any."""

    def checked(value: str) -> Path:
        path = _with_suffix(value, suffixes)
        if path.is_dir() or not path.exists():
            raise ArgumentTypeError(f"must be a file that exists, got {value!r}")
        return path

    return checked


def writable(*suffixes: str) -> Callable[[str], Path]:
    """Type of an argument that names a file to write, with one of these suffixes.

    A pipe, a device or standard output, `-`, needs no suffix, and is taken for a file with the
    first.
    """

    def checked(value: str) -> Path:
        path = Path("/dev/stdout" if value == "-" else value)
        if path.exists() and (not path.is_file() or path.is_relative_to("/dev")):
            target = path
        else:
            # A link leads to the file that is replaced.
            path = _with_suffix(value, suffixes)
            target = Path(os.path.realpath(path)).parent
            if not target.is_dir():
                raise ArgumentTypeError(f"must lie in an existing folder, got {value!r}")
        if path.is_dir() or not os.access(target, os.W_OK):
            raise ArgumentTypeError(f"must be a file that can be written, got {value!r}")
        return path

    return checked


def store(value: str) -> Path:
    """Type of an argument that names a database to write, which can be no pipe."""
    path = writable(".db")(value)
    if path.exists() and not path.is_file():
        raise ArgumentTypeError(f"must be a regular file, got {value!r}")
    return _with_suffix(value, (".db",))


def _with_suffix(value: str, suffixes: tuple[str, ...]) -> Path:
    path = Path(filled(value))
    if suffixes and path.suffix.lower() not in suffixes:
        *others, last = suffixes
        allowed = f"{', '.join(others)} or {last}" if others else last
        raise ArgumentTypeError(f"must end in {allowed}, got {value!r}")
    return path
