"""Runs of a scenario on either side.

What compares, draws or stores motions calls these and does not know who makes them. The engine
is loaded only when it is asked for.
"""

from typing import TYPE_CHECKING, Any

import numpy.typing as npt

import analysis
from analysis import Progress, RestCriterion, Scenario, SpatialMotion, Trajectory
from analysis.data.checks import choice, increasing_times
from analysis.data.endings import StopWhen
from analysis.data.limits import Effort
from analysis.data.names import ArgumentError
from analysis.data.trajectory import SOURCES, Source
from analysis.models import effort as inhouse_effort

if TYPE_CHECKING:
    from mbs_models import Integrator, IntegratorName

REST_SPACING = 2e-3
"""Time between samples of a motion to rest in s."""

_OF_ENGINE = ("step", "integrator")
_OF_IN_HOUSE = ("local_tolerance", "method")


def run(
    scenario: Scenario,
    times: npt.ArrayLike,
    *,
    source: Source = "engine",
    formulation: str | None = None,
    tolerance: float | None = None,
    step: float | None = None,
    integrator: "Integrator | IntegratorName | None" = None,
    local_tolerance: float | None = None,
    method: str | None = None,
    stop_when: StopWhen | None = None,
    allow_pulling: bool = False,
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """Run a scenario with one side.

    Parameters
    ----------
    scenario : Scenario
    times : array_like, shape (n,)
        Strictly increasing times in s.
    source : {"engine", "in-house"}
        Who runs it.
    formulation : str, optional
        One of `mbs_models.formulations(scenario)`, or a `form` of `analysis.simulate`; by default
        that of the side.
    tolerance : float, optional
        Largest error in beta and gamma in rad; the default of both sides if nothing else is said.
    step, integrator
        Of the engine alone; see `mbs_models.simulate`.
    local_tolerance, method
        Of the in-house equations alone; see `analysis.simulate`.
    stop_when, allow_pulling, time_limit, progress
        As both sides take them.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    ArithmeticError
        If the run fails; both sides tell how.
    """
    given = _given(
        source,
        step=step,
        integrator=integrator,
        local_tolerance=local_tolerance,
        method=method,
        tolerance=tolerance,
        stop_when=stop_when,
    )
    given |= {"allow_pulling": allow_pulling, "time_limit": time_limit, "progress": progress}
    if source == "in-house":
        given["form"] = formulation
        return analysis.simulate(scenario, times, **given)
    import mbs_models

    return mbs_models.simulate(_scene(scenario, formulation), times, **given)


def run_to_rest(
    scenario: Scenario,
    end: float,
    *,
    source: Source = "engine",
    spacing: float = REST_SPACING,
    criterion: RestCriterion | None = None,
    tolerance: float | None = None,
    step: float | None = None,
    local_tolerance: float | None = None,
    method: str | None = None,
    stop_when: StopWhen = (),
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> SpatialMotion:
    """Run a scenario with one side until the disk rests, or until `end` in s.

    Parameters
    ----------
    scenario : Scenario
        With a rounded penalty contact, such as `Scenario.rest` makes.
    end : float
        Longest time in s.
    source : {"engine", "in-house"}
        Who runs it.
    spacing : float
        Time between samples in s.
    criterion, tolerance, stop_when, time_limit, progress
        As both sides' `simulate_to_rest` take them.
    step
        Of the engine alone.
    local_tolerance, method
        Of the in-house equations alone.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    ArithmeticError
        If the run fails; both sides tell how.
    """
    given = _given(
        source, step=step, local_tolerance=local_tolerance, method=method, tolerance=tolerance
    )
    given |= {
        "spacing": spacing,
        "criterion": criterion,
        "stop_when": stop_when,
        "time_limit": time_limit,
        "progress": progress,
    }
    if source == "in-house":
        return analysis.simulate_to_rest(scenario, end, **given)
    import mbs_models

    return mbs_models.simulate_to_rest(_scene(scenario), end, **given)


def run_effort(
    scenario: Scenario,
    times: npt.ArrayLike,
    *,
    source: Source = "engine",
    formulation: str | None = None,
    tolerance: float | None = None,
    step: float | None = None,
    integrator: "Integrator | IntegratorName | None" = None,
    local_tolerance: float | None = None,
    method: str | None = None,
) -> Effort:
    """What `run` will take; the arguments are its own.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    """
    given = _given(
        source,
        step=step,
        tolerance=tolerance,
        integrator=integrator,
        local_tolerance=local_tolerance,
        method=method,
    )
    times = increasing_times(times)
    if source == "in-house":
        return inhouse_effort.simulation_effort(scenario, times, **given)
    from mbs_models.effort import simulation_effort
    from mbs_models.integrators import find_integrator

    scene = _scene(scenario, formulation)
    if integrator is not None:
        # Raises if it cannot take the scene.
        constrained = scene.has_constraints
        given["integrator"] = find_integrator(scene.built_as, integrator, constrained=constrained)
    return simulation_effort(scene, times, **given)


def single_run(source: Source, local_tolerance: float | None) -> dict[str, Any]:
    """What `run` takes for one run of a side that allows so much error in a step.

    The engine's DOPRI5 controls its steps. Nothing is taken for None.

    Raises
    ------
    ValueError
        If the tolerance is out of range for the engine.
    """
    if local_tolerance is None:
        return {}
    if source == "in-house":
        return {"local_tolerance": local_tolerance}
    from mbs_models import Integrator

    return {"integrator": Integrator(name="DOPRI5", local_tolerance=local_tolerance)}


def rest_effort(
    scenario: Scenario, end: float, *, source: Source = "engine", step: float | None = None
) -> Effort:
    """What `run_to_rest` will take; the arguments are its own.

    Raises
    ------
    ValueError
        If an argument is out of range, or belongs to the other side.
    """
    _given(source, step=step)
    if source == "in-house":
        return inhouse_effort.rest_effort(scenario, end)
    from mbs_models.effort import rest_effort as engine_effort
    from mbs_models.rest_run import SAFETY, largest_step

    scene = _scene(scenario)
    return engine_effort(scene, end, SAFETY * largest_step(scene) if step is None else step)


def _given(source: Source, **options: Any) -> dict[str, Any]:
    """What is given of the options, all of which must be for this side."""
    choice("source", source, SOURCES)
    given = {name: value for name, value in options.items() if value is not None}
    foreign = _OF_IN_HOUSE if source == "engine" else _OF_ENGINE
    for name in foreign:
        if name in given:
            raise ArgumentError(
                name,
                f"must be left out for source {source!r}, which does not know it, "
                f"got {given[name]!r}",
            )
    return given


def _scene(scenario: Scenario, formulation: Any = None) -> Any:
    import mbs_models

    return mbs_models.Scene(scenario=scenario, formulation=formulation)
