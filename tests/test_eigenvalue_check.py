"""Eigenvalues from the engine."""

from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import STEEL_DISK, SmoothCoulomb
from analysis.stability import linear_reduced, spectra
from validation.studies.stability import eigenvalue_check
from validation.studies.stability.eigenvalue_check import Case


def name(case: Case) -> str:
    return "-".join(map(str, case))


@pytest.mark.parametrize("case", eigenvalue_check.cases(), ids=name)
@pytest.mark.parametrize("motion", mbs_models.MOTIONS)
def test_engine_and_in_house_eigenvalues_agree(case: Case, motion: Any) -> None:
    level, formulation = case
    spins = np.array([0.0, 17.0, 60.0])
    expected = spectra.eigenvalues(
        eigenvalue_check.SYSTEM_OF_LEVEL[level], STEEL_DISK, SmoothCoulomb(), spins, motion
    )
    matrices = eigenvalue_check.engine_matrices(
        level, spins, formulation=formulation, motion=motion
    )
    for matrix, right in zip(matrices, expected, strict=True):
        gap = eigenvalue_check.distance(np.linalg.eigvals(matrix).astype(complex), right)
        assert gap <= eigenvalue_check.EIGENVALUE_LIMIT


@pytest.mark.slow
@pytest.mark.parametrize("case", eigenvalue_check.cases(), ids=name)
def test_eigenvalues_agree_from_0_to_60(case: Case) -> None:
    assert eigenvalue_check.check_eigenvalues(case).passed


def test_state_matrix_agrees_with_the_full_system_entry_by_entry() -> None:
    scene = mbs_models.stationary_scene(1, 33.0)
    expected = spectra.state_matrices("full", STEEL_DISK, SmoothCoulomb(), [33.0])[0]
    np.testing.assert_allclose(
        mbs_models.state_matrix(scene), expected, atol=1e-6 * np.max(np.abs(expected))
    )


def test_small_smoothing_does_not_spoil_the_derivatives() -> None:
    friction = SmoothCoulomb(smoothing=1e-4)
    scene = mbs_models.stationary_scene(3, 25.0, friction=friction)
    expected = spectra.eigenvalues("reduced", STEEL_DISK, friction, [25.0])[0]
    assert eigenvalue_check.distance(mbs_models.eigenvalues(scene), expected) < 1e-5


def test_stock_eigenvalues_are_right_without_constraints_and_wrong_with_them() -> None:
    right = spectra.eigenvalues("full", STEEL_DISK, SmoothCoulomb(), [30.0])[0]
    free = mbs_models.stock_eigenvalues(mbs_models.stationary_scene(1, 30.0))
    assert eigenvalue_check.distance(free, right) < 1e-5
    scene = mbs_models.stationary_scene(1, 30.0, formulation="euler-tree")
    constrained = mbs_models.stock_eigenvalues(scene)
    nearest = np.min(np.abs(constrained[:, None] - right), axis=0) / np.maximum(np.abs(right), 1)
    assert np.max(nearest) > 0.1


def test_engine_finds_the_closed_form_critical_speed() -> None:
    found = eigenvalue_check.engine_critical_spin(4, 30.0, 32.0, 7.1)
    assert found == pytest.approx(linear_reduced.critical_speed(STEEL_DISK).spin, rel=1e-7)


def test_unknown_motion_is_refused() -> None:
    with pytest.raises(ValueError, match="motion must be one of inverted, noninverted"):
        mbs_models.stationary_scene(1, 30.0, motion="upright")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="spin must be a finite number, got nan"):
        mbs_models.stationary_scene(1, float("nan"))
