"""The reduced linear system, its closed forms and the paper's numbers."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import (
    GRAVITY,
    MODELS,
    MOTIONS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Motion,
    Scenario,
    SmoothCoulomb,
    Table,
)
from analysis.mechanics import reduced
from analysis.stability.linear_reduced import closed_form, critical_speed, reduced_matrices

PAPER = Scenario(constraints=MODELS[4])
FRICTION = SmoothCoulomb()
HALF_TURN = np.pi / 2


@pytest.mark.parametrize(
    ("disk", "spin", "frequency", "limit"),
    [(STEEL_DISK, 30.9168, 7.0928, -129.0392), (ROUNDED_STEEL_DISK, 30.8866, 7.0859, -128.7875)],
    ids=["unrounded", "Table 1"],
)
def test_closed_form_gives_the_paper_numbers(
    disk: Disk, spin: float, frequency: float, limit: float
) -> None:
    critical = critical_speed(replace(PAPER, disk=disk))
    assert critical.kind == "hopf"
    assert critical.spin == pytest.approx(spin, abs=5e-5)
    assert critical.frequency == pytest.approx(frequency, abs=5e-5)
    assert closed_form(replace(PAPER, disk=disk), 30.0).a == pytest.approx(limit, abs=5e-5)


def test_unrounded_disk_reproduces_the_printed_digits() -> None:
    assert f"{critical_speed(PAPER).spin:.2f}" == "30.92"
    assert f"{closed_form(PAPER, 1.0).a:.2f}" == "-129.04"


def test_whole_matrix_and_eigenvalues_at_the_critical_speed() -> None:
    critical = critical_speed(PAPER)
    m, r, e = STEEL_DISK.mass, STEEL_DISK.radius, STEEL_DISK.eccentricity
    B_bar = STEEL_DISK.inertia_y - m * e**2
    d = FRICTION.coefficient * m * GRAVITY / FRICTION.smoothing
    Omega = critical.spin
    expected = np.array(
        [
            [0.0, 0.0, 1.0],
            [Omega, 0.0, 0.0],
            [
                m * GRAVITY * (r + e) / B_bar - Omega**2,
                -d * e * (r + e) * Omega / B_bar,
                -d * (r + e) ** 2 / B_bar,
            ],
        ]
    )
    matrix = reduced_matrices(PAPER, Omega)[0]
    np.testing.assert_allclose(matrix, expected, rtol=1e-13)
    values = np.sort_complex(np.linalg.eigvals(matrix))
    np.testing.assert_allclose(
        values,
        [matrix[2, 2], -1j * critical.frequency, 1j * critical.frequency],
        rtol=1e-10,
        atol=1e-11,
    )


@pytest.mark.parametrize("motion", MOTIONS)
def test_matrix_linearises_the_reduced_equations(motion: Motion) -> None:
    spin = 25.0
    gamma = HALF_TURN if motion == "inverted" else -HALF_TURN
    scenario = replace(PAPER, friction=SmoothCoulomb(coefficient=3e6, smoothing=1e6))
    columns = []
    for column in range(3):
        step = 1e-5 * np.eye(3)[column]
        place, rates = np.array([HALF_TURN, gamma, 0.0]), reduced.right_hand_side(scenario, spin)
        ahead, behind = (np.array(rates(0.0, place + sign * step)) for sign in (1.0, -1.0))
        columns.append((ahead - behind) / 2e-5)
    expected = reduced_matrices(scenario, spin, motion)[0]
    np.testing.assert_allclose(np.column_stack(columns), expected, rtol=1e-7, atol=1e-6)


@pytest.mark.parametrize("coefficient", [1e-3, 0.3, 50.0])
@pytest.mark.parametrize("smoothing", [1e-3, 0.1, 10.0])
def test_critical_speed_depends_on_neither_friction_parameter(
    coefficient: float, smoothing: float
) -> None:
    friction = SmoothCoulomb(coefficient=coefficient, smoothing=smoothing)
    critical = critical_speed(PAPER)
    values = np.linalg.eigvals(
        reduced_matrices(replace(PAPER, friction=friction), critical.spin)[0]
    )
    nearest = values[np.argmin(np.abs(values - 1j * critical.frequency))]
    tolerance = 1e-12 * np.max(np.abs(values)) + 1e-11
    assert abs(nearest - 1j * critical.frequency) < tolerance


def test_closed_form_converges_with_the_smoothing() -> None:
    errors = []
    for smoothing in (1e-2, 1e-3, 1e-4):
        friction = SmoothCoulomb(smoothing=smoothing)
        values = np.linalg.eigvals(reduced_matrices(replace(PAPER, friction=friction), 40.0)[0])
        approximate = closed_form(replace(PAPER, friction=friction), 40.0).eigenvalues[0]
        errors.append([np.min(np.abs(values - value)) for value in approximate])
    rates = np.log10(np.array(errors)[:-1] / np.array(errors)[1:])
    # lambda_1,2 are off by O(epsilon²), lambda_3 by O(epsilon), as Eq. (122) says
    assert np.all(rates[:, 2] == pytest.approx(1.0, abs=0.05))
    assert np.all(rates[:, :2] > 0.95)


def test_factors_of_the_closed_form_multiply_to_the_polynomial_in_the_limit() -> None:
    friction = SmoothCoulomb(smoothing=1e-6)
    matrix = reduced_matrices(replace(PAPER, friction=friction), 35.0)[0]
    form = closed_form(replace(PAPER, friction=friction), 35.0)
    assert form.a * form.c[0] == pytest.approx(matrix[2, 1] * 35.0, rel=1e-12)
    assert form.a * form.b[0] - form.c[0] == pytest.approx(matrix[2, 0], rel=1e-12)
    assert form.a - form.b[0] == pytest.approx(matrix[2, 2], rel=1e-9)


def test_noninverted_spinning_is_a_saddle_at_every_spin() -> None:
    spins = np.linspace(0.5, 60.0, 120)
    values = np.linalg.eigvals(reduced_matrices(PAPER, spins, "noninverted"))
    assert np.all(np.sum(values.real > 0.0, axis=1) == 1)
    form = closed_form(PAPER, spins, "noninverted")
    assert np.all(form.c < 0.0)
    assert np.all(form.eigenvalues[:, 0].real * form.eigenvalues[:, 1].real < 0.0)


def test_noninverted_closed_form_marks_a_neutral_saddle_without_frequency() -> None:
    critical = critical_speed(PAPER, "noninverted")
    assert critical.kind == "saddle"
    assert critical.frequency == 0.0
    assert critical.spin == pytest.approx(27.6624, abs=5e-5)
    values = np.linalg.eigvals(reduced_matrices(PAPER, critical.spin, "noninverted")[0])
    assert np.all(values.imag == 0.0)
    assert np.max(values.real) + np.sort(values.real)[1] == pytest.approx(0.0, abs=1e-10)


def test_without_eccentricity_the_critical_speed_is_finite_and_static() -> None:
    disk = replace(STEEL_DISK, eccentricity=0.0)
    for motion in MOTIONS:
        critical = critical_speed(replace(PAPER, disk=disk), motion)
        assert critical.kind == "static"
        assert critical.frequency == 0.0
        assert critical.spin == pytest.approx(
            np.sqrt(disk.radius * disk.mass * GRAVITY / disk.inertia_y), rel=1e-14
        )
    values = np.linalg.eigvals(reduced_matrices(replace(PAPER, disk=disk), critical.spin)[0])
    assert np.min(np.abs(values)) == 0.0
    assert np.sort(np.abs(values))[1] < 1e-12


def test_closed_form_takes_many_spins_at_once() -> None:
    form = closed_form(PAPER, np.linspace(0.0, 50.0, 11))
    assert form.eigenvalues.shape == (11, 3)
    np.testing.assert_array_equal(form.eigenvalues[:, 2], form.a)


def test_closed_form_without_friction_is_refused() -> None:
    with pytest.raises(
        ValueError, match="friction must have a positive gradient for the closed form, got 0"
    ):
        closed_form(replace(PAPER, friction=SmoothCoulomb(coefficient=0.0)), 1.0)


def test_bad_spins_and_motions_are_refused() -> None:
    with pytest.raises(ValueError, match="spins must be finite"):
        reduced_matrices(PAPER, [1.0, np.inf])
    with pytest.raises(ValueError, match="at least 1 entry"):
        closed_form(PAPER, [])
    with pytest.raises(ValueError, match="motion must be one of inverted, noninverted"):
        critical_speed(PAPER, "upright")  # type: ignore[arg-type]


def test_scenario_of_another_model_is_refused_by_the_matrices_and_not_by_the_closed_forms() -> (
    None
):
    full = replace(PAPER, constraints=MODELS[1])
    with pytest.raises(
        ValueError, match="the reduced system is that of Model 4, got Model 1; the"
    ):
        reduced_matrices(full, 1.0)
    assert critical_speed(full) == critical_speed(PAPER)
    assert closed_form(full, [20.0, 30.0]).a == closed_form(PAPER, [20.0, 30.0]).a


def test_leaning_table_is_refused() -> None:
    leaning = replace(PAPER, table=Table(inclination=0.1))
    with pytest.raises(ValueError, match="the reduced system needs a horizontal table"):
        reduced_matrices(leaning, 1.0)
    for function in (critical_speed, lambda scenario: closed_form(scenario, 1.0)):
        with pytest.raises(ValueError, match="the closed form needs a horizontal table"):
            function(leaning)


def test_critical_speed_grows_with_the_root_of_gravity() -> None:
    there = replace(PAPER, table=Table(gravity=4 * GRAVITY))
    assert critical_speed(there).spin == pytest.approx(2 * critical_speed(PAPER).spin, rel=1e-14)
    assert closed_form(there, 1.0).a == pytest.approx(4 * closed_form(PAPER, 1.0).a, rel=1e-14)
