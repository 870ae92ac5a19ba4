"""The results of a sweep in one SQLite file, which no kill at any point can damage.

Rows are committed in transactions of SQLite's rollback journal: after a kill the file holds all
rows of the last commit, and none of the next. The write-ahead log commits a little faster and
leaves more files than one.
"""

import json
import os
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

from analysis.data.outcomes import DONE, Row
from analysis.data.own import foreign_names
from validation.kit.provenance import commit
from validation.sweeps.outcomes import COLUMNS, IN_ROW, TIME
from validation.sweeps.sweep import Sweep

FORMAT = 2
"""Of the stores written here."""

READABLE = ("1", "2")
"""Formats that can be read. The first does not say which code a row comes from."""

APPLICATION = 0x74697070
"""Mark of these files among those of SQLite: "tipp"."""

COMMIT_EVERY = 1.0
"""Time in s between commits, each of which takes some 20 ms."""

_PATIENCE = 30.0
"""Time in s for which a commit waits for a reader of the file."""

_BYTES = 350
"""Size of a row in a file, generously."""

_PAGE = 4096
"""Size of a page of a file."""


class Store:
    """A store of a sweep, open for writing; use it as a context.

    Parameters
    ----------
    path : path-like
        Made if there is none.
    sweep : Sweep
        What its rows belong to.
    accept_other_code : bool
        Whether rows of other sources may stand in it, too; each says in "code" which.

    Raises
    ------
    OSError
        If the file cannot be read or written, or another process is writing to it.
    ValueError
        If it is no store, is damaged, or belongs to another sweep or to other sources.
    """

    def __init__(
        self, path: str | os.PathLike[str], sweep: Sweep, *, accept_other_code: bool = False
    ) -> None:
        self.path = Path(path)
        self._sweep = sweep
        self._accepts = accept_other_code
        self._code = sweep.code()
        # Commits of uncommitted changes are all alike.
        identity = sha256(json.dumps(self._code, sort_keys=True).encode()).hexdigest()[:10]
        self._code_name = ":".join(filter(None, (commit(), identity)))
        self._names = ["number", *(axis.field for axis in sweep.design.axes), *COLUMNS]
        self._series = ["number", TIME, *sweep.plan.keep] if sweep.plan.keep else []
        with self._told():
            self._file = sqlite3.connect(path, timeout=0.2, isolation_level=None)
            try:
                self._open()
            except BaseException:
                self._file.close()
                raise
        self._committed = time.monotonic()

    def _open(self) -> None:
        # A transaction is always open: its lock keeps a second process from writing.
        self._file.execute("BEGIN IMMEDIATE")
        if self._file.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            self._check()
        else:
            self._create()
        self._file.execute(f"PRAGMA busy_timeout = {round(1000 * _PATIENCE)}")

    def _create(self) -> None:
        kinds = ["INTEGER PRIMARY KEY"]
        for axis in self._sweep.design.axes:
            sample = axis.values[0] if axis.values else 0.0
            kinds.append("TEXT" if isinstance(sample, str) else "REAL")
        kinds += ["TEXT" if unit is None else "REAL" for unit in COLUMNS.values()]
        columns = ", ".join(f'"{name}" {kind}' for name, kind in zip(self._names, kinds,
                                                                     strict=True))  # fmt: skip
        self._file.execute(f"CREATE TABLE cases ({columns})")
        if self._series:
            blobs = ", ".join(f'"{name}" BLOB' for name in self._series[1:])
            self._file.execute(f"CREATE TABLE series (number INTEGER PRIMARY KEY, {blobs})")
        self._file.execute("CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT)")
        about = {"format": str(FORMAT), "sweep": self._sweep.to_text()}
        self._file.executemany("INSERT INTO sweep VALUES (?, ?)", about.items())
        self._file.execute("CREATE TABLE code (name TEXT PRIMARY KEY, value TEXT)")
        self._add_code()
        self._file.execute(f"PRAGMA application_id = {APPLICATION}")
        self._file.execute("COMMIT")
        self._file.execute("BEGIN IMMEDIATE")

    def _add_code(self) -> None:
        self._file.execute(
            "INSERT INTO code VALUES (?, ?)", (self._code_name, json.dumps(self._code))
        )

    def _check(self) -> None:
        about = _about(self._file, self.path)
        # Through JSON, which knows no tuples.
        self._refuse("another sweep", about["sweep"], json.loads(self._sweep.to_text()))
        if about["format"] != str(FORMAT):
            raise ValueError(
                f"{self.path} was written by an earlier version, in format {about['format']}: it "
                "can be read, but not added to; give another file"
            )
        known = [json.loads(text) for (text,) in self._file.execute("SELECT value FROM code")]
        if self._code not in known:
            if not self._accepts:
                self._refuse("other sources", known[-1], self._code, ", or --accept-other-code")
            self._add_code()

    def _refuse(self, what: str, there: Any, here: Any, besides: str = "") -> None:
        """Raise if plain data differ, naming the first difference."""
        there, here = _flat(there), _flat(here)
        for key in {**there, **here}:
            if there.get(key) != here.get(key):
                raise ValueError(
                    f"{self.path} holds results of {what}: {key} is {there.get(key)} there and "
                    f"{here.get(key)} here; give another file{besides}"
                )

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.commit()
        self._file.close()

    def count(self, status: str | None = None) -> int:
        """Number of rows, all or those of a status."""
        where = "" if status is None else " WHERE status = ?"
        with self._told():
            given = () if status is None else (status,)
            found = self._file.execute(f"SELECT count(*) FROM cases{where}", given)
            return int(found.fetchone()[0])

    def missing(self, numbers: Iterable[int], *, retry: bool = False) -> list[int]:
        """Those of some cases, at most some thousand, that have no row yet.

        Parameters
        ----------
        numbers : iterable of int
        retry : bool
            Whether a case that failed counts as missing.
        """
        numbers = list(numbers)
        if not numbers:
            return []
        with self._told():
            found = self._file.execute(
                "SELECT number FROM cases WHERE number BETWEEN ? AND ? AND (status = ? OR ?)",
                (min(numbers), max(numbers), DONE, not retry),
            )
            present = {number for (number,) in found}
        return [number for number in numbers if number not in present]

    def rows(self) -> Iterator[Row]:
        """All rows, by their numbers."""
        with self._told():
            for cells in self._file.execute("SELECT * FROM cases ORDER BY number"):
                yield dict(zip(self._names, cells, strict=True))

    def add(self, rows: Iterable[Row]) -> None:
        """Add rows; they are on the disk at the next commit."""
        rows = [{**row, "code": self._code_name} for row in rows]
        with self._told():
            self._insert("cases", self._names, rows)
            if self._series:
                names = ["number", *(IN_ROW.format(name) for name in self._series[1:])]
                self._insert("series", names, [row for row in rows if names[1] in row])

    def _insert(self, table: str, names: Sequence[str], rows: Iterable[Row]) -> None:
        marks = ", ".join("?" * len(names))
        self._file.executemany(
            f"INSERT OR REPLACE INTO {table} VALUES ({marks})",
            ([row.get(name) for name in names] for row in rows),
        )

    def commit_if_due(self) -> None:
        """Commit if the last time is `COMMIT_EVERY` ago."""
        if time.monotonic() - self._committed >= COMMIT_EVERY:
            self.commit()

    def commit(self) -> None:
        """Put all rows on the disk."""
        with self._told():
            if self._file.in_transaction:
                self._file.execute("COMMIT")
            self._file.execute("BEGIN IMMEDIATE")
        self._committed = time.monotonic()

    @contextmanager
    def _told(self) -> Iterator[None]:
        with told(self.path):
            yield


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Errors of SQLite as those that the command line tells in a line."""
    try:
        yield
    except sqlite3.OperationalError as error:
        if "locked" in str(error):
            raise OSError(f"{path} is being written to by another process") from error
        raise OSError(f"{path}: {error}") from error
    except sqlite3.DatabaseError as error:
        raise ValueError(f"{path} is no readable store of a sweep: {error}") from error


def read_about(path: str | os.PathLike[str]) -> tuple[sqlite3.Connection, Sweep]:
    """Open a store for reading; returns the file and the sweep.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no store.
    """
    place = Path(path)
    if not place.is_file():
        raise FileNotFoundError(f"{path}: there is no such file")
    with told(place):
        file = sqlite3.connect(f"{place.absolute().as_uri()}?mode=ro", uri=True, timeout=_PATIENCE)
        try:
            with foreign_names():
                return file, Sweep.from_values(_about(file, place)["sweep"])
        except BaseException as error:
            file.close()
            if isinstance(error, KeyError | TypeError | AttributeError):
                raise ValueError(f"{path} is no readable store of a sweep: {error!r}") from error
            raise


def expected_size(sweep: Sweep) -> int:
    """Bytes that a store of the whole sweep takes, generously."""
    row = _BYTES + 8 * len(sweep.design.axes)
    # What is longer than a page of the file takes whole pages.
    series = sweep.plan.series_bytes + _PAGE if sweep.plan.keep else 0
    return sweep.design.size * (row + series)


def _about(file: sqlite3.Connection, path: Path) -> dict[str, Any]:
    """What a store says of itself: its format, and the plain data of its sweep and its code."""
    if file.execute("PRAGMA application_id").fetchone()[0] != APPLICATION:
        raise ValueError(f"{path} is no store of a sweep, but another SQLite file")
    about: dict[str, str] = dict(file.execute("SELECT name, value FROM sweep"))
    if about.get("format") not in READABLE:
        raise ValueError(
            f"{path} has format {about.get('format')}, and this version reads "
            f"{' and '.join(READABLE)}"
        )
    try:
        return about | {"sweep": json.loads(about["sweep"])}
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise ValueError(f"{path} is no readable store of a sweep: {error!r}") from error


def _flat(values: Any, name: str = "") -> dict[str, Any]:
    """Nested plain data as one level, with dotted names."""
    if isinstance(values, Mapping):
        items = values.items()
    elif isinstance(values, list):
        items = {str(index): value for index, value in enumerate(values)}.items()
    else:
        return {name: values}
    flat: dict[str, Any] = {}
    for key, value in items:
        flat |= _flat(value, f"{name}.{key}" if name else str(key))
    return flat
