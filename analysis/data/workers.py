"""Worker processes that end when the process that made them ends, however it ends."""

import os
import signal
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context, parent_process
from multiprocessing.process import BaseProcess
from threading import Thread

ORPHANED = 3
"""Exit code of a worker that has lost its parent."""


def process_pool(workers: int | None = None, *, deaf: bool = False) -> ProcessPoolExecutor:
    """Pool of newly started interpreters whose workers do not outlive this process.

    Parameters
    ----------
    workers : int, optional
        Number of processes, by default that of the cores.
    deaf : bool
        Whether Ctrl-C, which reaches all processes of a terminal, is left to this one.
    """
    return ProcessPoolExecutor(
        max_workers=workers or os.cpu_count(),
        mp_context=get_context("spawn"),
        initializer=begin_worker,
        initargs=(deaf,),
    )


def begin_worker(deaf: bool = False) -> None:
    """What each worker process does first: see `process_pool`."""
    if deaf:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()


def end_with_parent() -> None:
    """End this process as soon as the one that started it is gone.

    A pool's workers would finish their jobs, which take minutes. The engine holds the
    interpreter's lock but at samples and friction forces, and there the watching thread gets it.
    In a process that `multiprocessing` has not started there is nothing to watch.
    """
    parent = parent_process()
    if parent is not None:
        Thread(target=_watch, args=(parent,), daemon=True, name="end with parent").start()


def _watch(parent: BaseProcess) -> None:
    # The kernel closes the parent's end of a pipe when it dies; killed processes tell nobody.
    parent.join()
    # Not `sys.exit`, which would end this thread alone.
    os._exit(ORPHANED)
