"""One hard case, run to its end and classified from measured error, drift and energy."""

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np

import analysis
import mbs_models
from analysis import Method, Trajectory
from validation.crosscheck import angle_error
from validation.isolated import Failure, run_isolated
from validation.robustness_cases import TOLERANCE, Problem, Way, scene

Verdict = Literal["accurate", "inaccurate", "diverged", "refused", "too slow", "crashed"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of a case.

    Parameters
    ----------
    problem : Problem
    way : Way
    verdict : str
        `accurate`: the error is within what was asked for or promised. `inaccurate`: a result
        came back as right and is not. `diverged`: the run said itself that it failed. `refused`:
        it did not start. `too slow` and `crashed`: the process had to be ended, or ended itself.
    error : float, optional
        Largest deviation of beta and gamma from the reference in rad.
    doubt : float, optional
        Deviation of two references by different methods from each other in rad.
    estimate : float, optional
        The run's own error estimate in rad.
    drift : float, optional
        Largest residual of the position-level constraints in m.
    energy : float, optional
        Largest residual of the energy balance as a part of weight times radius.
    repeatable : bool, optional
        Whether a second run gives the same bits; None if there was none.
    seconds : float
    reason : str
        Why it diverged or was refused.
    """

    problem: Problem
    way: Way
    verdict: Verdict
    error: float | None = None
    doubt: float | None = None
    estimate: float | None = None
    drift: float | None = None
    energy: float | None = None
    repeatable: bool | None = None
    seconds: float = 0.0
    reason: str = ""


def run_problems(batch: Sequence[tuple[Problem, Sequence[Way]]], limit: float) -> list[Outcome]:
    """Run problems in several ways each, in a process that may hang or crash.

    Parameters
    ----------
    batch : sequence of (Problem, sequence of Way)
    limit : float
        Time limit of each run in s.
    """
    cases = [(problem, way) for problem, ways in batch for way in ways]
    results = run_isolated(run_case, cases, limit=limit)
    return [
        Outcome(problem=problem, way=way, verdict=result.kind, reason=result.reason)
        if isinstance(result, Failure)
        else result
        for (problem, way), result in zip(cases, results, strict=True)
    ]


def run_case(problem: Problem, way: Way) -> Outcome:
    """Run one case and classify it."""
    begin = time.perf_counter()
    try:
        run = simulate(problem, way)
    except ValueError as error:
        return _failed(problem, way, "refused", error, begin)
    except ArithmeticError as error:
        return _failed(problem, way, "diverged", error, begin)
    seconds = time.perf_counter() - begin
    again = simulate(problem, way) if problem.axis == "sampling" else None
    try:
        truth, doubt = reference(problem)
    except ArithmeticError as error:
        reason = f"the reference fails: {error}"
        return Outcome(
            problem=problem, way=way, verdict="inaccurate", seconds=seconds, reason=reason
        )
    deviation = angle_error(run, truth)
    promised = max(TOLERANCE, run.error_estimate or 0.0)
    drift = float(np.max(analysis.constraint_drift(run)[0]))
    return Outcome(
        problem=problem,
        way=way,
        # What the references leave open cannot be held against the run.
        verdict="accurate" if deviation <= promised + doubt else "inaccurate",
        error=deviation,
        doubt=doubt,
        estimate=run.error_estimate,
        drift=drift,
        energy=_energy(run),
        repeatable=None if again is None else _same(run, again),
        seconds=seconds,
    )


def _failed(
    problem: Problem, way: Way, verdict: Verdict, error: Exception, begin: float
) -> Outcome:
    return Outcome(
        problem=problem,
        way=way,
        verdict=verdict,
        seconds=time.perf_counter() - begin,
        reason=" ".join(str(error).split()),
    )


def simulate(problem: Problem, way: Way) -> Trajectory:
    """Simulate a problem to `TOLERANCE`."""
    times = np.linspace(0.0, problem.end, problem.samples)
    if way.source == "engine":
        return mbs_models.simulate(
            scene(problem, way),
            times,
            # Step control has a local tolerance of its own and promises nothing more.
            tolerance=None if way.integrator == "DOPRI5" else TOLERANCE,
            integrator=way.integrator,  # type: ignore[arg-type]  # the engine's, by its source
        )
    return quietly(
        problem.level,
        times,
        disk=problem.disk,
        friction=problem.friction,
        start=problem.start,
        form=way.formulation,
        method=way.integrator,
        tolerance=TOLERANCE,
    )


def quietly(*arguments: Any, **options: Any) -> Trajectory:
    """`analysis.simulate` without a warning of SciPy's.

    Its Jacobian by differences warns where a column is zero, as those of the position are.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return analysis.simulate(*arguments, **options)


@lru_cache(maxsize=4)
def reference(problem: Problem) -> tuple[Trajectory, float]:
    """In-house run, and its deviation in rad from one by another method.

    Raises
    ------
    ArithmeticError
        If one of the two fails.
    """
    stiff = problem.friction.smoothing < 1e-3
    methods: tuple[Method, Method] = ("Radau", "BDF") if stiff else ("DOP853", "Radau")
    first, second = (
        quietly(
            problem.level,
            np.linspace(0.0, problem.end, problem.samples),
            disk=problem.disk,
            friction=problem.friction,
            start=problem.start,
            method=method,
            local_tolerance=tolerance,
        )
        for method, tolerance in zip(methods, (1e-10, 1e-9), strict=True)
    )
    return first, angle_error(first, second)


def _energy(run: Trajectory) -> float | None:
    if run.times.size < 101:
        return None
    scale = run.disk.weight * run.disk.radius
    return float(np.max(np.abs(analysis.energy_residual(run)))) / scale


def _same(run: Trajectory, other: Trajectory) -> bool:
    return bool(
        np.array_equal(run.coordinates, other.coordinates)
        and np.array_equal(run.rates, other.rates)
        and np.array_equal(run.multipliers, other.multipliers)
    )
