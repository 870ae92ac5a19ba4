"""Result files: written whole or not at all, read with suspicion."""

import os
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np
import numpy.typing as npt

from analysis.data.limits import LARGEST_STORAGE

T = TypeVar("T")
AnyArray = npt.NDArray[Any]

_UNREADABLE = (
    OSError, EOFError, ValueError, KeyError, TypeError, RuntimeError, ArithmeticError,
    MemoryError, SyntaxError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip
"""What NumPy, zipfile and JSON raise on damaged files."""

_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def read_archive(
    path: str | os.PathLike[str],
    kind: str,
    names: Iterable[str],
    build: Callable[[Mapping[str, Any]], T],
) -> T:
    """Build an object from the named arrays of an `.npz` file, without pickle.

    Parameters
    ----------
    path : path-like
    kind : str
        What the file should hold, for the message.
    names : iterable of str
    build : callable
        From the arrays by name to the object; it may raise what wrong contents make it raise.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is damaged, lacks an array, claims more than `LARGEST_STORAGE`, or holds
        something else.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            arrays = {name: _read_array(archive, f"{name}.npy") for name in names}
        return build(arrays)
    except FileNotFoundError:
        raise
    except _UNREADABLE as error:
        cause = f"lacks {error}" if isinstance(error, KeyError) else str(error)
        cause = " ".join(cause.split()) or type(error).__name__
        raise ValueError(f"{path} is not a readable {kind}: {cause}") from error


def _read_array(archive: zipfile.ZipFile, member: str) -> AnyArray:
    """One array; what its header claims is compared with the file before memory is taken."""
    if member not in archive.namelist():
        raise KeyError(member.removesuffix(".npy"))
    info = archive.getinfo(member)
    with archive.open(info) as stream:
        version = np.lib.format.read_magic(stream)
        if version not in _HEADERS:
            raise ValueError(f"{member} has format version {version}, which NumPy does not write")
        shape, _, dtype = _HEADERS[version](stream)
        held = info.file_size - stream.tell()
    claimed = prod(shape) * dtype.itemsize
    if claimed > LARGEST_STORAGE:
        raise ValueError(
            f"{member} claims {claimed:.3g} bytes, and at most {LARGEST_STORAGE:.3g} are read"
        )
    if claimed > held:
        raise ValueError(f"{member} claims {claimed} bytes and holds {held}")
    with archive.open(info) as stream:
        return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a temporary neighbour of `path` for writing and move it there on success.

    On any error the temporary file is removed, and what stood at `path` stays as it was.

    Raises
    ------
    OSError
        If the folder does not exist or cannot be written.
    """
    target = Path(path)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    draft = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
        # mkstemp makes files private; results get the permissions any new file would get.
        mask = os.umask(0)
        os.umask(mask)
        draft.chmod(0o666 & ~mask)
        draft.replace(target)
    except OSError as error:
        draft.unlink()
        if error.errno is None or error.filename is not None:
            raise
        # A full disk does not say where it is full.
        raise OSError(error.errno, error.strerror, str(target)) from error
    except BaseException:
        draft.unlink()
        raise
