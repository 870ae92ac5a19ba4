"""Many runs of the in-house equations at once."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from os import cpu_count
from time import process_time
from typing import Any, TypeVar, overload

import numpy as np
import numpy.typing as npt

from analysis.compiled.batches import Outcome, simulate_batches
from analysis.compiled.library import CannotCompileError, is_installed
from analysis.compiled.parts import Request, simulate_ensemble
from analysis.data.checks import (
    Array,
    ToleranceError,
    choice,
    function,
    increasing_times,
    instance,
    switch,
    whole,
)
from analysis.data.checks import local_tolerance as one_step
from analysis.data.endings import StopWhen, named_conditions
from analysis.data.ensemble import Ensemble
from analysis.data.limits import check_storage
from analysis.data.scenario import Scenario
from analysis.data.state import COORDINATES
from analysis.data.trajectories import Listed, Part, Trajectories, joined
from analysis.data.trajectory import Trajectory
from analysis.data.watch import Watch
from analysis.data.workers import Pool
from analysis.models.forms import FORMS, Form
from analysis.models.simulation import TIGHTEST_LOCAL_TOLERANCE, simulate
from analysis.solve.stepping import METHODS, Method

S = TypeVar("S")
T = TypeVar("T")
Tolerances = list[float | None]

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
def simulate_many(  # type: ignore[misc] # what comes out hangs on the members alone
    scenarios: Ensemble | Iterable[Scenario],
    times: npt.ArrayLike,
    *,
    form: Form | None = None,
    method: Method | None = None,
    tolerance: float | Sequence[float] | Array | None = None,
    local_tolerance: float | None = None,
    stop_when: StopWhen = (),
    allow_pulling: bool = False,
    time_limit: float | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Trajectories | list[Outcome]:
    """Simulate many scenarios; a member that fails does not end the others.

    Where heyoka is installed, members alike in structure are compiled together and run in
    batches, with the error estimate, endings and errors of single runs. Others, and more than
    `COMPILED_CHUNK` compiled ones, run on worker processes, which import the calling script: as
    with every such pool, a script calls this below `if __name__ == "__main__":`.

    Parameters
    ----------
    scenarios : Ensemble or iterable of Scenario
        The members. An ensemble is told by arrays and gives arrays; nothing is then done for
        each member in Python that is not asked for.
    times : array_like, shape (n,)
        Times in s, the same for all; see `simulate`.
    form, local_tolerance, stop_when, allow_pulling, time_limit
        Of every member, as in `simulate`. Functions in `stop_when` must be importable by name.
    method : str, optional
        As in `simulate`. By default "taylor" where heyoka is installed, and DOP853 for members
        that cannot be compiled or that it does not take to their tolerance: `Trajectory.method`
        tells. Compiled members run in batches.
    tolerance : float or sequence of floats, optional
        As in `simulate`, of all members or of each.
    workers : int, optional
        Number of processes, by default that of the cores; 1 runs everything in this process.
    executor : Executor, optional
        Where to run instead: anything with the interface of `concurrent.futures`.
    progress : callable, optional
        Called with the number of members done and of all.

    Returns
    -------
    Trajectories, or list of Trajectory or Exception
        For an ensemble, its motions as arrays. For scenarios the outcome of each, in order. An
        error is what `simulate` raises, or `BrokenExecutor` if a worker process died.

    Raises
    ------
    ValueError
        If the times, the conditions, the workers or the number of tolerances are out of range.
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
    times = increasing_times(times)
    allow_pulling = switch("allow_pulling", allow_pulling)
    if form is not None:
        choice("form", form, FORMS)
    if method is not None:
        choice("method", method, METHODS)
    if local_tolerance is not None:
        one_step("local_tolerance", local_tolerance, TIGHTEST_LOCAL_TOLERANCE)
    Watch(time_limit)
    check_storage("times", len(members) * times.size, 2 * len(COORDINATES))
    named_conditions(stop_when)
    if workers is not None:
        workers = whole("workers", workers)
    tolerances = _each(tolerance, len(members))
    how = _How(form, method, local_tolerance, stop_when, allow_pulling, time_limit)
    workers = workers or cpu_count() or 1
    if how.first == "taylor":
        chunk = COMPILED_CHUNK
    else:
        chunk = max(1, min(LARGEST_CHUNK, len(members) // (4 * workers)))
    rows = [slice(first, first + chunk) for first in range(0, len(members), chunk)]
    tell = (lambda _done, _all: None) if progress is None else function("progress", progress)
    if isinstance(members, Ensemble):
        pieces = [(members.part(some), tolerances[some]) for some in rows]
        found = _called(partial(_motions, times=times, how=how), pieces, executor, workers, tell)
        return joined(
            members,
            [
                _lost(piece, times, each) if isinstance(each, Exception) else each
                for each, (piece, _) in zip(found, pieces, strict=True)
            ],
        )
    lists = [(members[some], tolerances[some]) for some in rows]
    listed = _called(partial(_outcomes, times=times, how=how), lists, executor, workers, tell)
    outcomes: list[Outcome] = []
    for each, (some, _) in zip(listed, lists, strict=True):
        outcomes += [each] * len(some) if isinstance(each, Exception) else each
    return outcomes


def _members(given: Ensemble | Iterable[Scenario]) -> Ensemble | list[Scenario]:
    if isinstance(given, Ensemble):
        return given
    if isinstance(given, type) or not isinstance(given, Iterable):
        raise ValueError(f"scenarios must be an Ensemble or a list of Scenario, got {given!r}")
    return [instance(f"scenarios[{row}]", each, Scenario) for row, each in enumerate(given)]


@dataclass(frozen=True, slots=True)
class _How:
    """What is asked of every member, as in `simulate`."""

    form: Form | None
    method: Method | None
    local_tolerance: float | None
    stop_when: StopWhen
    allow_pulling: bool
    time_limit: float | None

    @property
    def first(self) -> Method:
        """Method that is tried first."""
        return self.method or ("taylor" if is_installed() else "DOP853")

    @property
    def runs_in_batches(self) -> bool:
        """Whether members are run together."""
        return self.first == "taylor" and not self.allow_pulling and self.time_limit is None


def _called(
    call: Callable[[S, Tolerances], T],
    pieces: Sequence[tuple[S, Tolerances]],
    executor: Executor | None,
    workers: int,
    tell: Callable[[int, int], None],
) -> list[T | Exception]:
    """What a function makes of pieces of an ensemble, here or elsewhere, in order."""
    size = sum(len(tolerances) for _, tolerances in pieces)
    done = 0
    if executor is None and (workers == 1 or len(pieces) == 1):
        results: list[T | Exception] = []
        for piece in pieces:
            results.append(call(*piece))
            done += len(piece[1])
            tell(done, size)
        return results
    with ExitStack() as stack:
        pool = executor or stack.enter_context(Pool(min(workers, len(pieces))))
        futures: dict[Future[T], int] = {
            pool.submit(call, *piece): len(piece[1]) for piece in pieces
        }
        for future in as_completed(futures):
            if isinstance(pool, Pool) and isinstance(future.exception(), BrokenExecutor):
                pool.check_begun()
            done += futures[future]
            tell(done, size)
    return [_result(future) for future in futures]


def _result(future: Future[Any]) -> Any:
    try:
        return future.result()
    except BrokenExecutor as error:
        return error


def _each(tolerance: float | Sequence[float] | Array | None, count: int) -> Tolerances:
    if not isinstance(tolerance, Sequence | np.ndarray):
        return [tolerance] * count
    given: list[float | None] = list(tolerance)
    if len(given) != count:
        raise ValueError(f"tolerance must be one number or {count} of them, got {len(given)}")
    return given


def _lost(piece: Ensemble, times: Array, error: Exception) -> Trajectories:
    """Motions of members whose worker has died."""
    failures = dict.fromkeys(range(len(piece)), error)
    return Trajectories(
        ensemble=piece,
        times=times,
        parts=(),
        failures=failures,
        seconds=np.full(len(piece), np.nan),
    )


def _motions(
    ensemble: Ensemble, tolerances: Tolerances, *, times: Array, how: _How
) -> Trajectories:
    """Motions of some members of an ensemble, in this process."""
    begin = process_time()
    parts: list[Part] = []
    failures: dict[int, Exception] = {}
    others = list(range(len(ensemble)))
    if how.runs_in_batches:
        request = Request(
            times=times,
            form=how.form,
            local_tolerance=how.local_tolerance,
            conditions=named_conditions(how.stop_when),
        )
        parts, failures, others = simulate_ensemble(ensemble, tolerances, request)
    scenarios = [ensemble[member] for member in others]
    asked = [tolerances[member] for member in others]
    outcomes = dict(zip(others, _outcomes(scenarios, asked, times=times, how=how), strict=True))
    for member, error in failures.items():
        outcomes[member] = _another_way(error, ensemble[member], tolerances[member], times, how)
    motions = {row: each for row, each in outcomes.items() if isinstance(each, Trajectory)}
    failures = {row: each for row, each in outcomes.items() if isinstance(each, Exception)}
    if motions:
        parts.append(Listed(np.array(list(motions)), list(motions.values()), times.size))
    return Trajectories(
        ensemble=ensemble,
        times=times,
        parts=parts,
        failures=failures,
        seconds=np.full(len(ensemble), (process_time() - begin) / len(ensemble)),
    )


def _outcomes(
    scenarios: Sequence[Scenario], tolerances: Tolerances, *, times: Array, how: _How
) -> list[Outcome]:
    """Outcomes of some members, with their tolerances, in this process."""
    tasks = list(zip(scenarios, tolerances, strict=True))
    if how.runs_in_batches:
        outcomes = simulate_batches(
            tasks,
            times,
            form=how.form,
            local_tolerance=how.local_tolerance,
            conditions=named_conditions(how.stop_when),
        )
    else:
        outcomes = [_alone(*task, times, how, how.first) for task in tasks]
    return [
        _another_way(outcome, *task, times, how)
        for outcome, task in zip(outcomes, tasks, strict=True)
    ]


def _another_way(
    outcome: Outcome, scenario: Scenario, tolerance: float | None, times: Array, how: _How
) -> Outcome:
    """The same by DOP853, if Taylor's method has not come to an outcome and was not asked for."""
    cannot = isinstance(outcome, CannotCompileError | ToleranceError)
    if not cannot or how.method is not None or how.first == "DOP853":
        return outcome
    return _alone(scenario, tolerance, times, how, "DOP853")


def _alone(
    scenario: Scenario, tolerance: float | None, times: Array, how: _How, method: Method
) -> Outcome:
    """Outcome of one run by itself."""
    try:
        return simulate(
            scenario,
            times,
            form=how.form,
            method=method,
            tolerance=tolerance,
            local_tolerance=how.local_tolerance,
            stop_when=how.stop_when,
            allow_pulling=how.allow_pulling,
            time_limit=how.time_limit,
        )
    except (ArithmeticError, ValueError) as error:
        return error
