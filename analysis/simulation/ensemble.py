"""Many runs of the in-house equations at once."""

import pickle
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, as_completed
from contextlib import ExitStack
from functools import partial
from math import nan
from os import cpu_count
from pathlib import Path
from time import process_time
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import ToleranceError, function, instance, several, whole
from analysis.problem.choices import Method
from analysis.problem.limits import MOST_WORKERS, check_storage
from analysis.problem.names import ArgumentError
from analysis.problem.scenario import Scenario
from analysis.problem.start import COORDINATES
from analysis.problem.variations import Ensemble, one_by_one
from analysis.simulation.compiled.ensemble import CompiledRuns, Scenarios, simulate_compiled
from analysis.simulation.compiled.library import CannotCompileError
from analysis.simulation.request import Request
from analysis.simulation.simulate import run_member
from analysis.simulation.trajectories import Trajectories
from analysis.solve.workers import Pool

Outcome = Trajectory | Exception
"""Of one member: its motion, or the error that ended it."""

Motions = tuple[list[CompiledRuns], dict[int, Outcome], float]
"""Members that were run together, outcomes of all others, and the processor time of each in s."""

LARGEST_CHUNK = 32
"""Members that a worker gets at once; some ten seconds of them, and handing over costs 1 ms."""

COMPILED_CHUNK = 4096
"""The same if they are compiled: a worker takes a second or two to start."""


@overload
def simulate_many(scenarios: Ensemble, times: npt.ArrayLike, **how: Any) -> Trajectories: ...
@overload
def simulate_many(
    scenarios: Iterable[Scenario], times: npt.ArrayLike, **how: Any
) -> list[Outcome]: ...
def simulate_many(
    scenarios: Ensemble | Iterable[Scenario],
    times: npt.ArrayLike,
    *,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
    **how: Any,
) -> Trajectories | list[Outcome]:
    """Simulate many scenarios; a member that fails does not end the others.

    Where heyoka is installed, members alike in structure are compiled together and run in
    batches, with the error estimate, endings and errors of single runs. Others, and more than
    4096 compiled ones, run on worker processes, which import the calling script: as
    with every such pool, a script calls this below `if __name__ == "__main__":`.

    Parameters
    ----------
    scenarios : Ensemble or iterable of Scenario
        The members. An ensemble is told by arrays and gives arrays; nothing is then done for
        each member in Python that is not asked for.
    times : array_like, shape (n,)
        Times in s, the same for all; see `simulate`.
    workers : int, optional
        Number of processes, by default that of the cores; 1 runs everything in this process.
    executor : Executor, optional
        Where to run instead: anything with the interface of `concurrent.futures`.
    progress : callable, optional
        Called with the number of members done and of all.
    **how
        Of every member, as in `simulate`: formulation, method, tolerance, local_tolerance,
        stop_when, allow_pulling and time_limit. Functions in `stop_when` must be importable by
        name. The method is by default "taylor" where heyoka is installed, and that of `simulate`
        for members that cannot be compiled or that it does not take to their tolerance:
        `Trajectory.method` tells. Compiled members run in batches.

    Returns
    -------
    Trajectories, or list of Trajectory or Exception
        For an ensemble, its motions as arrays. For scenarios the outcome of each, in order. An
        error is what `simulate` raises, or `BrokenExecutor` if a worker process died.

    Raises
    ------
    ValueError
        If an argument is out of range.
    UnguardedScriptError
        If workers cannot begin, as they come here while they import the calling script.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Ensemble, Scenario, Start, simulate_many
    >>> times = np.linspace(0.0, 2.0, 401)
    >>> starts = [Scenario(start=Start(spin=spin)) for spin in (10.0, 40.0)]
    >>> runs = simulate_many(starts, times, workers=1)
    >>> [run.inversion_time is not None for run in runs]
    [False, True]
    >>> ensemble = Ensemble(scenario=Scenario(), fields={"spin": np.array([10.0, 40.0])})
    >>> runs = simulate_many(ensemble, times, workers=1)
    >>> runs.inversions.outcomes.tolist()
    ['not inverted', 'inverted']
    >>> runs.coordinates.shape, round(runs[1].inversion_time, 4)
    ((2, 401, 6), 0.4852)
    """
    members = _members(scenarios)
    request = Request(times, **how)
    check_storage("times", len(members) * request.times.size, 2 * len(COORDINATES))
    workers = whole("workers", (cpu_count() or 1) if workers is None else workers, 1, MOST_WORKERS)
    tell = (lambda _done, _all: None) if progress is None else function("progress", progress)
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise ArgumentError("executor", f"must be an Executor or act as one, got {executor!r}")
    chunks = dict(_chunks(members, request, workers))
    compiled: list[CompiledRuns] = []
    alone: dict[int, Outcome] = {}
    seconds, done = np.empty(len(members)), 0
    for first, (some, others, mean) in _called(partial(_run, request), chunks, executor, workers):
        compiled += some
        alone |= others
        seconds[first : first + len(chunks[first])] = mean
        done += len(chunks[first])
        tell(done, len(members))
    if isinstance(members, Ensemble):
        return Trajectories(
            ensemble=members,
            times=request.times,
            compiled=compiled,
            alone={row: each for row, each in alone.items() if isinstance(each, Trajectory)},
            failures={row: each for row, each in alone.items() if isinstance(each, Exception)},
            seconds=seconds,
        )
    for each in compiled:
        for member in each.group.rows.tolist():
            motion = partial(each.trajectory, member)
            ((_, alone[member]),) = one_by_one(motion, members, [member])
    return [alone[member] for member in range(len(members))]


