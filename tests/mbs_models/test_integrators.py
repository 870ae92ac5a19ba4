"""Integrators of the engine and their options."""

from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import Scenario, Trajectory
from mbs_models import Integrator, Newton, Scene
from tests.helpers import model
from tests.scenes import scene_of

TIMES = np.linspace(0.0, 0.5, 26)


def angle_error(one: Trajectory, other: Trajectory) -> float:
    return float(np.max(np.abs(one.coordinates - other.coordinates)[:, 4:6]))


def dopri5(tolerance: float) -> Integrator:
    return Integrator(name="DOPRI5", local_tolerance=tolerance)


def test_step_control_follows_its_tolerance() -> None:
    truth = analysis.simulate(Scenario(), TIMES, local_tolerance=1e-13)
    errors = [
        angle_error(mbs_models.simulate(Scene(), TIMES, integrator=dopri5(tolerance)), truth)
        for tolerance in (1e-6, 1e-9, 1e-12)
    ]
    assert errors[0] < 1e-4
    assert errors[1] < 1e-2 * errors[0]
    assert errors[2] < 1e-11


def test_step_limits_the_steps_of_step_control() -> None:
    free = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-4))
    held = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-4), step=1e-3)
    assert held.counts["steps"] >= 500 > free.counts["steps"]


def test_counts_of_explicit_runs_are_those_of_their_stages() -> None:
    counts = mbs_models.simulate(Scene(), TIMES, step=1e-2, integrator="RK44").counts
    assert counts["steps"] == 50
    assert counts["right_hand_sides"] == 4 * 50
    controlled = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-8)).counts
    tried = controlled["steps"] + controlled["rejected_steps"]
    assert controlled["right_hand_sides"] == 7 * tried


@pytest.mark.parametrize("formulation", ["euler-tree", "floating", "floating-lie"])
@pytest.mark.parametrize("radius", [0.6, 0.9])
def test_generalized_alpha_in_index_3_form_has_second_order(
    formulation: Any, radius: float
) -> None:
    truth = analysis.simulate(model(2), TIMES, local_tolerance=1e-13)
    integrator = Integrator(name="GeneralizedAlpha", spectral_radius=radius)
    scene = scene_of(2, formulation)
    errors = [
        angle_error(mbs_models.simulate(scene, TIMES, step=step, integrator=integrator), truth)
        for step in (2.5e-3, 1.25e-3)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.4)


def test_spectral_radius_changes_the_run_and_goes_with_it() -> None:
    runs = [
        mbs_models.simulate(
            scene_of(2),
            TIMES,
            step=5e-3,
            integrator=Integrator(name="GeneralizedAlpha", spectral_radius=radius),
        )
        for radius in (0.9, 0.6)
    ]
    assert angle_error(*runs) > 1e-6
    assert [result.method["spectral_radius"] for result in runs] == [0.9, 0.6]


def test_loose_newton_iteration_takes_fewer_iterations_and_leaves_an_error() -> None:
    tight, loose = (
        mbs_models.simulate(
            scene_of(1, "floating-lie"),
            TIMES,
            step=5e-3,
            integrator=Integrator(name="TrapezoidalIndex2", newton=newton),
        )
        for newton in (Newton(), Newton(relative=1e-4, absolute=1e-6))
    )
    assert loose.counts["newton_iterations"] < tight.counts["newton_iterations"]
    assert angle_error(tight, loose) > 1e-9
