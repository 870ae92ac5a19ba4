"""Many runs of the in-house equations at once."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from contextlib import ExitStack
from functools import partial
from os import cpu_count
from typing import Any

import numpy as np
import numpy.typing as npt

from analysis.compiled.batches import Outcome, simulate_batches
from analysis.compiled.library import CannotCompileError, is_installed
from analysis.data.checks import Array, increasing_times
from analysis.data.endings import StopWhen, named_conditions
from analysis.data.scenario import Scenario
from analysis.data.workers import process_pool
from analysis.models.forms import Form
from analysis.models.integration import Method
from analysis.models.simulation import simulate

LARGEST_CHUNK = 32
"""Members that a worker gets at once; some ten seconds of them, and handing over costs 1 ms."""

COMPILED_CHUNK = 1024
"""The same if they are compiled: a worker takes a second to start."""


def simulate_many(
    scenarios: Iterable[Scenario],
    times: npt.ArrayLike,
    *,
    form: Form | None = None,
    method: Method | None = None,
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

    Where heyoka is installed, members alike in structure are compiled together and run in
    batches, with the error estimate, endings and errors of single runs. Others, and more than
    `COMPILED_CHUNK` compiled ones, run on worker processes, which import the calling script: as
    with every such pool, a script calls this below `if __name__ == "__main__":`.

    Parameters
    ----------
    scenarios : iterable of Scenario
        The members.
    times : array_like, shape (n,)
        Times in s, the same for all; see `simulate`.
    form, local_tolerance, stop_when, allow_pulling, time_limit
        Of every member, as in `simulate`. Functions in `stop_when` must be importable by name.
    method : str, optional
        As in `simulate`. By default "taylor" where heyoka is installed, and DOP853 for members
        that cannot be compiled. Compiled members run in batches.
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
    if method == "taylor" or (method is None and is_installed()):
        chunk = COMPILED_CHUNK
    else:
        chunk = max(1, min(LARGEST_CHUNK, len(tasks) // (4 * workers)))
    chunks = [tasks[first : first + chunk] for first in range(0, len(tasks), chunk)]
    tell = progress or (lambda _done, _all: None)
    outcomes: list[Outcome] = []
    if executor is None and (workers == 1 or len(chunks) == 1):
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
    if not isinstance(tolerance, Sequence | np.ndarray):
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


def _outcomes(
    tasks: list[tuple[Scenario, float | None]],
    *,
    times: Array,
    method: Method | None,
    stop_when: StopWhen,
    allow_pulling: bool,
    time_limit: float | None,
    **how: Any,
) -> list[Outcome]:
    """Outcomes of some members, with their tolerances, in this process."""

    def alone(task: tuple[Scenario, float | None], method: Method) -> Outcome:
        try:
            return simulate(
                task[0],
                times,
                method=method,
                tolerance=task[1],
                stop_when=stop_when,
                allow_pulling=allow_pulling,
                time_limit=time_limit,
                **how,
            )
        except (ArithmeticError, ValueError) as error:
            return error

    first: Method = method or "taylor"
    if first == "taylor" and not allow_pulling and time_limit is None:
        conditions = named_conditions(stop_when)
        outcomes = simulate_batches(tasks, times, conditions=conditions, **how)
    else:
        outcomes = [alone(task, first) for task in tasks]
    if method is None:
        for number, outcome in enumerate(outcomes):
            if isinstance(outcome, CannotCompileError):
                outcomes[number] = alone(tasks[number], "DOP853")
    return outcomes