def _members(given: Ensemble | Iterable[Scenario]) -> Scenarios:
    if isinstance(given, Ensemble):
        return given
    every = several("scenarios", given, "Scenario, or an Ensemble")
    return [instance(f"scenarios[{row}]", each, Scenario) for row, each in enumerate(every)]


def _chunks(members: Scenarios, request: Request, workers: int) -> Iterator[tuple[int, Scenarios]]:
    """Members that a worker gets at once, by the number of the first one."""
    size = COMPILED_CHUNK
    if request.first_method != "taylor":
        size = max(1, min(LARGEST_CHUNK, len(members) // (4 * workers)))
    for first in range(0, len(members), size):
        some = slice(first, first + size)
        yield first, members.subset(some) if isinstance(members, Ensemble) else members[some]


def _called(
    call: Callable[[int, Scenarios], Motions],
    chunks: Mapping[int, Scenarios],
    executor: Executor | None,
    workers: int,
) -> Iterator[tuple[int, Motions]]:
    """Motions of chunks, run here or elsewhere, as they come in, by the number of the first."""
    if executor is None and (workers == 1 or len(chunks) < 2):
        for first, chunk in chunks.items():
            yield first, call(first, chunk)
        return
    if executor is None:
        _check_sent("stop_when", call)
        for chunk in chunks.values():
            _check_sent("scenarios", chunk)
    with ExitStack() as stack:
        pool = executor or stack.enter_context(Pool(min(workers, len(chunks))))
        futures = {pool.submit(call, *each): each for each in chunks.items()}
        for future in as_completed(futures):
            first, chunk = futures[future]
            if isinstance(error := future.exception(), BrokenExecutor):
                if isinstance(pool, Pool):
                    pool.check_begun()
                yield first, ([], dict.fromkeys(range(first, first + len(chunk)), error), nan)
            else:
                yield first, future.result()


def _check_sent(name: str, sent: Any) -> None:
    """Raise `ArgumentError` if worker processes cannot be given something."""
    main, fault = sys.modules["__main__"], ""
    try:
        is_typed = b"__main__" in pickle.dumps(sent)
    except Exception as error:  # noqa: BLE001 - what is one's own may fail in any way
        fault = str(error)
    else:
        if is_typed and not (main.__spec__ or Path(getattr(main, "__file__", "")).is_file()):
            fault = "what is typed in, or read from a pipe, lies in no file"
    if fault:
        wanted = "must hold what worker processes import by name, or workers be 1"
        raise ArgumentError(name, f"{wanted}; write it in a file of its own: {fault}")


def _run(request: Request, first: int, scenarios: Scenarios) -> Motions:
    """Motions of members in this process."""
    begin = process_time()
    compiled: list[CompiledRuns] = []
    outcomes: dict[int, Outcome] = {}

    def alone(members: Iterable[int], method: Method | None) -> dict[int, Outcome]:
        call = partial(run_member, request=request, method=method)
        found = one_by_one(call, scenarios, (member - first for member in members))
        return {first + int(row): outcome for (row,), outcome in found}

    # A limit of its own has each one alone.
    if request.first_method == "taylor" and request.time_limit is None:
        compiled, failures = simulate_compiled(scenarios, request, first)
        outcomes |= failures
    else:
        outcomes = alone(range(first, first + len(scenarios)), request.first_method)
    if request.method is None and request.first_method == "taylor":
        kinds = (CannotCompileError, ToleranceError)
        cannot = [member for member, each in outcomes.items() if isinstance(each, kinds)]
        outcomes |= alone(cannot, None)
    return compiled, outcomes, (process_time() - begin) / len(scenarios)
