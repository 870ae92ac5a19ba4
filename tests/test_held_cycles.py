"""Cycles of the full models at held spin, and of the engine, found from runs alone."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import Scenario, Start, simulate
from analysis.nonlinear.cycle import Cycle
from analysis.nonlinear.family import cycle_family
from analysis.stability.linear_reduced import critical_speed
from tests.helpers import model
from validation.studies.nonlinear import engine_cycles
from validation.studies.nonlinear.engine_cycles import Witness, beginning, witness_table
from validation.studies.nonlinear.held_spin import HELD, NoHeldCycleError, find, small_cycle

PAPER = model(4)


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


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in HELD if name != "Model 4"])
def test_models_with_more_freedom_lose_stability_hard(name: str) -> None:
    small, fold, large = engine_cycles.held_family(name, (0.1, 0.2, 0.4))
    largest = [engine_cycles.split(cycle)[0] for cycle in (small, fold, large)]
    assert largest[0] < 1.0 < largest[1] < largest[2]
    assert small.spin > fold.spin or fold.spin < large.spin
    assert np.all(np.array([small.residual, fold.residual, large.residual]) < 1e-6)


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
