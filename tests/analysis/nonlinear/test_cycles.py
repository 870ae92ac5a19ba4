"""Periodic motions of the reduced system: two methods, their multipliers, where they begin."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

from analysis import CENTRED_DISK, Disk, Scenario, SmoothCoulomb, TanhCoulomb
from analysis.data.checks import Array
from analysis.data.disk import STEEL_RING
from analysis.mechanics import reduced
from analysis.nonlinear import family as families
from analysis.nonlinear import flow
from analysis.nonlinear.collocation import NoCycleError, solve
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
from tests.helpers import jacobian, model, reduced_run

PAPER = model(4)
WEAK = model(4, friction=SmoothCoulomb(coefficient=0.1, smoothing=0.4))
"""Friction so weak and smooth that cycles lose their stability on the way."""

WEAKEST = model(4, friction=SmoothCoulomb(coefficient=0.02, smoothing=0.4))
"""So weak that the strong multiplier is no small number."""


@pytest.fixture(scope="module")
def family() -> CycleFamily:
    return cycle_family(PAPER, (0.15, 0.3, 0.45, 0.6, 0.8, 1.0, 2.0, 2.9))


@pytest.fixture(scope="module")
def weak() -> CycleFamily:
    return cycle_family(WEAK, (0.5, 1.0, 1.5, 2.0, 2.5, 2.8, 3.0))


@pytest.fixture(scope="module")
def changes(weak: CycleFamily) -> tuple[Bifurcation, ...]:
    return bifurcations(weak)


def run(cycle: Cycle, spin: float, half: float, begin: Array) -> Array:
    """Deviation from inverted spinning after a time, mirrored, by an explicit method."""
    found = solve_ivp(
        reduced.right_hand_side(cycle.scenario, spin),
        (0.0, half),
        begin + INVERTED,
        method="DOP853",
        rtol=1e-13,
        atol=1e-14,
    )
    result: Array = INVERTED - found.y[:, -1]
    return result


def shot(cycle: Cycle) -> tuple[float, float, float]:
    """Spin, half the period and rate of beta of the cycle of an amplitude, by shooting."""

    def miss(unknowns: Array) -> Array:
        begin = np.array((0.0, cycle.amplitude, unknowns[2]))
        return np.asarray(run(cycle, unknowns[0], unknowns[1], begin) - begin)

    guess = np.array((cycle.spin, cycle.period / 2, cycle.states[0, 2])) * (1 + 1e-6, 1 - 1e-6, 1)
    spin, half, rate = root(miss, guess, tol=1e-13).x.tolist()
    return spin, half, rate


def assert_shot(cycle: Cycle) -> None:
    """Shooting gives the same cycle, and integrated variations its larger multiplier."""
    spin, half, rate = shot(cycle)
    assert cycle.spin == pytest.approx(spin, rel=1e-10)
    assert cycle.period == pytest.approx(2.0 * half, rel=1e-9)
    assert multipliers_of_runs(cycle, rate)[-1] == pytest.approx(cycle.half_multiplier, rel=1e-8)


def multipliers_of_runs(cycle: Cycle, rate: float) -> list[float]:
    """Multipliers over half a period by rising size but for that along it, by integration."""

    def rates(_: float, values: Array) -> Array:
        right, slopes = flow.derivatives(cycle.scenario, cycle.spin, values[:3, None])[:2]
        return np.append(right[:, 0], (slopes[0] @ values[3:].reshape(3, 3)).ravel())

    begin = np.append((0.0, cycle.amplitude, rate), np.eye(3))
    found = solve_ivp(
        rates, (0.0, cycle.period / 2), begin, method="DOP853", rtol=1e-11, atol=1e-12
    )
    # The mirror image turns all deviations round.
    values = np.linalg.eigvals(-found.y[3:, -1].reshape(3, 3)).real
    others = np.delete(values, np.argmin(np.abs(values - 1.0)))
    return sorted(others.tolist(), key=abs)


def test_collocation_and_shooting_agree(family: CycleFamily) -> None:
    spin, half = shot(family.cycles[0])[:2]
    assert family.cycles[0].spin == pytest.approx(spin, rel=1e-10)
    assert family.cycles[0].period == pytest.approx(2.0 * half, rel=1e-9)


@pytest.mark.slow
def test_collocation_and_shooting_agree_along_the_families(
    family: CycleFamily, weak: CycleFamily
) -> None:
    for cycle in (family.cycles[4], family.cycles[6], weak.cycles[5]):
        assert_shot(cycle)


def test_both_multipliers_are_those_of_the_variational_equations_over_half_a_period() -> None:
    (cycle,) = cycle_family(WEAKEST, (0.5,)).cycles
    strong = -np.exp(cycle.log_strong / 2.0)
    found = multipliers_of_runs(cycle, float(cycle.states[0, 2]))
    assert found == pytest.approx([strong, cycle.half_multiplier], rel=1e-7)


def test_either_multiplier_may_tell_that_the_stability_changes(family: CycleFamily) -> None:
    # Over half a period the smaller one has the opposite sign.
    for larger, at in ((1.3, -1.0), (-1.3, 1.0)):
        inside, outside = (
            replace(family.cycles[0], half_multiplier=larger, log_strong=2.0 * np.log(size))
            for size in (0.9, 1.1)
        )
        assert inside.characteristic(at) * outside.characteristic(at) < 0.0
        assert inside.characteristic(-at) * outside.characteristic(-at) > 0.0


def test_a_cycle_closes_and_is_its_own_mirror_image(family: CycleFamily) -> None:
    for cycle in family.cycles[::5]:
        begin, (times, states) = cycle.states[0], cycle.full
        end = reduced_run(PAPER, cycle.spin, begin, cycle.period)
        np.testing.assert_allclose(end, begin, rtol=0.0, atol=1e-8)
        assert times[-1] == pytest.approx(cycle.period)
        np.testing.assert_allclose(states[-1], begin, rtol=0.0, atol=1e-9)
        assert np.max(cycle.states[:, 1]) - np.pi / 2 == pytest.approx(cycle.amplitude)


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
    sides = (solve(WEAK, fold.amplitude + side, fold).spin for side in (-0.01, 0.01))
    before, after = (spin - fold.spin for spin in sides)
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


@pytest.mark.parametrize("spin", [30.85, 30.916])
def test_the_cycle_at_a_spin_has_that_spin(spin: float) -> None:
    cycle = cycle_at(PAPER, spin)
    assert cycle.spin == spin
    assert solve(PAPER, cycle.amplitude, cycle).spin == pytest.approx(spin, rel=1e-11)


def test_cycles_are_refused_where_there_can_be_none(monkeypatch: pytest.MonkeyPatch) -> None:
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
    with pytest.raises(ValueError, match="spins and amplitudes must be 5 or more"):
        fitted_growth([30.0], [1.0], 31.0)
    with pytest.raises(ValueError, match="amplitude or spin must be given"):
        cycles_over([PAPER], spin=30.0, amplitude=1.0)
    with pytest.raises(ValueError, match=r"amplitude must lie between 0 and 3\.14159"):
        cycles_over([PAPER], amplitude=4.0)
    with pytest.raises(ValueError, match="scenarios must be 1 or more"):
        cycles_over([], spin=30.0)
    monkeypatch.setattr(families, "AMPLITUDES", np.array((0.3, 0.6)))
    with pytest.raises(ValueError, match=r"between 30\.83.* and 30\.91.*, got 31"):
        cycle_at(PAPER, 31.0)


def test_a_family_that_fails_names_the_last_good_cycle(
    family: CycleFamily, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_: Scenario, amplitude: float, start: Cycle) -> Cycle:
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


@pytest.mark.slow
def test_a_collocation_from_far_off_fails_instead_of_finding_something() -> None:
    (cycle,) = cycle_family(PAPER, (1.0,)).cycles
    with pytest.raises(NoCycleError, match="no periodic motion with an amplitude of 1 rad found"):
        solve(PAPER, 1.0, replace(cycle, spin=-10.0, times=3.0 * cycle.times))


def test_derivatives_of_the_flow_are_those_of_its_values() -> None:
    x, spin = np.array(((0.3, -0.8), (1.0, 0.2), (-2.0, 0.7))), 29.0
    right, slopes, by_spin = flow.derivatives(PAPER, spin, x)
    np.testing.assert_allclose(right, flow.right_hand_side(PAPER, spin, x), rtol=1e-14)
    for index, begin in enumerate(x.T):
        state = (begin + INVERTED).tolist()
        expected = reduced.solver(PAPER, spin)(*state)[:3]
        np.testing.assert_allclose(right[:, index], expected, rtol=1e-12)
        found = jacobian(
            lambda each: flow.right_hand_side(PAPER, each[3], each[:3, None])[:, 0],
            np.append(begin, spin),
        )
        joined = np.column_stack((slopes[index], by_spin[:, index]))
        np.testing.assert_allclose(joined, found, rtol=1e-8, atol=1e-8)
