"""Cases of a sweep, run by themselves or together: what is called in a worker."""

import faulthandler
import json
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np

from analysis import Ensemble, Trajectories, outcomes, simulate_many
from analysis.data.outcomes import DONE, Row, failure
from validation.sweeps.outcomes import difference, outcome, series
from validation.sweeps.plan import Motion, Plan
from validation.sweeps.sweep import Sweep

_IDLE = 20
"""Times as much may pass on the clock, on a machine that has other things to do."""

TIMERS = tuple(
    (getattr(signal, f"ITIMER_{name}"), times, getattr(signal, signal_name))
    for name, times, signal_name in (("PROF", 1, "SIGPROF"), ("REAL", _IDLE, "SIGALRM"))
    if hasattr(signal, "setitimer")
)
"""Which ends a process after so many times a limit, and by which signal; none on Windows."""


def run_chunk(text: str, numbers: Sequence[int], time_limit: float, hanging: float) -> list[Row]:
    """Rows of some cases.

    Parameters
    ----------
    text : str
        From `Sweep.to_text`.
    numbers : sequence of int
    time_limit : float
        Of each run in s of processor time.
    hanging : float
        Processor time in s after which a case that does not look at its limit, such as an endless
        loop of a friction law of one's own, ends the process.
    """
    sweep = _sweep_from(text)
    if sweep.plan.runs_in_batches and len(numbers) > 1:
        # A case of a chunk that takes too long is found when its cases run alone.
        with _ended_after(hanging):
            return run_batch(sweep, numbers)
    rows = []
    for number in numbers:
        with _ended_after(hanging):
            rows.append(run_case(sweep, number, time_limit))
    return rows


@lru_cache(maxsize=1)
def _sweep_from(text: str) -> Sweep:
    """Sweep from the JSON of `Sweep.to_text`; the last one is kept."""
    return Sweep.from_values(json.loads(text))


@contextmanager
def _ended_after(seconds: float) -> Iterator[None]:
    """End this process if a context takes so much processor time, or waits for ever.

    That needs nothing of the interpreter, whose lock the engine holds: a signal that nobody
    handles ends a process.
    """
    for timer, times, _ in TIMERS:
        signal.setitimer(timer, times * seconds)
    if not TIMERS:
        faulthandler.dump_traceback_later(_IDLE * seconds, exit=True)
    try:
        yield
    finally:
        for timer, *_ in TIMERS:
            signal.setitimer(timer, 0.0)
        if not TIMERS:
            faulthandler.cancel_dump_traceback_later()


def run_case(sweep: Sweep, index: int, time_limit: float | None) -> Row:
    """Row of a case: its number, its values and its outcome, or why there is none."""
    begin = time.process_time()
    row: Row = {"number": index, **sweep.design.values_of(index)}
    try:
        motion = sweep.plan.motion(sweep.scenario_of(index), time_limit=time_limit)
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a law of one's own may raise any
        return {**row, **failure(error), "seconds": time.process_time() - begin}
    row |= outcome(motion)
    row["seconds"] = time.process_time() - begin
    return {**row, **_besides(sweep, index, motion, time_limit)} if row["status"] == DONE else row


def run_batch(sweep: Sweep, numbers: Sequence[int]) -> list[Row]:
    """Rows of several cases that are compiled and run together; the plan's method is "taylor".

    The time limit is left to whoever calls this.
    """
    begin = time.process_time()
    cases = [sweep.design.values_of(number) for number in numbers]
    fields = {name: np.array([case[name] for case in cases]) for name in cases[0]}
    ensemble, members, found = Ensemble.sieved(sweep.scenario, fields)
    outcome_of: dict[int, Row] = {member: failure(error) for member, error in found.items()}
    runs = _together(sweep.plan, ensemble) if members.size else None
    if runs is not None:
        outcome_of |= dict(zip(members.tolist(), outcomes(runs).rows(), strict=True))
    each = (time.process_time() - begin) / len(cases)
    rows: list[Row] = [
        {**outcome_of[member], "number": number, **case, "seconds": each}
        for member, (number, case) in enumerate(zip(numbers, cases, strict=True))
    ]
    for place, member in enumerate(members.tolist()):
        wanted = sweep.plan.keep or sweep.has_witness(numbers[member])
        if runs is not None and wanted and rows[member]["status"] == DONE:
            rows[member] |= _besides(sweep, numbers[member], runs[place], None)
    return rows


def _together(plan: Plan, ensemble: Ensemble) -> Trajectories:
    form: Any = plan.formulation
    return simulate_many(
        ensemble,
        plan.times,
        form=form,
        method="taylor",
        tolerance=plan.tolerance,
        local_tolerance=plan.local_tolerance,
        stop_when=plan.stop_when or (),
        workers=1,
    )


def _besides(sweep: Sweep, index: int, motion: Motion, time_limit: float | None) -> Row:
    """Series of a case and what its witness says, where they are asked for."""
    row = series(motion, sweep.plan.keep)
    if sweep.has_witness(index):
        row |= _witnessed(sweep.plan, motion, time_limit)
    return row


def _witnessed(plan: Plan, motion: Motion, time_limit: float | None) -> Row:
    begin = time.process_time()
    try:
        other = plan.witness(motion.scenario, time_limit=time_limit)
    except (ValueError, ArithmeticError) as error:
        return {"other_inversion": "failed", "reason": failure(error)["reason"]}
    found = outcome(other)
    if found["status"] != DONE:
        return {"other_inversion": "failed", "reason": found["reason"]}
    return {
        "other_inversion": found["inversion"],
        "other_face_end": found["face_end"],
        "other_error_estimate": found["error_estimate"],
        "other_seconds": time.process_time() - begin,
        "difference": difference(motion, other),
    }
