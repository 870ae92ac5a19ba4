"""Descriptions of scenes."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import LEVELS, MODELS, STEEL_DISK, SmoothCoulomb, Start, State
from mbs_models.scene import build
from tests.helpers import model
from tests.scenes import scene_of


def test_default_formulation_is_the_most_accurate_one_of_each_level() -> None:
    assert [scene_of(level).built_as for level in LEVELS] == [
        "contact-tree",
        "euler-tree",
        "euler-tree",
        "euler-tree",
    ]


def test_default_formulation_of_model_1_knows_the_contact_force_where_friction_needs_it() -> None:
    scene = scene_of(friction=SmoothCoulomb(load="contact"))
    assert scene.built_as == "euler-tree"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"formulation": "floatng"}, "formulation must be one of floating"),
        ({"level": 2, "formulation": "contact-tree"}, "exists for Model 1 alone, got Model 2"),
        (
            {"formulation": "contact-tree", "friction": SmoothCoulomb(load="contact")},
            "load 'contact' of the friction law .* use one of euler-tree",
        ),
    ],
)
def test_scene_that_cannot_be_built_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        scene_of(**arguments)


@pytest.mark.parametrize("level", LEVELS)
def test_frictionless_scene_has_no_friction_item(level: Any) -> None:
    frictionless = SmoothCoulomb(coefficient=0.0)
    for formulation in mbs_models.formulations(model(level)):
        with_friction = build(scene_of(level, formulation)).system
        without = build(scene_of(level, formulation, friction=frictionless)).system
        connectors = int(formulation.startswith("floating"))
        count = with_friction.systemData.NumberOfObjects()
        assert without.systemData.NumberOfObjects() == count - connectors
        if not connectors:
            assert without.GetObject(0)["forceUserFunction"] == 0


@pytest.mark.parametrize("level", LEVELS)
def test_engine_starts_where_the_scene_says(level: Any) -> None:
    start = Start(beta=1.1, gamma=0.7, spin=-23.0, beta_rate=3.0)
    for formulation in mbs_models.formulations(model(level)):
        built = build(scene_of(level, formulation, start=start))
        coordinates, rates = built.decode(built.record()[None])
        state = built.scenario.initial_state
        np.testing.assert_allclose(coordinates[0], state.coordinates, atol=1e-12)
        np.testing.assert_allclose(rates[0], state.rates, atol=1e-11)


@pytest.mark.parametrize(
    ("level", "column", "rate", "name"),
    [
        (1, 2, False, "'contact' of Model 1.*position level by 1.000e-04 m,"),
        (1, 2, True, "'contact' of Model 1.*velocity level by 1.000e-04 m/s,"),
        (2, 0, False, "'fixed-cog' of Model 2.*position level by 1.000e-04 m,"),
        (2, 1, True, "'fixed-cog' of Model 2.*velocity level by 1.000e-04 m/s,"),
        (3, 5, True, "velocity level by 2.488e-07 m/s,"),
    ],
)
def test_start_that_breaks_a_constraint_is_refused_by_the_engine(
    level: Any, column: int, rate: bool, name: str
) -> None:
    start = Start().state(MODELS[level], STEEL_DISK)
    values = list(start.rates if rate else start.coordinates)
    values[column] += 1e-4
    broken: State = replace(start, **{"rates" if rate else "coordinates": tuple(values)})
    for formulation in mbs_models.formulations(model(level)):
        scene = scene_of(level, formulation, start=broken)
        with pytest.raises(ValueError, match=name):
            mbs_models.acceleration(scene)
        with pytest.raises(ValueError, match=name):
            mbs_models.simulate(scene, [0.0, 0.1])
