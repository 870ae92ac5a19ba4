"""The full linear system: structure, and agreement with the nonlinear equations."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from analysis import DISKS, ROUNDED_STEEL_DISK, STEEL_DISK, Disk, Level, Load, SmoothCoulomb
from analysis.data.checks import Array
from analysis.models import index1
from analysis.stability.linear_full import MOTIONS, Motion, full_system, without_drift
from analysis.stability.linear_models import MODEL_STATES, model_matrices
from analysis.stability.linear_reduced import reduced_matrices
from tests.helpers import assert_close, random_disk

FRICTION = SmoothCoulomb()
SPINS = np.array([0.0, 1e-3, 5.0, 30.0, 60.0])


def relative(found: Array, expected: Array) -> float:
    """Largest error of a stack of matrices, relative to each matrix' largest entry."""
    scale = np.max(np.abs(expected), axis=(1, 2), keepdims=True)
    return float(np.max(np.abs(found - expected) / scale))


@pytest.mark.parametrize("motion", MOTIONS)
def test_mass_damping_and_stiffness_are_symmetric(motion: Motion) -> None:
    system = full_system(STEEL_DISK, FRICTION, SPINS, motion)
    for matrix in (system.mass, system.damping, system.stiffness):
        np.testing.assert_array_equal(matrix, np.swapaxes(matrix, 1, 2))


@pytest.mark.parametrize("motion", MOTIONS)
def test_gyroscopic_and_circulatory_matrices_are_skew(motion: Motion) -> None:
    system = full_system(STEEL_DISK, FRICTION, SPINS, motion)
    for matrix in (system.gyroscopic, system.circulatory):
        np.testing.assert_array_equal(matrix, -np.swapaxes(matrix, 1, 2))


def test_friction_takes_energy_and_never_brings_any() -> None:
    system = full_system(STEEL_DISK, FRICTION, 30.0)
    assert np.linalg.eigvalsh(system.damping).min() > -1e-12
    assert np.linalg.eigvalsh(system.mass).min() > 0.0


def test_stack_of_spins_gives_stacked_matrices() -> None:
    system = full_system(STEEL_DISK, FRICTION, SPINS)
    assert system.stiffness.shape == (5, 4, 4)
    assert system.state_matrices.shape == (5, 8, 8)


def test_without_friction_nothing_damps_and_nothing_circulates() -> None:
    system = full_system(STEEL_DISK, replace(FRICTION, coefficient=0.0), SPINS)
    assert not np.any(system.damping)
    assert not np.any(system.circulatory)


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("load", ["weight", "contact"])
@pytest.mark.parametrize(("mu", "epsilon"), [(0.3, 0.1), (0.3, 0.01), (0.3, 1e-3), (0.0, 0.1)])
def test_state_matrices_linearise_the_nonlinear_equations(
    motion: Motion, load: Load, mu: float, epsilon: float
) -> None:
    friction = SmoothCoulomb(coefficient=mu, smoothing=epsilon, load=load)
    expected = full_system(STEEL_DISK, friction, SPINS, motion).state_matrices
    found = model_matrices(1, STEEL_DISK, friction, SPINS, motion)
    assert relative(found, expected) < 1e-8


@pytest.mark.parametrize("motion", MOTIONS)
def test_linearisation_holds_for_any_disk(motion: Motion) -> None:
    disks = [random_disk(np.random.default_rng(seed)) for seed in range(4)]
    for disk in (ROUNDED_STEEL_DISK, replace(STEEL_DISK, eccentricity=0.0), *disks):
        expected = full_system(disk, FRICTION, SPINS, motion).state_matrices
        assert relative(model_matrices(1, disk, FRICTION, SPINS, motion), expected) < 1e-9


def test_state_matrix_predicts_small_accelerations_of_the_nonlinear_model() -> None:
    spin, size = 30.0, 1e-9
    matrix = full_system(STEEL_DISK, FRICTION, spin).state_matrices[0]
    deviation = size * np.array([0.3, -0.2, 0.5, 0.9, 2.0, -1.0, 3.0, 1.0])
    x, y, beta, gamma, *rates = deviation.tolist()
    r = STEEL_DISK.radius
    z = (x, y, r * np.cos(beta), 0.0, pi / 2 + beta, pi / 2 + gamma)
    u = (rates[0], rates[1], -r * np.sin(beta) * rates[2], spin, rates[2], rates[3])
    found = index1.accelerations(1, STEEL_DISK, FRICTION, z, u)[0][[0, 1, 4, 5]]
    assert_close(found, (matrix @ deviation)[4:], relative=1e-6)


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("level", [3, 4])
def test_models_3_and_4_linearise_to_the_reduced_system(level: Level, motion: Motion) -> None:
    expected = reduced_matrices(STEEL_DISK, FRICTION, SPINS, motion)
    assert relative(model_matrices(level, STEEL_DISK, FRICTION, SPINS, motion), expected) < 1e-9


