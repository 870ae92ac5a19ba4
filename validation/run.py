"""Runs of a scenario on either side.

What compares, draws or stores motions calls these and does not know who makes them. The engine
is loaded only when it is asked for. How a run is made is told by keywords, those of `RunOptions`.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

import analysis
from analysis import Progress, Scenario, SpatialMotion, Trajectory, multiplier_names
from analysis.problem.checks import Array, increasing_times
from analysis.problem.limits import REST_SPACING, Effort, check_storage
from analysis.problem.names import ArgumentError
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
    side, subject, given = _asked(scenario, options, *_HOW, *_ENDS, "allow_pulling")
    if side is analysis:
        given["formulation"] = options.formulation
    return side.simulate(subject, times, progress=progress, **given)


def even_times(scenario: Scenario, end: float, samples: int, name: str) -> Array:
    """Evenly spaced times from 0 to an end in s, if the samples that a run makes can be held.

    Raises
    ------
    ValueError
        If they cannot; it names what asks for them.
    """
    # Time, six coordinates, their rates and the constraint forces.
    check_storage(name, samples, 13 + len(multiplier_names(scenario.constraints)))
    return np.linspace(0.0, end, samples)


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
    side, subject, given = _asked(scenario, _of_rest(scenario, how), *_HOW, *_ENDS)
    given |= {"spacing": spacing, "progress": progress}
    return side.simulate_to_rest(subject, end, **given)


def run_effort(scenario: Scenario, times: npt.ArrayLike, **how: Any) -> Effort:
    """What `run` will take; the arguments are its own.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    """
    side, subject, given = _asked(scenario, RunOptions(**how), *_HOW)
    return _efforts(side).simulation_effort(subject, increasing_times(times), **given)


def rest_effort(scenario: Scenario, end: float, **how: Any) -> Effort:
    """What `run_to_rest` will take; the arguments are its own.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side, or the rim is sharp.
    """
    side, subject, given = _asked(scenario, _of_rest(scenario, how), "step")
    return _efforts(side).rest_effort(subject, end, **given)


def _of_rest(scenario: Scenario, how: dict[str, Any]) -> RunOptions:
    if scenario.contact is not None and not scenario.is_smooth:
        raise ArgumentError("half_thickness", "must be positive for the disk to lie flat, got 0")
    options = RunOptions(**how)
    for name in ("formulation", "integrator", "allow_pulling"):
        options.refuse(name, "a run to rest")
    if options.source == "engine":
        options.refuse("local_tolerance", "a run of the engine to rest")
    return options


def _asked(
    scenario: Scenario, options: RunOptions, *names: str
) -> tuple[Any, Any, dict[str, Any]]:
    """The side that is asked, what it is to run, and what it is told of some options.

    The engine takes the formulation with its scene, and the error of a step with its integrator.
    """
    given = options.given(*names)
    if options.source == "in-house":
        return analysis, scenario, given
    import mbs_models

    if (local := given.pop("local_tolerance", None)) is not None:
        wanted: Any = options.integrator or "DOPRI5"
        name = getattr(wanted, "name", wanted)
        given["integrator"] = mbs_models.Integrator(name=name, local_tolerance=local)
    formulation: Any = options.formulation
    return mbs_models, mbs_models.Scene(scenario=scenario, formulation=formulation), given


def _efforts(side: Any) -> Any:
    """Module of a side that tells what its runs take."""
    return inhouse_effort if side is analysis else side.effort
