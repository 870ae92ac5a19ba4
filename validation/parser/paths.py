"""Paths on the command line, looked at before anything is imported or computed."""

import os
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path

PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of pictures that can be written."""


def existing(*suffixes: str) -> Callable[[str], Path]:
    """Type of an argument that names a file to read, with one of these suffixes or any."""

    def checked(value: str) -> Path:
        path = _with_suffix(value, suffixes)
        if path.is_dir() or not path.exists():
            raise ArgumentTypeError(f"must be a file that exists, got {value!r}")
        return path

    return checked


def writable(*suffixes: str) -> Callable[[str], Path]:
    """Type of an argument that names a file to write, with one of these suffixes."""

    def checked(value: str) -> Path:
        path = _with_suffix(value, suffixes)
        if not path.parent.is_dir():
            raise ArgumentTypeError(f"must lie in an existing folder, got {value!r}")
        if path.is_dir() or not os.access(path.parent, os.W_OK):
            raise ArgumentTypeError(f"must be a file that can be written, got {value!r}")
        return path

    return checked


def _with_suffix(value: str, suffixes: tuple[str, ...]) -> Path:
    path = Path(value)
    if suffixes and path.suffix not in suffixes:
        *others, last = suffixes
        allowed = f"{', '.join(others)} or {last}" if others else last
        raise ArgumentTypeError(f"must end in {allowed}, got {value!r}")
    return path
