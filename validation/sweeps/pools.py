"""Who computes: processes of this machine, a Dask cluster or the ranks of an MPI job.

Each gives an executor with the interface of `concurrent.futures`.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from multiprocessing import active_children
from multiprocessing.process import BaseProcess
from typing import Any, Literal, Protocol, get_args

from analysis.data.workers import process_pool

Kind = Literal["processes", "dask", "mpi"]
KINDS: tuple[Kind, ...] = get_args(Kind)

_PATIENCE = "10s"
"""For which a scheduler may keep silent at first."""


class Pool(Protocol):
    """Workers, and what to do when one is lost."""

    workers: int

    def submit(self, function: Callable[..., Any], *arguments: Any) -> "Future[Any]":
        """Call a function in a worker."""

    def mend(self) -> None:
        """Get ready for further calls after one that failed; `OSError` if that cannot be."""

    def stop(self) -> None:
        """End at once; calls that are being made are lost."""


class Processes:
    """Worker processes of this machine."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._before = set(active_children())
        self._executor: Executor = process_pool(workers, deaf=True)

    def submit(self, function: Callable[..., Any], *arguments: Any) -> "Future[Any]":
        """Call a function in a worker."""
        return self._executor.submit(function, *arguments)

    def mend(self) -> None:
        """Start new processes: those of a pool that lost one are all gone."""
        self._executor.shutdown()
        self._before = set(active_children())
        self._executor = process_pool(self.workers, deaf=True)

    def children(self) -> set[BaseProcess]:
        """The processes that are running."""
        return set(active_children()) - self._before

    def stop(self) -> None:
        """End the processes at once."""
        for child in self.children():
            child.terminate()
        self._executor.shutdown(cancel_futures=True)


class _Borrowed:
    """Workers that others keep running."""

    def __init__(self, executor: Any, workers: int, is_lost: Callable[[], bool]) -> None:
        self.workers = workers
        self._executor = executor
        self._is_lost = is_lost

    def submit(self, function: Callable[..., Any], *arguments: Any) -> "Future[Any]":
        self.mend()
        future: Future[Any] = self._executor.submit(function, *arguments)
        return future

    def mend(self) -> None:
        if self._is_lost():
            raise OSError(
                "the workers are lost; what is done is stored, and the same command goes on"
            )

    def stop(self) -> None:
        """Leave it to whoever closes the executor."""


@contextmanager
def open_pool(kind: Kind, *, workers: int, scheduler: str | None = None) -> Iterator[Pool]:
    """Workers for the time of a context.

    Parameters
    ----------
    kind : {"processes", "dask", "mpi"}
    workers : int
        Number of processes; an MPI job and a Dask scheduler bring their own.
    scheduler : str, optional
        Address of a Dask scheduler; without one, a cluster of this machine is started.

    Raises
    ------
    OSError
        If the scheduler does not answer.
    ValueError
        If what is needed is not installed or not started.
    """
    opened = {"processes": _processes, "dask": _dask, "mpi": _mpi}[kind]
    with opened(workers, scheduler) as pool:
        try:
            yield pool
        except BaseException:
            pool.stop()
            raise


@contextmanager
def _processes(workers: int, _: str | None) -> Iterator[Pool]:
    pool = Processes(workers)
    yield pool
    pool.stop()


@contextmanager
def _dask(workers: int, scheduler: str | None) -> Iterator[Pool]:
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise ValueError(
            "the executor dask needs the extra: pip install 'tippedisk[dask]'"
        ) from None
    if scheduler is None:
        # The engine and the watch over hung cases want a process for each case.
        cluster = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    else:
        cluster = None
    try:
        client = Client(scheduler or cluster, timeout=_PATIENCE)
    except (OSError, ValueError) as error:
        raise OSError(f"the Dask scheduler {scheduler} does not answer: {error}") from None
    try:
        client.wait_for_workers(1, timeout=60)
        executor = client.get_executor(pure=False)
        yield _Borrowed(executor, sum(client.ncores().values()),
                        lambda: client.status != "running")  # fmt: skip
    finally:
        client.close()
        if cluster is not None:
            cluster.close()


@contextmanager
def _mpi(_: int, __: str | None) -> Iterator[Pool]:
    try:
        from mpi4py import MPI
        from mpi4py.futures import MPIPoolExecutor
    except (ImportError, RuntimeError) as error:
        cause = " ".join(str(error).split()[:12])
        raise ValueError(
            f"the executor mpi needs the extra, pip install 'tippedisk[mpi]', and an MPI library: "
            f"{cause}"
        ) from None
    if MPI.COMM_WORLD.size < 2:
        raise ValueError(
            "the executor mpi needs at least 2 ranks, the first of which only hands out work: "
            "mpiexec -n 4 python -m mpi4py.futures -m validation sweep …"
        )
    executor = MPIPoolExecutor()
    try:
        yield _Borrowed(executor, executor.num_workers, lambda: False)
    finally:
        executor.shutdown(cancel_futures=True)
