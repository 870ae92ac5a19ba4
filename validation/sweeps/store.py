"""The results of a sweep in one SQLite file, which no kill at any point can damage.

Rows are committed in transactions of SQLite's rollback journal: after a kill the file holds all
rows of the last commit, and none of the next. The write-ahead log commits a little faster and
leaves more files than one.
"""

import json
import os
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from hashlib import sha256
from itertools import islice
from pathlib import Path
from typing import Any

from analysis.motion.outcomes import DONE
from analysis.problem.user_modules import foreign_names
from validation.comparison.differences import flat
from validation.measurement.provenance import commit
from validation.sweeps.case import COLUMNS, WITNESS_FAILED, CaseRow
from validation.sweeps.plan import TIME
from validation.sweeps.sweep import Sweep

FORMAT = 3
"""Of the stores written and read here."""

APPLICATION = 0x74697070
"""Mark of these files among those of SQLite: "tipp"."""

COMMIT_EVERY = 1.0
"""Time in s between commits, each of which takes some 20 ms."""

_LOOK = 4096
"""Cases whose presence is asked for at once."""

_PATIENCE = 30.0
"""Time in s for which a commit waits for a reader of the file."""

_BYTES = 350
"""Size of a row in a file, generously."""

_PAGE = 4096
"""Size of a page of a file."""

ELSEWHERE = "failed on the other side"
"""What has become of a case of which that alone has failed."""

_FAILED = f"(status <> '{DONE}' OR other_inversion IS '{WITNESS_FAILED}')"


# SQLite has no truth values of its own.
sqlite3.register_converter("BOOLEAN", lambda cell: cell == b"1")


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
        self.sweep = sweep
        self._code = sweep.code()
        # Commits of uncommitted changes are all alike.
        identity = sha256(_json(self._code).encode()).hexdigest()[:10]
        self._code_name = ":".join(filter(None, (commit(), identity)))
        self._tables = tables(sweep)
        with plain_errors(self.path):
            self._file = sqlite3.connect(path, timeout=0.2, isolation_level=None)
            try:
                # A transaction is always open: its lock keeps a second process from writing.
                self._file.execute("BEGIN IMMEDIATE")
                self._file.execute(f"PRAGMA busy_timeout = {round(1000 * _PATIENCE)}")
                if self._file.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                    self._check(accept_other_code)
                else:
                    self._create()
                code = self._code_name, _json(self._code)
                self._file.execute("INSERT OR IGNORE INTO code VALUES (?, ?)", code)
                self.commit()
            except BaseException:
                self._file.close()
                raise

    def _create(self) -> None:
        pairs = {"name": "TEXT PRIMARY KEY", "value": "TEXT"}
        for table, kinds in {**self._tables, "sweep": pairs, "code": pairs}.items():
            columns = ", ".join(f'"{name}" {kind}' for name, kind in kinds.items())
            self._file.execute(f"CREATE TABLE {table} ({columns})")
        about = {"format": str(FORMAT), "sweep": _json(self.sweep.values())}
        self._file.executemany("INSERT INTO sweep VALUES (?, ?)", about.items())
        self._file.execute(f"PRAGMA application_id = {APPLICATION}")

    def _check(self, accepts: bool) -> None:
        # Nothing that it names is imported.
        self._refuse("another sweep", _stored_sweep(self._file, self.path), self.sweep.values())
        codes = [json.loads(text) for (text,) in self._file.execute("SELECT value FROM code")]
        if self._code not in codes and not accepts:
            self._refuse("other sources", codes[-1], self._code, ", or --accept-other-code")

    def _refuse(self, what: str, there: Any, here: Any, besides: str = "") -> None:
        """Raise if plain data differ, naming the first difference."""
        known, wanted = flat(there), flat(here)
        for key in {**known, **wanted}:
            if known.get(key) != wanted.get(key):
                raise ValueError(
                    f"{self.path} holds results of {what}: {key} is {known.get(key)} there and "
                    f"{wanted.get(key)} here; give another file{besides}"
                )

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.commit()
        self._file.close()

    def _found(self, query: str, *values: int) -> list[tuple[Any, ...]]:
        with plain_errors(self.path):
            return self._file.execute(query, values).fetchall()

    def count(self, *, retry: bool = False) -> int:
        """Number of rows, or of those that do not run again where failed ones do."""
        asked = f"SELECT count(*) FROM cases WHERE NOT (? AND {_FAILED})"
        return int(self._found(asked, retry)[0][0])

    def failed(self) -> list[int]:
        """Numbers of the cases that have failed, on either side."""
        return [number for (number,) in self._found(f"SELECT number FROM cases WHERE {_FAILED}")]

    def failures(self) -> dict[str, int]:
        """Numbers of cases that have failed, by what has become of them."""
        asked = f"SELECT iif(status = '{DONE}', '{ELSEWHERE}', status), count(*) FROM cases "
        return dict(self._found(f"{asked} WHERE {_FAILED} GROUP BY 1"))

    def missing(self, numbers: Iterable[int], *, retry: bool = False) -> Iterator[int]:
        """Those of some cases that have no row yet; they are asked for as these are.

        Parameters
        ----------
        numbers : iterable of int
        retry : bool
            Whether a case that failed, on either side, counts as missing.
        """
        left = iter(numbers)
        while block := list(islice(left, _LOOK)):
            asked = "SELECT number FROM cases WHERE number BETWEEN ? AND ? AND NOT"
            found = self._found(f"{asked} (? AND {_FAILED})", min(block), max(block), retry)
            present = {number for (number,) in found}
            yield from (number for number in block if number not in present)

    def add(self, rows: Iterable[CaseRow]) -> None:
        """Add rows, or none; they are on the disk at the next commit, made here if it is due."""
        rows = [{**row, "code": self._code_name} for row in rows]
        kept = [{"number": row["number"], **row["series"]} for row in rows if "series" in row]
        held = {"cases": rows, "series": kept}
        with plain_errors(self.path):
            for table, names in self._tables.items():
                marks = ", ".join("?" * len(names))
                self._file.executemany(
                    f"INSERT OR REPLACE INTO {table} VALUES ({marks})",
                    ([row.get(name) for name in names] for row in held[table]),
                )
        if time.monotonic() - self._committed >= COMMIT_EVERY:
            self.commit()

    def commit(self) -> None:
        """Put all rows on the disk."""
        with plain_errors(self.path):
            if self._file.in_transaction:
                self._file.execute("COMMIT")
            self._file.execute("BEGIN IMMEDIATE")
        self._committed = time.monotonic()


