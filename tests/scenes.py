"""Scenes of the paper's models in one short call."""

from typing import Any

from analysis import Level, Scenario
from mbs_models import Formulation, Scene
from tests.helpers import model


def scene_of(level: Level = 1, formulation: Formulation | None = None, **fields: Any) -> Scene:
    """Scene of one of the paper's models."""
    return Scene(model(level, **fields), formulation)


def rest_scene(**fields: Any) -> Scene:
    """Scene for the way to rest."""
    return Scene(Scenario.rest(**fields))
