"""Critical spins found by root finding: the paper's numbers, sides, limits."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.linalg import eigvals

from analysis import (
    CENTRED_DISK,
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    ConstraintSet,
    Level,
    Motion,
    Scenario,
    SmoothCoulomb,
    Table,
)
from analysis.data.body import Body
from analysis.data.checks import Array
from analysis.data.constraint_set import set_name
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Spectra, critical_speeds
from analysis.stability.printed import critical_speed, static_gradient
from analysis.stability.spectra import System, matrices_over_spin
from tests.helpers import not_none

PAPER = Scenario()
MILD = Scenario(friction=SmoothCoulomb(smoothing=0.2))
"""With this friction inverted spinning is stable somewhere in the full system."""


def model(level: Level, disk: Body = STEEL_DISK) -> Scenario:
    return replace(PAPER, constraints=MODELS[level], disk=disk)


@pytest.mark.parametrize(
    ("disk", "spins", "frequencies"),
    [
        (STEEL_DISK, [26.87362, 30.10488], [22.66749, 5.75203]),
        (ROUNDED_STEEL_DISK, [26.85987, 30.06306], [22.65552, 5.72167]),
    ],
    ids=["unrounded", "Table 1"],
)
def test_full_system_has_two_hopf_crossings_in_opposite_directions(
    disk: Body, spins: list[float], frequencies: list[float]
) -> None:
    found = critical_speeds(model(1, disk))
    np.testing.assert_allclose([c.spin for c in found.crossings], spins, atol=5e-6)
    np.testing.assert_allclose([c.frequency for c in found.hopf], frequencies, atol=5e-6)
    assert [crossing.stable_side for crossing in found.hopf] == ["below", "above"]
    assert (found.reason, found.stable) == (None, ())


def test_pairs_are_born_where_the_discriminant_vanishes() -> None:
    first, *others = critical_speeds(model(4), (0.0, 100.0)).pair_changes
    assert first.spin == pytest.approx(12.51344, abs=5e-6)
    assert first.complex_side == "above"
    for change in (first, *others):
        polynomial = np.poly(matrices_over_spin(model(4))(np.array([change.spin]))[0])
        scale = abs(change.value) + 1.0
        assert abs(np.polyval(polynomial, change.value)) < 1e-7 * scale**3
        assert abs(np.polyval(np.polyder(polynomial), change.value)) < 1e-7 * scale**2


@pytest.mark.parametrize(("level", "system"), [(4, "reduced"), (3, "numeric")], ids=str)
def test_reduced_crossing_is_that_of_the_closed_form(level: Level, system: System) -> None:
    closed = critical_speed(model(level))
    # Also where a spin that is looked at is the critical one.
    for low, high in ((0.0, 60.0), (closed.spin - 1.0, closed.spin + 1.0)):
        found = critical_speeds(model(level), (low, high), system)
        (crossing,) = found.crossings
        assert crossing.spin == pytest.approx(closed.spin, rel=1e-10)
        assert crossing.frequency == pytest.approx(closed.frequency, rel=1e-9)
        assert (crossing.kind, crossing.stable_side) == ("hopf", "above")
        assert found.stable == ((crossing.spin, high),)


@pytest.mark.parametrize(("gradient", "side"), [(3.0, "below"), (1e-3, "above")])
def test_static_crossings_lie_on_the_closed_static_curve_even_beside_a_collision(
    gradient: float, side: str
) -> None:
    scenario = with_gradient(PAPER, gradient)
    (crossing,) = (
        each for each in critical_speeds(scenario, (0.0, 100.0)).crossings if each.kind == "static"
    )
    assert (crossing.frequency, crossing.stable_side) == (0.0, side)
    assert static_gradient(scenario, crossing.spin)[0] == pytest.approx(gradient, rel=1e-8)


def test_a_pair_born_just_before_it_crosses_is_one_crossing() -> None:
    """Eigenvalues Omega - 1 +- i sqrt((Omega - 0.98) / 1000)."""

    def matrices(spins: Array) -> Array:
        matrix = np.tile(np.array(((0.0, 1.0), (0.0, 0.0))), (spins.size, 1, 1))
        matrix[:, 0, 0] = matrix[:, 1, 1] = spins - 1.0
        matrix[:, 1, 0] = -(spins - 0.98) / 1000.0
        return matrix

    (crossing,) = Spectra(matrices, np.arange(0.97, 1.2, 0.05)).crossings()
    assert (crossing.kind, crossing.stable_side) == ("hopf", "below")
    assert (crossing.spin, crossing.frequency) == pytest.approx((1.0, np.sqrt(2e-5)))


def pair_sums(matrix: Array) -> Array:
    """Matrix whose eigenvalues are the sums of every two eigenvalues of `matrix`."""
    size = len(matrix)
    pairs = list(combinations(range(size), 2))
    both = np.kron(matrix, np.eye(size)) + np.kron(np.eye(size), matrix)
    wedge = np.zeros((size * size, len(pairs)))
    for column, (i, j) in enumerate(pairs):
        wedge[i * size + j, column], wedge[j * size + i, column] = 1.0, -1.0
    result: Array = wedge.T @ both @ wedge / 2
    return result


def has_imaginary_pair(matrix: Array) -> bool:
    values = np.linalg.eigvals(matrix)
    return bool(np.any((np.abs(values.real) < 1e-5) & (values.imag > 1e-3)))


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("gradient", [0.5, 1.2, 3.0, 30.0])
def test_no_hopf_crossing_is_missed(motion: Motion, gradient: float) -> None:
    """All spins at which two eigenvalues sum to zero, from one polynomial eigenvalue problem."""
    scenario = with_gradient(PAPER, gradient)

    def matrices(*spins: float) -> Array:
        return matrices_over_spin(scenario, motion=motion)(np.array(spins))

    # The matrices are quadratic in the spin: S(Omega) = S_0 + Omega S_1 + Omega² S_2.
    less, constant, more = (pair_sums(matrix) for matrix in matrices(-30.0, 0.0, 30.0))
    linear, square = (more - less) / 2, (more + less) / 2 - constant
    one, zero = np.eye(15), np.zeros((15, 15))
    top, bottom = eigvals(
        np.block([[zero, one], [-constant, -linear]]),
        np.block([[one, zero], [zero, square]]),
        homogeneous_eigvals=True,
    )
    finite = np.abs(bottom) > 1e-12 * np.abs(top)
    spins = 30.0 * top[finite] / bottom[finite]
    real = np.sort(spins[np.abs(spins.imag) < 1e-6 * np.abs(spins)].real)
    inside = real[(real > 0.0) & (real < 60.0)].tolist()
    expected = [spin for spin in inside if has_imaginary_pair(matrices(spin)[0])]
    found = critical_speeds(scenario, (0.0, 60.0), motion=motion)
    np.testing.assert_allclose([crossing.spin for crossing in found.hopf], expected, rtol=1e-7)


@pytest.mark.parametrize("gradient", [3.0, 1e-3])
@pytest.mark.parametrize("level", [1, 2, 4])
def test_without_eccentricity_the_closed_form_speed_is_a_static_crossing(
    level: Level, gradient: float
) -> None:
    centred = with_gradient(model(level, CENTRED_DISK), gradient)
    (static,) = (each for each in critical_speeds(centred).crossings if each.kind == "static")
    assert static.stable_side == "above"
    assert static.spin == pytest.approx(critical_speed(centred).spin, rel=1e-10)


@pytest.mark.parametrize("system", ["reduced", "numeric"])
def test_eigenvalues_that_are_small_at_high_spin_alone_are_none_at_rest(system: System) -> None:
    weak = replace(model(4), table=Table(gravity=4e-6))
    assert critical_speeds(weak, system=system, motion="noninverted").crossings == ()


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_without_friction_nothing_crosses_nor_is_stable_and_the_result_says_why(
    constraints: ConstraintSet,
) -> None:
    frictionless = Scenario(constraints=constraints, friction=SmoothCoulomb(coefficient=0.0))
    found = critical_speeds(frictionless, (25.0, 35.0))
    assert (found.crossings, found.stable) == ((), ())
    assert "no friction" in not_none(found.reason)


def test_an_interval_without_crossing_says_so() -> None:
    found = critical_speeds(model(4), (0.0, 20.0))
    assert (found.crossings, found.where) == ((), "nowhere")
    assert found.reason == "no eigenvalue crosses the imaginary axis from 0 to 20 rad/s"


@pytest.mark.parametrize("level", [1, 2, 4])
@pytest.mark.parametrize("motion", ["inverted", "noninverted"])
def test_every_eigenvalue_decays_inside_and_one_grows_outside(
    level: Level, motion: Motion
) -> None:
    scenario = replace(MILD, constraints=MODELS[level])
    found = critical_speeds(scenario, (0.0, 50.0), motion=motion).stable
    for spin in np.linspace(0.3, 49.7, 20).tolist():
        values = matrices_over_spin(scenario, motion=motion)(np.array([spin]))[0]
        inside = any(low < spin < high for low, high in found)
        assert (np.max(np.linalg.eigvals(values).real) < 0.0) == inside


@pytest.mark.parametrize(
    ("interval", "message"),
    [
        ((10.0, 10.0), "interval must have 0 <= lowest < highest spin"),
        ((-5.0, 10.0), "interval must have 0 <= lowest < highest spin"),
        ((0.0, float("nan")), "interval must be a finite number, got nan"),
    ],
)
def test_bad_intervals_are_refused(interval: tuple[float, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        critical_speeds(PAPER, interval)
