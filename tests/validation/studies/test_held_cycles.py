"""Cycles of the full models at held spin, and of the engine, found from runs alone."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import Scenario, Start, simulate
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import cycle_family
from analysis.stability import spectra
from analysis.stability.critical import critical_speeds
from analysis.stability.linear_reduced import critical_speed
from tests.helpers import model
from validation.studies.nonlinear import engine_cycles
from validation.studies.nonlinear.engine_cycles import (
    LARGE,
    Witness,
    beginning,
    held_table,
    witness_table,
)
from validation.studies.nonlinear.held_spin import (
    HELD,
    HeldCycle,
    NoHeldCycleError,
    find,
    small_cycle,
    start_of,
)

PAPER = model(4)
SLIPPING = ("Model 1 at held spin", "Model 2 at held spin")


@pytest.fixture(scope="module")
def cycle() -> Cycle:
    return cycle_family(PAPER, (0.5,)).cycles[-1]


def test_the_full_equations_have_the_cycle_of_the_reduced_system(cycle: Cycle) -> None:
    found = find(PAPER, beginning(cycle), source="in-house", formulation="index-1")
    assert found.amplitude == pytest.approx(cycle.amplitude, abs=1e-8)
    assert found.period == pytest.approx(cycle.period, abs=1e-8)
    assert found.multiplier == pytest.approx(cycle.multiplier, abs=1e-6)
    assert found.half_multipliers[0].real == pytest.approx(cycle.half_multiplier, abs=1e-6)


@pytest.mark.slow
def test_the_engine_has_the_cycle_of_the_reduced_system() -> None:
    table = witness_table([engine_cycles.witness(30.8)])
    assert table.rows[0][-1] is True


def test_a_cycle_that_is_off_is_not_called_the_same(cycle: Cycle) -> None:
    found = find(PAPER, beginning(cycle), source="in-house", formulation="index-1")
    for wrong in (
        replace(found, amplitude=found.amplitude + 2e-6),
        replace(found, period=found.period - 2e-6),
        replace(found, half_multipliers=found.half_multipliers * (1.0 + 1e-5)),
    ):
        (right, off) = witness_table(
            [Witness(cycle=cycle, engine=found), Witness(cycle=cycle, engine=wrong)]
        ).rows
        assert right[-1] is True
        assert off[-1] is False


def test_the_linear_guess_is_the_direction_of_the_hopf_point() -> None:
    hopf = critical_speed(PAPER)
    start = small_cycle(PAPER, hopf.spin, hopf.frequency, 0.1)
    # The critical pair does not slip: the rate of beta is that of the slow manifold.
    disk = PAPER.disk
    rate = -disk.eccentricity * hopf.spin * 0.1 / (disk.radius + disk.eccentricity)
    assert start["start"] == pytest.approx([rate], rel=1e-4)


@pytest.fixture(scope="module")
def small() -> dict[str, list[HeldCycle]]:
    return {name: engine_cycles.held_family(name, (0.1, 0.2)) for name in SLIPPING}


@pytest.mark.parametrize("name", SLIPPING)
def test_families_that_slip_begin_downwards_and_fold(
    name: str, small: dict[str, list[HeldCycle]]
) -> None:
    hopf = critical_speeds(Scenario(constraints=HELD[name]), (29.0, 31.5)).crossings[-1].spin
    assert small[name][0].spin < hopf
    real = [engine_cycles.split(cycle)[0] for cycle in small[name]]
    assert real[0] < 1.0 < real[1]
    assert max(cycle.residual for cycle in small[name]) < 1e-6


def test_cycles_of_model_2_are_born_stable_and_those_of_model_1_are_not(
    small: dict[str, list[HeldCycle]],
) -> None:
    one, two = (small[name] for name in SLIPPING)
    assert [cycle.stable for cycle in one] == [False, False]
    assert [cycle.stable for cycle in two] == [True, False]
    # The fast pair of inverted spinning, which has grown by so much over a period.
    growth = spectra.branches(Scenario(constraints=HELD[SLIPPING[0]]), [one[0].spin]).values
    expected = np.exp(np.max(growth.real) * one[0].period)
    assert one[0].multiplier == pytest.approx(expected, rel=1e-2)


def test_what_is_said_of_the_cycles_is_what_was_found(small: dict[str, list[HeldCycle]]) -> None:
    said = held_table(list(small.items())).note
    assert (
        "Model 1 at held spin: unstable at 0.1 and 0.2 rad; a fold between 0.1 and 0.2 rad; "
        "a complex pair outside of the unit circle at 0.1 and 0.2 rad." in said
    )
    assert "Model 2 at held spin: stable at 0.1 rad; unstable at 0.2 rad; a fold" in said
    calmed = [
        replace(cycle, half_multipliers=0.9 * cycle.half_multipliers)
        for cycle in small[SLIPPING[0]]
    ]
    assert "Model 1: stable at 0.1 and 0.2 rad. Model 3" in held_table([("Model 1", calmed)]).note


@pytest.mark.parametrize("name", SLIPPING)
def test_amplitude_is_the_largest_deviation_of_gamma(
    name: str, small: dict[str, list[HeldCycle]]
) -> None:
    cycle = small[name][-1]
    start = start_of(cycle.constraints, cycle.spin, np.array((cycle.amplitude, *cycle.start)))
    scenario = Scenario(constraints=cycle.constraints, start=start)
    motion = simulate(scenario, np.linspace(0.0, cycle.period, 401), local_tolerance=1e-10)
    swing = motion.coordinate("gamma") - np.pi / 2
    assert np.max(swing) == pytest.approx(cycle.amplitude, abs=1e-6)
    assert -np.min(swing) == pytest.approx(cycle.amplitude, abs=1e-6)


@pytest.mark.slow
def test_large_cycles_of_model_2_are_stable_on_either_side_of_a_loss_of_symmetry() -> None:
    family = {cycle.amplitude: cycle for cycle in engine_cycles.held_family(SLIPPING[1], LARGE)}
    assert [family[each].stable for each in (2.5, 2.7, 2.74, 2.8)] == [True, True, False, True]
    assert family[2.7].spin == pytest.approx(31.5574, abs=1e-3)
    assert family[2.7].half_multipliers[0].real == pytest.approx(-0.995, abs=1e-3)


@pytest.mark.slow
def test_model_2_swings_for_ever_above_its_critical_speed() -> None:
    start = Start(beta=np.pi / 2, gamma=np.pi / 2 + 2.6, spin=31.8)
    scenario = Scenario(constraints=HELD["Model 2 at held spin"], start=start)
    motion = simulate(scenario, np.linspace(0.0, 14.0, 2801), local_tolerance=1e-8)
    swing = motion.coordinate("gamma") - np.pi / 2
    before, after = swing[1601:2201], swing[2201:]
    for each in (before, after):
        assert np.max(each) == pytest.approx(2.6203, abs=1e-3)
        assert np.min(each) == pytest.approx(-2.6203, abs=1e-3)


def test_shooting_from_far_off_is_refused() -> None:
    start = {"spin": 20.0, "amplitude": 0.5, "period": 0.2, "start": np.array((3.0,))}
    with pytest.raises(NoHeldCycleError, match="no cycle of Model 4 found near"):
        find(Scenario(constraints=HELD["Model 4"]), start, source="in-house")