def listed_failures(failures: Mapping[str, int]) -> str:
    """What `Store.failures` tells, behind a number of cases."""
    return "".join(f", {count} of them {words}" for words, count in failures.items())


def tables(sweep: Sweep) -> dict[str, dict[str, str]]:
    """Columns of the tables of a store with their kinds, as SQLite calls them."""
    kinds = {name: "TEXT" if unit is None else "REAL" for name, unit in COLUMNS.items()}
    known = {str: "TEXT", int: "INTEGER", bool: "BOOLEAN"}
    axes = {axis.field: known.get(type(axis.at(0)), "REAL") for axis in sweep.design.axes}
    number = {"number": "INTEGER PRIMARY KEY"}
    found = {"cases": number | axes | kinds}
    if sweep.plan.keep:
        found["series"] = number | dict.fromkeys((TIME, *sweep.plan.keep), "BLOB")
    return found


@contextmanager
def plain_errors(path: Path) -> Iterator[None]:
    """Errors of SQLite as those that the command line tells in a line."""
    try:
        yield
    except sqlite3.OperationalError as error:
        if "locked" in str(error):
            raise OSError(f"{path} is being written to by another process") from error
        raise OSError(f"{path}: {error}") from error
    except sqlite3.DatabaseError as error:
        raise ValueError(f"{path} is no readable store of a sweep: {error}") from error


@contextmanager
def reading(path: str | os.PathLike[str]) -> Iterator[tuple[sqlite3.Connection, Sweep]]:
    """A store that is open for reading, and its sweep.

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
    # A kill between two commits may leave a journal, which whoever opens it first plays back. A
    # file that may only be read is opened as one.
    address = f"{place.absolute().as_uri()}?mode=rw"
    how: Any = {"uri": True, "timeout": _PATIENCE, "detect_types": sqlite3.PARSE_DECLTYPES}
    with plain_errors(place), closing(sqlite3.connect(address, **how)) as file:
        try:
            with foreign_names():
                sweep = Sweep.from_values(_stored_sweep(file, place))
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"{path} is no readable store of a sweep: {error!r}") from error
        yield file, sweep


def expected_size(sweep: Sweep) -> int:
    """Bytes that a store of the whole sweep takes, generously."""
    row, plan = _BYTES + 8 * len(sweep.design.axes), sweep.plan
    if plan.keep:
        # What is longer than a page of the file takes whole pages.
        row += 8 * plan.times.size * (1 + len(plan.keep)) + _PAGE
    return sweep.design.size * row


def _json(values: Any) -> str:
    return json.dumps(values, sort_keys=True, allow_nan=False)


def _stored_sweep(file: sqlite3.Connection, path: Path) -> Any:
    """What a store says of the sweep that it belongs to, as plain data."""
    if file.execute("PRAGMA application_id").fetchone()[0] != APPLICATION:
        raise ValueError(f"{path} is no store of a sweep, but another SQLite file")
    about: dict[str, str] = dict(file.execute("SELECT name, value FROM sweep"))
    if about.get("format") != str(FORMAT):
        raise ValueError(f"{path} has format {about.get('format')}, this version reads {FORMAT}")
    try:
        return json.loads(about["sweep"])
    except (KeyError, ValueError, RecursionError) as error:
        raise ValueError(f"{path} is no readable store of a sweep: {error!r}") from error
