"""Runs to a tolerance: the local tolerance is tightened until two runs agree."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from analysis.data.agreement import error_at_ending, needed
from analysis.data.checks import Array, TimeLimitError, ToleranceError
from analysis.data.endings import FLAT, TIME_LIMIT
from analysis.solve.stepping import InitialValueProblem, Run

ROUNDING = 1e-14
"""Error in rad that no run is free of, not even one that stands still."""

CAUTION = 2.0
"""Estimated error over the difference of two runs that it is taken from."""

COARSEST = 1e-5
"""Error in a step from which on runs take the longest steps there are, whatever is asked for."""

_MOMENT = 1e-7
"""Time in s over which rates are told by a difference."""


def run_to(
    run: Callable[[float, float], Run],
    problem: InitialValueProblem,
    tolerance: float,
    local_tolerances: Sequence[float],
    method: str,
) -> tuple[Run, float, float]:
    """Tighten the local tolerance until the estimated error of beta and gamma is small enough.

    Parameters
    ----------
    run : callable
        From a local tolerance and a part of the longest step to a run.
    problem : InitialValueProblem
        What is run.
    tolerance : float
        Largest error in rad.
    local_tolerances : sequence of float
        In turn; see `tighter_and_tighter`.
    method : str
        What runs, for the message.

    Returns
    -------
    run : Run
    local_tolerance : float
        That of this run.
    estimate : float
        Its estimated error in rad.

    Raises
    ------
    TimeLimitError
        If the time limit is met before two runs agree.
    ToleranceError
        If not even the last two do.
    """
    first, *tighter = local_tolerances
    longest = 1.0
    coarse, estimate = run(first, longest), inf
    for local in tighter:
        if coarse.ended == TIME_LIMIT:
            break
        # Not both may take the longest steps there are.
        longest *= 0.8
        fine = run(local, longest)
        fine, estimate = compare(fine, coarse, problem)
        if estimate <= needed(tolerance, fine.ended == FLAT):
            return fine, local, estimate
        coarse = fine
    if coarse.ended == TIME_LIMIT:
        raise TimeLimitError(
            f"time limit met at t = {coarse.times[-1]:.6g} s of a run before two runs agreed to "
            f"{tolerance:g} rad"
        )
    raise unreachable(tolerance, method, estimate)


def unreachable(tolerance: float, method: str, estimate: float) -> ToleranceError:
    """The error of a tolerance that not even the tightest run keeps."""
    return ToleranceError(
        f"tolerance {tolerance:g} rad cannot be reached with {method}: the estimated error of "
        f"the tightest run is {estimate:.1e} rad"
    )


def compare(fine: Run, coarse: Run, problem: InitialValueProblem) -> tuple[Run, float]:
    """The finer run as far as it can be judged, and its estimated error.

    The error in beta and gamma, and in the time of an ending, is infinite if the two do not end
    alike.
    """
    if fine.ended == TIME_LIMIT and fine.times.size > 2:
        fine = replace(fine, times=fine.times[:-1], states=fine.states[:-1])
    elif fine.ended != coarse.ended or fine.times.size != coarse.times.size:
        return fine, inf
    common = fine.times.size
    if coarse.times.size < common:
        return fine, inf
    error = ROUNDING / CAUTION
    if fine.ended not in {None, TIME_LIMIT}:
        common -= 1
        error = max(error, _apart_at_ending(fine, coarse, problem))
    attitudes = problem.attitudes
    apart = attitudes(fine.states[:common]) - attitudes(coarse.states[:common])
    return fine, CAUTION * max(error, float(np.max(np.abs(apart))))


def _apart_at_ending(fine: Run, coarse: Run, problem: InitialValueProblem) -> float:
    """How far two runs are apart at their endings, as `error_at_ending` has it."""

    def angles(state: Array) -> Array:
        if fine.ended == FLAT:
            # There only the sum or the difference of alpha and gamma has a meaning.
            return np.array([problem.leaning(state)])
        found: Array = problem.attitudes(state[None])[0]
        return found

    time, state = fine.times[-1], fine.states[-1]
    moved = state + _MOMENT * np.asarray(problem.right_hand_side(time, state))
    rates = (angles(moved) - angles(state)) / _MOMENT
    apart = angles(state) - angles(coarse.states[-1])
    return float(error_at_ending(apart, time - coarse.times[-1], rates))


def tighter_and_tighter(first: float, tightest: float) -> list[float]:
    """Local tolerances of the runs to a tolerance, in turn, none below the tightest.

    Two runs of nearly the same one would agree without being right.
    """
    local = max(min(first, COARSEST), 10.0 * tightest)
    tolerances = [local]
    while local >= 3.0 * tightest:
        local /= 10.0
        tolerances.append(max(local, tightest))
    return tolerances
