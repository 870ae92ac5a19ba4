"""How many steps an engine run will take, told from its arguments before it starts.

With a step, their number is known. With a tolerance, the motion asks for steps in proportion to
those of an in-house run; the numbers come from measured runs.
"""

from dataclasses import replace
from math import ceil, inf, log2

import numpy as np

from analysis.problem.checks import Array, positive, within
from analysis.problem.choices import IntegratorName, Method
from analysis.problem.limits import DEFAULT_TOLERANCE, SHORTEST_STEP, Effort
from analysis.solve import effort as shared
from mbs_models.integrators import Integrator, find_integrator
from mbs_models.runs import MINIMUM_STEP
from mbs_models.scene import Scene

HALVINGS = 13
"""Number of runs after which a tolerance-controlled run gives up; the last step is some µs."""

LATE = 5
"""Halvings after which fixed steps are looked at, whether they lead anywhere."""

_LIKE: Method = "RK23"
"""In-house method that takes steps in proportion to those of the engine's own integrators."""


_EXPLICIT, _IMPLICIT = (5e-5, 0.5), (3e-4, 0.25)
"""Processor time of their steps in s, and how long these are over the steps of `_LIKE`."""

_EVALUATION_SECONDS = {"contact-tree": 2.5e-5, "floating-lie": 6e-5}
"""Processor time in s of an evaluation of accelerations in a formulation,"""

_USUAL_EVALUATION = 4.5e-5
"""and in any other."""

STIFF = 0.6
"""Times the cost of implicit steps in-house that explicit ones may be estimated to cost there: an
evaluation takes longer here, and they pass the finest speed of friction only now and then."""

FAST_CONTACT = 1e5
"""Parts of a tolerance that the steps of a stiff contact meet besides: it alone asks for them, and
LSODA takes two evaluations for each where DOP853 takes twelve."""

FINEST_STEPPED = 1e-9
"""Tolerance in rad below which the noise of accelerations is in the way of runs that step them."""

_REST_SECONDS = 4.5e-5
"""Processor time in s of a step on the way to rest, of either kind."""


def ways(scene: Scene, times: Array, tolerance: float) -> list[Integrator]:
    """Integrators that `mbs_models.simulate` tries in turn to a tolerance.

    The engine's own first where the contact is ideal and no constraint is left; else, and where
    friction is stiff, one that steps accelerations: on a penalty contact, fixed steps lose their
    order wherever the disk lifts off or lands. Fixed steps that lead to nothing are given up
    `LATE`, and taken up again if nothing else leads anywhere.

    Parameters
    ----------
    scene : Scene
    times : ndarray, shape (n,)
        In s.
    tolerance : float
        In rad.
    """
    stepping = stepping_integrator(scene, times, tolerance)
    fixed = find_integrator(scene, None)
    is_smooth = scene.scenario.contact is None and stepping.name == "DOP853"
    is_fixed_first = is_smooth and (not scene.has_constraints or tolerance < FINEST_STEPPED)
    # Impacts may leave LSODA short of a fine tolerance.
    sure = [Integrator(name="DOP853")] if stepping.name == "LSODA" else []
    return [fixed, stepping, fixed] if is_fixed_first else [stepping, *sure, fixed]


def stepping_integrator(scene: Scene, times: Array, tolerance: float) -> Integrator:
    """Integrator that steps a scene's accelerations in the least time.

    The arguments are those of `ways`.
    """
    scenario = scene.scenario
    if scenario.contact is not None:
        finer = tolerance / FAST_CONTACT
        known = shared.simulation_effort(scenario, times, method="LSODA", tolerance=finer)
        if known.argument == "stiffness":
            return Integrator(name="LSODA")
    method = shared.usual_method(scenario, times, tolerance=tolerance, stiff=STIFF)
    return Integrator(name=method)


