"""The unilateral penalty contact."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LOADS,
    MODELS,
    STEEL_DISK,
    Dissipation,
    Load,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
)
from analysis.data.frames import poses
from analysis.mechanics.paper import mass_matrix
from mbs_models import Formulation
from tests.scenes import scene_of

FORMULATIONS: tuple[Formulation, ...] = ("euler-tree", "floating", "floating-lie")
CONTACT = PenaltyContact(stiffness=1e5, damping=10.0)
TIMES = np.linspace(0.0, 0.1, 21)

MOVING = Start(beta=1.2, gamma=0.4, spin=20.0, beta_rate=2.0, gamma_rate=-5.0)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("coefficient", [0.0, 0.3])
def test_all_formulations_have_the_same_accelerations(load: Load, coefficient: float) -> None:
    friction = SmoothCoulomb(load=load, coefficient=coefficient)
    found = [
        mbs_models.acceleration(
            scene_of(1, name, contact=CONTACT, friction=friction, start=MOVING)
        )
        for name in FORMULATIONS
    ]
    for accelerations, force in found[1:]:
        np.testing.assert_allclose(accelerations, found[0][0], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(force, found[0][1], rtol=1e-9)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("load", LOADS)
def test_disk_in_the_air_feels_its_weight_alone(formulation: Any, load: Load) -> None:
    start = Start(spin=0.0, height=1e-3)
    scene = scene_of(
        1, formulation, contact=CONTACT, friction=SmoothCoulomb(load=load), start=start
    )
    accelerations, force = mbs_models.acceleration(scene)
    np.testing.assert_allclose(accelerations, [0, 0, -analysis.GRAVITY, 0, 0, 0], atol=1e-9)
    assert force[0] == 0.0


def test_disk_falls_freely_until_it_touches_the_table() -> None:
    start = Start(spin=0.0, gamma=np.pi / 2, height=0.05)
    times = np.linspace(0.0, 0.1, 11)
    scene = scene_of(contact=CONTACT, start=start)
    run = mbs_models.simulate(scene, times, step=1e-3)
    fallen = scene.scenario.initial_state.coordinates[2] - 0.5 * analysis.GRAVITY * times**2
    np.testing.assert_allclose(run.coordinate("z"), fallen, atol=1e-12)
    assert not np.any(run.normal_force)


def test_undamped_frictionless_bounce_keeps_the_energy() -> None:
    start = Start(spin=0.0, gamma=np.pi / 2, height=0.01)
    scene = scene_of(
        contact=PenaltyContact(stiffness=1e5),
        friction=SmoothCoulomb(coefficient=0.0),
        start=start,
    )
    run = mbs_models.simulate(scene, np.linspace(0.0, 0.3, 301), step=2e-5)
    kinetic, potential = analysis.energies(run.scenario, run.coordinates, run.rates)
    total = kinetic + potential + 0.5 * run.normal_force**2 / 1e5
    assert np.max(run.normal_force) > 10 * run.scenario.weight
    # A step across the touch-down is of lower order.
    np.testing.assert_allclose(total, total[0], rtol=2e-5)


@pytest.mark.parametrize("ratio", [0.05, 0.5])
def test_damping_ratio_is_that_of_the_upright_disk_on_its_spring(ratio: float) -> None:
    damped = PenaltyContact.damped(1e5, STEEL_DISK, ratio=ratio)
    # The centre of gravity above the contact point: the disk moves up and down alone.
    contact = replace(damped, bilateral=True)
    resting = Scenario(contact=contact, start=Start(spin=0.0, gamma=np.pi / 2)).initial_state
    x, y, z, *angles = resting.coordinates
    start = replace(resting, coordinates=(x, y, z + 1e-5, *angles))
    times = np.linspace(0.0, 0.02, 41)
    run = mbs_models.simulate(scene_of(contact=contact, start=start), times, step=1e-5)
    frequency = np.sqrt(1e5 / STEEL_DISK.mass)
    ringing = frequency * np.sqrt(1.0 - ratio**2)
    decay = np.exp(-ratio * frequency * times)
    shape = np.cos(ringing * times) + ratio * frequency / ringing * np.sin(ringing * times)
    np.testing.assert_allclose(run.coordinate("z") - z, 1e-5 * decay * shape, atol=1e-9)


def test_default_start_rests_in_the_table() -> None:
    disk, scenario = STEEL_DISK, Scenario(contact=CONTACT)
    start = scenario.initial_state
    depth = disk.radius * np.sin(start.coordinates[4]) - start.coordinates[2]
    assert CONTACT.stiffness * depth == pytest.approx(scenario.weight, rel=1e-9)


def test_disk_at_rest_stays_at_rest() -> None:
    start = Start(spin=0.0, gamma=np.pi / 2)
    for name in FORMULATIONS:
        scene = scene_of(1, name, contact=CONTACT, start=start)
        run = mbs_models.simulate(scene, TIMES, step=1e-3)
        np.testing.assert_allclose(run.coordinates, run.coordinates[:1].repeat(21, 0), atol=1e-12)
        np.testing.assert_allclose(run.normal_force, run.scenario.weight, rtol=1e-8)


def test_normal_force_is_what_accelerates_the_centre_of_gravity() -> None:
    scene = scene_of(contact=CONTACT, start=MOVING)
    step = 1e-4
    run = mbs_models.simulate(scene, [0.0, step, 2 * step], tolerance=1e-12)
    _, rotation = poses(run.coordinates)
    disk = run.scenario.disk
    height = run.coordinate("z") + disk.eccentricity * rotation[:, 2, 0]
    acceleration = (height[0] - 2 * height[1] + height[2]) / step**2
    expected = run.normal_force[1] / disk.mass - analysis.GRAVITY
    assert acceleration == pytest.approx(expected, abs=0.02)
    assert mass_matrix(run.scenario.disk, run.coordinates[1])[2, 2] == pytest.approx(
        run.scenario.disk.mass
    )


def test_bilateral_contact_pulls_and_the_unilateral_one_does_not() -> None:
    start = Start(spin=0.0, gamma=np.pi / 2, height=1e-5)
    for formulation in FORMULATIONS:
        for bilateral, expected in ((False, 0.0), (True, -1e5 * 1e-5)):
            scene = scene_of(
                1,
                formulation,
                contact=replace(CONTACT, bilateral=bilateral),
                friction=SmoothCoulomb(load="contact"),
                start=start,
            )
            accelerations, force = mbs_models.acceleration(scene)
            assert force[0] == pytest.approx(expected, rel=1e-9)
            lifting = expected / STEEL_DISK.mass - analysis.GRAVITY
            assert accelerations[2] == pytest.approx(lifting, rel=1e-9)


def test_disk_falling_onto_the_table_feels_no_damper_before_it_touches() -> None:
    start = Start(spin=0.0, gamma=np.pi / 2, height=1e-6).state(MODELS[1], STEEL_DISK)
    falling = replace(start, rates=(0.0, 0.0, -1.0, 0.0, 0.0, 0.0))
    for formulation in FORMULATIONS:
        scene = scene_of(1, formulation, contact=CONTACT, start=falling)
        assert mbs_models.acceleration(scene)[1][0] == 0.0


def test_rounded_rim_vanishes_with_the_second_power_of_its_thickness() -> None:
    def gamma(half_thickness: float) -> Any:
        contact = PenaltyContact.damped(1e5, STEEL_DISK, half_thickness=half_thickness)
        scene = scene_of(1, "floating-lie", contact=contact)
        run = mbs_models.simulate(scene, TIMES, step=1e-3)
        return run.coordinate("gamma")

    thin = gamma(0.0)
    errors = [np.max(np.abs(gamma(c) - thin)) for c in (2e-3, 1e-3)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("formulation", "constrained"),
    [("euler-tree", False), ("floating-lie", False), ("floating", True)],
)
def test_penalty_leaves_no_constraint_but_that_of_euler_parameters(
    formulation: Any, constrained: bool
) -> None:
    scene = scene_of(1, formulation, contact=CONTACT)
    assert scene.has_constraints is constrained
    if constrained:
        with pytest.raises(ValueError, match="cannot take the constraints"):
            mbs_models.simulate(scene, TIMES, step=1e-4, integrator="RK44")
    else:
        run = mbs_models.simulate(scene, TIMES, step=1e-4, integrator="RK44")
        implicit = mbs_models.simulate(scene, TIMES, step=1e-4, integrator="TrapezoidalIndex2")
        np.testing.assert_allclose(run.coordinates, implicit.coordinates, atol=1e-5)


def test_stiff_contact_is_taken_by_the_implicit_integrator_in_large_steps() -> None:
    truth = analysis.simulate(Scenario(), TIMES, tolerance=1e-9)
    for name in FORMULATIONS:
        scene = scene_of(1, name, contact=PenaltyContact.damped(1e9, STEEL_DISK))
        run = mbs_models.simulate(scene, TIMES, step=1e-3, integrator="TrapezoidalIndex2")
        assert np.max(np.abs(run.coordinates - truth.coordinates)[:, 4:]) < 1e-3


def test_uneven_times_go_on_where_the_stretch_before_ended() -> None:
    even = mbs_models.simulate(scene_of(contact=CONTACT), TIMES, tolerance=1e-9)
    uneven = mbs_models.simulate(
        scene_of(contact=CONTACT), TIMES[[0, 1, 2, 5, 20]], tolerance=1e-9
    )
    np.testing.assert_allclose(uneven.coordinates[-1], even.coordinates[-1], atol=1e-8)


def test_trajectory_says_which_contact_made_it() -> None:
    run = mbs_models.simulate(scene_of(contact=CONTACT), [0.0, 0.01], step=1e-3)
    assert run.scenario.contact == CONTACT


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"contact": PenaltyContact(stiffness=1e3)}, r"stiffness must be at least .* got 1000"),
        ({"contact": CONTACT, "level": 2}, "takes no further constraint, got Model 2"),
        ({"contact": CONTACT, "formulation": "contact-tree"}, "no room for a penalty contact"),
        (
            {"contact": PenaltyContact.rounded(STEEL_DISK), "formulation": "euler-tree"},
            "'euler-tree' is singular when the disk lies flat, .* half_thickness = 0.0002",
        ),
        (
            {"contact": PenaltyContact(stiffness=1e5, half_thickness=0.05)},
            "half_thickness must not exceed the radius of the disk = 0.045, got 0.05",
        ),
        (
            {"dissipation": Dissipation(pivoting=1e-5)},
            "dissipation acts on a penalty contact",
        ),
        (
            {
                "dissipation": Dissipation(pivoting=1e-5),
                "contact": CONTACT,
                "formulation": "euler-tree",
            },
            "knows no dissipation .* use one of floating-lie, floating",
        ),
    ],
)
def test_contact_that_fits_no_scene_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        scene_of(**arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"stiffness": 0.0}, "stiffness must be positive"),
        ({"stiffness": 1e5, "damping": -1.0}, "damping must not be negative"),
        ({"stiffness": np.nan}, "stiffness must be a finite number"),
        ({"stiffness": 1e5, "half_thickness": -1e-4}, "half_thickness must not be negative"),
    ],
)
def test_bad_contact_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        PenaltyContact(**arguments)
