"""The largest step that works, over the smoothing of the friction and the contact's stiffness."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Literal

import numpy as np

import mbs_models
from analysis import STEEL_DISK, Method, PenaltyContact, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data.checks import Array
from analysis.stability.linearisation import ComplexArray
from analysis.stability.spectra import state_matrices
from mbs_models import Formulation, IntegratorName, Scene
from mbs_models.linear_stability import largest_step
from validation.studies.robustness.cases import STIFF, Way
from validation.studies.robustness.reference import deviation

Axis = Literal["smoothing", "stiffness"]

SPIN = 40.0
"""Spinning speed in rad/s of the inverted spinning about which stability is tested."""

DAMPING_RATIO = 0.5

ACCURACY = 1e-3
"""Error in rad from Table 3 at which a step counts as accurate."""

_STEPS = 480
"""Steps over which a motion must not grow."""

_SMALL = 1e-4
"""Disturbance as a part of the smoothing or of the resting penetration."""

_GROWTH = 100.0
"""Growth of a disturbance that counts as instability."""

_LATE = slice(-8, None)
"""Samples in which a growing disturbance shows, of 25."""

LADDER: tuple[float, ...] = tuple(10.0 ** (-1.0 - k / 4.0) for k in range(17))
"""Steps tried for accuracy in s, from 1e-1 to 1e-5."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepLimit:
    """The largest step at one place of a curve.

    Parameters
    ----------
    axis : {"smoothing", "stiffness"}
    value : float
        Smoothing in m/s or stiffness in N/m.
    formulation, integrator : str
    kind : {"stable", "accurate"}
        `stable`: no fast growth near the inverted spinning; `accurate`: error below
        `ACCURACY` from Table 3.
    step : float, optional
        In s; None if no step tried works.
    predicted : float, optional
        From the eigenvalues and the measured stability function, in s.
    """

    axis: Axis
    value: float
    formulation: Formulation
    integrator: IntegratorName
    kind: Literal["stable", "accurate"]
    step: float | None
    predicted: float | None = None


def stable_over_smoothing(smoothing: float, integrator: IntegratorName) -> list[StepLimit]:
    """Largest stable step of the contact tree, by bisection, and its prediction.

    Near inverted spinning the slip is tiny, so that friction is linear with a rate that grows as
    one over the smoothing. An unstable step shows as slip that grows; it does not blow up, since
    the friction force is bounded, but chatters. With much smoothing the inverted spinning itself
    is unstable about as fast; then there is no limit to be seen, and none is given.
    """
    slip = _SMALL * smoothing
    scenario = Scenario(
        friction=SmoothCoulomb(smoothing=smoothing),
        start=Start(gamma=pi / 2, spin=SPIN, gamma_rate=slip / STEEL_DISK.radius),
    )
    scene = Scene(scenario, "contact-tree")

    def stable(step: float) -> bool:
        run = _short_run(scene, step, integrator)
        return run is not None and bool(np.max(_slip(run)[_LATE]) <= _GROWTH * slip)

    values = _eigenvalues(scenario)
    predicted = min(largest_step(integrator, value) for value in _fast(values))
    hidden = np.exp(np.max(values.real) * _STEPS * predicted) > 0.5 * _GROWTH
    limit = StepLimit(
        axis="smoothing",
        value=smoothing,
        formulation="contact-tree",
        integrator=integrator,
        kind="stable",
        step=None if hidden else _bisect(stable, predicted),
        predicted=None if hidden else predicted,
    )
    return [limit]


def stable_over_stiffness(stiffness: float, integrator: IntegratorName) -> list[StepLimit]:
    """Largest stable step of the Euler tree on a damped penalty contact, and its prediction."""
    contact = PenaltyContact.damped(stiffness, STEEL_DISK, ratio=DAMPING_RATIO)
    scenario = Scenario(
        friction=SmoothCoulomb(load="contact"),
        contact=contact,
        start=Start.stationary(SPIN, "inverted"),
    )
    rate = sqrt(stiffness / scenario.disk.mass)
    depth = contact.resting_penetration(scenario.weight)
    resting = scenario.initial_state
    along, across, _, *turning = resting.rates
    bouncing_start = replace(resting, rates=(along, across, _SMALL * depth * rate, *turning))
    scene = Scene(replace(scenario, start=bouncing_start), "euler-tree")

    def stable(step: float) -> bool:
        run = _short_run(scene, step, integrator)
        if run is None:
            return False
        height = run.coordinate("z") - run.scenario.disk.radius * np.sin(run.coordinate("beta"))
        return bool(np.max(np.abs(height[_LATE] + depth)) <= _GROWTH * _SMALL * depth)

    bouncing = rate * complex(-DAMPING_RATIO, sqrt(1.0 - DAMPING_RATIO**2))
    rates_of_decay = [bouncing, *_fast(_eigenvalues(replace(scenario, contact=None)))]
    predicted = min(largest_step(integrator, value) for value in rates_of_decay)
    limit = StepLimit(
        axis="stiffness",
        value=stiffness,
        formulation="euler-tree",
        integrator=integrator,
        kind="stable",
        step=_bisect(stable, predicted),
        predicted=predicted,
    )
    return [limit]


