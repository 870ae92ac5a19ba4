"""Cycles without mirror symmetry, of friction so weak that symmetric ones lose their stability."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analysis import SmoothCoulomb
from analysis.mechanics import reduced
from analysis.nonlinear.asymmetric import AsymmetricCycle, asymmetric_family, changes
from analysis.nonlinear.family import Bifurcation, bifurcations, cycle_family
from tests.helpers import model, reduced_run

WEAK = model(4, friction=SmoothCoulomb(coefficient=0.1, smoothing=0.4))


@pytest.fixture(scope="module")
def lost() -> Bifurcation:
    return bifurcations(cycle_family(WEAK, (0.5, 1.0, 1.5, 1.7, 1.9)))[0]


@pytest.fixture(scope="module")
def branch(lost: Bifurcation) -> tuple[AsymmetricCycle, ...]:
    return asymmetric_family(lost, (2.0, 2.2, 2.4)).cycles


@pytest.mark.slow
def test_cycles_without_symmetry_come_back_after_a_period(
    branch: tuple[AsymmetricCycle, ...],
) -> None:
    for cycle in branch:
        state = reduced_run(WEAK, cycle.spin, cycle.states[0], cycle.period)
        np.testing.assert_allclose(state, cycle.states[0], rtol=0.0, atol=1e-7)
        assert cycle.amplitude + cycle.lowest > 0.4


@pytest.mark.slow
def test_they_branch_off_where_symmetric_cycles_regain_their_stability_too() -> None:
    regained = bifurcations(cycle_family(WEAK, (1.0, 2.0, 2.5, 2.7, 2.8)))[-1]
    assert regained.cycle.amplitude == pytest.approx(2.7496, abs=1e-4)
    begin = regained.cycle.amplitude
    first, second = asymmetric_family(regained, (begin + 0.02, begin + 0.1)).cycles
    # Growing with the amplitude, the asymmetry begins in the bifurcation.
    assert first.amplitude + first.lowest == pytest.approx(0.04, abs=2e-3)
    assert first.spin == pytest.approx(regained.cycle.spin, abs=1e-3)
    state = reduced_run(WEAK, second.spin, second.states[0], second.period)
    np.testing.assert_allclose(state, second.states[0], rtol=0.0, atol=1e-6)


@pytest.mark.slow
def test_their_period_doubles_where_the_multiplier_passes_minus_one(
    branch: tuple[AsymmetricCycle, ...],
) -> None:
    assert [each.stable for each in branch] == [True, True, False]
    ((kind, cycle),) = changes(branch)
    assert kind == "period-doubling"
    assert cycle.multiplier == pytest.approx(-1.0, abs=1e-6)
    assert cycle.spin == pytest.approx(29.9690, abs=1e-4)
    for spin, apart in ((cycle.spin + 0.03, 0.0), (29.9, 0.19749)):
        assert difference_of_swings(spin) == pytest.approx(apart, abs=1e-4)


def difference_of_swings(spin: float) -> float:
    """Difference in rad between largest deviations that follow each other, after a minute."""

    def upright(_: float, x: np.ndarray) -> float:
        return float(x[0]) - np.pi / 2

    upright.direction = -1.0  # type: ignore[attr-defined]
    run = solve_ivp(
        reduced.right_hand_side(WEAK, spin),
        (0.0, 60.0),
        # Not on the event itself, whose sign rounding would decide.
        (np.pi / 2 - 0.01, np.pi / 2 + 1.9, -1.0),
        method="LSODA",
        rtol=1e-9,
        atol=1e-10,
        events=upright,
    )
    return abs(float(run.y_events[0][-1, 1] - run.y_events[0][-2, 1]))


@pytest.mark.slow
def test_other_bifurcations_and_amplitudes_are_refused(lost: Bifurcation) -> None:
    with pytest.raises(ValueError, match="must be symmetry-breaking, got 'fold'"):
        asymmetric_family(replace(lost, kind="fold"), (2.0,))
    for amplitudes in ((), (1.7, 1.9), (2.1, 2.0)):
        with pytest.raises(ValueError, match=r"must rise strictly beyond 1\.78157"):
            asymmetric_family(lost, amplitudes)
