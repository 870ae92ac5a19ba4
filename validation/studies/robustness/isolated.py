"""Calls in a process of their own, each with a time limit, that may hang or crash."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, Literal

from analysis.data.workers import end_with_parent

START_LIMIT = 60.0
"""Time in s in which a new process must have come up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """A call that gave nothing back.

    Parameters
    ----------
    kind : {"too slow", "crashed"}
    reason : str
    """

    kind: Literal["too slow", "crashed"]
    reason: str


def run_isolated(
    function: Callable[..., Any], calls: Sequence[tuple[Any, ...]], *, limit: float
) -> list[Any]:
    """Call a function many times in a process of its own; results or `Failure`, in order.

    A call that takes too long is ended, one that takes the interpreter down is noted, and either
    way the next call gets a new process. An exception of the function is a crash as well.

    Parameters
    ----------
    function : callable
        Importable by its name.
    calls : sequence of tuples
        Arguments of each call.
    limit : float
        Time limit of each call in s.
    """
    results: list[Any] = []
    while len(results) < len(calls):
        results += _until_failure(function, calls[len(results) :], limit)
    return results


def _until_failure(
    function: Callable[..., Any], calls: Sequence[tuple[Any, ...]], limit: float
) -> list[Any]:
    """Results up to the first failure, which is the last of them then."""
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs, function, list(calls)), daemon=True)
    process.start()
    theirs.close()
    results: list[Any] = []
    try:
        if not ours.poll(START_LIMIT):
            return [Failure(kind="crashed", reason="the process did not start")]
        ours.recv()
        for _ in calls:
            if not ours.poll(limit):
                failure = Failure(kind="too slow", reason=f"no result within {limit:g} s")
                return [*results, failure]
            results.append(ours.recv())
    except EOFError:
        process.join()
        reason = f"the interpreter ended with code {process.exitcode}"
        results.append(Failure(kind="crashed", reason=reason))
    finally:
        ours.close()
        process.kill()
        process.join()
    return results


def _serve(pipe: Connection, function: Callable[..., Any], calls: list[tuple[Any, ...]]) -> None:
    """Run the calls in the child and send the results as they come."""
    end_with_parent()
    pipe.send("ready")
    for arguments in calls:
        pipe.send(function(*arguments))
