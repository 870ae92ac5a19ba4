"""Scenarios and scenes of the paper's models in one short call."""

from typing import Any

from analysis import MODELS, Level, Scenario
from mbs_models import Formulation, Scene


def scenario_of(level: Level = 1, **fields: Any) -> Scenario:
    """Scenario of one of the paper's models."""
    return Scenario(constraints=MODELS[level], **fields)


def scene_of(level: Level = 1, formulation: Formulation | None = None, **fields: Any) -> Scene:
    """Scene of one of the paper's models."""
    return Scene(scenario_of(level, **fields), formulation)


def rest_scene(**fields: Any) -> Scene:
    """Scene for the way to rest."""
    return Scene(Scenario.rest(**fields))
