"""The largest stable step over the smoothing of the friction and the contact's stiffness."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import sqrt

import numpy as np
import pandas as pd

import mbs_models
from analysis import STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start
from analysis.stability.spectra import eigenvalues
from mbs_models import Formulation, IntegratorName, Scene
from mbs_models.integrators import largest_step
from validation.study import Content, Row, Study, equal

Place = tuple[str, float]
"""Smoothing in m/s or stiffness in N/m."""

SMOOTHINGS = tuple(10.0**-digits for digits in range(1, 9))
STIFFNESSES = tuple(10.0**digits for digits in range(4, 10))

EXPLICIT: tuple[IntegratorName, ...] = ("RK44", "RK67")
"""Integrators of which stability is tested, on a formulation without constraints:"""

TREES: dict[str, Formulation] = {"smoothing": "contact-tree", "stiffness": "euler-tree"}

SPIN = 40.0
"""Spinning speed in rad/s of the inverted spinning about which stability is tested."""

DAMPING_RATIO = 0.5

NEAR = 0.03
"""Part of the predicted step by which steps are shorter and longer than it."""

_STEPS = 480
"""Steps over which a motion must not grow."""

_SMALL = 1e-4
"""Disturbance as a part of the smoothing or of the resting penetration."""

_GROWTH = 100.0
"""Growth of a disturbance that counts as instability."""

_LATE = slice(-8, None)
"""Samples in which a growing disturbance shows, of 25."""


def measure(place: Place) -> Iterator[Row]:
    """Whether inverted spinning is stable at steps about the predicted limit of each integrator.

    With more smoothing than here the inverted spinning itself is unstable about as fast as the
    step could make it, and there is no limit to be seen.
    """
    quantity, value = place
    scenario, speed = disturbed(quantity, value)
    ideal = replace(scenario, contact=None, start=Start())
    values = eigenvalues(ideal, [SPIN])[0]
    # Those of which the decay is friction's; the slow ones need no small step.
    decays = [complex(each) for each in values[np.argsort(values.real)[:2]]]
    if scenario.contact is not None:
        rate = sqrt(value / scenario.disk.mass)
        decays.append(rate * complex(-DAMPING_RATIO, sqrt(1.0 - DAMPING_RATIO**2)))
    scene = Scene(scenario, TREES[quantity])
    for integrator in EXPLICIT:
        step = min(largest_step(integrator, each) for each in decays)
        below, above = (
            is_stable(scene, integrator, part * step, speed) for part in (1.0 - NEAR, 1.0 + NEAR)
        )
        row: Row = {"quantity": quantity, "value": value, "integrator": integrator}
        yield row | {"predicted": step, "below": below, "above": above}


def disturbed(quantity: str, value: float) -> tuple[Scenario, float]:
    """Inverted spinning that is slightly disturbed, and the speed of that in m/s.

    By a slip, in which friction is linear with a rate of one over the smoothing; slip that grows
    does not blow up, since the friction force is bounded, but chatters. On a damped penalty
    contact by a vertical speed.
    """
    start = Start.stationary(SPIN, "inverted")
    if quantity == "smoothing":
        scenario, speed = Scenario(friction=SmoothCoulomb(smoothing=value)), _SMALL * value
        start = replace(start, gamma_rate=speed / scenario.disk.radius)
        return replace(scenario, start=start), speed
    contact = PenaltyContact.damped(value, STEEL_DISK, ratio=DAMPING_RATIO)
    scenario = Scenario(friction=SmoothCoulomb(load="contact"), contact=contact, start=start)
    depth = contact.resting_penetration(scenario.weight)
    speed = _SMALL * depth * sqrt(value / scenario.disk.mass)
    along, across, _, *turning = scenario.initial_state.rates
    rising = replace(scenario.initial_state, rates=(along, across, speed, *turning))
    return replace(scenario, start=rising), speed


def is_stable(scene: Scene, integrator: IntegratorName, step: float, speed: float) -> bool:
    """Whether a disturbance does not grow: the largest change of a velocity, over its speed."""
    times = step * np.linspace(0.0, _STEPS, 25)
    try:
        run = mbs_models.simulate(scene, times, step=step, integrator=integrator)
    except ArithmeticError:
        return False
    lengths = np.repeat((1.0, scene.scenario.disk.radius), 3)
    changes = lengths * (run.rates - (0.0, 0.0, 0.0, SPIN, 0.0, 0.0))[_LATE]
    return run.ending is None and bool(np.max(np.abs(changes)) <= _GROWTH * speed)


def _cases() -> Mapping[str, Place]:
    smoothings: dict[str, Place] = {f"smoothing {e:g} m/s": ("smoothing", e) for e in SMOOTHINGS}
    return smoothings | {f"stiffness {e:g} N/m": ("stiffness", e) for e in STIFFNESSES}


STUDY = Study(
    name="robustness-steps",
    cases=_cases,
    measure=measure,
    columns={
        "predicted": "predicted step in s",
        "below": f"stable {100 * NEAR:g} % below",
        "above": f"stable {100 * NEAR:g} % above",
    },
)


def present(table: pd.DataFrame) -> Content:
    """Whether steps are stable below the predicted ones and not above them."""
    # A step that is no number predicts nothing.
    complete = table.dropna()
    found = (
        complete[complete["below"] & ~complete["above"]].groupby("integrator")["case"].nunique()
    )
    places = len(_cases())
    return Content(
        tables={"steps": table.drop(columns="case").rename(columns=STUDY.columns)},
        checks=[
            equal(f"steps: {each}, places with the predicted limit", found.get(each), places)
            for each in EXPLICIT
        ],
    )
