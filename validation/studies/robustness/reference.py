"""What a run is compared with: two runs by other methods, and how far they are apart."""

import warnings
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

import analysis
import mbs_models
from analysis import Method, Trajectory
from analysis.data.checks import Array
from analysis.models.simulation import TIGHTEST_LOCAL_TOLERANCE
from mbs_models import EngineError, Integrator
from validation.studies.robustness.cases import STIFF, Problem, Way, scene
from validation.studies.robustness.work import StepCount

STEPS = 30_000
"""Most steps of a reference of up to a second; of longer ones per second."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reference:
    """Two runs of a motion by two methods.

    Parameters
    ----------
    first, second : Trajectory
    """

    first: Trajectory
    second: Trajectory

    @property
    def doubt(self) -> float:
        """Their deviation in rad, or that of the times at which they end in s if it is larger."""
        return max(deviation(self.first, self.second), ending_error(self.first, self.second))

    def for_way(self, way: Way) -> Trajectory:
        """The first run, or the second for a way that has the method of the first."""
        method = self.first.method
        if self.first.source != way.source:
            return self.first
        if way.source == "in-house":
            same = method["method"] == way.integrator
        else:
            same = (method["formulation"], method["integrator"]) == (
                way.formulation,
                way.integrator,
            )
        return self.second if same else self.first


@dataclass(frozen=True, slots=True, kw_only=True)
class NoReference:
    """Why there is none.

    Parameters
    ----------
    reason : str
    refused : bool
        Whether the motion cannot start.
    """

    reason: str
    refused: bool = False


def common(run: Trajectory, other: Trajectory) -> int:
    """Number of samples that two runs of the same times share; the ending of one is none."""
    early = run.ending is not None or other.ending is not None
    return min(run.times.size, other.times.size) - early


def deviation(run: Trajectory, other: Trajectory) -> float:
    """Largest difference of beta and gamma in rad over what the two have in common."""
    rows = common(run, other)
    apart = np.abs(run.coordinates[:rows] - other.coordinates[:rows])[:, 4:6]
    return float(np.max(apart))


def ending_error(run: Trajectory, other: Trajectory) -> float:
    """Difference in s of the times at which two runs end; infinite if one alone ends early."""
    if run.ending is None and other.ending is None:
        return 0.0
    if run.ending is None or other.ending is None or run.ending.reason != other.ending.reason:
        return inf
    return abs(run.ending.time - other.ending.time)


def reference_or_reason(problem: Problem) -> Reference | NoReference:
    """The reference of a problem, or why there is none."""
    try:
        return reference(problem)
    except ValueError as error:
        return NoReference(reason=_line(error), refused=True)
    except ArithmeticError as error:
        return NoReference(reason=_line(error))


def reference(problem: Problem) -> Reference:
    """Two runs of a problem.

    Both are in-house, or on a penalty contact of different formulations and integrators.

    Raises
    ------
    ArithmeticError
        If one of the two fails, or takes too many steps.
    ValueError
        If the motion cannot start.
    """
    if problem.contact is not None:
        return _penalty_reference(problem)
    stiff = problem.friction.smoothing < STIFF
    # Over tens of seconds small errors grow by some thousands.
    tight = 1e-12 if problem.end <= 5.0 else TIGHTEST_LOCAL_TOLERANCE
    methods: tuple[tuple[Method, float], ...] = (
        ("Radau", 1e-10) if stiff else ("DOP853", tight),
        ("LSODA", tight),
    )
    first, second = (
        _within(
            problem,
            quietly,
            problem.level,
            problem.times,
            disk=problem.disk,
            friction=problem.friction,
            start=problem.start,
            method=method,
            local_tolerance=tolerance,
        )
        for method, tolerance in methods
    )
    return Reference(first=first, second=second)


def _penalty_reference(problem: Problem) -> Reference:
    tree, body = (scene(problem, formulation) for formulation in ("euler-tree", "floating-lie"))
    tight = Integrator(name="DOPRI5", local_tolerance=1e-11)
    try:
        first = _within(problem, mbs_models.simulate, tree, problem.times, integrator=tight)
    except EngineError:
        # Step control cannot pass the jump of a damper that meets the table: short steps can.
        first, second = (
            mbs_models.simulate(scene, problem.times, integrator="RK44", step=step)
            for scene, step in ((tree, 1e-6), (body, 1.3e-6))
        )
        return Reference(first=first, second=second)
    second = _within(
        problem, mbs_models.simulate, body, problem.times, integrator="RK67", tolerance=1e-8
    )
    return Reference(first=first, second=second)


def limited(steps: int, problem: Problem) -> int:
    """Limit of steps of a problem from that of a second."""
    return round(steps * max(1.0, problem.end))


def _within(problem: Problem, simulate: Any, *arguments: Any, **options: Any) -> Trajectory:
    """A call of `simulate` within the limit of steps."""
    count = StepCount(limited(STEPS, problem))
    try:
        result: Trajectory = simulate(*arguments, progress=count, **options)
    except Exception as error:
        if count.is_used_up:
            raise ArithmeticError(
                f"{count.limit} steps taken at t = {count.reached:.3g} s of a reference"
            ) from error
        raise
    return result


def quietly(*arguments: Any, **options: Any) -> Trajectory:
    """`analysis.simulate` without a warning of SciPy's.

    LSODA warns where it gives up, which is an error here as well.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return analysis.simulate(*arguments, **options)


def energy_error(run: Trajectory, truth: Trajectory) -> float:
    """Largest deviation of the energy over what two runs have in common, relative."""
    rows = common(run, truth)
    total, expected = (_energy(each)[:rows] for each in (run, truth))
    return float(np.max(np.abs(total - expected)) / np.max(expected))


def _energy(run: Trajectory) -> Array:
    result: Array = sum(analysis.energies(run.disk, run.coordinates, run.rates), np.zeros(1))
    return result


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
