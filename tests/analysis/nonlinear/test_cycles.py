"""Periodic motions of the reduced system: two methods, their multipliers, where they begin."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import CENTRED_DISK, Disk, Scenario, SmoothCoulomb, TanhCoulomb
from analysis.data.checks import Array
from analysis.data.disk import STEEL_RING
from analysis.mechanics import reduced
from analysis.nonlinear import family as families
from analysis.nonlinear.collocation import Mesh, NoCycleError
from analysis.nonlinear.cycle import INVERTED, Cycle
from analysis.nonlinear.family import (
    Bifurcation,
    CycleFamily,
    bifurcations,
    cycle_at,
    cycle_family,
)
from analysis.nonlinear.hopf import fitted_growth, hopf_type
from analysis.nonlinear.over import cycles_over
from analysis.nonlinear.shooting import shoot
from tests.helpers import model, reduced_run

PAPER = model(4)
WEAK = model(4, friction=SmoothCoulomb(coefficient=0.1, smoothing=0.4))
"""Friction so weak and smooth that cycles lose their stability on the way."""


@pytest.fixture(scope="module")
def family() -> CycleFamily:
    return cycle_family(PAPER, (0.15, 0.3, 0.45, 0.6, 0.8, 1.0, 2.0, 2.9))


@pytest.fixture(scope="module")
def weak() -> CycleFamily:
    return cycle_family(WEAK, (0.5, 1.0, 1.5, 2.0, 2.5, 2.8, 3.0))


@pytest.fixture(scope="module")
def changes(weak: CycleFamily) -> tuple[Bifurcation, ...]:
    return bifurcations(weak)


def shot(cycle: Cycle, off: float = 1e-5) -> Cycle:
    more = 1.0 + off
    start = cycle.spin * more, cycle.period / more, float(cycle.states[0, 2]) * more
    return shoot(cycle.scenario, cycle.amplitude, start)


def assert_same(first: Cycle, second: Cycle) -> None:
    assert first.method != second.method
    assert second.spin == pytest.approx(first.spin, rel=1e-10)
    assert second.period == pytest.approx(first.period, rel=1e-9)
    assert second.half_multiplier == pytest.approx(first.half_multiplier, rel=1e-8)
    assert second.log_strong == pytest.approx(first.log_strong, abs=1e-5)


def test_collocation_and_shooting_agree(family: CycleFamily) -> None:
    assert_same(family.cycles[0], shot(family.cycles[0], off=1e-7))


@pytest.mark.slow
@pytest.mark.parametrize("index", [4, 6, 7])
def test_collocation_and_shooting_agree_along_the_family(family: CycleFamily, index: int) -> None:
    assert_same(family.cycles[index], shot(family.cycles[index]))


@pytest.mark.slow
def test_collocation_and_shooting_agree_where_cycles_are_unstable(weak: CycleFamily) -> None:
    assert_same(weak.cycles[5], shot(weak.cycles[5]))


def test_the_reduced_system_comes_back_after_a_period(family: CycleFamily) -> None:
    for cycle in family.cycles[::5]:
        begin = cycle.states[0]
        np.testing.assert_allclose(
            reduced_run(PAPER, cycle.spin, begin, cycle.period), begin, rtol=0.0, atol=1e-8
        )
        times, states = cycle.full
        assert times[-1] == pytest.approx(cycle.period)
        np.testing.assert_allclose(states[-1], begin, rtol=0.0, atol=1e-9)


def test_a_deviation_shrinks_by_the_multiplier(family: CycleFamily) -> None:
    cycle, size = family.cycles[5], 1e-5
    # After half a period only the weak direction is left, and what lies along the motion.
    ends = [
        reduced_run(
            PAPER, cycle.spin, cycle.states[0] + np.array((0.0, change, 0.0)), part * cycle.period
        )
        for part in (0.5, 1.0)
        for change in (size, -size)
    ]
    along = np.array(reduced.solver(PAPER, cycle.spin)(*cycle.states[0].tolist())[:3])
    half, whole = ends[0] - ends[1], ends[2] - ends[3]

    def across(deviation: Array) -> Array:
        return np.asarray(deviation - along * (along @ deviation) / (along @ along))

    # Projected across the motion, one of them is as many times smaller as the other is larger.
    ratio = np.linalg.norm(across(whole)) / np.linalg.norm(across(half))
    assert ratio == pytest.approx(abs(cycle.half_multiplier), rel=1e-5)


def test_larger_multipliers_may_be_of_either_sign() -> None:
    cycles = cycle_family(WEAK, (0.5, 1.0, 1.7)).cycles
    assert cycles[0].half_multiplier > 0.0 > cycles[-1].half_multiplier
    for cycle in cycles:
        assert cycle.half_multiplier * cycle.strong_half_multiplier < 0.0
        assert abs(cycle.half_multiplier) > abs(cycle.strong_half_multiplier)


def test_both_multipliers_are_those_of_displaced_runs_over_half_a_period() -> None:
    # Friction so weak that the strong multiplier is no small number.
    scenario = model(4, friction=SmoothCoulomb(coefficient=0.02, smoothing=0.4))
    (*_, cycle) = cycle_family(scenario, (0.5,)).cycles
    ends = [
        reduced_run(scenario, cycle.spin, cycle.states[0] + displaced, 0.5 * cycle.period)
        for displaced in 1e-5 * np.vstack((np.eye(3), -np.eye(3)))
    ]
    # The mirror image turns all deviations round.
    monodromy = -(np.array(ends[:3]) - np.array(ends[3:])).T / 2e-5
    expected = [cycle.strong_half_multiplier, cycle.half_multiplier, 1.0]
    assert np.sort(np.linalg.eigvals(monodromy).real) == pytest.approx(expected, rel=1e-6)


def test_small_cycles_are_those_of_the_hopf_point(family: CycleFamily) -> None:
    first = family.cycles[0]
    assert first.spin == pytest.approx(family.hopf.spin, rel=3e-4)
    assert first.period == pytest.approx(2.0 * np.pi / family.hopf.frequency, rel=2e-3)
    assert first.multiplier == pytest.approx(1.0, abs=3e-3)


@pytest.mark.parametrize("law", [SmoothCoulomb(), TanhCoulomb()], ids=["kink", "smooth"])
def test_growth_of_the_cycles_is_that_of_the_normal_form(
    law: SmoothCoulomb | TanhCoulomb, family: CycleFamily
) -> None:
    scenario = replace(PAPER, friction=law)
    normal = hopf_type(scenario)
    found = family if law == PAPER.friction else cycle_family(scenario, np.arange(0.15, 1.0, 0.15))
    small = [cycle for cycle in found.cycles if cycle.amplitude < 1.05]
    growth = fitted_growth(
        [cycle.spin for cycle in small], [cycle.amplitude for cycle in small], normal.spin
    )
    assert normal.kind == "supercritical"
    assert normal.slip < 1e-12
    assert abs(growth.curvature - normal.curvature) < 5.0 * growth.curvature_error + 1e-6
    assert abs(growth.curvature - normal.curvature) < 1e-4 * abs(normal.curvature)
    assert growth.exponent == pytest.approx(2.0, abs=1e-4)


@pytest.mark.slow
def test_stability_changes_where_bifurcations_are_found(
    weak: CycleFamily, changes: tuple[Bifurcation, ...]
) -> None:
    assert [each.kind for each in changes] == ["symmetry-breaking", "symmetry-breaking", "fold"]
    for each, multiplier in zip(changes, (-1.0, -1.0, 1.0), strict=True):
        assert each.cycle.half_multiplier == pytest.approx(multiplier, abs=1e-6)
    lost, regained, fold = (each.cycle.amplitude for each in changes)
    for cycle in weak.cycles:
        inside = lost < cycle.amplitude < regained or cycle.amplitude > fold
        assert cycle.stable is not inside


@pytest.mark.slow
def test_a_fold_is_where_the_spin_is_extreme(changes: tuple[Bifurcation, ...]) -> None:
    fold = changes[-1].cycle
    beside = cycle_family(
        WEAK, (0.5, 1.0, 1.5, 2.0, 2.5, fold.amplitude - 0.01, fold.amplitude + 0.01)
    )
    before, after = (cycle.spin - fold.spin for cycle in beside.cycles[-2:])
    assert before == pytest.approx(after, rel=0.05)
    assert before > 1e-6


def test_a_cycle_followed_over_a_parameter_is_that_from_the_hopf_point() -> None:
    softer = replace(PAPER, friction=SmoothCoulomb(smoothing=0.13))
    alone = cycle_family(softer, [0.4]).cycles[0]
    followed = cycles_over([PAPER, softer], amplitude=0.4).cycles[1]
    assert followed.spin == pytest.approx(alone.spin, abs=1e-10)
    assert followed.half_multiplier == pytest.approx(alone.half_multiplier, abs=1e-8)
    held = cycles_over([PAPER, softer], spin=alone.spin).cycles[1]
    assert held.amplitude == pytest.approx(0.4, abs=1e-8)


def test_a_cycle_that_ends_over_a_parameter_names_the_last_good_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(families, "AMPLITUDES", np.array((0.2, 0.4)))
    # With the centre of gravity nearer to the middle the Hopf point falls below the held spin.
    nearer = replace(PAPER, disk=Disk.ring(**STEEL_RING | {"hole_distance": 0.0199}))
    found = cycles_over([PAPER, nearer], spin=30.91)
    assert len(found.cycles) == 1
    assert found.reason is not None
    assert found.reason.endswith(" at a spin of 30.91 rad/s")
    assert "the last good one is cycle 1 of 2" in found.reason
    with pytest.raises(ValueError, match="amplitude or spin must be given"):
        cycles_over([PAPER], spin=30.0, amplitude=1.0)
    with pytest.raises(ValueError, match="scenarios must be 1 or more"):
        cycles_over([], spin=30.0)


def test_the_cycle_at_a_spin_has_that_spin() -> None:
    cycle = cycle_at(PAPER, 30.85)
    assert cycle.spin == pytest.approx(30.85, rel=1e-12)
    assert cycle.method == "collocation"


def test_cycles_are_refused_where_there_can_be_none() -> None:
    for scenario, message in (
        (model(1), "Model 4"),
        (replace(PAPER, disk=CENTRED_DISK), "eccentricity"),
        (replace(PAPER, friction=SmoothCoulomb(coefficient=0.0)), "friction must have a positive"),
        (replace(PAPER, friction=SmoothCoulomb(load="contact")), "load must be 'weight'"),
        (replace(PAPER, friction=SmoothCoulomb(smoothing=1e-5)), "gradient of at most 10000 s/m"),
    ):
        with pytest.raises(ValueError, match=message):
            cycle_family(scenario)
    for amplitudes in ((), (0.0, 1.0), (1.0, 0.5), (1.0, 4.8)):
        with pytest.raises(ValueError, match="amplitudes must rise"):
            cycle_family(PAPER, amplitudes)
    for amplitude in (0.0, 4.8):
        with pytest.raises(ValueError, match=r"amplitude must lie between 0 and 4\.71239"):
            shoot(PAPER, amplitude, (30.0, 1.0, 1.0))
    with pytest.raises(ValueError, match="spins and amplitudes must be 5 or more"):
        fitted_growth([30.0], [1.0], 31.0)


def test_a_spin_without_cycles_is_refused_with_those_that_have_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(families, "AMPLITUDES", np.array((0.3, 0.6)))
    with pytest.raises(ValueError, match=r"between 30\.83.* and 30\.91.*, got 31"):
        cycle_at(PAPER, 31.0)


def test_a_family_that_fails_names_the_last_good_cycle(
    family: CycleFamily, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(scenario: Scenario, amplitude: float, start: Mesh) -> Cycle:
        assert scenario is PAPER
        if amplitude == 0.15:
            return family.cycles[0]
        raise NoCycleError(f"no periodic motion found at {amplitude:g} rad from {start.amplitude}")

    monkeypatch.setattr(families, "solve", fails)
    found = cycle_family(PAPER, (0.15, 0.3))
    assert found.cycles == family.cycles[:1]
    assert found.reason is not None
    assert found.reason.endswith("the last good one has 0.15 rad at a spin of 30.9111277 rad/s")
    with pytest.raises(NoCycleError):
        cycle_family(PAPER, (0.3,))


def test_shooting_from_far_off_fails_instead_of_finding_something() -> None:
    with pytest.raises(NoCycleError, match="shooting does not converge"):
        shoot(PAPER, 1.0, (15.0, 0.5, -1.0))


def test_a_cycle_is_its_own_mirror_image(family: CycleFamily) -> None:
    for cycle in family.cycles:
        np.testing.assert_allclose(
            cycle.states[-1] - INVERTED, INVERTED - cycle.states[0], atol=1e-9
        )
        assert np.max(cycle.states[:, 1]) - np.pi / 2 == pytest.approx(cycle.amplitude)
