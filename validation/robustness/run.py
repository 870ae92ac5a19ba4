"""One hard case, run to its end and classified from measured error, drift and energy."""

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

import analysis
import mbs_models
from analysis import Method, Trajectory
from analysis.checks import Array
from mbs_models import Integrator
from validation.crosscheck import angle_error
from validation.robustness.cases import TOLERANCE, Problem, Way, scene
from validation.robustness.isolated import Failure, run_isolated

Verdict = Literal[
    "accurate", "inaccurate", "unchecked", "diverged", "refused", "too slow", "crashed"
]

Reference = tuple[Trajectory, float]
"""A run to compare with, and its deviation in rad from one by another method."""

REFERENCE_LIMIT = 4.0
"""Time that a reference may take, in time limits of a run."""


SLACK = 10.0
"""Times the angles' allowed error in rad that drift over radius and relative energy error may be.

Speeds and forces are not what a tolerance promises, and converge more slowly in some methods.
"""

FEW = 3
"""Samples up to which a run is repeated, to see whether it gives the same bits."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of a case.

    Parameters
    ----------
    problem : Problem
    way : Way
    verdict : str
        `accurate`: the error is within what was asked for or promised, drift and energy within
        `SLACK` times that. `inaccurate`: a result came back, and is beyond that. `unchecked`: a
        result came back, and there is no reference. `diverged`: the run said itself that it
        failed. `refused`: it did not start. `too slow` and `crashed`: the process had to be ended,
        or ended itself.
    error : float, optional
        Largest deviation of beta and gamma from the reference in rad.
    doubt : float, optional
        Deviation of two references by different methods from each other in rad.
    estimate : float, optional
        The run's own error estimate in rad.
    drift : float, optional
        Largest residual of the position-level constraints as a part of the radius; None on a
        penalty contact.
    energy : float, optional
        Largest deviation of the energy from the reference as a part of its largest value.
    repeatable : bool, optional
        Whether a second run gives the same bits; None if there was none.
    seconds : float
    reason : str
        Why it diverged, was refused or is unchecked.
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

    @property
    def broken(self) -> bool:
        """Whether it crashed, broke its promise or, run again, gave other bits.

        The promise is about the angles. A run without an error estimate, such as one with step
        control, promises nothing.
        """
        if self.verdict == "crashed" or self.repeatable is False:
            return True
        if self.error is None or self.estimate is None:
            return False
        return self.error > max(TOLERANCE, self.estimate) + (self.doubt or 0.0)


def run_problems(batch: Sequence[tuple[Problem, Sequence[Way]]], limit: float) -> list[Outcome]:
    """Run problems in several ways each, in a process that may hang or crash.

    Parameters
    ----------
    batch : sequence of (Problem, sequence of Way)
    limit : float
        Time limit of each run in s.
    """
    problems = [problem for problem, _ in batch]
    found = run_isolated(
        reference_or_reason, [(problem,) for problem in problems], limit=REFERENCE_LIMIT * limit
    )
    references = [each.reason if isinstance(each, Failure) else each for each in found]
    cases = [
        (problem, way, known)
        for (problem, ways), known in zip(batch, references, strict=True)
        for way in ways
    ]
    results = run_isolated(run_case, cases, limit=limit)
    return [
        Outcome(problem=problem, way=way, verdict=result.kind, reason=result.reason)
        if isinstance(result, Failure)
        else result
        for (problem, way, _), result in zip(cases, results, strict=True)
    ]


def run_case(problem: Problem, way: Way, known: Reference | str) -> Outcome:
    """Run one case and classify it.

    Parameters
    ----------
    problem : Problem
    way : Way
    known : (Trajectory, float) or str
        The reference, or why there is none.
    """
    begin = time.perf_counter()
    try:
        run = simulate(problem, way)
    except ValueError as error:
        return _failed(problem, way, "refused", error, begin)
    except ArithmeticError as error:
        return _failed(problem, way, "diverged", error, begin)
    seconds = time.perf_counter() - begin
    again = simulate(problem, way) if problem.samples <= FEW else None
    if isinstance(known, str):
        return Outcome(
            problem=problem,
            way=way,
            verdict="unchecked",
            estimate=run.error_estimate,
            seconds=seconds,
            reason=f"the reference fails: {known}",
        )
    truth, doubt = known
    deviation, energy = angle_error(run, truth), _energy(run, truth)
    drift = None
    if problem.contact is None:
        drift = float(np.max(analysis.constraint_drift(run)[0])) / problem.disk.radius
    # What the references leave open cannot be held against the run.
    allowed = max(TOLERANCE, run.error_estimate or 0.0) + doubt
    good = deviation <= allowed and max(drift or 0.0, energy) <= SLACK * allowed
    return Outcome(
        problem=problem,
        way=way,
        verdict="accurate" if good else "inaccurate",
        error=deviation,
        doubt=doubt,
        estimate=run.error_estimate,
        drift=drift,
        energy=energy,
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
    times = _times(problem)
    if way.source == "engine":
        return mbs_models.simulate(
            scene(problem, way.formulation),  # type: ignore[arg-type]  # the engine's, by its source
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


def reference_or_reason(problem: Problem) -> Reference | str:
    """The reference of a problem, or why there is none."""
    try:
        return reference(problem)
    except ArithmeticError as error:
        return " ".join(str(error).split())


def reference(problem: Problem) -> Reference:
    """Run to compare with, and its deviation from one by another method.

    Both are in-house, or on a penalty contact of different formulations and integrators.

    Raises
    ------
    ArithmeticError
        If one of the two fails.
    """
    if problem.contact is not None:
        first, second = _penalty_references(problem)
        return first, angle_error(first, second)
    stiff = problem.friction.smoothing < 1e-3
    methods: tuple[Method, Method] = ("Radau", "BDF") if stiff else ("DOP853", "Radau")
    first, second = (
        quietly(
            problem.level,
            _times(problem),
            disk=problem.disk,
            friction=problem.friction,
            start=problem.start,
            method=method,
            local_tolerance=tolerance,
        )
        for method, tolerance in zip(methods, (1e-10, 1e-9), strict=True)
    )
    return first, angle_error(first, second)


def _penalty_references(problem: Problem) -> tuple[Trajectory, Trajectory]:
    tree, body = (scene(problem, formulation) for formulation in ("euler-tree", "floating-lie"))
    tight = Integrator(name="DOPRI5", local_tolerance=1e-11)
    return (
        mbs_models.simulate(tree, _times(problem), integrator=tight),
        mbs_models.simulate(body, _times(problem), tolerance=1e-8),
    )


def _times(problem: Problem) -> Array:
    return np.linspace(0.0, problem.end, problem.samples)


def _energy(run: Trajectory, truth: Trajectory) -> float:
    total, expected = (
        sum(analysis.energies(each.disk, each.coordinates, each.rates)) for each in (run, truth)
    )
    return float(np.max(np.abs(total - expected)) / np.max(expected))


def _same(run: Trajectory, other: Trajectory) -> bool:
    return bool(
        np.array_equal(run.coordinates, other.coordinates)
        and np.array_equal(run.rates, other.rates)
        and np.array_equal(run.multipliers, other.multipliers)
    )
