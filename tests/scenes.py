"""Scenes of the paper's models in one short call."""

from typing import Any

from analysis import Level, Scenario
from mbs_models import Formulation, Scene
from tests.helpers import model as scenario_of

__all__ = ["rest_scene", "scenario_of", "scene_of"]


def scene_of(level: Level = 1, formulation: Formulation | None = None, **fields: Any) -> Scene:
    """Scene of one of the paper's models."""
    return Scene(scenario_of(level, **fields), formulation)


def rest_scene(**fields: Any) -> Scene:
    """Scene for the way to rest."""
    return Scene(Scenario.rest(**fields))
