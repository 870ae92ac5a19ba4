"""Integrators of the engine and their options."""

from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import Scenario, SmoothCoulomb, Trajectory
from mbs_models import EngineError, Integrator, Newton, Scene
from mbs_models.runs import run
from mbs_models.scene import build
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


def test_step_control_has_a_step_at_every_sample() -> None:
    truth = analysis.simulate(Scenario(), TIMES, local_tolerance=1e-13)
    result = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-12))
    # A sample taken one step of a millisecond late would be off by some 1e-2 rad.
    np.testing.assert_allclose(result.coordinates, truth.coordinates, atol=1e-10)
    np.testing.assert_array_equal(result.times, TIMES)


def test_uneven_samples_are_hit_by_step_control() -> None:
    times = np.array([0.0, 0.003, 0.1, 0.1001, 0.5])
    truth = analysis.simulate(Scenario(), times, local_tolerance=1e-13)
    result = mbs_models.simulate(Scene(), times, integrator=dopri5(1e-11))
    np.testing.assert_allclose(result.coordinates, truth.coordinates, atol=1e-8)


def test_step_limits_the_steps_of_step_control() -> None:
    free = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-4))
    held = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-4), step=1e-3)
    assert held.counts["steps"] >= 500 > free.counts["steps"]


def test_step_control_at_its_minimum_step_raises() -> None:
    with pytest.raises(EngineError, match="step control came down to its minimum step"):
        mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-40))


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


def test_full_newton_gives_the_same_motion_with_more_jacobians() -> None:
    modified, full = (
        mbs_models.simulate(
            scene_of(3),
            TIMES,
            step=5e-3,
            integrator=Integrator(name="TrapezoidalIndex2", newton=Newton(modified=flag)),
        )
        for flag in (True, False)
    )
    assert angle_error(modified, full) < 1e-9
    assert full.counts["jacobians"] > 2 * modified.counts["jacobians"]


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


def test_options_are_part_of_the_method() -> None:
    result = mbs_models.simulate(
        Scene(), TIMES, step=1e-2, integrator=Integrator(name="TrapezoidalIndex2")
    )
    assert result.method["newton_modified"] is True
    assert result.method["newton_relative"] == 1e-12
    controlled = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-6))
    assert controlled.method["local_tolerance"] == 1e-6


def test_run_tells_its_processor_time() -> None:
    samples = run(build(Scene()), Integrator(name="RK67"), spacing=0.01, intervals=50, substeps=4)
    assert 0.0 < samples.seconds < 10.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "RK99"}, "integrator must be one of RK44, RK67, DOPRI5"),
        ({"name": "RK44", "newton": Newton()}, "newton is no option of integrator 'RK44'"),
        ({"name": "RK44", "local_tolerance": 1e-3}, "local_tolerance is no option"),
        ({"name": "TrapezoidalIndex2", "spectral_radius": 0.9}, "spectral_radius is no option"),
        ({"name": "GeneralizedAlpha", "spectral_radius": 1.5}, r"in \[0, 1\], got 1.5"),
        ({"name": "GeneralizedAlpha", "spectral_radius": -0.1}, r"in \[0, 1\], got -0.1"),
        ({"name": "DOPRI5", "local_tolerance": 0.0}, "local_tolerance must be positive"),
    ],
)
def test_bad_integrator_options_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        Integrator(**arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("field", ["relative", "absolute"])
@pytest.mark.parametrize("value", [0.0, -1e-3, float("nan"), "tight"])
def test_bad_newton_tolerances_are_refused(field: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"{field} must be"):
        Newton(**{field: value})


def test_tolerance_of_extrapolation_is_refused_for_step_control() -> None:
    with pytest.raises(ValueError, match="tolerance must be left out for integrator 'DOPRI5'"):
        mbs_models.simulate(Scene(), TIMES, tolerance=1e-6, integrator="DOPRI5")


def test_step_control_is_refused_where_constraints_are_left() -> None:
    with pytest.raises(ValueError, match="explicit and cannot take the constraints"):
        mbs_models.simulate(scene_of(2), TIMES, integrator="DOPRI5")


def test_step_control_masters_stiff_friction() -> None:
    friction = SmoothCoulomb(smoothing=1e-3)
    times = np.linspace(0.0, 0.2, 11)
    truth = analysis.simulate(Scenario(friction=friction), times, local_tolerance=1e-12)
    result = mbs_models.simulate(scene_of(friction=friction), times, integrator=dopri5(1e-9))
    assert angle_error(result, truth) < 1e-6
