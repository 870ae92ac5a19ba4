"""Worker processes that end when the process that made them ends, however it ends."""

import os
import signal
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import current_process, parent_process
from multiprocessing.context import SpawnContext, SpawnProcess
from multiprocessing.process import BaseProcess
from multiprocessing.synchronize import Event
from pathlib import Path
from threading import Thread
from typing import Any

ORPHANED = 3
"""Exit code of a worker that has lost its parent,"""

UNGUARDED = 4
"""and of one that would start workers while it imports the script that has started it."""


class UnguardedScriptError(RuntimeError):
    """Workers import the script that starts them, and it starts them again."""


class Process(SpawnProcess):
    """A process that hears nothing of Ctrl-C before it knows what to do with it; see `_begin`."""

    def start(self) -> None:
        """Start it."""
        # A mask goes over to what is started; Windows has none.
        if not hasattr(signal, "pthread_sigmask"):
            return super().start()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Spawning:
    """How worker processes are started, and whether any of them has come as far as to work.

    Where a worker that is only being started comes here, as it imports a script that does not
    guard its calls, it ends without a word.

    Parameters
    ----------
    process : type
        Of the processes.

    Raises
    ------
    OSError
        If the working directory is gone.

    Attributes
    ----------
    context : multiprocessing context
    first : dict
        `initializer` and `initargs` of a pool: what each worker is to call first.
    """

    def __init__(self, process: type[SpawnProcess] = Process) -> None:
        if getattr(current_process(), "_inheriting", False):
            sys.exit(UNGUARDED)
        try:
            Path.cwd()
        except OSError as error:
            raise OSError("workers start in the working directory, and that is gone") from error
        self.context = SpawnContext()
        self.context.Process = process  # type: ignore[misc] # of this context alone
        self._begun = self.context.Event()
        self.first: dict[str, Any] = {"initializer": _begin, "initargs": (self._begun,)}

    def check_begun(self) -> None:
        """Raise `UnguardedScriptError` if no worker has come as far as to work."""
        if not self._begun.is_set():
            raise UnguardedScriptError(
                "no worker process could begin: each imports the script that starts it, which "
                'must do so below `if __name__ == "__main__":`, or with workers=1'
            )


class Pool(ProcessPoolExecutor):
    """Pool of newly started interpreters whose workers do not outlive this process.

    Where a context of it is left, calls that nobody has begun are forgotten.

    Parameters
    ----------
    workers : int
        Number of processes.
    """

    def __init__(self, workers: int) -> None:
        spawning = Spawning()
        self.check_begun = spawning.check_begun
        super().__init__(workers, mp_context=spawning.context, **spawning.first)

    def __exit__(self, *_: object) -> None:
        self.shutdown(cancel_futures=True)


def _begin(begun: Event) -> None:
    begun.set()
    # What runs in the background of a script is born deaf to Ctrl-C, and its workers with it.
    # Those of Pebble always are: it reaches all of a terminal's, and is left to their parent.
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
        # An exception instead would end one call, and the next would begin.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
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
