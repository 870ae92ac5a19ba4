"""What cannot work, asked for, and how it is refused."""

import time
from collections.abc import Callable
from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np

import analysis
import mbs_models
from analysis import MODELS, STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start, State
from mbs_models import Scene
from validation.study import Row, Study

TIMES = (0.0, 0.1)
RADIUS = STEEL_DISK.radius
LIMIT = 2.0
"""Time in s within which a refusal comes, so that nothing has run."""


PENALTY = PenaltyContact(stiffness=1e5)
BY_CONTACT = SmoothCoulomb(load="contact")


def _above() -> State:
    start = Scenario().initial_state
    x, y, z, *angles = start.coordinates
    return replace(start, coordinates=(x, y, z + 1e-3, *angles))


def _tree(**scenario: Any) -> Scene:
    return Scene(Scenario(**scenario), "contact-tree")


def _engine(how: dict[str, Any], **scenario: Any) -> object:
    return mbs_models.simulate(Scene(Scenario(**scenario)), **({"times": TIMES} | how))


def _reduced(**scenario: Any) -> object:
    return analysis.simulate(Scenario(**scenario), TIMES, form="reduced")


REQUESTS: dict[str, Callable[[], object]] = {
    "smoothing of zero": lambda: SmoothCoulomb(smoothing=0.0),
    "friction coefficient below zero": lambda: SmoothCoulomb(coefficient=-0.1),
    "friction coefficient not a number": lambda: SmoothCoulomb(coefficient=nan),
    "start lying flat": lambda: Start(beta=0.0),
    "endless spin": lambda: Start(spin=inf),
    "COG at the rim": lambda: replace(STEEL_DISK, eccentricity=RADIUS),
    "COG far out, moments about the centre kept": lambda: replace(
        STEEL_DISK, eccentricity=0.99 * RADIUS
    ),
    "slip along the edge in Model 3": lambda: Scenario(
        constraints=MODELS[3], start=Start(gamma_rate=1.0)
    ),
    "start above the table, engine": lambda: _engine({}, start=_above()),
    "start above the table, in-house": lambda: analysis.simulate(Scenario(start=_above()), TIMES),
    "explicit integrator on constraints": lambda: _engine(
        {"integrator": "RK44"}, constraints=MODELS[2]
    ),
    "contact tree in Model 2": lambda: _tree(constraints=MODELS[2]),
    "contact tree with the contact force as load": lambda: _tree(friction=BY_CONTACT),
    "penalty contact on a contact tree": lambda: _tree(contact=PENALTY),
    "penalty contact in Model 2": lambda: Scenario(constraints=MODELS[2], contact=PENALTY),
    "penalty contact that is too soft": lambda: Scenario(contact=PenaltyContact(stiffness=1e3)),
    "damping below zero": lambda: replace(PENALTY, damping=-1.0),
    "minimal coordinates in Model 3": lambda: _reduced(constraints=MODELS[3]),
    "minimal coordinates with the contact force as load": lambda: _reduced(
        constraints=MODELS[4], friction=BY_CONTACT
    ),
    "times that do not increase": lambda: _engine({"times": (0.0, 0.0)}),
    "step of zero": lambda: _engine({"step": 0.0}),
    "step and tolerance": lambda: _engine({"step": 1e-3, "tolerance": 1e-6}),
}


def measure(name: str) -> list[Row]:
    """Ask for something; it must be refused at once, in one line."""
    Scene()
    begin = time.perf_counter()
    reason, refused = "", False
    try:
        with np.errstate(all="raise"):
            REQUESTS[name]()
    except ValueError as error:
        reason, refused = str(error), True
    seconds = time.perf_counter() - begin
    at_once = refused and "\n" not in reason and seconds < LIMIT
    return [{"at_once": at_once, "reason": reason, "seconds": seconds}]


REFUSALS = Study(
    name="robustness-refusals",
    cases=lambda: {name: name for name in REQUESTS},
    measure=measure,
    columns={"at_once": f"by a ValueError of one line within {LIMIT:g} s"},
)
