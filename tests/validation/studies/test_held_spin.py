"""Cycles of the full models at held spin, and of the engine, found from runs alone."""

import numpy as np
import pytest

from analysis import Scenario, simulate
from analysis.nonlinear.families import cycle_family
from analysis.nonlinear.motions import PeriodicMotion
from analysis.stability import spectra
from analysis.stability.printed import critical_speed
from tests.helpers import model
from validation.studies.nonlinear.held_spin import (
    AMPLITUDE,
    HELD,
    HeldCycle,
    NoHeldCycleError,
    beginning,
    birth,
    family,
    find,
    start_of,
)
from validation.studies.nonlinear.measured import HELD_NAMES

PAPER = model(4)


@pytest.fixture(scope="module")
def cycle() -> PeriodicMotion:
    return cycle_family(PAPER, (0.5,)).motions[-1]


@pytest.mark.parametrize("source", ["in-house", pytest.param("engine", marks=pytest.mark.slow)])
def test_runs_have_the_cycle_of_the_reduced_system(cycle: PeriodicMotion, source: str) -> None:
    guess = beginning(cycle) * (1.0, 1.01, 1.01, 0.99)
    found = find(PAPER, guess, source=source)  # type: ignore[arg-type]
    assert found.amplitude == pytest.approx(cycle.value, abs=1e-8)
    assert found.period == pytest.approx(cycle.period, abs=1e-8)
    assert found.multiplier == pytest.approx(cycle.multiplier, abs=1e-6)
    assert found.half_multiplier == pytest.approx(cycle.larger, abs=1e-6)


def test_cycles_are_born_along_the_critical_direction() -> None:
    hopf = critical_speed(PAPER)
    born, direction = birth(PAPER)
    assert born[0] == pytest.approx(hopf.spin, rel=1e-9)
    # The critical pair does not slip: the rate of beta is that of the slow manifold.
    disk = PAPER.disk
    rate = -disk.eccentricity * hopf.spin / (disk.radius + disk.eccentricity)
    assert direction[AMPLITUDE:] == pytest.approx([1.0, rate], rel=1e-4)


@pytest.fixture(scope="module")
def small() -> dict[str, list[HeldCycle]]:
    return {name: family(name, (0.1, 0.2)) for name in HELD_NAMES}


@pytest.mark.parametrize("name", HELD_NAMES)
def test_families_that_slip_begin_downwards_and_fold(
    name: str, small: dict[str, list[HeldCycle]]
) -> None:
    first, second = small[name]
    assert first.spin < birth(Scenario(constraints=HELD[name]))[0][0]
    assert first.half_multiplier < 1.0 < second.half_multiplier
    assert max(first.residual, second.residual) < 1e-6


def test_cycles_of_model_2_are_born_stable_and_those_of_model_1_are_not(
    small: dict[str, list[HeldCycle]],
) -> None:
    one, two = (small[name] for name in HELD_NAMES)
    assert [cycle.stable for cycle in one] == [False, False]
    assert [cycle.stable for cycle in two] == [True, False]
    assert [cycle.complex_multiplier for cycle in two] == [None, None]
    # The fast pair of inverted spinning, which has grown by so much over a period.
    growth = spectra.branches(Scenario(constraints=HELD[HELD_NAMES[0]]), [one[0].spin]).values
    expected = np.exp(np.max(growth.real) * one[0].period)
    assert one[0].multiplier == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize("name", HELD_NAMES)
def test_amplitude_is_the_largest_deviation_of_gamma(
    name: str, small: dict[str, list[HeldCycle]]
) -> None:
    cycle = small[name][-1]
    start = start_of(HELD[name], cycle.spin, cycle.unknowns[AMPLITUDE:])
    scenario = Scenario(constraints=HELD[name], start=start)
    motion = simulate(scenario, np.linspace(0.0, cycle.period, 401), local_tolerance=1e-10)
    swing = motion.coordinate("gamma") - np.pi / 2
    assert np.max(swing) == pytest.approx(cycle.amplitude, abs=1e-6)
    assert -np.min(swing) == pytest.approx(cycle.amplitude, abs=1e-6)


def test_shooting_from_far_off_is_refused() -> None:
    with pytest.raises(NoHeldCycleError, match="no cycle of Model 4 found near"):
        find(PAPER, np.array((20.0, 0.1, 0.5, 3.0)), source="in-house")
