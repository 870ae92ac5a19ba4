"""Who computes: processes of this machine, a Dask cluster, MPI ranks, or any other executor."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

from analysis.problem.checks import choice, whole
from analysis.problem.limits import MOST_WORKERS
from analysis.problem.names import ArgumentError
from analysis.problem.user_modules import error_text, is_user_name, user_object
from validation.measurement.processes import Processes

_PATIENCE = "10s"
"""For which a scheduler may keep silent at first."""

_WORKERS_PATIENCE = 60.0
"""Time in s for which it may have no workers at first."""


@dataclass
class Pool:
    """Workers for the cases of a sweep.

    Parameters
    ----------
    executor : concurrent.futures.Executor
        A call of it that fails in any way, such as by the loss of a worker, fails alone or with
        others; their cases are run again, each by itself, in a process of this machine.
    workers : int
    is_lost : callable
        Whether it takes no further calls, as a `RuntimeError` of `executor.submit` says, too.
    renewed : callable, optional
        Makes an executor in place of one that is lost; what that one was at fails.
    """

    executor: Executor
    workers: int
    is_lost: Callable[[], bool] = lambda: False
    renewed: Callable[[], Executor] | None = None

    def submit(self, function: Callable[..., Any], *arguments: Any) -> "Future[Any]":
        """Call a function; `OSError` if the workers are lost and none can take their place."""
        with suppress(RuntimeError):
            if not self.is_lost():
                return self.executor.submit(function, *arguments)
        if self.renewed is not None:
            self.executor = self.renewed()
            with suppress(RuntimeError):
                return self.executor.submit(function, *arguments)
        raise OSError("the workers are lost; what is done is stored, and the same command goes on")


@contextmanager
def open_pool(
    executor: str, *, workers: int | None = None, scheduler: str | None = None
) -> Iterator[Pool]:
    """Workers for the time of a context; where it fails, the calls that are being made are lost.

    Parameters
    ----------
    executor : str
        "processes", "dask", "mpi", or `module:function` of one's own that returns a
        `concurrent.futures.Executor`.
    workers : int, optional
        Number of processes, by default that of the cores; an MPI job, a Dask scheduler and an
        executor of one's own bring theirs, the last one as many as is said here.
    scheduler : str, optional
        Address of a Dask scheduler; without one, a cluster of this machine is started.

    Raises
    ------
    OSError
        If the scheduler does not answer, or has no workers.
    ValueError
        If there is no such executor, or what it needs is not installed or not started.
    """
    if not is_user_name(executor):
        choice("executor", executor, ("processes", "dask", "mpi", "module:function"))
    if scheduler is not None and executor != "dask":
        raise ArgumentError("scheduler", f"needs --executor dask, got {executor}")
    given = os.cpu_count() or 1 if workers is None else workers
    workers = whole("workers", given, 1, MOST_WORKERS)
    with ExitStack() as stack:
        if executor == "dask":
            yield _dask(workers, scheduler, stack)
        elif executor == "mpi":
            yield _mpi(stack)
        elif executor == "processes":
            yield Pool(stack.enter_context(Processes(workers)), workers)
        else:
            make = partial(_user_executor, executor, stack)
            yield Pool(make(), workers, renewed=make)


def _user_executor(name: str, stack: ExitStack) -> Executor:
    make = user_object("executor", name)
    try:
        executor = make() if callable(make) else make
    except (Exception, SystemExit) as error:  # a function of one's own may fail in any way
        fault = f"cannot be made: {error_text(error)}"
        raise ArgumentError("executor", fault, f"executor {name!r}") from error
    if not isinstance(executor, Executor):
        fault = f"must be a function that returns a concurrent.futures.Executor, got {executor!r}"
        raise ArgumentError("executor", fault, f"executor {name!r}")
    stack.callback(executor.shutdown, cancel_futures=True)
    return executor


def _mpi(stack: ExitStack) -> Pool:
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
    stack.callback(executor.shutdown, cancel_futures=True)
    return Pool(executor, executor.num_workers)


def _dask(workers: int, scheduler: str | None, stack: ExitStack) -> Pool:
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise ValueError(
            "the executor dask needs the extra: pip install 'tippedisk[dask]'"
        ) from None
    if scheduler is None:
        # The engine and the watch over hung cases want a process for each case.
        how = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
        scheduler = stack.enter_context(LocalCluster(**how)).scheduler_address
    try:
        client = stack.enter_context(Client(scheduler, timeout=_PATIENCE))
    except (OSError, ValueError) as error:
        raise OSError(f"the Dask scheduler {scheduler} does not answer: {error}") from None
    try:
        client.wait_for_workers(1, timeout=_WORKERS_PATIENCE)
    except TimeoutError as error:
        raise OSError(f"the Dask scheduler {scheduler} has no workers: {error}") from None
    executor, count = client.get_executor(pure=False), sum(client.ncores().values())
    return Pool(executor, count, lambda: client.status != "running")
