"""Critical spins found by root finding: the paper's numbers, sides, limits."""

from dataclasses import replace
from itertools import combinations
from typing import Any

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
from analysis.stability.critical import CriticalSpeeds, critical_speeds
from analysis.stability.printed import critical_speed
from analysis.stability.spectra import System, matrices_over_spin
from tests.helpers import not_none

PAPER = Scenario()
REDUCED = Scenario(constraints=MODELS[4])
MILD = Scenario(friction=SmoothCoulomb(smoothing=0.2))
"""With this friction inverted spinning is stable somewhere in the full system."""


def model(level: Level, disk: Body = STEEL_DISK) -> Scenario:
    return replace(PAPER, constraints=MODELS[level], disk=disk)


def spins_of(found: CriticalSpeeds) -> list[float]:
    return [crossing.spin for crossing in found.crossings]


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
    np.testing.assert_allclose(spins_of(found), spins, atol=5e-6)
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


@pytest.mark.parametrize(
    ("level", "system"), [(4, "reduced"), (3, "numeric"), (4, "numeric")], ids=str
)
@pytest.mark.parametrize("disk", [STEEL_DISK, ROUNDED_STEEL_DISK], ids=["unrounded", "Table 1"])
def test_reduced_crossing_is_that_of_the_closed_form(
    level: Level, system: System, disk: Body
) -> None:
    closed = critical_speed(model(level, disk))
    (crossing,) = critical_speeds(model(level, disk), system=system).crossings
    assert crossing.spin == pytest.approx(closed.spin, rel=1e-10)
    assert crossing.frequency == pytest.approx(closed.frequency, rel=1e-9)
    assert (crossing.kind, crossing.stable_side) == ("hopf", "above")
    assert critical_speeds(model(level, disk), system=system).stable == ((crossing.spin, 60.0),)


def test_a_crossing_at_a_spin_that_is_looked_at_is_found() -> None:
    closed = critical_speed(model(4)).spin
    (crossing,) = critical_speeds(model(4), (closed - 1.0, closed + 1.0)).crossings
    assert crossing.spin == pytest.approx(closed, rel=1e-10)


def test_inverted_spinning_falls_over_statically_at_very_high_spin() -> None:
    found = critical_speeds(model(1), (60.0, 100.0))
    (crossing,) = found.crossings
    assert crossing.spin == pytest.approx(73.87631, abs=5e-6)
    assert (crossing.kind, crossing.frequency, crossing.stable_side) == ("static", 0.0, "below")


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


def test_without_eccentricity_the_closed_form_speed_is_a_static_crossing() -> None:
    levels: tuple[Level, ...] = (1, 2, 4)
    for level in levels:
        found = critical_speeds(model(level, CENTRED_DISK))
        static = [crossing for crossing in found.crossings if crossing.kind == "static"]
        assert [crossing.stable_side for crossing in static] == ["above"]
        assert static[0].spin == pytest.approx(
            critical_speed(model(1, CENTRED_DISK)).spin, rel=1e-10
        )


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


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_a_round_disk_has_no_event_out_of_rounding(constraints: ConstraintSet) -> None:
    found = critical_speeds(
        replace(PAPER, constraints=constraints, disk=CENTRED_DISK), (0.0, 30.0)
    )
    assert len(found.crossings) + len(found.pair_changes) <= 3


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
    ("scenario", "interval", "options", "message"),
    [
        (PAPER, (10.0, 10.0), {}, "interval must have 0 <= lowest < highest spin"),
        (PAPER, (-5.0, 10.0), {}, "interval must have 0 <= lowest < highest spin"),
        (PAPER, (0.0, float("nan")), {}, "interval must be a finite number, got nan"),
        (PAPER, (0.0, 9.0), {"system": "model0"}, "system must be one of full, reduced"),
        (PAPER, (0.0, 9.0), {"motion": "flat"}, "motion must be one of inverted, noninverted"),
        (model(3), (0.0, 9.0), {"system": "full"}, "full system is that of Model 1, got Model 3"),
        (model(1), (0.0, 9.0), {"system": "reduced"}, "that of Model 4, got Model 1"),
        (replace(PAPER, table=Table(inclination=0.1)), (0.0, 9.0), {}, "needs a horizontal table"),
    ],
)
def test_bad_calls_are_refused(
    scenario: Scenario, interval: tuple[float, float], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        critical_speeds(scenario, interval, **options)
