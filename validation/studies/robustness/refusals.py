"""What cannot work, asked for, and how it is refused."""

import time
from collections.abc import Callable
from dataclasses import replace
from math import inf, nan

import numpy as np

import analysis
import mbs_models
from analysis import MODELS, STEEL_DISK, PenaltyContact, Scenario, SmoothCoulomb, Start, State
from mbs_models import Scene
from validation.study import Row, Study

TIMES = (0.0, 0.1)
LIMIT = 2.0
"""Time in s within which a refusal comes, so that nothing has run."""


def _above_the_table() -> State:
    start = Scenario().initial_state
    x, y, z, *angles = start.coordinates
    return replace(start, coordinates=(x, y, z + 1e-3, *angles))


REQUESTS: dict[str, Callable[[], object]] = {
    "smoothing of zero": lambda: SmoothCoulomb(smoothing=0.0),
    "friction coefficient below zero": lambda: SmoothCoulomb(coefficient=-0.1),
    "friction coefficient not a number": lambda: SmoothCoulomb(coefficient=nan),
    "start lying flat": lambda: Start(beta=0.0),
    "endless spin": lambda: Start(spin=inf),
    "COG at the rim": lambda: replace(STEEL_DISK, eccentricity=STEEL_DISK.radius),
    "COG far out, moments about the centre kept": lambda: replace(
        STEEL_DISK, eccentricity=0.99 * STEEL_DISK.radius
    ),
    "slip along the edge in Model 3": lambda: Scenario(
        constraints=MODELS[3], start=Start(gamma_rate=1.0)
    ),
    "start above the table, engine": lambda: mbs_models.simulate(
        Scene(Scenario(start=_above_the_table())), TIMES
    ),
    "start above the table, in-house": lambda: analysis.simulate(
        Scenario(start=_above_the_table()), TIMES
    ),
    "explicit integrator on constraints": lambda: mbs_models.simulate(
        Scene(Scenario(constraints=MODELS[2])), TIMES, integrator="RK44"
    ),
    "contact tree in Model 2": lambda: Scene(Scenario(constraints=MODELS[2]), "contact-tree"),
    "contact tree with the contact force as load": lambda: Scene(
        Scenario(friction=SmoothCoulomb(load="contact")), "contact-tree"
    ),
    "penalty contact on a contact tree": lambda: Scene(
        Scenario(contact=PenaltyContact(stiffness=1e5)), "contact-tree"
    ),
    "penalty contact in Model 2": lambda: Scenario(
        constraints=MODELS[2], contact=PenaltyContact(stiffness=1e5)
    ),
    "penalty contact that is too soft": lambda: Scenario(contact=PenaltyContact(stiffness=1e3)),
    "damping below zero": lambda: PenaltyContact(stiffness=1e5, damping=-1.0),
    "minimal coordinates in Model 3": lambda: analysis.simulate(
        Scenario(constraints=MODELS[3]), TIMES, form="reduced"
    ),
    "minimal coordinates with the contact force as load": lambda: analysis.simulate(
        Scenario(constraints=MODELS[4], friction=SmoothCoulomb(load="contact")),
        TIMES,
        form="reduced",
    ),
    "times that do not increase": lambda: mbs_models.simulate(Scene(), (0.0, 0.0)),
    "step of zero": lambda: mbs_models.simulate(Scene(), TIMES, step=0.0),
    "step and tolerance": lambda: mbs_models.simulate(Scene(), TIMES, step=1e-3, tolerance=1e-6),
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
