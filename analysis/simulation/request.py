"""What is asked of runs, checked once for one or for many, and the trajectory that it leads to."""

from collections.abc import Sequence
from math import inf
from typing import Any

import numpy.typing as npt

from analysis.motion.endings import StopWhen, named_conditions
from analysis.motion.trajectory import Trajectory, versions
from analysis.problem.checks import choice, increasing_times, optional, positive, switch
from analysis.problem.checks import local_tolerance as one_step
from analysis.problem.choices import FORMULATIONS, METHODS, Formulation, Method
from analysis.problem.limits import DEFAULT_TOLERANCE, MOST_STEPS, Effort
from analysis.problem.scenario import Scenario
from analysis.simulation.compiled.library import is_installed
from analysis.simulation.formulations import default_formulation
from analysis.solve.effort import simulation_effort, usual_method
from analysis.solve.stepping import Run
from analysis.solve.to_tolerance import tighter_and_tighter
from analysis.solve.watch import Progress, Watch

TIGHTEST_LOCAL_TOLERANCE = 3e-14
"""SciPy's solvers do not go below 100 machine precisions."""

COMPILED_TOLERANCES = (1e-6, 1e-9, 1e-12, 1e-15)
"""Local tolerances of compiled runs to a tolerance; code is compiled for each."""


class Request:
    """What is asked of each of some scenarios; its parameters are those of `analysis.simulate`.

    Attributes
    ----------
    times : ndarray, shape (n,)
    formulation : str or None
    method : str or None
        Asked for, if any.
    tolerance, local_tolerance : float or None
        `DEFAULT_TOLERANCE` if neither is given, and None where the other one is.
    conditions : dict
        Conditions that end a run, by the reason that they give.
    allow_pulling : bool
    time_limit : float or None

    Raises
    ------
    ValueError
        If one of them is out of range.
    """

    def __init__(
        self,
        times: npt.ArrayLike,
        *,
        formulation: Formulation | None = None,
        method: Method | None = None,
        tolerance: float | None = None,
        local_tolerance: float | None = None,
        stop_when: StopWhen = (),
        allow_pulling: bool = False,
        time_limit: float | None = None,
        progress: Progress | None = None,
    ) -> None:
        self.times = increasing_times(times)
        self.formulation = optional(choice, "formulation", formulation, FORMULATIONS)
        self.method = optional(choice, "method", method, METHODS)
        self.tolerance, self.local_tolerance = tolerance, local_tolerance
        if local_tolerance is None:
            wanted = DEFAULT_TOLERANCE if tolerance is None else tolerance
            self.tolerance = positive("tolerance", wanted)
        elif tolerance is None:
            least = TIGHTEST_LOCAL_TOLERANCE
            self.local_tolerance = one_step("local_tolerance", local_tolerance, least)
        else:
            raise ValueError("give either tolerance or local_tolerance, not both")
        self.conditions = named_conditions(stop_when)
        self.allow_pulling = switch("allow_pulling", allow_pulling)
        self.time_limit, self._progress = time_limit, progress
        self.watch()

    @property
    def first_method(self) -> Method | None:
        """Method that many runs are tried with first; None stands for `usual_method`."""
        return self.method or ("taylor" if is_installed() else None)

    def usual_method(self, scenario: Scenario) -> Method:
        """Method of a scenario that is not compiled, where none is asked for."""
        return usual_method(scenario, self.times, **self._accuracy)

    def watch(self, most: float = MOST_STEPS) -> Watch:
        """Who watches a run of so many steps at most."""
        return Watch(self.time_limit, self._progress, most)

    def local_tolerances(self, method: Method, coarsest: float = inf) -> Sequence[float]:
        """Local tolerances of the runs to the tolerance, in turn; a single one gives no estimate.

        Two runs of nearly the same one would agree without being right. Steps of "taylor" end at
        the kink of friction; those of others are no coarser than is told.
        """
        if self.tolerance is None:
            assert self.local_tolerance is not None
            return (self.local_tolerance,)
        if method == "taylor":
            rungs = [each for each in COMPILED_TOLERANCES if each <= self.tolerance / 3.0]
            return rungs if len(rungs) > 1 else COMPILED_TOLERANCES[-2:]
        return tighter_and_tighter(min(self.tolerance / 3.0, coarsest), TIGHTEST_LOCAL_TOLERANCE)

    def effort(self, scenario: Scenario, method: Method) -> Effort:
        """What a run should take; `ValueError` if that is too many steps."""
        effort = simulation_effort(scenario, self.times, method=method, **self._accuracy)
        effort.check()
        return effort

    @property
    def _accuracy(self) -> dict[str, Any]:
        return {"tolerance": self.tolerance, "local_tolerance": self.local_tolerance}


def trajectory(
    scenario: Scenario, request: Request, run: Run, method: Method, watch: Watch | None
) -> Trajectory:
    """Trajectory of a run.

    Parameters
    ----------
    scenario : Scenario
    request : Request
    run : Run
        See `Run.trajectory`.
    method : str
        That has run it.
    watch : Watch, optional
        Of the call, if it has a single run to a result.
    """
    compiled = method == "taylor"
    return run.trajectory(
        scenario,
        watch,
        source="in-house",
        method={
            "formulation": request.formulation or default_formulation(scenario),
            "method": method,
            "tolerance": request.tolerance,
            "local_tolerance": run.local_tolerance,
        },
        counts={"steps" if compiled else "right_hand_sides": run.evaluations},
        versions=versions("numpy", "heyoka" if compiled else "scipy"),
    )
