"""What a run is compared with: two runs by other methods, and how far they are apart."""

from dataclasses import dataclass
from typing import Any

from analysis import Method, Scenario, Trajectory, formulations
from analysis.motion.endings import StopWhen
from analysis.problem.checks import Array
from analysis.simulation.request import TIGHTEST_LOCAL_TOLERANCE
from validation.kit.differences import deviation, ending_error
from validation.kit.located import up_to_ending
from validation.kit.ways import StepLimit, Way

STIFF = 1e-3
"""Finest speed of friction in m/s below which explicit in-house methods are not tried."""

LONG = 5.0
"""Time in s beyond which small errors grow by some thousands."""

SPACINGS = (2e-4, 1.37e-4)
"""Times in s between the samples of both runs, among which endings are located."""

STEPS = 200_000
"""Most steps of a reference per second; see `StepLimit`."""


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

    def beside(self, run: Trajectory) -> Trajectory:
        """The first one, or the second for a run by the method of the first."""
        return self.second if _method(run) == _method(self.first) else self.first


def _method(run: Trajectory) -> tuple[object, ...]:
    """What runs by one method have in common."""
    names = ("formulation", "integrator") if run.source == "engine" else ("method",)
    return run.source, *(run.method[name] for name in names)


def reference(scenario: Scenario, times: Array, *, stop_when: StopWhen | None = None) -> Reference:
    """Two in-house runs of a motion.

    Parameters
    ----------
    scenario : Scenario
    times : ndarray, shape (n,)
        Strictly increasing, in s.
    stop_when : str, callable or iterable of them, optional
        What ends the motion besides a contact that would have to pull. If it is given, even an
        empty one, endings are located apart from the solvers' own search for them.

    Raises
    ------
    ArithmeticError
        If one of the two fails, or takes more than `STEPS`.
    ValueError
        If the motion cannot start.
    """

    def run(way: Way, spacing: float, **how: Any) -> Trajectory:
        with StepLimit(STEPS, times[-1]) as count:
            if stop_when is None:
                return way.run(scenario, times, progress=count, **how)

            def plain(scenario: Scenario, times: Array) -> Trajectory:
                return way.run(scenario, times, progress=count, allow_pulling=True, **how)

            return up_to_ending(plain, scenario, times, stop_when, spacing)

    tight = 1e-12 if times[-1] <= LONG else TIGHTEST_LOCAL_TOLERANCE
    stiff = scenario.friction.finest_speed < STIFF
    method: Method = "Radau" if stiff else "DOP853"
    tolerance = 1e-10 if stiff else tight
    formulation = formulations(scenario)[0]
    first = run(Way("in-house", formulation, method), SPACINGS[0], local_tolerance=tolerance)
    second = run(Way("in-house", formulation, "LSODA"), SPACINGS[1], local_tolerance=tight)
    return Reference(first=first, second=second)
