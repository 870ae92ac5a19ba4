"""What a run is compared with: two runs by other methods, and how far they are apart."""

from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

import numpy as np

import analysis
from analysis import Method, Scenario, Trajectory
from analysis.data.agreement import error_at_ending
from analysis.data.checks import Array
from analysis.data.endings import FLAT
from analysis.models.simulation import TIGHTEST_LOCAL_TOLERANCE
from mbs_models import EngineError, Integrator
from validation.kit.limits import largest
from validation.kit.located import up_to_ending
from validation.studies.robustness.cases import STIFF, EndedProblem, HardProblem, Way
from validation.studies.robustness.work import StepCount

ANGLES = slice(4, 6)
"""Columns of beta and gamma."""

SPACINGS = (2e-4, 1.37e-4)
"""Times in s between the samples of both runs, among which endings are located."""

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
    """Largest difference of beta and gamma in rad over what the two have in common.

    Where both end for the same reason, also at one time there, but for a disk that lies flat,
    whose gamma has no meaning. Infinite if a number is none.
    """
    rows = common(run, other)
    apart = np.abs(run.coordinates[:rows] - other.coordinates[:rows])[:, ANGLES]
    found = apart.ravel().tolist()
    if isfinite(late := ending_error(run, other)) and run.ending and run.ending.reason != FLAT:
        last = run.coordinates[-1, ANGLES] - other.coordinates[-1, ANGLES]
        found.append(float(error_at_ending(last, late, other.rates[-1, ANGLES])))
    return largest(found)


def ending_error(run: Trajectory, other: Trajectory) -> float:
    """Difference in s of the times at which two runs end; infinite if one alone ends early."""
    if run.ending is None and other.ending is None:
        return 0.0
    if run.ending is None or other.ending is None or run.ending.reason != other.ending.reason:
        return inf
    return abs(run.ending.time - other.ending.time)


def reference_or_reason(problem: HardProblem) -> Reference | NoReference:
    """The reference of a problem, or why there is none."""
    try:
        return reference(problem)
    except ValueError as error:
        return NoReference(reason=_line(error), refused=True)
    except ArithmeticError as error:
        return NoReference(reason=_line(error))


def reference(problem: HardProblem) -> Reference:
    """Two runs of a problem.

    Both are in-house, or on a penalty contact of different formulations and integrators.

    Raises
    ------
    ArithmeticError
        If one of the two fails, or takes too many steps.
    ValueError
        If the motion cannot start.
    """
    scenario = problem.scenario
    if scenario.contact is not None:
        return _penalty_reference(problem)
    stiff = scenario.friction.finest_speed < STIFF
    # Over tens of seconds small errors grow by some thousands.
    tight = 1e-12 if problem.end <= 5.0 else TIGHTEST_LOCAL_TOLERANCE
    methods: tuple[tuple[Method, float], tuple[Method, float]] = (
        ("Radau", 1e-10) if stiff else ("DOP853", tight),
        ("LSODA", tight),
    )
    first, second = (
        _within(
            problem,
            Way(source="in-house", formulation="index-1", integrator=method),
            spacing,
            local_tolerance=tolerance,
        )
        for (method, tolerance), spacing in zip(methods, SPACINGS, strict=True)
    )
    return Reference(first=first, second=second)


def _penalty_reference(problem: HardProblem) -> Reference:
    tree = Way(source="engine", formulation="euler-tree", integrator="DOPRI5")
    body = Way(source="engine", formulation="floating-lie", integrator="RK67")
    tight = Integrator(name="DOPRI5", local_tolerance=1e-11)
    try:
        first = _within(problem, tree, SPACINGS[0], integrator=tight)
    except EngineError:
        # Step control cannot pass the jump of a damper that meets the table: short steps can.
        first, second = (
            replace(way, integrator="RK44").run(problem.scenario, problem.times, step=step)
            for way, step in ((tree, 1e-6), (body, 1.3e-6))
        )
        return Reference(first=first, second=second)
    second = _within(problem, body, SPACINGS[1], tolerance=1e-8)
    return Reference(first=first, second=second)


def limited(steps: int, problem: HardProblem) -> int:
    """Limit of steps of a problem from that of a second."""
    return round(steps * max(1.0, problem.end))


def _within(problem: HardProblem, way: Way, spacing: float, **how: Any) -> Trajectory:
    """Run a problem within the limit of steps; up to an ending located apart if it is to."""
    count = StepCount(limited(STEPS, problem))

    def plain(scenario: Scenario, times: Array) -> Trajectory:
        return way.run(scenario, times, progress=count, allow_pulling=True, **how)

    try:
        if isinstance(problem, EndedProblem):
            scenario, times = problem.scenario, problem.times
            return up_to_ending(plain, scenario, times, problem.stop_when, spacing)
        return way.run(problem.scenario, problem.times, progress=count, **how)
    except Exception as error:
        if count.is_used_up:
            raise ArithmeticError(
                f"{count.limit} steps taken at t = {count.reached:.3g} s of a reference"
            ) from error
        raise


def energy_error(run: Trajectory, truth: Trajectory) -> float:
    """Largest deviation of the energy over what two runs have in common, relative."""
    rows = common(run, truth)
    total, expected = (_energy(each)[:rows] for each in (run, truth))
    return float(np.max(np.abs(total - expected)) / np.max(expected))


def _energy(run: Trajectory) -> Array:
    result: Array = sum(analysis.energies(run.scenario, run.coordinates, run.rates), np.zeros(1))
    return result


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
