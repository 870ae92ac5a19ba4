"""The unilateral penalty contact, in the engine's formulations and in-house."""

from dataclasses import replace

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    GRAVITY,
    LOADS,
    MODELS,
    STEEL_DISK,
    Load,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
)
from analysis.mechanics.recorded import accelerations
from analysis.problem.checks import Array
from mbs_models import Formulation
from tests.helpers import angles_apart
from tests.scenes import scene_of

CONTACT = PenaltyContact(stiffness=1e5, damping=10.0)
TIMES = np.linspace(0.0, 0.1, 21)
UPRIGHT = Start(spin=0.0, gamma=np.pi / 2)

every_formulation = pytest.mark.parametrize(
    "formulation", ["euler-tree", "floating-lie", "floating"]
)


@every_formulation
@pytest.mark.parametrize("load", LOADS)
def test_only_a_bilateral_contact_acts_in_the_air(formulation: Formulation, load: Load) -> None:
    # What falls onto the table feels no damper before it touches.
    for height, speed, bilateral in ((1e-5, 0.0, False), (1e-5, 0.0, True), (1e-6, -1.0, False)):
        start = replace(UPRIGHT, height=height).state(MODELS[1], STEEL_DISK)
        scene = scene_of(
            1,
            formulation,
            contact=replace(CONTACT, bilateral=bilateral),
            friction=SmoothCoulomb(load=load),
            start=replace(start, rates=(0.0, 0.0, speed, 0.0, 0.0, 0.0)),
        )
        found, force = mbs_models.acceleration(scene)
        expected = -CONTACT.stiffness * height * bilateral
        assert force[0] == pytest.approx(expected, rel=1e-9)
        lifting = expected / STEEL_DISK.mass - GRAVITY
        np.testing.assert_allclose(found, [0, 0, lifting, 0, 0, 0], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("bilateral", [False, True])
@pytest.mark.parametrize("load", LOADS)
def test_friction_in_the_air_is_that_of_a_bilateral_contact_under_the_weight_alone(
    load: Load, *, bilateral: bool
) -> None:
    contact = replace(CONTACT, bilateral=bilateral)
    start = Start(spin=30.0, x_rate=0.2, height=5e-3)
    found: list[list[Array]] = []
    for coefficient in (0.3, 0.0):
        friction = SmoothCoulomb(coefficient=coefficient, load=load)
        scenario = Scenario(contact=contact, friction=friction, start=start)
        state = scenario.initial_state
        in_house, _ = accelerations(scenario, state.coordinates, state.rates)
        found.append([in_house, mbs_models.acceleration(scenario)[0]])
    np.testing.assert_allclose(found[0][0], found[0][1], rtol=1e-8, atol=1e-7)
    for rubbing, smooth in zip(*found, strict=True):
        assert np.allclose(rubbing, smooth) == (not bilateral or load == "contact")


def test_damping_ratio_is_that_of_the_upright_disk_on_its_spring() -> None:
    ratio, offset = 0.3, 1e-5
    damped = PenaltyContact.damped(1e5, STEEL_DISK, ratio=ratio)
    # The centre of gravity above the contact point: the disk moves up and down alone.
    upright = Scenario(contact=replace(damped, bilateral=True), start=UPRIGHT)
    resting = upright.initial_state
    x, y, z, *angles = resting.coordinates
    lifted = replace(resting, coordinates=(x, y, z + offset, *angles))
    times = np.linspace(0.0, 0.02, 41)
    run = analysis.simulate(replace(upright, start=lifted), times, local_tolerance=1e-11)
    frequency = np.sqrt(1e5 / STEEL_DISK.mass)
    ringing, decay = frequency * np.sqrt(1.0 - ratio**2), ratio * frequency
    shape = np.cos(ringing * times) + decay / ringing * np.sin(ringing * times)
    expected = offset * np.exp(-decay * times) * shape
    np.testing.assert_allclose(run.coordinate("z") - z, expected, atol=1e-11)


@every_formulation
def test_stiff_contact_is_taken_by_the_implicit_integrator_in_large_steps(
    formulation: Formulation,
) -> None:
    truth = analysis.simulate(Scenario(), TIMES, tolerance=1e-9)
    scene = scene_of(1, formulation, contact=PenaltyContact.damped(1e9, STEEL_DISK))
    run = mbs_models.simulate(scene, TIMES, step=1e-3, integrator="TrapezoidalIndex2")
    assert angles_apart(run, truth) < 1e-3