def test_model_2_keeps_the_free_rate_of_gamma() -> None:
    matrices = model_matrices(2, STEEL_DISK, FRICTION, SPINS)
    assert matrices.shape == (5, 4, 4)
    assert MODEL_STATES[2] == ("beta", "gamma", "beta_rate", "gamma_rate")
    np.testing.assert_allclose(matrices[:, :2], np.eye(4)[None, 2:].repeat(5, axis=0), atol=1e-9)


@pytest.mark.parametrize("disk", [*DISKS.values(), random_disk(np.random.default_rng(7))])
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("gradient", [0.0, 0.1, 3.0, 1000.0])
def test_a_disk_spinning_elsewhere_circles_in_the_rotating_frame(
    disk: Disk, motion: Motion, gradient: float
) -> None:
    friction = SmoothCoulomb(coefficient=gradient, smoothing=1.0)
    matrix = full_system(disk, friction, 7.0, motion).state_matrices[0]
    shifted_along_x = np.array([1.0, 0.0, 0.0, 0.0, 0.0, -7.0, 0.0, 0.0])
    shifted_along_y = np.array([0.0, 1.0, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0])
    tolerance = 1e-13 * np.max(np.abs(matrix))
    np.testing.assert_allclose(matrix @ shifted_along_x, -7 * shifted_along_y, atol=tolerance)
    np.testing.assert_allclose(matrix @ shifted_along_y, 7 * shifted_along_x, atol=tolerance)


def test_without_drift_leaves_the_six_other_eigenvalues() -> None:
    matrices = full_system(STEEL_DISK, FRICTION, SPINS).state_matrices
    six = np.linalg.eigvals(without_drift(SPINS, matrices)).astype(complex)
    with_pair = np.column_stack((six, 1j * SPINS, -1j * SPINS))
    for found, expected in zip(with_pair, np.linalg.eigvals(matrices), strict=True):
        np.testing.assert_allclose(np.sort(found.real), np.sort(expected.real), atol=1e-6)
        np.testing.assert_allclose(np.sort(found.imag), np.sort(expected.imag), atol=1e-6)


def test_a_table_that_is_not_homogeneous_is_refused() -> None:
    matrices = full_system(STEEL_DISK, FRICTION, SPINS).state_matrices
    matrices[:, 4, 0] += 50.0
    with pytest.raises(ArithmeticError, match="drift does not separate"):
        without_drift(SPINS, matrices)


def test_fast_eigenvalues_are_those_printed_for_the_tenth_smoothing() -> None:
    for smoothing, expected in ((0.1, (-156.418, -93.940)), (0.01, (-1584.48, -915.874))):
        matrix = full_system(STEEL_DISK, SmoothCoulomb(smoothing=smoothing), 30.0).state_matrices
        slowest = np.sort(np.linalg.eigvals(matrix[0]).real)[:2]
        np.testing.assert_allclose(slowest, expected, rtol=1e-5)


@pytest.mark.parametrize(
    ("spins", "message"),
    [
        ([], "spins must be one-dimensional with at least 1 entry"),
        ([[1.0]], "spins must be one-dimensional"),
        ([1.0, np.nan], "spins must be finite numbers in rad/s, got nan"),
        (np.inf, "got inf"),
        ("fast", "got 'fast'"),
    ],
)
def test_bad_spins_are_refused(spins: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        full_system(STEEL_DISK, FRICTION, spins)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=message):
        model_matrices(1, STEEL_DISK, FRICTION, spins)  # type: ignore[arg-type]


def test_unknown_motion_and_level_are_refused() -> None:
    with pytest.raises(ValueError, match="motion must be one of inverted, noninverted"):
        full_system(STEEL_DISK, FRICTION, 1.0, "upright")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="motion must be one of"):
        model_matrices(2, STEEL_DISK, FRICTION, 1.0, "upright")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="level must be one of"):
        model_matrices(5, STEEL_DISK, FRICTION, 1.0)  # type: ignore[arg-type]
