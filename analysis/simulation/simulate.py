"""In-house simulation: the index-1 systems and the reduced system, integrated with SciPy."""

from dataclasses import replace
from functools import partial
from math import inf
from typing import Any

import numpy.typing as npt

from analysis.motion.endings import StopWhen, try_conditions
from analysis.motion.trajectory import Trajectory
from analysis.problem.checks import instance
from analysis.problem.choices import Formulation, Method
from analysis.problem.friction import check_slipping
from analysis.problem.scenario import Scenario
from analysis.simulation.compiled.ensemble import simulate_compiled
from analysis.simulation.formulations import default_formulation, pose
from analysis.simulation.request import Request, trajectory
from analysis.solve.stepping import integrate
from analysis.solve.to_tolerance import run_to
from analysis.solve.watch import Progress


def simulate(
    scenario: Scenario,
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
) -> Trajectory:
    """Simulate a scenario with the in-house equations.

    Accuracy is asked for in one of two ways. With `tolerance`, the run is repeated with tighter
    local tolerances until two runs agree; twice their difference is the `error_estimate`. With
    `local_tolerance`, there is a single run without an estimate.

    A run ends where the ideal contact would have to pull, where the disk lies flat, where it is
    told to, or at its time limit: the trajectory then holds fewer samples than asked for, the
    last one at the ending, and says why.

    Parameters
    ----------
    scenario : Scenario
    times : array_like, shape (n,)
        Strictly increasing times in s at which the motion is wanted; it starts at the first.
    formulation : {"index-1", "reduced", "free-body"}, optional
        Index-1 system (64), such as (79), (80) and (92); the minimal coordinates (102) of Model 4;
        or the Newton-Euler equations of a free body on a penalty contact. By default that of the
        contact.
    method : {"DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "taylor"}, optional
        Of SciPy; Radau, BDF and LSODA are for stiff problems, and the first two are given exact
        Jacobians, which the steepest friction needs. Or Taylor's method, compiled, tens of times
        as fast from the second run on (extra `fast`; ideal contact only). By default DOP853, or
        Radau where friction is so stiff that its steps should take less time.
    tolerance : float, optional
        Largest error in beta and gamma in rad at any one time, and in s of the time of an ending;
        1e-8 if neither tolerance is given.
    local_tolerance : float, optional
        Relative tolerance of a single step; the absolute one is the same number in m and rad.
    stop_when : str, callable or sequence of them
        What else ends the run: "inverted", "lost", or functions of a `State` that turn
        negative there.
    allow_pulling : bool
        Go on where the contact pulls. There is no friction there if its load is "contact"; if it
        is "weight", there is as before.
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
        If an argument is out of range, the run would take more than 1e8 steps, or the start
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
    request = Request(
        times,
        formulation=formulation,
        method=method,
        tolerance=tolerance,
        local_tolerance=local_tolerance,
        stop_when=stop_when,
        allow_pulling=allow_pulling,
        time_limit=time_limit,
        progress=progress,
    )
    scenario = instance("scenario", scenario, Scenario)
    return run_member(scenario, request, method)


def run_member(scenario: Scenario, request: Request, method: Method | None) -> Trajectory:
    """Trajectory of one scenario; parameters and errors are those of `simulate`."""
    check_slipping(scenario.friction)
    try_conditions(request.conditions, scenario.initial_state)
    if method != "taylor":
        return _stepped(scenario, request, method or request.usual_method(scenario))
    compiled, failures = simulate_compiled([scenario], request)
    for failure in failures.values():
        raise failure
    return compiled[0].trajectory(0, scenario)


def _stepped(scenario: Scenario, request: Request, method: Method) -> Trajectory:
    """The same by one of SciPy's solvers."""
    watch = request.watch(request.effort(scenario, method).most)
    formulation = request.formulation or default_formulation(scenario)
    problem, expand = pose(scenario, formulation, request.conditions)
    rungs = request.local_tolerances(method, scenario.finest_slip)
    tolerance = request.tolerance or inf
    how: dict[str, Any] = {"allow_pulling": request.allow_pulling, "watch": watch}
    run = partial(integrate, problem, request.times, method, **how)
    found = run_to(run, problem, request.times, tolerance, rungs, method=method)
    samples = replace(found, states=expand(found.times, found.states))
    return trajectory(scenario, request, samples, method, watch)
