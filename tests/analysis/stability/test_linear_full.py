"""The full linear system: structure, and agreement with the nonlinear paper."""

from math import pi

import numpy as np
import pytest

from analysis import (
    DISKS,
    MODELS,
    MOTIONS,
    STEEL_DISK,
    Disk,
    Motion,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Table,
)
from analysis.mechanics.recorded import accelerations
from analysis.stability.linear_full import full_system, without_drift
from tests.helpers import assert_close, random_disk

PAPER = Scenario()
SPINS = np.array([0.0, 1e-3, 5.0, 30.0, 60.0])


@pytest.mark.parametrize("motion", MOTIONS)
def test_mass_damping_and_stiffness_are_symmetric(motion: Motion) -> None:
    system = full_system(PAPER, SPINS, motion)
    for matrix in (system.mass, system.damping, system.stiffness):
        np.testing.assert_array_equal(matrix, np.swapaxes(matrix, 1, 2))


@pytest.mark.parametrize("motion", MOTIONS)
def test_gyroscopic_and_circulatory_matrices_are_skew(motion: Motion) -> None:
    system = full_system(PAPER, SPINS, motion)
    for matrix in (system.gyroscopic, system.circulatory):
        np.testing.assert_array_equal(matrix, -np.swapaxes(matrix, 1, 2))


def test_friction_takes_energy_and_never_brings_any() -> None:
    system = full_system(PAPER, 30.0)
    assert np.linalg.eigvalsh(system.damping).min() > -1e-12
    assert np.linalg.eigvalsh(system.mass).min() > 0.0


def test_stack_of_spins_gives_stacked_matrices() -> None:
    system = full_system(PAPER, SPINS)
    assert system.stiffness.shape == (5, 4, 4)
    assert system.state_matrices.shape == (5, 8, 8)


def test_without_friction_nothing_damps_and_nothing_circulates() -> None:
    system = full_system(Scenario(friction=SmoothCoulomb(coefficient=0.0)), SPINS)
    assert not np.any(system.damping)
    assert not np.any(system.circulatory)


def test_state_matrix_predicts_small_accelerations_of_the_nonlinear_model() -> None:
    spin, size = 30.0, 1e-9
    matrix = full_system(PAPER, spin).state_matrices[0]
    deviation = size * np.array([0.3, -0.2, 0.5, 0.9, 2.0, -1.0, 3.0, 1.0])
    x, y, beta, gamma, *rates = deviation.tolist()
    r = STEEL_DISK.radius
    z = (x, y, r * np.cos(beta), 0.0, pi / 2 + beta, pi / 2 + gamma)
    u = (rates[0], rates[1], -r * np.sin(beta) * rates[2], spin, rates[2], rates[3])
    found = accelerations(PAPER, z, u)[0][[0, 1, 4, 5]]
    assert_close(found, (matrix @ deviation)[4:], relative=1e-6)


@pytest.mark.parametrize("disk", [*DISKS.values(), random_disk(np.random.default_rng(7))])
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("gradient", [0.0, 0.1, 3.0, 1000.0])
def test_a_disk_spinning_elsewhere_circles_in_the_rotating_frame(
    disk: Disk, motion: Motion, gradient: float
) -> None:
    friction = SmoothCoulomb(coefficient=gradient, smoothing=1.0)
    matrix = full_system(Scenario(disk=disk, friction=friction), 7.0, motion).state_matrices[0]
    shifted_along_x = np.array([1.0, 0.0, 0.0, 0.0, 0.0, -7.0, 0.0, 0.0])
    shifted_along_y = np.array([0.0, 1.0, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0])
    tolerance = 1e-13 * np.max(np.abs(matrix))
    np.testing.assert_allclose(matrix @ shifted_along_x, -7 * shifted_along_y, atol=tolerance)
    np.testing.assert_allclose(matrix @ shifted_along_y, 7 * shifted_along_x, atol=tolerance)


def test_without_drift_leaves_the_six_other_eigenvalues() -> None:
    matrices = full_system(PAPER, SPINS).state_matrices
    six = np.linalg.eigvals(without_drift(SPINS, matrices)).astype(complex)
    with_pair = np.column_stack((six, 1j * SPINS, -1j * SPINS))
    for found, expected in zip(with_pair, np.linalg.eigvals(matrices), strict=True):
        np.testing.assert_allclose(np.sort(found.real), np.sort(expected.real), atol=1e-6)
        np.testing.assert_allclose(np.sort(found.imag), np.sort(expected.imag), atol=1e-6)


def test_a_table_that_is_not_homogeneous_is_refused() -> None:
    matrices = full_system(PAPER, SPINS).state_matrices
    matrices[:, 4, 0] += 50.0
    with pytest.raises(ArithmeticError, match="drift does not separate"):
        without_drift(SPINS, matrices)


def test_fast_eigenvalues_are_those_printed_for_the_tenth_smoothing() -> None:
    for smoothing, expected in ((0.1, (-156.418, -93.940)), (0.01, (-1584.48, -915.874))):
        matrix = full_system(
            Scenario(friction=SmoothCoulomb(smoothing=smoothing)), 30.0
        ).state_matrices
        slowest = np.sort(np.linalg.eigvals(matrix[0]).real)[:2]
        np.testing.assert_allclose(slowest, expected, rtol=1e-5)


@pytest.mark.parametrize(
    ("spins", "message"),
    [
        ([], "spins must be one-dimensional with at least 1 entry"),
        ([[1.0]], "spins must be one-dimensional"),
        ([1.0, np.nan], "spins must be finite numbers in rad/s, got nan"),
        (np.inf, "got inf"),
        ("fast", "must be an array of real numbers"),
    ],
)
def test_bad_spins_are_refused(spins: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        full_system(PAPER, spins)  # type: ignore[arg-type]


def test_unknown_motion_is_refused() -> None:
    with pytest.raises(ValueError, match="motion must be one of inverted, noninverted"):
        full_system(PAPER, 1.0, "upright")  # type: ignore[arg-type]


def test_scenario_of_another_model_table_or_contact_is_refused() -> None:
    with pytest.raises(ValueError, match="the full system is that of Model 1, got Model 4; the"):
        full_system(Scenario(constraints=MODELS[4]), 1.0)
    with pytest.raises(ValueError, match="full system needs a horizontal table, got an inclin"):
        full_system(Scenario(table=Table(inclination=0.1)), 1.0)
    with pytest.raises(ValueError, match="full system needs the ideal contact, got a Penalty"):
        full_system(Scenario(contact=PenaltyContact(stiffness=1e5)), 1.0)


def test_load_of_the_friction_has_no_influence() -> None:
    """The contact force is the weight up to the second order, Eq. (40)."""
    by_contact = Scenario(friction=SmoothCoulomb(load="contact"))
    np.testing.assert_array_equal(
        full_system(by_contact, SPINS).state_matrices, full_system(PAPER, SPINS).state_matrices
    )
