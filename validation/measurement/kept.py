"""Measuring side by side, and keeping what is found, so that nothing is computed twice."""

import json
import os
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path

from pebble import ProcessExpired

from analysis.motion.trajectory import versions
from validation.display.progress import bar
from validation.measurement.processes import Processes
from validation.measurement.provenance import PACKAGES, machine
from validation.measurement.sources import behind
from validation.study import Found, Row, Study, Task, rows_of


def measured(
    tasks: Sequence[Task],
    folder: Path,
    *,
    workers: int | None = None,
    fresh: bool = False,
    title: str = "",
) -> Found:
    """Rows of each task, or what it crashed with.

    Parameters
    ----------
    tasks : sequence of Task
    folder : Path
        Where finished rows are kept, and found again while nothing changes that they hang on:
        the code of the study and of both sides, the versions, the machine.
    workers : int, optional
        Number of processes, by default that of the cores; 0 for none but this one, where no time
        limit holds and a debugger sees everything.
    fresh : bool
        Measure all of them again.
    title : str
        In front of the progress bar.

    Raises
    ------
    OSError
        If the folder cannot be written, or another process works in it.
    """
    studies = {task.study.name: task.study for task in tasks}
    hang_on = {name: _hang_on(study) for name, study in studies.items()}
    found: Found = {}
    with _kept(folder) as file:
        for task in tasks if not fresh else ():
            asked = (*task.key, hang_on[task.study.name])
            for (rows,) in file.execute(_FIND, asked):
                found[task.key] = json.loads(rows)
        left = [task for task in tasks if task.key not in found]
        most = os.cpu_count() or 1 if workers is None else workers
        for task, call in bar(title, iterable=_called(left, most), total=len(left), unit="cases"):
            rows = _outcome(task, call)
            if not isinstance(rows, Exception):
                row = (*task.key, hang_on[task.study.name], json.dumps(rows))
                file.execute("REPLACE INTO kept VALUES (?, ?, ?, ?)", row)
            found[task.key] = rows
    return found


_KEEP = """
PRAGMA locking_mode = EXCLUSIVE;
BEGIN EXCLUSIVE;
CREATE TABLE IF NOT EXISTS kept (study, label, hang_on, rows, PRIMARY KEY (study, label));
COMMIT
"""
_FIND = "SELECT rows FROM kept WHERE study = ? AND label = ? AND hang_on = ?"


@contextmanager
def _kept(folder: Path) -> Iterator[sqlite3.Connection]:
    """Rows that earlier calls have left in a folder; `OSError` if another process works in it."""
    folder.mkdir(parents=True, exist_ok=True)
    # A lock of SQLite's is known on every system and ends with its process, however that ends.
    path = folder / ".kept.db"
    try:
        with closing(sqlite3.connect(path, timeout=0.0, isolation_level=None)) as file:
            file.executescript(_KEEP)
            yield file
    except sqlite3.DatabaseError as error:
        reason = "another process works in it" if "locked" in str(error) else error
        raise OSError(f"{folder} cannot be written to now: {reason}") from error


def _hang_on(study: Study) -> str:
    """What the results of a study hang on, beside its cases."""
    code, engine = behind(study.measure.__module__), os.environ.get("EXUDYN_MODULE", "")
    return json.dumps([code, versions(*PACKAGES), machine(), engine, study.rests_on])


def _called(tasks: Sequence[Task], workers: int) -> Iterator[tuple[Task, Callable[[], list[Row]]]]:
    """Each task with a call for its rows: as it is finished by a process, or to be made here."""
    processes = min(workers, len(tasks))
    if not processes:
        yield from ((task, partial(rows_of, task.study.measure, task.case)) for task in tasks)
        return
    with Processes(processes) as pool:
        futures = {
            pool.submit(rows_of, task.study.measure, task.case, limit=task.study.limit): task
            for task in tasks
        }
        yield from ((futures[each], each.result) for each in as_completed(futures))


def _outcome(task: Task, call: Callable[[], list[Row]]) -> list[Row] | Exception:
    """Rows of a task, or what it crashed with."""
    try:
        return call()
    except ProcessExpired as error:
        return RuntimeError(f"the interpreter ended with code {error.exitcode}")
    except TimeoutError as error:
        limit = task.study.limit
        return RuntimeError(repr(error) if limit is None else f"not finished within {limit:g} s")
    except (Exception, SystemExit) as error:  # noqa: BLE001 # whatever it is, it is a crash
        return RuntimeError(repr(error))
