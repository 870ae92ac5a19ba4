"""Eigenvalues from the engine."""

from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import MODELS, MOTIONS, POSSIBLE_SETS, ConstraintSet, Motion, Scenario, SmoothCoulomb
from analysis.data.constraint_set import set_name
from analysis.stability import linear_reduced, spectra
from validation.studies.stability import eigenvalue_check
from validation.studies.stability.eigenvalue_check import Case, spinning

PAPER = Scenario()


def name(case: Any) -> str:
    return "-".join(map(str, case))


@pytest.mark.parametrize("case", eigenvalue_check.cases(), ids=name)
@pytest.mark.parametrize("motion", MOTIONS)
def test_engine_and_in_house_eigenvalues_agree(case: Case, motion: Motion) -> None:
    level, formulation = case
    worst = eigenvalue_check.worst_difference(
        Scenario(constraints=MODELS[level]), np.array([0.0, 17.0, 60.0]), formulation, motion
    )
    assert worst <= eigenvalue_check.EIGENVALUE_LIMIT


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_engine_and_in_house_eigenvalues_agree_under_every_set(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    worst = eigenvalue_check.worst_difference(
        scenario, np.array([0.0, 33.0]), "euler-tree", "inverted"
    )
    assert worst <= eigenvalue_check.EIGENVALUE_LIMIT


@pytest.mark.slow
@pytest.mark.parametrize("case", eigenvalue_check.cases(), ids=name)
def test_eigenvalues_agree_from_0_to_60(case: Case) -> None:
    assert eigenvalue_check.check_eigenvalues(case).passed


@pytest.mark.slow
@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_every_formulation_of_every_set_agrees(constraints: ConstraintSet) -> None:
    check = eigenvalue_check.check_set(constraints)
    assert check.passed
    (row,) = eigenvalue_check.sets_table([check]).rows
    assert row[0] == set_name(constraints)


def test_state_matrix_agrees_with_the_full_system_entry_by_entry() -> None:
    expected = spectra.state_matrices(PAPER, [33.0], "full")[0]
    np.testing.assert_allclose(
        mbs_models.state_matrix(spinning(PAPER, 33.0)),
        expected,
        atol=1e-6 * np.max(np.abs(expected)),
    )


def test_small_smoothing_does_not_spoil_the_derivatives() -> None:
    for constraints in MODELS.values():
        scenario = Scenario(constraints=constraints, friction=SmoothCoulomb(smoothing=1e-4))
        expected = spectra.eigenvalues(scenario, [25.0])[0]
        found = mbs_models.eigenvalues(spinning(scenario, 25.0))
        assert eigenvalue_check.distance(found, expected) < 1e-5


def test_stock_eigenvalues_are_right_without_constraints_and_wrong_with_them() -> None:
    right = spectra.eigenvalues(PAPER, [30.0])[0]
    free = mbs_models.stock_eigenvalues(spinning(PAPER, 30.0))
    assert eigenvalue_check.distance(free, right) < 1e-5
    constrained = mbs_models.stock_eigenvalues(spinning(PAPER, 30.0, formulation="euler-tree"))
    nearest = np.min(np.abs(constrained[:, None] - right), axis=0) / np.maximum(np.abs(right), 1)
    assert np.max(nearest) > 0.1


def test_engine_finds_the_closed_form_critical_speed() -> None:
    found = eigenvalue_check.engine_critical_spin(4, 30.0, 32.0, 7.1)
    assert found == pytest.approx(linear_reduced.critical_speed(PAPER).spin, rel=1e-7)


def test_unknown_motion_is_refused() -> None:
    with pytest.raises(ValueError, match="motion must be one of inverted, noninverted"):
        spinning(PAPER, 30.0, motion="upright")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="spin must be a finite number, got nan"):
        spinning(PAPER, float("nan"))
