"""In-house simulation: the index-1 systems and the reduced system, integrated with SciPy."""

import time
from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy.typing as npt

from analysis.compiled.runs import CompiledScenario
from analysis.data.checks import (
    Array,
    choice,
    increasing_times,
    instance,
    positive,
    switch,
)
from analysis.data.checks import local_tolerance as one_step
from analysis.data.endings import TIME_LIMIT, Ending, StopWhen, named_conditions
from analysis.data.friction import check_slipping
from analysis.data.scenario import Scenario
from analysis.data.trajectory import Setting, Trajectory, versions
from analysis.data.watch import Progress, Watch
from analysis.models.forms import Form, PosedForm, default_form, pose
from analysis.solve.effort import simulation_effort
from analysis.solve.stepping import METHODS, Method, Run, integrate
from analysis.solve.to_tolerance import run_to, tighter_and_tighter

TIGHTEST_LOCAL_TOLERANCE = 3e-14
"""SciPy's solvers do not go below 100 machine precisions."""

COMPILED_TOLERANCES = (1e-6, 1e-9, 1e-12, 1e-15)
"""Local tolerances of compiled runs to a tolerance; code is compiled for each."""


def simulate(
    scenario: Scenario,
    times: npt.ArrayLike,
    *,
    form: Form | None = None,
    method: Method = "DOP853",
    tolerance: float | None = None,
    local_tolerance: float | None = None,
    stop_when: StopWhen = (),
    allow_pulling: bool = False,
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """Simulate a scenario with the in-house equations.

    Accuracy is asked for in one of two ways. With `tolerance`, the run is repeated with tighter
    local tolerances until two runs agree; the difference is returned as `error_estimate`. With
    `local_tolerance`, there is a single run without an estimate.

    A run ends where the ideal contact would have to pull, where the disk lies flat, where it is
    told to, or at its time limit: the trajectory then holds fewer samples than asked for, the
    last one at the ending, and says why.

    Parameters
    ----------
    scenario : Scenario
    times : array_like, shape (n,)
        Strictly increasing times in s at which the motion is wanted; it starts at the first.
    form : {"index-1", "reduced", "free-body"}, optional
        Index-1 system (80), (79) or (92); the minimal coordinates (102) of Model 4; or the
        Newton-Euler equations of a free body on a penalty contact. By default that of the contact.
    method : {"DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor"}
        Of SciPy; Radau, BDF and LSODA are for stiff problems. Or Taylor's method, compiled,
        tens of times as fast from the second run on (extra `fast`; ideal contact only).
    tolerance : float, optional
        Largest error in beta and gamma in rad at any one time, and in s of the time of an ending;
        1e-8 if neither tolerance is given.
    local_tolerance : float, optional
        Relative tolerance of a single step; the absolute one is the same number in m and rad.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there.
    allow_pulling : bool
        Go on where the contact pulls. Friction with the load "contact" rubs with none there;
        with the load "weight" it rubs under the weight as before.
    time_limit : float, optional
        Processor time in s after which the run ends with what it has reached.
    progress : callable, optional
        Called after each step with the time reached and the end of the run in s.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If an argument is out of range, the run would take more than `MOST_STEPS`, or the start
        breaks a constraint or needs a contact that pulls.
    ToleranceError
        If `tolerance` cannot be met, or the run takes far more steps than it should; with a time
        limit it may.
    TimeLimitError
        If the limit is met before two runs agree to `tolerance` anywhere.
    ArithmeticError
        If the integration fails on the way.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import MODELS, Scenario, Start, simulate
    >>> scenario = Scenario(constraints=MODELS[2], start=Start(spin=35.0))
    >>> run = simulate(scenario, np.linspace(0.0, 1.0, 101), stop_when="inverted")
    >>> print(run.ending)
    ended at t = 0.56875... s: the centre of gravity is up, at 90% of its largest height
    """
    scenario, times = instance("scenario", scenario, Scenario), increasing_times(times)
    allow_pulling = switch("allow_pulling", allow_pulling)
    choice("method", method, METHODS)
    form = default_form(scenario) if form is None else form
    check_slipping(scenario.friction)
    conditions = named_conditions(stop_when, scenario.initial_state)
    compiled = None
    if method == "taylor":
        compiled = CompiledScenario(scenario, form, conditions, allow_pulling=allow_pulling)
    tolerance, local_tolerance = _accuracy(tolerance, local_tolerance)
    effort = simulation_effort(
        scenario, times, method=method, tolerance=tolerance, local_tolerance=local_tolerance
    )
    effort.check()
    watch = Watch(time_limit, progress, effort.most)

    evaluations: list[int] = []
    seconds = 0.0

    def run(posed: PosedForm, local: float, longest: float = 1.0) -> Run:
        nonlocal seconds
        problem, begin = posed.problem.with_steps_up_to(longest), time.process_time()
        if compiled is not None:
            found = compiled.integrate(problem, times, local, watch)
        else:
            found = integrate(
                problem, times, method, local, allow_pulling=allow_pulling, watch=watch
            )
        seconds = time.process_time() - begin
        evaluations.append(found.evaluations)
        if found.ended == _LOW:
            raise _NearlyFlatError
        return found

    def solved(posed: PosedForm) -> tuple[Run, float, float | None]:
        if tolerance is None:
            assert local_tolerance is not None
            return run(posed, local_tolerance), local_tolerance, None
        tolerances = local_tolerances(tolerance, method)
        return run_to(partial(run, posed), posed.problem, tolerance, tolerances, method)

    posed = pose(scenario, form, conditions, compiled.multipliers if compiled else None)
    try:
        # Minimal coordinates, and a spin that is held, have no rates that grow.
        if compiled is None and form != "reduced" and "constant-spin" not in scenario.constraints:
            posed = _until_low(posed)
        result, local_tolerance, estimate = solved(posed)
    except _NearlyFlatError:
        posed = pose(scenario, form, conditions, nearly_flat=True)
        result, local_tolerance, estimate = solved(posed)
    result = replace(result, evaluations=sum(evaluations))
    if result.ended == TIME_LIMIT:
        result = replace(result, value=watch.seconds)
    settings: dict[str, Setting] = {
        "form": form,
        "method": method,
        "tolerance": tolerance,
        "local_tolerance": local_tolerance,
    }
    return replace(trajectory(scenario, posed, result, settings, estimate), solver_seconds=seconds)


def _accuracy(
    tolerance: float | None, local_tolerance: float | None
) -> tuple[float | None, float | None]:
    """The one of the two that is given, or the usual tolerance."""
    if local_tolerance is None:
        return positive("tolerance", 1e-8 if tolerance is None else tolerance), None
    if tolerance is not None:
        raise ValueError("give either tolerance or local_tolerance, not both")
    return None, one_step("local_tolerance", local_tolerance, TIGHTEST_LOCAL_TOLERANCE)


_LOW = "low"
"""Ends a run that the rates of the angles are no variables for."""

_LOWEST = 0.05
"""Sine of the angle between disk and table below which they are not.

Rounding makes the second derivatives of alpha and gamma uncertain by 1e-16 over its square, which
step control takes for an error at the tightest tolerances.
"""


class _NearlyFlatError(Exception):
    """A motion comes below `_LOWEST`."""


def _until_low(posed: PosedForm) -> PosedForm:
    """The same that ends where the disk comes low; `_NearlyFlatError` if it begins there."""
    problem = posed.problem

    def height(state: Array) -> float:
        return problem.leaning(state) - _LOWEST

    if height(problem.start) < 0.0:
        raise _NearlyFlatError
    return replace(
        posed, problem=replace(problem, conditions={**problem.conditions, _LOW: height})
    )


def trajectory(
    scenario: Scenario,
    posed: PosedForm,
    run: Run,
    settings: Mapping[str, Setting],
    estimate: float | None,
) -> Trajectory:
    """Trajectory of a run, with the settings that led to it and its estimated error."""
    coordinates, rates, multipliers = posed.expand(run.times, run.states)
    compiled = settings["method"] == "taylor"
    ending = None
    if run.ended is not None:
        ending = Ending(reason=run.ended, time=float(run.times[-1]), value=run.value)
    return Trajectory(
        times=run.times,
        coordinates=coordinates,
        rates=rates,
        multipliers=multipliers,
        scenario=scenario,
        source="in-house",
        method=settings,
        error_estimate=estimate,
        counts={"steps" if compiled else "right_hand_sides": run.evaluations},
        versions=versions("numpy", "heyoka" if compiled else "scipy"),
        ending=ending,
        pulling=run.pulling,
    )


def local_tolerances(tolerance: float, method: Method) -> list[float]:
    """Local tolerances of the runs to a tolerance, in turn.

    Two runs of nearly the same one would agree without being right.
    """
    if method == "taylor":
        rungs = [each for each in COMPILED_TOLERANCES if each <= tolerance / 3.0]
        return rungs if len(rungs) > 1 else list(COMPILED_TOLERANCES[-2:])
    return tighter_and_tighter(tolerance / 3.0, TIGHTEST_LOCAL_TOLERANCE)
