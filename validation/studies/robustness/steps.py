"""The largest stable step over the smoothing of the friction and the contact's stiffness."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import pi, sqrt
from typing import Literal

import numpy as np
import pandas as pd

import mbs_models
from analysis import (
    STEEL_DISK,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Trajectory,
)
from analysis.data.checks import Array
from analysis.stability.spectra import eigenvalues
from mbs_models import Formulation, IntegratorName, Scene
from mbs_models.linear_stability import largest_step
from validation.kit.limits import largest
from validation.page.content import Content
from validation.study import Row, Study, at_most, relative

Axis = Literal["smoothing", "stiffness"]
Place = tuple[Axis, float]
"""Smoothing in m/s or stiffness in N/m."""

SMOOTHINGS = tuple(10.0**-digits for digits in range(9))
STIFFNESSES = tuple(10.0**digits for digits in range(4, 10))

EXPLICIT: tuple[IntegratorName, ...] = ("RK44", "RK67")
"""Integrators of which stability is tested, on a formulation without constraints:"""

TREES: dict[Axis, Formulation] = {"smoothing": "contact-tree", "stiffness": "euler-tree"}

SPIN = 40.0
"""Spinning speed in rad/s of the inverted spinning about which stability is tested."""

DAMPING_RATIO = 0.5

NEAR = 0.03
"""Largest relative difference of a stable step from the predicted one."""

APART = "step over predicted less 1"
"""Column."""

_STEPS = 480
"""Steps over which a motion must not grow."""

_SMALL = 1e-4
"""Disturbance as a part of the smoothing or of the resting penetration."""

_GROWTH = 100.0
"""Growth of a disturbance that counts as instability."""

_LATE = slice(-8, None)
"""Samples in which a growing disturbance shows, of 25."""


Growth = Callable[[Trajectory], Array]
"""From a run to a disturbance over its start, shape (n,)."""


def measure(place: Place) -> list[Row]:
    """Largest stable steps of explicit integrators at a place by bisection, and their prediction.

    They are those with which a small disturbance of inverted spinning does not grow.

    With much smoothing the inverted spinning itself is unstable about as fast as the step could
    make it; then there is no limit to be seen, and none is given.
    """
    axis, value = place
    ideal, scenario, growth = (_slipping if axis == "smoothing" else _bouncing)(value)
    values = eigenvalues(ideal, [SPIN])[0]
    # Those of which the decay is friction's; the slow ones need no small step.
    decays = [complex(each) for each in values[np.argsort(values.real)[:2]]]
    if scenario.contact is not None:
        rate = sqrt(scenario.contact.stiffness / scenario.disk.mass)
        decays.append(rate * complex(-DAMPING_RATIO, sqrt(1.0 - DAMPING_RATIO**2)))
    scene, rows = Scene(scenario, TREES[axis]), []
    for integrator in EXPLICIT:
        row: Row = {"over": axis, "value": value, "integrator": integrator}
        row |= {"step": None, "predicted": None}
        predicted = min(largest_step(integrator, each) for each in decays)
        if np.exp(np.max(values.real) * _STEPS * predicted) <= 0.5 * _GROWTH:
            works = partial(_is_stable, scene, integrator, growth)
            row |= {"step": bisected(works, predicted), "predicted": predicted}
        rows.append(row)
    return rows


def _is_stable(scene: Scene, integrator: IntegratorName, growth: Growth, step: float) -> bool:
    times = step * np.linspace(0.0, _STEPS, 25)
    try:
        run = mbs_models.simulate(scene, times, step=step, integrator=integrator)
    except ArithmeticError:
        return False
    return run.ending is None and bool(np.max(growth(run)[_LATE]) <= _GROWTH)


def _slipping(smoothing: float) -> tuple[Scenario, Scenario, Growth]:
    """With a small slip, in which friction is linear with a rate of one over the smoothing.

    Slip that grows does not blow up, since the friction force is bounded, but chatters.

    Returns
    -------
    ideal, scenario : Scenario
        With an ideal contact, and what is run.
    growth : callable
    """
    ideal = Scenario(friction=SmoothCoulomb(smoothing=smoothing))
    slip = _SMALL * smoothing
    start = Start(gamma=pi / 2, spin=SPIN, gamma_rate=slip / ideal.disk.radius)

    def growth(run: Trajectory) -> Array:
        positions, _, velocities, turning = run.poses
        speeds = velocities + np.cross(turning, run.contact_points - positions)
        found: Array = np.hypot(speeds[:, 0], speeds[:, 1]) / slip
        return found

    return ideal, replace(ideal, start=start), growth


def _bouncing(stiffness: float) -> tuple[Scenario, Scenario, Growth]:
    """The same on a damped penalty contact, with a small vertical speed."""
    ideal = Scenario(friction=SmoothCoulomb(load="contact"))
    contact = PenaltyContact.damped(stiffness, STEEL_DISK, ratio=DAMPING_RATIO)
    depth = contact.resting_penetration(ideal.weight)
    resting = replace(ideal, contact=contact, start=Start.stationary(SPIN, "inverted"))
    along, across, _, *turning = resting.initial_state.rates
    speed = _SMALL * depth * sqrt(stiffness / ideal.disk.mass)
    start = replace(resting.initial_state, rates=(along, across, speed, *turning))

    def growth(run: Trajectory) -> Array:
        height = run.coordinate("z") - ideal.disk.radius * np.sin(run.coordinate("beta"))
        found: Array = np.abs(height + depth) / (_SMALL * depth)
        return found

    return ideal, replace(resting, start=start), growth


def bisected(works: Callable[[float], bool], guess: float) -> float | None:
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


def _cases() -> Mapping[str, Place]:
    smoothings: dict[str, Place] = {f"smoothing {e:g} m/s": ("smoothing", e) for e in SMOOTHINGS}
    return smoothings | {f"stiffness {e:g} N/m": ("stiffness", e) for e in STIFFNESSES}


STUDY = Study(
    name="robustness-steps",
    cases=_cases,
    measure=measure,
    keys=("integrator",),
    sample=("stiffness 10000 N/m", "smoothing 1 m/s", "smoothing 0.01 m/s"),
    confirm={"step": relative("step", 0.01), "predicted": relative("predicted", 1e-4)},
    columns={"step": "largest in s", "predicted": "in s"},
)


def present(table: pd.DataFrame) -> Content:
    """Stable steps beside predicted ones, where there are some."""
    limits = table.assign(**{APART: table["step"] / table["predicted"] - 1.0})
    told = limits.dropna(subset="predicted")
    checks = []
    for integrator in EXPLICIT:
        found = limits[limits["integrator"] == integrator].set_index("case").reindex([*_cases()])
        hidden = found["predicted"].isna()
        # The widest smoothing: there the spinning itself is unstable about as fast.
        name, worst = f"steps: {integrator}", largest(found[APART][~hidden].abs())
        checks += [
            at_most(f"{name}, places without a stable step", int(hidden.sum()), 1),
            at_most(f"{name}, stable over predicted", worst, NEAR),
        ]
    return Content(
        numbers={
            "apart": float(told[APART].abs().max()),
            "places": told.groupby("over")["value"].agg(["min", "max"]).to_dict("index"),
        },
        tables={"steps": told.drop(columns="case")},
        checks=checks,
    )
