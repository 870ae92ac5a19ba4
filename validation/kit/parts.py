"""Finished parts of a report, kept in files and found again while nothing they hang on changes.

A part is the result of one job. Its file is named by a hash of the call, of all code the call can
reach, of the versions of Python and the packages below, and of the machine, since some results
are run times.
"""

import hashlib
import io
import json
import os
import pickle
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from analysis.data.trajectory import versions
from validation.kit import reach
from validation.kit.plain import pack, unpack
from validation.kit.provenance import machine

FOLDER = ".parts"
"""Folder of the parts inside that of the report."""

_SUFFIX = ".part"

_LOCK = ".lock"


@dataclass(frozen=True, slots=True)
class Job:
    """A function call to be made in a worker process.

    Parameters
    ----------
    key : hashable
        Its result is found by it.
    function : callable
        Importable by its name, or a `functools.partial` of one that is.
    arguments : tuple
    on_all_code : bool
        Whether the result depends on all code, not just on what the function can reach by name,
        as that of one that starts other programs does.
    """

    key: Any
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = field(default=())
    on_all_code: bool = False


@dataclass(frozen=True, slots=True)
class Part:
    """A result and the processor time in s that it took."""

    result: Any
    seconds: float


class Store:
    """Parts in a folder.

    Parameters
    ----------
    folder : Path
        Made if it does not exist.

    Attributes
    ----------
    folder : Path
    unreadable : int
        Number of files so far that were no parts.

    Raises
    ------
    OSError
        If the folder cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.unreadable = 0

    def find(self, job: Job) -> Part | None:
        """The kept part of a job; None without one, or if its file is damaged."""
        try:
            return self.read(identity(job))
        except KeyError:
            return None
        except ValueError:
            self.unreadable += 1
            return None

    def read(self, name: str) -> Part:
        """The part of the job with this identity.

        Raises
        ------
        KeyError
            If there is none.
        ValueError
            If its file is damaged or holds something else.
        """
        path = self.folder / f"{name}{_SUFFIX}"
        if not path.is_file():
            raise KeyError(name)
        try:
            result, seconds = json.loads(path.read_bytes())
            return Part(unpack(result), float(seconds))
        except Exception as error:
            # What is not of its kind may raise anything in the class that is to be made of it.
            raise ValueError(f"{path} is no part of a report: {error}") from error

    def keep(self, job: Job, part: Part) -> None:
        """Write the part of a job as plain data, whole or not at all."""
        text = json.dumps([pack(part.result, exact=True), part.seconds], separators=(",", ":"))
        with whole_file(self._path(job)) as stream:
            stream.write(text.encode())

    def forget(self, jobs: Iterable[Job]) -> None:
        """Remove the parts of some jobs."""
        for job in jobs:
            self._path(job).unlink(missing_ok=True)

    def forget_all_but(self, jobs: Iterable[Job]) -> None:
        """Remove the parts of other jobs, and of these in earlier versions."""
        wanted = {self._path(job) for job in jobs}
        for path in self.folder.glob(f"*{_SUFFIX}"):
            if path not in wanted:
                path.unlink()

    def _path(self, job: Job) -> Path:
        return self.folder / f"{identity(job)}{_SUFFIX}"


@contextmanager
def open_store(folder: Path) -> Iterator[Store]:
    """Parts of a report in a folder of its own, which no other process works in meanwhile.

    Parameters
    ----------
    folder : Path
        Of the report; the parts lie in its `FOLDER`.

    Raises
    ------
    OSError
        If another process works in it, or it cannot be made.
    """
    store = Store(folder / FOLDER)
    # A lock of SQLite's is known on every system and ends with its process, however that ends.
    with closing(sqlite3.connect(store.folder / _LOCK, timeout=0.0, isolation_level=None)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            reason = "another process works in it" if "locked" in str(error) else error
            raise OSError(f"{folder} cannot be written to now: {reason}") from error
        yield store


def identity(job: Job) -> str:
    """Hash of a call and of everything its result depends on."""
    stream = io.BytesIO()
    pickler = _Pickler(stream)
    pickler.dump((job.function, job.arguments))
    code = reach.all_code() if job.on_all_code else _code(frozenset(pickler.seen))
    text = "\n".join((repr(job.key), code, _surroundings()))
    return hashlib.sha256(text.encode() + stream.getvalue()).hexdigest()[:32]


@cache
def _code(seeds: frozenset[Callable[..., Any]]) -> str:
    return reach.fingerprint(seeds)


@cache
def _surroundings() -> str:
    packages = versions("exudyn", "numpy", "scipy", "matplotlib")
    return f"{packages}, {machine()}, {os.environ.get('EXUDYN_MODULE', '')}"


class _Pickler(pickle.Pickler):
    """Notes the classes and functions of what it writes."""

    def __init__(self, stream: io.BytesIO) -> None:
        super().__init__(stream)
        self.seen: set[Callable[..., Any]] = set()

    def persistent_id(self, thing: Any) -> None:
        """Called for every object; all are written as they are."""
        if hasattr(thing, "__qualname__") and hasattr(thing, "__module__"):
            self.seen.add(thing)
