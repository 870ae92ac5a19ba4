"""Runs that step the engine's own accelerations, against others of either side."""

from math import radians
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    LEVELS,
    POSSIBLE_SETS,
    STEEL_DISK,
    ConstraintSet,
    Level,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    Trajectory,
)
from analysis.data.constraint_set import set_name
from mbs_models import Integrator, Scene
from mbs_models.friction import slip_velocity
from mbs_models.integrators import ACCELERATED
from tests.helpers import model, mostly_slow, not_none, slip
from tests.scenes import scene_of

TIMES = np.linspace(0.0, 0.2, 21)
SLOPE = Table(inclination=radians(2.0), downhill=0.7)
TREES = ["contact-tree", "euler-tree"]


def angle_error(run: Trajectory, other: Trajectory) -> float:
    return float(np.max(np.abs(run.coordinates - other.coordinates)[:, 4:6]))


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_formulations_follow_the_in_house_motion_on_a_slope(
    constraints: ConstraintSet,
) -> None:
    scenario = Scenario(constraints=constraints, table=SLOPE, start=Start(spin=20.0, beta=1.3))
    truth = analysis.simulate(scenario, TIMES, local_tolerance=1e-13)
    for formulation in mbs_models.formulations(scenario):
        run = mbs_models.simulate(
            Scene(scenario, formulation), TIMES, tolerance=1e-7, integrator="DOP853"
        )
        np.testing.assert_allclose(run.coordinates, truth.coordinates, atol=1e-7)
        np.testing.assert_allclose(run.rates, truth.rates, atol=1e-5)
        np.testing.assert_allclose(run.multipliers, truth.multipliers, atol=1e-5)


def test_slip_is_the_velocity_of_the_disk_where_it_touches_the_table() -> None:
    place, rates = np.random.default_rng(3).uniform(0.2, 1.4, size=(2, 6))
    found = slip_velocity(STEEL_DISK.radius, place, rates)
    np.testing.assert_allclose(found, slip(STEEL_DISK, lambda t: place + t * rates), rtol=1e-8)


@pytest.mark.parametrize("level", [2, 3, 4])
def test_to_a_tolerance_they_are_the_default_where_constraints_are_left(level: Level) -> None:
    run = mbs_models.simulate(scene_of(level), TIMES, tolerance=1e-6)
    assert run.method["integrator"] == "DOP853"
    assert run.method["tolerance"] == 1e-6
    with_step = mbs_models.simulate(scene_of(level), TIMES, step=5e-3)
    assert with_step.method["integrator"] == "TrapezoidalIndex2"


@pytest.mark.parametrize("smoothing", mostly_slow([1e-4, 1e-6, 1e-8], [1e-4, 1e-6]))
@pytest.mark.parametrize("level", mostly_slow(LEVELS, [1, 2]))
def test_stiff_friction_keeps_its_tolerance_in_few_steps(level: Level, smoothing: float) -> None:
    scenario = model(level, friction=SmoothCoulomb(smoothing=smoothing))
    truth = analysis.simulate(scenario, TIMES, method="Radau", tolerance=1e-8)
    run = mbs_models.simulate(Scene(scenario), TIMES, tolerance=1e-6)
    assert run.method["integrator"] == "Radau"
    assert angle_error(run, truth) <= not_none(run.error_estimate) + 1e-8 <= 1.01e-6
    assert run.counts["steps"] < 4000


def test_impacts_keep_their_tolerance_where_fixed_steps_lose_their_order() -> None:
    contact = PenaltyContact.damped(1e5, Scenario().disk)
    scenario = Scenario(
        friction=SmoothCoulomb(load="contact"), contact=contact, start=Start(height=5e-3)
    )
    times = np.linspace(0.0, 0.1, 11)
    truth = analysis.simulate(scenario, times, local_tolerance=1e-11)
    run = mbs_models.simulate(Scene(scenario), times, tolerance=1e-6)
    assert angle_error(run, truth) <= 1e-6
    assert run.counts["steps"] < 1000


@pytest.mark.parametrize("name", ACCELERATED)
@pytest.mark.parametrize("formulation", TREES)
def test_a_local_tolerance_makes_a_single_run(name: Any, formulation: Any) -> None:
    truth = analysis.simulate(Scenario(), TIMES, local_tolerance=1e-13)
    coarse, fine = (
        mbs_models.simulate(
            Scene(Scenario(), formulation),
            TIMES,
            integrator=Integrator(name=name, local_tolerance=local),
        )
        for local in (1e-4, 1e-8)
    )
    assert fine.error_estimate is None
    assert fine.method["local_tolerance"] == 1e-8
    assert angle_error(fine, truth) < min(1e-5, angle_error(coarse, truth))
