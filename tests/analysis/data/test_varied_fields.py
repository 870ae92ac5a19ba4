"""Fields of a scenario that vary: their names, the scenarios they make, and what is refused."""

from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

from analysis import (
    MODELS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Ensemble,
    Scenario,
    SmoothCoulomb,
    Start,
    Stribeck,
)
from analysis.data.changes import changed
from analysis.data.disk import STEEL_RING

PAPER = Scenario()
TWICE = asdict(STEEL_DISK)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"start.spin": 12.0}, replace(PAPER, start=Start(spin=12.0))),
        ({"model": 4}, replace(PAPER, constraints=MODELS[4])),
        ({"constraints": "contact+fixed-cog"}, replace(PAPER, constraints=MODELS[2])),
        ({"friction.load": "contact"}, replace(PAPER, friction=SmoothCoulomb(load="contact"))),
        (
            {"friction.static": 0.6, "friction.law": "stribeck"},
            replace(PAPER, friction=Stribeck(static=0.6)),
        ),
        (
            {"disk.eccentricity": 2e-3, "disk.name": "steel-rounded"},
            replace(PAPER, disk=replace(ROUNDED_STEEL_DISK, eccentricity=2e-3)),
        ),
        (
            {"disk.hole_radius": 0.01},
            replace(PAPER, disk=Disk.ring(**(STEEL_RING | {"hole_radius": 0.01}))),
        ),
        (
            {f"disk.{name}": 2.0 * value for name, value in TWICE.items()},
            replace(PAPER, disk=Disk(**{name: 2.0 * value for name, value in TWICE.items()})),
        ),
    ],
)
def test_case_is_the_scenario_with_its_fields_changed(changes: Any, expected: Scenario) -> None:
    assert changed(PAPER, changes) == expected


ROUNDED = replace(PAPER, disk=ROUNDED_STEEL_DISK)
TOLD = replace(PAPER, start=PAPER.initial_state)


@pytest.mark.parametrize(
    ("scenario", "names", "message"),
    [
        (PAPER, "contact.stiffness", "needs a penalty contact"),
        (PAPER, "friction.static", r"static is unknown here; .* takes law, .*coefficient"),
        (PAPER, "disk.radius disk.mass", "mass is unknown here; .*; or radius, mass"),
        (ROUNDED, "disk.radius", "radius varies a ring alone"),
        (TOLD, "start.spin", "the start is told by its coordinates and"),
    ],
)
def test_fields_that_do_not_vary_in_a_scenario_are_refused(
    scenario: Scenario, names: str, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        Ensemble(scenario=scenario, fields=dict.fromkeys(names.split(), np.array([0.04, 0.05])))