def simulation_effort(
    scene: Scene,
    times: Array,
    integrator: Integrator | IntegratorName | None = None,
    *,
    step: float | None = None,
    tolerance: float | None = None,
) -> Effort:
    """Effort of `mbs_models.simulate` with these arguments.

    Parameters
    ----------
    scene : Scene
    times : ndarray, shape (n,)
        In s.
    integrator : Integrator or str, optional
        By default that of `mbs_models.simulate`, which may change to step control on the way.
    step : float, optional
        In s.
    tolerance : float, optional
        In rad; 1e-8 if neither is given.

    Raises
    ------
    ValueError
        If step or tolerance is not positive, or the step or one between times shorter than
        `SHORTEST_STEP`, or the integrator cannot take the scene.
    """
    if step is not None:
        step = within("step", positive("step", step), SHORTEST_STEP, inf)
    tolerance = positive("tolerance", DEFAULT_TOLERANCE if tolerance is None else tolerance)
    spacings, other = _spacings(times), None
    if integrator is None and step is None:
        chosen, other, *_ = ways(scene, times, tolerance)
    else:
        chosen = find_integrator(scene, integrator)
    if chosen.steps_accelerations:
        return _stepping_effort(scene, times, chosen, step or inf, tolerance)
    step_seconds, part = _IMPLICIT if chosen.implicit else _EXPLICIT
    doubt = ""
    wanted = chosen.local_tolerance or tolerance
    known = shared.simulation_effort(scene.scenario, times, method=_LIKE, local_tolerance=wanted)
    argument, value = known.argument.replace("local_tolerance", "tolerance"), known.value
    needed = part * float(times[-1] - times[0]) / known.steps
    if chosen.controls_step:
        steps = _count(spacings, min(max(needed, MINIMUM_STEP), step or inf))
    elif step is not None:
        steps, argument = _count(spacings, step), "step"
        value = f"{step:g} s up to t = {times[-1]:g} s"
    else:
        longest = chosen.first_step(scene.scenario)
        first, shortest = _count(spacings, longest), min(longest, float(np.min(spacings)))
        halvings = max(1, ceil(log2(max(shortest / needed, 1.0))))
        if halvings > LATE and other is not None:
            # It takes over.
            found = _stepping_effort(scene, times, other, inf, tolerance)
            before = first * (2.0**LATE - 1.0)
            seconds = found.seconds + before * step_seconds
            return replace(found, steps=found.steps + before, seconds=seconds)
        if halvings >= HALVINGS:
            halvings = HALVINGS - 1
            tried = shortest / 2.0**halvings
            doubt = f"it needs steps of {needed:.0e} s, the shortest tried is {tried:.0e} s"
        steps = first * (2.0 ** (halvings + 1) - 1.0)
        if first >= steps / 8.0:
            argument, value = "times", f"up to t = {times[-1]:g} s"
    return Effort(
        steps=steps, seconds=steps * step_seconds, argument=argument, value=value, doubt=doubt
    )


def _stepping_effort(
    scene: Scene, times: Array, integrator: Integrator, longest: float, tolerance: float
) -> Effort:
    """That of runs which step accelerations; the same motions take in-house runs as many steps."""
    local = integrator.local_tolerance
    wanted = {"tolerance": tolerance} if local is None else {"local_tolerance": local}
    found = shared.simulation_effort(scene.scenario, times, method=integrator.method, **wanted)
    steps = max(found.steps, float(times[-1] - times[0]) / longest)
    cost = _EVALUATION_SECONDS.get(scene.built_as, _USUAL_EVALUATION)
    used = shared.METHODS[integrator.method]
    evaluations = used.evaluations * steps + times.size
    return replace(found, steps=steps, seconds=evaluations * (cost + used.linear))


def rest_effort(scene: Scene, end: float, step: float | None = None) -> Effort:
    """Effort of `mbs_models.simulate_to_rest` with these arguments.

    Parameters
    ----------
    scene : Scene
        With a rounded rim.
    end : float
        In s.
    step : float, optional
        In s. Without one, there are two runs or more to a tolerance.

    Raises
    ------
    ValueError
        If the step is not positive.
    """
    scenario = scene.scenario
    if step is None:
        found = shared.rest_effort(scenario, end)
        return replace(found, seconds=found.steps * _REST_SECONDS)
    end, step = positive("end", end), positive("step", step)
    stiffness, gradient = scenario.penalty_contact.stiffness, scenario.friction_gradient
    return Effort(
        steps=end / step,
        seconds=end / step * _REST_SECONDS,
        argument="end",
        value=f"= {end:g} s with steps of {step:.1e} s, at stiffness {stiffness:g} N/m and "
        f"friction gradient {gradient:g} s/m,",
    )


def _spacings(times: Array) -> Array:
    spacings: Array = np.diff(times)
    if (least := float(np.min(spacings))) < SHORTEST_STEP:
        raise ValueError(
            f"times must be {SHORTEST_STEP:g} s apart or more for the engine, got {least:g} s"
        )
    return spacings


def _count(spacings: Array, step: float) -> float:
    """Steps of at most `step` in s that end at every sample."""
    return float(np.sum(np.ceil(np.maximum(spacings / step - 1e-9, 1.0))))
