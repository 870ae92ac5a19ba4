"""Worker processes of this machine, of which one that ends or hangs fails its own call alone."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

from pebble import ProcessPool

from analysis.solve.workers import Process, Spawning


class _Worker(Process):
    """A process of which every end is told: of one with code 0 Pebble would take no notice."""

    @property
    def exitcode(self) -> Any:
        """Text in place of 0."""
        code = super().exitcode
        return str(code) if code == 0 else code


class Processes(Executor):
    """Worker processes of this machine: one that ends fails the call that it was at, no other.

    Parameters
    ----------
    workers : int
        Number of processes; a new one is started for each that ends.
    """

    def __init__(self, workers: int) -> None:
        spawning = Spawning(_Worker)
        self.check_begun = spawning.check_begun
        self._pool = ProcessPool(workers, context=spawning.context, **spawning.first)

    def submit(
        self,
        function: Callable[..., Any],
        /,
        *arguments: Any,
        limit: Any = None,
        **named: Any,
    ) -> "Future[Any]":
        """Call a function in a worker; `pebble.ProcessExpired` is what its end leads to.

        A call that takes longer than a limit in s ends in a `TimeoutError`.
        """
        return self._pool.schedule(function, args=arguments, kwargs=named, timeout=limit)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:  # noqa: ARG002
        """End the processes at once, with whatever they are at."""
        self._pool.stop()
        if wait:
            self._pool.join()
