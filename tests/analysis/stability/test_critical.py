"""Critical spins found by root finding: the paper's numbers, sides, limits."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import (
    CENTRED_DISK,
    GRAVITY,
    LEVELS,
    MOTIONS,
    POSSIBLE_SETS,
    STEEL_DISK,
    ConstraintSet,
    Disk,
    Level,
    LubricatedCoulomb,
    Motion,
    Scenario,
    SmoothCoulomb,
    Table,
)
from analysis.mechanics.paper import critical_speed
from analysis.problem.checks import Array
from analysis.stability.chart import with_gradient
from analysis.stability.critical import Spectra, critical_speeds
from analysis.stability.spectra import System, matrices_over_spin
from tests.bodies import of_six
from tests.helpers import ROLLING, model, not_none


@pytest.mark.parametrize(
    ("smoothing", "spin"), [(0.1, 12.51344), (1e-4, 0.01529438), (1e-5, 0.001529438)]
)
def test_pairs_are_born_where_the_discriminant_vanishes(smoothing: float, spin: float) -> None:
    scenario = model(4, friction=SmoothCoulomb(smoothing=smoothing))
    first, *others = critical_speeds(scenario, (0.0, 100.0)).pair_changes
    # In rational numbers; steep friction hides how narrow the pair is.
    assert first.spin == pytest.approx(spin, rel=4e-7)
    assert first.complex_side == "above"
    for change in (first, *others):
        polynomial = np.poly(matrices_over_spin(scenario)(np.array([change.spin]))[0])
        scale = abs(change.value) + 1.0
        assert abs(np.polyval(polynomial, change.value)) < 1e-7 * scale**3
        assert abs(np.polyval(np.polyder(polynomial), change.value)) < 1e-7 * scale**2


def test_a_body_without_a_plane_of_symmetry_that_rolls_has_critical_spins_without_friction() -> (
    None
):
    body = of_six(0.045, 0.4, 0.027, 4.61e-4, 5.29e-4, 5.27e-4, inertia_yz=6.6e-5)
    scenario = Scenario(disk=body, constraints=ROLLING)
    found = critical_speeds(scenario, motion="noninverted")
    (crossing,) = found.crossings
    # By the spectrum of independent equations, bisected.
    assert (crossing.kind, crossing.stable_side) == ("static", "above")
    assert crossing.spin == pytest.approx(28.3177, abs=3e-3)
    assert found.stable == ((crossing.spin, 60.0),)
    # The other sense is that of the mirror image.
    mirrored = replace(scenario, disk=replace(body, inertia_yz=-6.6e-5))
    other = critical_speeds(mirrored, (-60.0, 0.0), motion="noninverted")
    assert [each.spin for each in other.crossings] == pytest.approx([-crossing.spin], rel=1e-9)
    symmetric = replace(scenario, disk=replace(body, inertia_yz=0.0))
    assert "mirrored at both axes" in not_none(critical_speeds(symmetric).reason)


@pytest.mark.parametrize(
    ("disk", "level", "system", "gradient"),
    [
        *((STEEL_DISK, 4, "reduced", gradient) for gradient in (1e-4, 3.0, 5e4)),
        *((STEEL_DISK, 3, "numeric", gradient) for gradient in (1e-4, 3.0, 5e4)),
        # A round disk spins at any gamma: one eigenvalue is always zero.
        *((CENTRED_DISK, *case) for case in ((1, None, 3.0), (2, None, 1e-3), (4, None, 3.0))),
        *((replace(STEEL_DISK, eccentricity=1e-9), level, None, 1e-3) for level in (3, 4)),
    ],
)
def test_crossing_is_that_of_the_closed_form_with_any_friction(
    disk: Disk, level: Level, system: System | None, gradient: float
) -> None:
    scenario = with_gradient(model(level, disk=disk), gradient)
    closed = critical_speed(scenario)
    assert closed.kind == ("hopf" if disk.eccentricity else "static")
    # Also where a spin that is looked at is the critical one.
    for low, high in ((0.0, 60.0), (closed.spin - 1.0, closed.spin + 1.0)):
        found = critical_speeds(scenario, (low, high), system)
        (crossing,) = (each for each in found.crossings if each.kind == closed.kind)
        assert crossing.spin == pytest.approx(closed.spin, rel=1e-10)
        assert crossing.frequency == pytest.approx(closed.frequency, rel=1e-9, abs=1e-11)
        assert crossing.stable_side == "above"
        assert found.stable == (((crossing.spin, high),) if disk.eccentricity else ())
        # Model 1 has a Hopf crossing as well.
        assert len(found.crossings) == 1 or level == 1


def test_without_friction_pairs_are_born_where_no_eigenvalue_leaves_both_axes() -> None:
    """By a scan of the eigenvalues of independent equations."""
    held: ConstraintSet = ("contact", "no-slip-along")
    free = Scenario(constraints=held, friction=SmoothCoulomb(coefficient=0.0))
    (change,) = critical_speeds(free, motion="noninverted").pair_changes
    assert change.spin == pytest.approx(29.795, abs=1e-3)
    assert change.complex_side == "above"


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


@pytest.mark.parametrize("slope", [0.2, -0.4])
def test_a_pair_that_is_born_or_dies_beside_another_one_is_told_from_it(slope: float) -> None:
    """Eigenvalues -1 +- sqrt(slope (Omega - 1.053)) and -1.047 +- 0.016 i."""

    def matrices(spins: Array) -> Array:
        matrix = np.zeros((spins.size, 4, 4))
        matrix[:] = np.diag((-1.0, -1.0, -1.047, -1.047))
        matrix[:, 0, 1], matrix[:, 1, 0] = 1.0, slope * (spins - 1.053)
        matrix[:, 2, 3], matrix[:, 3, 2] = 0.016, -0.016
        return matrix

    (change,) = Spectra(matrices, np.arange(0.5, 1.5, 0.05), 1.0).pair_changes()
    assert (change.spin, change.value) == pytest.approx((1.053, -1.0))
    assert change.complex_side == ("below" if slope > 0.0 else "above")


RINGS = (STEEL_DISK, Disk.ring(hole_distance=1e-3))
CORNER = 1.851081
"""Friction gradient of Model 1 in s/m at which two pairs cross at one spin, of 29.847 rad/s."""

CASES: list[tuple[Scenario, float]] = [
    *((with_gradient(model(1), each), 60.0) for each in (1e-3, 0.5, 1.2, 1.5, 3.0, 30.0)),
    *((with_gradient(model(level), 1.5), 60.0) for level in LEVELS[1::2]),
    # Beside a large eigenvalue, rounding hides slow ones; a small eccentricity makes these slower.
    *((with_gradient(model(level, disk=disk), gradient), 60.0)
      for disk in RINGS for level in LEVELS for gradient in (3e3, 1e4, 1e5)),
    # Two pairs cross within a step.
    *((with_gradient(model(1), part * CORNER), 60.0) for part in (0.9999, 1.0001, 1.001)),
    # A four-hundredth of the gravity slows all motions twentyfold.
    *((with_gradient(model(1, table=Table(gravity=GRAVITY / times**2)), times * gradient),
       60.0 / times) for times, gradient in ((20.0, 1.85), (1e3, 1.8512))),
]  # fmt: skip
"""Scenarios, and the highest spins in rad/s that are looked at."""

PARTS = np.concatenate((np.geomspace(1e-4, 0.999, 600), np.linspace(0.4966, 0.4984, 1000)))
"""Of the highest spin: evenly over its sizes, and closely about where pairs cross in a corner."""


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize(("scenario", "highest"), CASES)
def test_crossings_and_pairs_explain_every_change_of_the_eigenvalues(
    scenario: Scenario, highest: float, motion: Motion
) -> None:
    found = critical_speeds(scenario, (0.0, highest), motion=motion)
    spins, matrices = highest * np.sort(PARTS), matrices_over_spin(scenario, motion=motion)
    values = np.linalg.eigvals(matrices(spins))
    counts = np.array((values.real > 0.0, values.imag > 1e-6 * highest)).sum(axis=2)
    changes = np.zeros_like(counts)
    for each in found.crossings:
        number = {"hopf": 2, "static": 1}[each.kind]
        changes[0, spins > each.spin] += number if each.stable_side == "below" else -number
        critical = np.linalg.eigvals(matrices(np.array([each.spin]))[0])
        assert np.min(np.abs(critical - 1j * each.frequency)) < 1e-7
    for pair in found.pair_changes:
        changes[1, spins > pair.spin] += 1 if pair.complex_side == "above" else -1
    np.testing.assert_array_equal(np.diff(counts), np.diff(changes))
    inside = [any(low < spin < high for low, high in found.stable) for spin in spins.tolist()]
    np.testing.assert_array_equal(counts[0] == 0, inside)


def test_a_dip_at_a_spin_of_the_grid_tells_the_crossings_beside_it() -> None:
    """Eigenvalues -1 and 1e-6 - (Omega - 1)², which rounding in a stack makes negative at 1."""

    def matrices(spins: Array) -> Array:
        values = np.zeros((spins.size, 2, 2))
        values[:, 0, 0] = 1e-6 - (spins - 1.0) ** 2 - 2e-6 * (spins.size > 1)
        values[:, 1, 1] = -1.0
        return values

    first, second = Spectra(matrices, np.array((0.5, 0.75, 1.0, 1.25, 1.5))).crossings()
    assert (first.spin, second.spin) == pytest.approx((0.999, 1.001), abs=1e-9)


def test_eigenvalues_that_are_small_at_high_spin_alone_are_none_at_rest() -> None:
    weak = replace(model(4), table=Table(gravity=4e-6))
    for system in ("reduced", "numeric"):
        assert critical_speeds(weak, system=system, motion="noninverted").crossings == ()


def test_where_nothing_crosses_nothing_is_stable_and_the_result_says_why() -> None:
    slippery = SmoothCoulomb(coefficient=0.0)
    cases = [
        (model(4), 20.0, "no eigenvalue crosses the imaginary axis from 0 to 20 rad/s"),
        (with_gradient(model(4), 1e8), 100.0, "friction so steep that rounding hides"),
        (with_gradient(model(1), 2.5e5), 60.0, "friction so steep that rounding hides"),
        *((Scenario(constraints=h, friction=slippery), 35.0, "no fric") for h in POSSIBLE_SETS),
    ]
    for scenario, highest, reason in cases:
        found = critical_speeds(scenario, (0.0, highest))
        assert (found.crossings, found.stable) == ((), ()), scenario.name
        # In Model 1 a pair clearly grows, whatever crosses besides.
        is_hidden = "rounding hides" in reason and scenario.model == 4
        assert found.is_hidden == is_hidden
        assert found.where == ("hidden by rounding" if is_hidden else "nowhere")
        assert not_none(found.reason).startswith(reason)


def test_no_pairs_are_told_that_rounding_makes_and_what_clearly_grows_is_not_hidden() -> None:
    for gradient in (3e7, 1e8):
        found = critical_speeds(with_gradient(model(4), gradient))
        assert (found.where, found.pair_changes) == ("hidden by rounding", ())
    growing = critical_speeds(with_gradient(model(4), 3e6), motion="noninverted")
    assert (growing.where, growing.is_hidden) == ("nowhere", False)


def test_an_eigenvalue_that_comes_slowly_to_one_that_stays_zero_crosses() -> None:
    # It stays within 1e-4 1/s of zero over two steps of the search.
    disk = of_six(3.6e-3, 1.77, 2.17e-5, 1.322e-5, 1.302e-5, 1.147e-5)
    law = LubricatedCoulomb(load="contact", smoothing=0.266, coefficient=0.6555, film=0.17625)
    held: ConstraintSet = ("contact", "no-slip-along", "constant-spin", "held-tilt-rate")
    scenario = Scenario(constraints=held, disk=disk, friction=law)
    (crossing,) = critical_speeds(scenario, (0.0, 300.0)).crossings
    assert (crossing.kind, crossing.stable_side) == ("static", "above")
    values = matrices_over_spin(scenario)(crossing.spin + np.array((-0.01, 0.01)))
    below, above = np.sort(np.linalg.eigvals(values).real)[:, -2:].tolist()
    assert below == pytest.approx((0.0, 1.7e-5), abs=2e-6)
    assert above == pytest.approx((-1.7e-5, 0.0), abs=2e-6)