def _eigenvalues(scenario: Scenario) -> ComplexArray:
    values = np.linalg.eigvals(state_matrices(scenario, [SPIN], system="full")[0])
    return values.astype(complex)


def _fast(values: ComplexArray) -> list[complex]:
    """The two eigenvalues whose decay is friction's; the slow ones need no small step."""
    return [complex(value) for value in values[np.argsort(values.real)[:2]]]


def _slip(run: Trajectory) -> Array:
    """Slip speed in m/s, shape (n,)."""
    x, y, _, _, beta, _ = run.coordinates.T
    x_rate, y_rate, _, spin, beta_rate, gamma_rate = run.rates.T
    r = run.scenario.disk.radius
    along = x_rate + (r * np.cos(beta) - y) * spin + r * gamma_rate
    across = y_rate + x * spin + r * np.sin(beta) * beta_rate
    result: Array = np.hypot(along, across)
    return result


def _short_run(scene: Scene, step: float, integrator: IntegratorName) -> Trajectory | None:
    times = step * np.linspace(0.0, _STEPS, 25)
    try:
        run = mbs_models.simulate(scene, times, step=step, integrator=integrator)
    except ArithmeticError:
        return None
    return run if run.ending is None else None


def _bisect(works: Callable[[float], bool], guess: float) -> float | None:
    """Largest working step within a factor of 30 about a guess, to two per cent.

    None if the smallest does not work.
    """
    low, high = guess / 30.0, guess * 30.0
    if not works(low):
        return None
    # Far above the limit a run can be too short to show its growth, so come from below.
    while low < high and works(2.0 * low):
        low *= 2.0
    high = 2.0 * low
    while high / low > 1.02:
        middle = sqrt(low * high)
        low, high = (middle, high) if works(middle) else (low, middle)
    return low


def accurate_steps(
    axis: Axis,
    value: float,
    ways: Sequence[tuple[Formulation, IntegratorName]],
    smallest: float,
) -> list[StepLimit]:
    """Largest step of `LADDER` that keeps the error from Table 3 below `ACCURACY`, by way.

    Parameters
    ----------
    axis : {"smoothing", "stiffness"}
    value : float
    ways : sequence of (formulation, integrator)
    smallest : float
        Step in s at which to give up.
    """
    ideal = scenario = Scenario(friction=SmoothCoulomb(smoothing=value))
    if axis == "stiffness":
        ideal = Scenario(friction=SmoothCoulomb(load="contact"))
        contact = PenaltyContact.damped(value, STEEL_DISK, ratio=DAMPING_RATIO)
        scenario = replace(ideal, contact=contact)
    times = np.linspace(0.0, 0.4, 5)
    method: Method = "Radau" if ideal.friction.finest_speed < STIFF else "DOP853"
    by_equations = Way(source="in-house", formulation="index-1", integrator=method)
    truth = by_equations.run(ideal, times, local_tolerance=1e-8)
    found = []
    for formulation, integrator in ways:
        scene = Scene(scenario, formulation)
        found.append(
            StepLimit(
                axis=axis,
                value=value,
                formulation=formulation,
                integrator=integrator,
                kind="accurate",
                step=_largest_accurate(scene, integrator, truth, smallest),
            )
        )
    return found


def _largest_accurate(
    scene: Scene, integrator: IntegratorName, truth: Trajectory, smallest: float
) -> float | None:
    for step in LADDER:
        if step < 0.999 * smallest:
            break
        try:
            run = mbs_models.simulate(scene, truth.times, step=step, integrator=integrator)
        except ArithmeticError:
            continue
        if run.ending is None and deviation(run, truth) <= ACCURACY:
            return step
    return None
