"""Accelerations and forces of the engine in a state are those of the in-house equations."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import (
    LAWS,
    LOADS,
    MODELS,
    STEEL_DISK,
    Body,
    ConstraintSet,
    Dissipation,
    Level,
    Load,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    multiplier_names,
)
from analysis.mechanics.recorded import accelerations
from mbs_models import Scene, formulations
from mbs_models.friction import slip_velocity
from tests.bodies import BODIES, random_start
from tests.helpers import model, more_sets, random_scenario, slip
from tests.helpers import random_start as free_start
from tests.wayward_law import Own

STEEP = Table(inclination=0.2, downhill=0.5)


def compare(scenario: Scenario, parts: Sequence[float] = (1e-9, 1e-9), least: float = 0.0) -> None:
    """Accelerations and forces of every formulation with the in-house ones.

    They differ by no more than so large a part of the largest, or of the least if that is more.
    """
    state = scenario.initial_state
    expected = accelerations(scenario, state.coordinates, state.rates)
    built = formulations(scenario)
    assert built
    for formulation in built:
        found = mbs_models.acceleration(Scene(scenario, formulation))
        assert found[1].shape == (len(multiplier_names(scenario.constraints)),)
        for one, other, part in zip(found, expected, parts, strict=True):
            scale = max(least, float(np.max(np.abs(other))))
            np.testing.assert_allclose(one, other, rtol=0.0, atol=part * scale)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("products", [0.0, 0.25])
@more_sets
def test_with_every_set_of_constraints(
    constraints: ConstraintSet, products: float, load: Load
) -> None:
    for seed in range(3):
        compare(random_scenario(constraints, seed, SmoothCoulomb(load=load), products)[0])


@pytest.mark.parametrize("spin", [-1000.0, 5.0])
@pytest.mark.parametrize("tilt", [1e-3, 1e-2])
@pytest.mark.parametrize("side", ["bottom", "top"])
@pytest.mark.parametrize("level", [2, 3, 4])
def test_near_a_flat_disk(level: Level, side: str, tilt: float, spin: float) -> None:
    """Angles are ill-conditioned there: a tilt of 1e-3 loses six digits of alpha and gamma."""
    beta = tilt if side == "bottom" else pi - tilt
    for seed in range(4):
        start = free_start(MODELS[level], np.random.default_rng(seed))
        start = replace(start, beta=beta, spin=spin)
        scenario = Scenario(constraints=MODELS[level], start=start)
        compare(scenario, (1e-10 / tilt**2, 1e-7), scenario.weight)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("contact", ["ideal", "sharp", "sharp, losses", "rounded, losses"])
@pytest.mark.parametrize("body", BODIES.values(), ids=list(BODIES))
def test_of_bodies_on_either_contact(body: Body, contact: str, seed: int, load: Load) -> None:
    given: Any = {"friction": SmoothCoulomb(load=load), "start": random_start(seed)}
    if "sharp" in contact:
        given["contact"] = PenaltyContact.damped(1e5, body)
    if "rounded" in contact:
        given["contact"] = PenaltyContact.rounded(body, stiffness=1e5)
    if "losses" in contact:
        drag = 1.2 * body.is_round_disk
        given["dissipation"] = Dissipation(
            rolling_dry=1e-3, rolling_viscous=1e-3, pivoting=1e-4, air_drag=drag
        )
    compare(Scenario(disk=body, table=STEEP, **given))


@dataclass(frozen=True, slots=True, kw_only=True)
class Slanted(SmoothCoulomb):
    """Law whose axes are not those of the edge: there is a left and a right."""

    IS_ISOTROPIC = False

    def force(self, along: Any, across: Any, load: Any) -> tuple[Any, Any]:
        x, y = SmoothCoulomb.force(self, along, across, load)
        return x + 0.5 * y, y + 0.5 * x


ON_CONTACT = [kind(load="contact") for kind in (*[*LAWS.values()][1:], Own)]
BESIDE = Start(beta=1.2, gamma=0.4, spin=20.0, beta_rate=2.0)
RUBBED = [
    *(model(level, friction=law, start=BESIDE) for level in (1, 3) for law in ON_CONTACT),
    model(1, friction=Slanted(), start=BESIDE),
    *(
        Scenario(contact=PenaltyContact(stiffness=2e5, damping=20.0), friction=law)
        for law in ON_CONTACT
        if not law.is_simple
    ),
]


@pytest.mark.parametrize("scenario", RUBBED, ids=lambda each: f"{each.friction} {each.name}")
def test_under_every_law_and_on_a_yielding_table(scenario: Scenario) -> None:
    compare(scenario, least=1.0)


def test_slip_is_the_velocity_of_the_disk_where_it_touches_the_table() -> None:
    place, rates = np.random.default_rng(3).uniform(0.2, 1.4, size=(2, 6))
    found = slip_velocity(STEEL_DISK.radius, place, rates)
    np.testing.assert_allclose(found, slip(STEEL_DISK, lambda t: place + t * rates), rtol=1e-8)
