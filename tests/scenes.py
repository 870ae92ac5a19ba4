"""Scenes of the paper's models in one short call, and what their motions are in truth."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import analysis
import mbs_models
from analysis import Level, Scenario, SmoothCoulomb, Start
from mbs_models import Formulation, Scene
from tests.helpers import model

TIMES, SHORT = np.linspace(0.0, 0.5, 26), np.linspace(0.0, 0.2, 21)
LOADED = SmoothCoulomb(load="contact")

JAMMING = Scenario(
    friction=SmoothCoulomb(coefficient=1.5, smoothing=1e-3, load="contact"),
    start=Start(beta=0.7, gamma=np.pi / 2, spin=0.0, y_rate=-3.0),
)
"""Thrown sideways, it jams after 0.013 s at a tilt of 0.7647 rad."""


def scene_of(level: Level = 1, formulation: Formulation | None = None, **fields: Any) -> Scene:
    """Scene of one of the paper's models."""
    return Scene(model(level, **fields), formulation)


def rest_scene(**fields: Any) -> Scene:
    """Scene for the way to rest."""
    return Scene(Scenario.rest(**fields))


def runner(formulation: Any, times: Any, **fields: Any) -> Callable[..., Any]:
    """What runs Model 1 by a formulation, or as long "to rest"."""
    if formulation == "to rest":
        return partial(mbs_models.simulate_to_rest, rest_scene(**fields), times[-1])
    return partial(mbs_models.simulate, scene_of(1, formulation, **fields), times)


def truth(scenario: Scenario, times: Any, **how: Any) -> analysis.Trajectory:
    """In-house motion, far below every tolerance."""
    return analysis.simulate(scenario, times, **({"local_tolerance": 1e-13} | how))
