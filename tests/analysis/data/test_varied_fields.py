"""Fields of a scenario that vary: their names, the scenarios they make, and what is refused."""

from dataclasses import asdict, replace
from math import pi
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
    State,
    Stribeck,
)
from analysis.data.changes import changed
from analysis.data.disk import STEEL_RING

PAPER = Scenario()


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
            {"disk.radius": 0.05},
            replace(PAPER, disk=Disk.ring(**(STEEL_RING | {"radius": 0.05}))),
        ),
        (
            {f"disk.{name}": 2.0 * value for name, value in asdict(STEEL_DISK).items()}
            | {"disk.mass": 1.0},
            replace(
                PAPER,
                disk=Disk(
                    **{name: 2.0 * value for name, value in asdict(STEEL_DISK).items()}
                    | {"mass": 1.0}
                ),
            ),
        ),
    ],
)
def test_case_is_the_scenario_with_its_fields_changed(changes: Any, expected: Scenario) -> None:
    assert changed(PAPER, changes) == expected


ROUNDED = replace(PAPER, disk=ROUNDED_STEEL_DISK)
TOLD = State(coordinates=(0, 0, 0.045, 0, pi / 2, 0), rates=(0.0,) * 6)


@pytest.mark.parametrize(
    ("scenario", "names", "message"),
    [
        (PAPER, "contact.stiffness", "needs a penalty contact"),
        (PAPER, "friction.static", r"friction\.static must be one of load, coefficient"),
        (PAPER, "disk.radius disk.mass", "mass does not go together with radius, from which it"),
        (PAPER, "disk.thickness disk.inertia_x", "inertia_x does not go together with thickness"),
        (ROUNDED, "disk.radius", "radius varies a ring alone"),
        (ROUNDED, "disk.hole_radius", "hole_radius varies a ring alone"),
        (replace(PAPER, start=TOLD), "start.spin", "the start is told by its coordinates and"),
    ],
)
def test_fields_that_do_not_vary_in_a_scenario_are_refused(
    scenario: Scenario, names: str, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        Ensemble(
            scenario=scenario, fields={name: np.array([0.04, 0.05]) for name in names.split()}
        )
