"""Runs of a scenario on either side.

What compares, draws or stores motions calls these and does not know who makes them. The engine
is loaded only when it is asked for. How a run is made is told by keywords, those of `RunOptions`.
"""

from typing import Any

import numpy.typing as npt

import analysis
from analysis import Progress, Scenario, SpatialMotion, Trajectory
from analysis.problem.checks import increasing_times
from analysis.problem.limits import REST_SPACING, Effort
from analysis.solve import effort as inhouse_effort
from validation.parser.runs import RunOptions

_HOW = ("tolerance", "step", "local_tolerance", "integrator", "method")
_ENDS = ("stop_when", "time_limit")


def run(
    scenario: Scenario, times: npt.ArrayLike, *, progress: Progress | None = None, **how: Any
) -> Trajectory:
    """Run a scenario with one side.

    Parameters
    ----------
    scenario : Scenario
    times : array_like, shape (n,)
        Strictly increasing times in s.
    progress : callable, optional
        As both sides take it.
    **how
        See `RunOptions`. `stop_when` may be whatever both sides take, and `integrator` an
        `mbs_models.Integrator`.

    Raises
    ------
    ValueError
        If an option is out of range, or belongs to the other side.
    ArithmeticError
        If the run fails; both sides tell how.
    """
    options = RunOptions(**how)
    given = _given(options, *_HOW, *_ENDS, "allow_pulling") | {"progress": progress}
    if options.source == "in-house":
        return analysis.simulate(scenario, times, formulation=options.formulation, **given)  # type: ignore[arg-type]
    import mbs_models

    return mbs_models.simulate(_scene(scenario, options), times, **given)


def run_to_rest(
    scenario: Scenario,
    end: float,
    *,
    spacing: float = REST_SPACING,
    progress: Progress | None = None,
    **how: Any,
) -> SpatialMotion:
    """Run a scenario with one side until the disk rests, or until `end` in s.

    Parameters
    ----------
    scenario : Scenario
        With a rounded penalty contact, such as `Scenario.rest` makes.
    end : float
        Longest time in s.
    spacing : float
        Time between samples in s.
    progress : callable, optional
        As both sides take it.
    **how
        See `RunOptions`; without `formulation`, `integrator` and `allow_pulling`.

    Raises
    ------
    ValueError
        If an option is out of range, or belongs to the other side.
    ArithmeticError
        If the run fails; both sides tell how.
    """
    options = _of_rest(**how)
    given = _given(options, *_HOW, *_ENDS) | {"spacing": spacing, "progress": progress}
    if options.source == "in-house":
        return analysis.simulate_to_rest(scenario, end, **given)
    import mbs_models

    return mbs_models.simulate_to_rest(_scene(scenario, options), end, **given)


def run_effort(scenario: Scenario, times: npt.ArrayLike, **how: Any) -> Effort:
    """What `run` will take; the arguments are its own.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    """
    options = RunOptions(**how)
    given, times = _given(options, *_HOW), increasing_times(times)
    if options.source == "in-house":
        return inhouse_effort.simulation_effort(scenario, times, **given)
    from mbs_models.effort import simulation_effort

    return simulation_effort(_scene(scenario, options), times, **given)


def rest_effort(scenario: Scenario, end: float, **how: Any) -> Effort:
    """What `run_to_rest` will take; the arguments are its own.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    """
    options = _of_rest(**how)
    if options.source == "in-house":
        return inhouse_effort.rest_effort(scenario, end)
    from mbs_models.effort import rest_effort as engine_effort

    return engine_effort(_scene(scenario, options), end, options.step)


def _of_rest(**how: Any) -> RunOptions:
    options = RunOptions(**how)
    for name in ("formulation", "integrator", "allow_pulling"):
        options.refuse(name, "a run to rest")
    if options.source == "engine":
        options.refuse("local_tolerance", "a run of the engine to rest")
    return options


def _given(options: RunOptions, *names: str) -> dict[str, Any]:
    """What a side is told; the engine takes the error of a step with its integrator."""
    given = options.given(*names)
    if options.source == "engine" and (local := given.pop("local_tolerance", None)) is not None:
        from mbs_models import Integrator

        given["integrator"] = Integrator(name="DOPRI5", local_tolerance=local)
    return given


def _scene(scenario: Scenario, options: RunOptions) -> Any:
    import mbs_models

    return mbs_models.Scene(scenario=scenario, formulation=options.formulation)  # type: ignore[arg-type]
