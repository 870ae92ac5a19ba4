"""Cases of a sweep, run by themselves or together: what is called in a worker."""

import faulthandler
import signal
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from multiprocessing import parent_process
from typing import Any

import numpy as np

from analysis import Ensemble, Scenario, StoredRun, Trajectories, outcomes, simulate_many
from analysis.motion.outcomes import DONE, OUTCOMES, Row
from analysis.problem.variations import changed
from validation.comparison.differences import deviation
from validation.sweeps.plan import TIME, Plan
from validation.sweeps.sweep import Sweep

_OF_WITNESS = ("inversion", "ending", "face_end", "error_estimate", "seconds")

COLUMNS: Mapping[str, str | None] = {
    **OUTCOMES,
    **{f"other_{name}": OUTCOMES[name] for name in _OF_WITNESS},
    "difference": "rad",
    "code": None,
}
"""Columns of a row behind those of the axes, with their units; None for words.

Behind `OUTCOMES` those of the run of the other side, where there is one (`WITNESS_FAILED` if it
gave none, with its reason); `difference` is their `deviation`; `code` names commit and sources
that the row comes from.
"""

WITNESS_FAILED = "failed"
"""Word for the inversion of the run of the other side where that has failed."""

NUMBERS = "<f8"
"""Of a series in a store, as `numpy.frombuffer` takes it: 8 bytes each, the lowest one first."""

_IDLE = 20
"""Times as much may pass on the clock, on a machine that has other things to do."""

CaseRow = dict[str, Any]
"""Cells by the names of their columns, and under "series" the bytes of series by theirs."""

TIMERS = (
    {signal.SIGPROF: (signal.ITIMER_PROF, 1), signal.SIGALRM: (signal.ITIMER_REAL, _IDLE)}
    if hasattr(signal, "setitimer")
    else {}
)
"""By the signal that ends a process: its timer, after so many times a limit; none on Windows."""


def run_chunk(sweep: Sweep, numbers: Sequence[int]) -> list[CaseRow]:
    """Rows of some cases: their numbers, values and outcomes, or why there is none.

    A case that does not look at its time limit, such as an endless loop of a friction law of one's
    own, ends the process; see `Plan.hanging`.
    """
    plan, rows = sweep.plan, []
    cases = [sweep.design.values_of(number) for number in numbers]
    runs: Any
    if plan.runs_in_batches and len(cases) > 1:
        runs = _together(sweep, cases)
        seconds = runs.seconds.tolist()
    else:
        runs, seconds = zip(*(_run(plan, sweep.scenario, case) for case in cases), strict=True)
    told = zip(outcomes(runs).rows(), numbers, cases, seconds, strict=True)
    for place, (found, number, case, taken) in enumerate(told):
        row: CaseRow = {**found, "number": number, **case, "seconds": taken}
        if row["status"] == DONE:
            # A motion of a batch is worked out where it is asked for.
            if plan.keep:
                row["series"] = series(runs[place], plan.keep)
            if sweep.has_witness(number):
                row |= _told_by_witness(plan.witness, runs[place])
        rows.append(row)
    return rows


@contextmanager
def _ended_after(seconds: float) -> Iterator[None]:
    """End this process if a context takes so much processor time, or waits for ever.

    That needs nothing of the interpreter, whose lock the engine holds: a signal that nobody
    handles ends a process.
    """
    for timer, times in TIMERS.values():
        signal.setitimer(timer, times * seconds)
    if not TIMERS:
        faulthandler.dump_traceback_later(_IDLE * seconds, exit=True)
    try:
        yield
    finally:
        for timer, _ in TIMERS.values():
            signal.setitimer(timer, 0.0)
        if not TIMERS:
            faulthandler.cancel_dump_traceback_later()


def _run(plan: Plan, scenario: Scenario, values: Mapping[str, Any]) -> tuple[Any, float]:
    """Motion with other values of some fields, or the error that ended it; processor time in s."""
    begin = time.process_time()
    with _ended_after(plan.hanging):
        try:
            motion: Any = plan.motion(changed(scenario, values))
        except BaseException as error:
            # Ctrl-C comes to the process that was called alone, and is no failure of a case.
            if isinstance(error, KeyboardInterrupt) and parent_process() is None:
                raise
            motion = error
    return motion, time.process_time() - begin


def _together(sweep: Sweep, cases: Sequence[Mapping[str, Any]]) -> Trajectories:
    """Motions of cases that are compiled and run together; the plan's method is "taylor".

    The time limit of their runs is left to whoever calls this.
    """
    plan = sweep.plan
    fields = {name: np.array([case[name] for case in cases]) for name in cases[0]}
    ensemble = Ensemble(scenario=sweep.scenario, fields=fields, check=False)
    how = plan.given("method", "tolerance", "local_tolerance", "stop_when", "allow_pulling")
    # A case of a chunk that takes too long is found when its cases run alone.
    with _ended_after(plan.hanging):
        return simulate_many(ensemble, plan.times, formulation=plan.formulation, workers=1, **how)


def _told_by_witness(plan: Plan, motion: StoredRun) -> Row:
    """Columns of the run of the other side of the same scenario."""
    other, seconds = _run(plan, motion.scenario, {})
    (found,) = outcomes([other]).rows()
    if found["status"] != DONE:
        return {"other_inversion": WITNESS_FAILED, "reason": found["reason"]}
    told = {f"other_{name}": found[name] for name in _OF_WITNESS}
    return told | {"other_seconds": seconds, "difference": deviation(motion, other)}


def series(motion: StoredRun, names: Sequence[str]) -> dict[str, bytes]:
    """Bytes of some series of a motion and of its times; those that it has."""
    held = motion.columns()
    return {
        name: held[name][0].astype(NUMBERS).tobytes() for name in (TIME, *names) if name in held
    }


def outcome(motion: StoredRun) -> Row:
    """What is kept of a motion, without its run time."""
    (row,) = outcomes([motion]).rows()
    return {name: row[name] for name in OUTCOMES}
