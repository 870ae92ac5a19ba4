"""Finished parts of a report, kept in files and found again while nothing they hang on changes.

A part is the result of one job. Its file is named by a hash of the call, of all code the call can
reach, of the versions of Python and the packages below, and of the machine, since some results
are run times.
"""

import hashlib
import io
import os
import pickle
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from analysis.data.files import whole_file
from analysis.data.trajectory import versions
from validation.kit import reach
from validation.kit.provenance import machine

FOLDER = ".parts"
"""Folder of the parts inside that of the report."""

_SUFFIX = ".part"

_NUMPY = {
    "_reconstruct", "ndarray", "dtype", "scalar", "_frombuffer", "bool", "bool_",
    "float64", "int64", "complex128",
}  # fmt: skip
_BUILT_IN = {"complex", "set", "frozenset", "slice", "range"}


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
        except pickle.UnpicklingError:
            self.unreadable += 1
            return None

    def read(self, name: str) -> Part:
        """The part of the job with this identity.

        Raises
        ------
        KeyError
            If there is none.
        UnpicklingError
            If its file is damaged or holds something else.
        """
        path = self.folder / f"{name}{_SUFFIX}"
        if not path.is_file():
            raise KeyError(name)
        try:
            with path.open("rb") as stream:
                result, seconds = _Unpickler(stream).load()
            return Part(result, float(seconds))
        except Exception as error:
            # Damaged bytes make a loader raise anything.
            raise pickle.UnpicklingError(f"{path} is no part of a report: {error}") from error

    def keep(self, job: Job, part: Part) -> None:
        """Write the part of a job, whole or not at all."""
        with whole_file(self._path(job)) as stream:
            pickle.dump((part.result, part.seconds), stream)

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


class _Unpickler(pickle.Unpickler):
    """Makes nothing but numbers, arrays and the project's classes.

    A report's folder may come from somebody else, and a pickle can name any function to call.
    """

    def find_class(self, module: str, name: str) -> Any:
        package = module.partition(".")[0]
        allowed = (
            package in reach.PROJECT
            or (package == "numpy" and name in _NUMPY)
            or (module == "builtins" and name in _BUILT_IN)
        )
        found = super().find_class(module, name) if allowed and "." not in name else None
        # A module also holds functions, and what it imports from elsewhere.
        ours = package not in reach.PROJECT or (
            isinstance(found, type) and found.__module__.partition(".")[0] in reach.PROJECT
        )
        if found is None or not ours:
            raise pickle.UnpicklingError(f"{module}.{name} is no part of a result")
        return found
