"""Many runs of the in-house equations at once."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from contextlib import ExitStack
from functools import partial
from os import cpu_count
from typing import Any

import numpy.typing as npt

from analysis.data.checks import increasing_times
from analysis.data.endings import StopWhen, named_conditions
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Trajectory
from analysis.data.workers import process_pool
from analysis.models.forms import Form
from analysis.models.integration import Method
from analysis.models.simulation import simulate

Outcome = Trajectory | Exception
"""Of one member: its motion, or the error that ended it."""

LARGEST_CHUNK = 32
"""Members that a worker gets at once; some ten seconds of them, and handing over costs 1 ms."""


def simulate_many(
    scenarios: Iterable[Scenario],
    times: npt.ArrayLike,
    *,
    form: Form | None = None,
    method: Method = "DOP853",
    tolerance: float | Sequence[float] | None = None,
    local_tolerance: float | None = None,
    stop_when: StopWhen = (),
    allow_pulling: bool = False,
    time_limit: float | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Outcome]:
    """Simulate many scenarios; a member that fails does not end the others.

    The members run on worker processes, which import the calling script: as with every such
    pool, a script calls this below `if __name__ == "__main__":`.

    Parameters
    ----------
    scenarios : iterable of Scenario
        The members.
    times : array_like, shape (n,)
        Times in s, the same for all; see `simulate`.
    form, method, local_tolerance, stop_when, allow_pulling, time_limit
        Of every member, as in `simulate`. Functions in `stop_when` must be importable by name.
    tolerance : float or sequence of floats, optional
        Largest error in beta and gamma in rad, of all members or of each.
    workers : int, optional
        Number of processes, by default that of the cores; 1 runs everything in this process.
    executor : Executor, optional
        Where to run instead: anything with the interface of `concurrent.futures`.
    progress : callable, optional
        Called with the number of members done and of all.

    Returns
    -------
    list of Trajectory or Exception
        The outcome of each member, in order. An error is what `simulate` raises, or
        `BrokenExecutor` if a worker process died.

    Raises
    ------
    ValueError
        If the times, the conditions, the workers or the number of tolerances are out of range.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, Start, simulate_many
    >>> starts = [Scenario(start=Start(spin=spin)) for spin in (10.0, 40.0)]
    >>> runs = simulate_many(starts, np.linspace(0.0, 2.0, 401), workers=1)
    >>> [run.inversion_time is not None for run in runs]
    [False, True]
    """
    members = list(scenarios)
    times = increasing_times(times)
    named_conditions(stop_when)
    if workers is not None and workers < 1:
        raise ValueError(f"workers must be at least 1, got {workers}")
    tolerances = _each(tolerance, len(members))
    call = partial(
        _outcomes,
        times=times,
        form=form,
        method=method,
        local_tolerance=local_tolerance,
        stop_when=stop_when,
        allow_pulling=allow_pulling,
        time_limit=time_limit,
    )
    tasks = list(zip(members, tolerances, strict=True))
    workers = workers or cpu_count() or 1
    chunk = max(1, min(LARGEST_CHUNK, len(tasks) // (4 * workers)))
    chunks = [tasks[first : first + chunk] for first in range(0, len(tasks), chunk)]
    tell = progress or (lambda _done, _all: None)
    outcomes: list[Outcome] = []
    if executor is None and (workers == 1 or len(tasks) == 1):
        for some in chunks:
            outcomes += call(some)
            tell(len(outcomes), len(tasks))
        return outcomes
    with ExitStack() as stack:
        pool = executor or stack.enter_context(process_pool(min(workers, len(chunks))))
        futures = {pool.submit(call, some): len(some) for some in chunks}
        done = 0
        for future in as_completed(futures):
            done += futures[future]
            tell(done, len(tasks))
    for future, size in futures.items():
        outcomes += _result(future, size)
    return outcomes


def _each(tolerance: float | Sequence[float] | None, count: int) -> list[float | None]:
    if not isinstance(tolerance, Sequence):
        return [tolerance] * count
    given: list[float | None] = list(tolerance)
    if len(given) != count:
        raise ValueError(f"tolerance must be one number or {count} of them, got {len(given)}")
    return given


def _result(future: Future[list[Outcome]], size: int) -> list[Outcome]:
    try:
        return future.result()
    except BrokenExecutor as error:
        return [error] * size


def _outcomes(tasks: list[tuple[Scenario, Any]], *, times: Any, **how: Any) -> list[Outcome]:
    """Outcomes of some members, with their tolerances, in this process."""
    outcomes: list[Outcome] = []
    for scenario, tolerance in tasks:
        try:
            outcomes.append(simulate(scenario, times, tolerance=tolerance, **how))
        except (ArithmeticError, ValueError) as error:
            outcomes.append(error)
    return outcomes
