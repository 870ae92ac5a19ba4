"""The engine against the in-house equations: every set of constraints, and a leaning table."""

from dataclasses import replace
from math import radians
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LOADS,
    MODELS,
    POSSIBLE_SETS,
    ConstraintSet,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    multiplier_names,
)
from analysis.data.admissible import independent_coordinates
from analysis.data.constraint_set import set_name
from analysis.mechanics.recorded import accelerations
from mbs_models import Formulation, Scene, formulations
from tests.helpers import TILTED

SLOPE = Table(inclination=radians(2.0), downhill=0.7)
RANGES = {
    "x": (-0.02, 0.02),
    "y": (-0.02, 0.02),
    "beta": (0.6, 2.4),
    "gamma": (-3.0, 3.0),
    "x_rate": (-0.3, 0.3),
    "y_rate": (-0.3, 0.3),
    "beta_rate": (-5.0, 5.0),
    "gamma_rate": (-5.0, 5.0),
    "alpha": (-3.0, 3.0),
    "spin": (-20.0, 20.0),
}

CASES = [
    (constraints, formulation)
    for constraints in (*POSSIBLE_SETS, *TILTED)
    for formulation in formulations(Scenario(constraints=constraints))
]


def name(value: object) -> str:
    if isinstance(value, Table):
        return "horizontal" if value.is_horizontal else "slope"
    return set_name(value) if isinstance(value, tuple) else str(value)


def random_start(constraints: ConstraintSet, random: np.random.Generator) -> Start:
    """Start that is free in everything that the constraints leave free."""
    free = (*independent_coordinates(constraints), "alpha", "spin")
    return Start(**{field: random.uniform(*RANGES[field]) for field in free})


def loads(formulation: Formulation) -> tuple[analysis.Load, ...]:
    return ("weight",) if formulation == "contact-tree" else LOADS


@pytest.mark.parametrize("table", [Table(), SLOPE], ids=name)
@pytest.mark.parametrize(("constraints", "formulation"), CASES, ids=name)
def test_accelerations_and_forces_are_those_of_the_in_house_equations(
    constraints: ConstraintSet, formulation: Formulation, table: Table
) -> None:
    random = np.random.default_rng(len(constraints))
    for load in 3 * loads(formulation):
        scenario = Scenario(
            constraints=constraints,
            friction=SmoothCoulomb(load=load),
            table=table,
            start=random_start(constraints, random),
        )
        state = scenario.initial_state
        expected = accelerations(scenario, state.coordinates, state.rates)
        found = mbs_models.acceleration(Scene(scenario, formulation))
        assert found[1].shape == (len(multiplier_names(constraints)),)
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * np.max(np.abs(other)))


@pytest.mark.parametrize("spin", [-1000.0, 5.0])
@pytest.mark.parametrize("tilt", [1e-3, 1e-2])
@pytest.mark.parametrize("side", ["bottom", "top"])
@pytest.mark.parametrize("constraints", [MODELS[2], MODELS[3], MODELS[4]], ids=name)
@pytest.mark.parametrize("formulation", ["euler-tree", "floating", "floating-lie"])
def test_accelerations_and_forces_are_right_near_a_flat_disk(
    formulation: Formulation, constraints: ConstraintSet, side: str, tilt: float, spin: float
) -> None:
    """Angles are ill-conditioned there: a tilt of 1e-3 loses six digits of alpha and gamma."""
    random = np.random.default_rng(3)
    for _ in range(4):
        beta = tilt if side == "bottom" else np.pi - tilt
        start = replace(random_start(constraints, random), beta=beta, spin=spin)
        scenario = Scenario(constraints=constraints, start=start)
        state = scenario.initial_state
        expected = accelerations(scenario, state.coordinates, state.rates)
        found = mbs_models.acceleration(Scene(scenario, formulation))
        for one, other, least in zip(found, expected, (1e-10 / tilt**2, 1e-7), strict=True):
            scale = max(scenario.weight, float(np.max(np.abs(other))))
            np.testing.assert_allclose(one, other, rtol=0.0, atol=least * scale)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"table": SLOPE}, "linearisation .* needs a horizontal table, got an inclination"),
        ({"contact": PenaltyContact(stiffness=1e5)}, "contact must be left out"),
        ({"start": Start()}, "start must be a stationary motion to linearise about"),
    ],
    ids=["slope", "penalty", "moving"],
)
def test_what_is_not_linearised_is_refused(fields: dict[str, Any], message: str) -> None:
    scenario = Scenario(**{"start": Start.stationary(30.0)} | fields)
    with pytest.raises(ValueError, match=message):
        mbs_models.eigenvalues(Scene(scenario))
