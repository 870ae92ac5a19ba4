"""Cycles of the full models at held spin, and of the engine, found from runs alone."""

import numpy as np
import pytest

from analysis import Scenario, simulate
from analysis.nonlinear.collocation import NoCycleError
from analysis.nonlinear.families import cycle_family
from analysis.stability import spectra
from analysis.stability.critical import critical_speeds
from tests.helpers import model
from validation.studies.nonlinear.held_spin import (
    AMPLITUDE,
    HELD,
    Cycle,
    beginning,
    family,
    find,
    start_of,
)
from validation.studies.nonlinear.measured import HELD_NAMES


@pytest.mark.parametrize("source", ["in-house", pytest.param("engine", marks=pytest.mark.whole)])
def test_runs_have_the_cycle_of_the_reduced_system(source: str) -> None:
    cycle = cycle_family(model(4), (0.5,)).motions[-1]
    guess = beginning(cycle) * (1.0, 1.01, 1.01, 0.99)
    found = find(model(4), guess, source=source)  # type: ignore[arg-type]
    expected = pytest.approx((cycle.value, cycle.period), abs=1e-8)
    assert (found["amplitude"], found["period"]) == expected
    assert found["multiplier"] == pytest.approx(cycle.multiplier, abs=1e-6)
    assert found["half_multiplier"] == pytest.approx(cycle.larger, abs=1e-6)


@pytest.fixture(scope="module")
def small() -> dict[str, list[Cycle]]:
    return {name: family(name, (0.1, 0.2)) for name in HELD_NAMES}


def test_families_that_slip_begin_downwards_and_fold_and_only_model_2_is_born_stable(
    small: dict[str, list[Cycle]],
) -> None:
    one, two = (small[name] for name in HELD_NAMES)
    for name, (first, second) in small.items():
        assert first["spin"] < critical_speeds(Scenario(constraints=HELD[name])).hopf[-1].spin
        assert first["half_multiplier"] < 1.0 < second["half_multiplier"]
    assert [cycle["stable"] for cycle in one] == [False, False]
    assert [(cycle["stable"], cycle["complex_multiplier"]) for cycle in two] == [
        (True, None),
        (False, None),
    ]
    # The fast pair of inverted spinning, which has grown by so much over a period.
    growth = spectra.eigenvalues(Scenario(constraints=HELD[HELD_NAMES[0]]), [one[0]["spin"]])
    expected = np.exp(np.max(growth.real) * one[0]["period"])
    assert one[0]["multiplier"] == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize("name", HELD_NAMES)
def test_amplitude_is_the_largest_deviation_of_gamma(
    name: str, small: dict[str, list[Cycle]]
) -> None:
    cycle = small[name][-1]
    start = start_of(cycle["spin"], cycle["unknowns"][AMPLITUDE:])
    scenario = Scenario(constraints=HELD[name], start=start)
    motion = simulate(scenario, np.linspace(0.0, cycle["period"], 401), local_tolerance=1e-10)
    swing = motion.coordinate("gamma") - np.pi / 2
    assert (np.max(swing), -np.min(swing)) == pytest.approx((cycle["amplitude"],) * 2, abs=1e-6)


def test_shooting_from_far_off_is_refused() -> None:
    with pytest.raises(NoCycleError, match="no cycle of Model 4 found near"):
        find(model(4), np.array((20.0, 0.1, 0.5, 3.0)), source="in-house")
