"""Running the cases of a sweep that its store does not hold yet."""

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from contextlib import contextmanager
from itertools import islice
from types import FrameType
from typing import Any

from pebble import ProcessExpired

from analysis.motion.outcomes import DONE, failed
from analysis.problem.checks import instance
from validation.display.progress import bar
from validation.measurement.processes import Processes
from validation.sweeps.case import TIMERS, CaseRow, run_chunk
from validation.sweeps.pools import Pool, open_pool
from validation.sweeps.store import COMMIT_EVERY, Store
from validation.sweeps.sweep import Sweep, look_ahead

CHUNK_TIME = 1.0
"""Time in s that a chunk of cases should take: handing one out takes 1 ms here, 18 ms on Dask."""

MOST_CHUNKS = 100
"""Chunks that may come in per second; with more workers they are larger. Dask needs 4 ms each."""

LARGEST_CHUNK = 1000
"""Cases in a chunk."""

FIRST_BATCH = 32
"""Cases in the first chunks that run together; how long one takes is not known then."""

LARGEST_SAMPLES = 1_000_000
"""Samples of the cases of a chunk, once for each motion and for each series that comes back; some
300 bytes of each are held."""


def run_cases(
    store: Store, pool: Pool, *, numbers: Iterable[int] | None = None, retry: bool = False
) -> None:
    """Run the cases that a store does not hold of its sweep, with a progress bar.

    A case whose run fails, hangs or takes its process down becomes a row that says so. However
    this ends, the store holds what was done up to a second before.

    Parameters
    ----------
    store : Store
        Gets their rows.
    pool : Pool
    numbers : iterable of int, optional
        Cases to run; all by default. Memory does not grow with their number.
    retry : bool
        Whether cases that failed run again.

    Raises
    ------
    OSError
        If the store cannot be written, or the workers are lost.
    UnguardedScriptError
        If the processes import a script that starts them without a guard.
    KeyboardInterrupt
        It says what the store holds.
    """
    size, failures = store.sweep.design.size, 0
    todo = store.missing(range(size) if numbers is None else numbers, retry=retry)
    total = size if numbers is None else None
    counted: Any = {"total": total, "initial": store.count(retry=retry)}
    try:
        with (
            _interrupts_deferred() as check,
            Processes(1) as apart,
            bar(store.path.name, unit="cases", **counted) as shown,
        ):
            for rows in _incoming(store.sweep, pool, apart, todo):
                store.add(rows)
                failures += sum(row["status"] != DONE for row in rows)
                shown.set_postfix_str(f"{failures} failed" if failures else "", refresh=False)
                shown.update(len(rows))
                check()
    except KeyboardInterrupt:
        held = f"{store.count()} of {size} cases are in {store.path}"
        raise KeyboardInterrupt(f"{held}; the same command goes on") from None
    finally:
        store.commit()


def run_sweep(sweep: Sweep, path: str | os.PathLike[str], *, workers: int | None = None) -> None:
    """Run what a store does not hold of a sweep, in processes of this machine, with a bar.

    Parameters
    ----------
    sweep : Sweep
    path : path-like
        Of the store, made if there is none; `Results.load` reads it.
    workers : int, optional
        Number of processes, by default that of the cores.

    Raises
    ------
    OSError, ValueError
        If the store cannot be written, or is another's; or if no case can be run as planned.
    """
    look_ahead(instance("sweep", sweep, Sweep))
    # A worker of a script without a guard ends there, and does not come to the store.
    with open_pool("processes", workers=workers) as pool, Store(path, sweep) as store:
        run_cases(store, pool)


@contextmanager
def _interrupts_deferred() -> Iterator[Callable[[], None]]:
    """Ctrl-C raises where the function that this gives is called, a second one at once.

    In the midst of a change of a queue that threads share, it would leave them waiting for ever.
    """
    pending: list[int] = []
    usual = signal.getsignal(signal.SIGINT)

    def remember(number: int, frame: FrameType | None) -> None:
        if pending and callable(usual):
            usual(number, frame)
        pending.append(number)

    def check() -> None:
        if pending:
            raise KeyboardInterrupt

    if not callable(usual) or threading.current_thread() is not threading.main_thread():
        yield check
        return
    signal.signal(signal.SIGINT, remember)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, usual)
    check()


def _incoming(
    sweep: Sweep, pool: Pool, apart: Processes, todo: Iterator[int]
) -> Iterator[list[CaseRow]]:
    """Rows of cases as they come in, or none, after a second at the latest.

    Where a chunk is lost, with a worker, nobody knows over which case: those it holds run again
    one by one, apart, in processes of this machine, where a worker that ends has one case alone.
    """
    chunk_time, plan = max(CHUNK_TIME, pool.workers / MOST_CHUNKS), sweep.plan
    fitting = LARGEST_SAMPLES // (plan.times.size * (1 + len(plan.keep)))
    # Of a case; the first chunk tells how long one takes.
    seconds = CHUNK_TIME / (FIRST_BATCH if plan.runs_in_batches else 1)
    chunks: dict[Future[Any], list[int]] = {}
    alone: dict[Future[Any], list[int]] = {}
    while True:
        size = max(1, min(int(chunk_time / seconds), fitting, LARGEST_CHUNK))
        # Where chunk after chunk is lost, those to be run alone must not become all cases.
        room = 2 * pool.workers if len(alone) < LARGEST_CHUNK else 0
        while len(chunks) < room and (chunk := list(islice(todo, size))):
            chunks[pool.submit(run_chunk, sweep, chunk)] = chunk
        if not (running := chunks | alone):
            return
        rows: list[CaseRow] = []
        for future in wait(running, timeout=COMMIT_EVERY, return_when=FIRST_COMPLETED).done:
            chunk, is_alone = running[future], future in alone
            del (alone if is_alone else chunks)[future]
            error = CancelledError() if future.cancelled() else future.exception()
            if error is None:
                rows += future.result()
            elif is_alone:
                apart.check_begun()
                rows.append(_ended(sweep, chunk[0], error))
            else:
                for number in chunk:
                    alone[apart.submit(run_chunk, sweep, [number])] = [number]
        if rows:
            names = ("seconds", "other_seconds")
            taken = sum(row.get(name) or 0.0 for row in rows for name in names)
            seconds = max(0.5 * seconds + 0.5 * taken / len(rows), 1e-6)
        yield rows


def _ended(sweep: Sweep, number: int, error: BaseException) -> CaseRow:
    """Row of a case that has ended its process; any other error is raised."""
    if not isinstance(error, ProcessExpired):
        raise error
    # Without signals it is faulthandler that ends a process, with this code.
    if error.exitcode in ([-each for each in TIMERS] or [1]):
        within = f"{sweep.plan.hanging:g} s of processor time"
        end = failed("too slow", f"no result within {within}")
    else:
        end = failed("crashed", f"its process ended with code {error.exitcode}")
    return {"number": number, **sweep.design.values_of(number), **end}
