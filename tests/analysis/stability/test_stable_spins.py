"""Spins at which the spinning is stable as a whole."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import MODELS, POSSIBLE_SETS, ConstraintSet, Level, Motion, Scenario, SmoothCoulomb
from analysis.data.constraint_set import set_name
from analysis.stability import linear_reduced, spectra
from analysis.stability.stable_spins import stable_spins

PAPER = Scenario()
REDUCED = Scenario(constraints=MODELS[4])
MILD = Scenario(friction=SmoothCoulomb(smoothing=0.2))
"""With this friction inverted spinning is stable somewhere in the full system."""


def test_inverted_spinning_is_stable_nowhere_in_the_full_system() -> None:
    assert stable_spins(PAPER) == ()


def test_inverted_spinning_is_stable_above_the_closed_form_in_the_reduced_system() -> None:
    closed = linear_reduced.critical_speed(REDUCED).spin
    ((low, high),) = stable_spins(REDUCED)
    assert low == pytest.approx(closed, abs=1e-6)
    assert high == 60.0


@pytest.mark.parametrize("level", [1, 2, 4])
@pytest.mark.parametrize("motion", ["inverted", "noninverted"])
def test_every_eigenvalue_decays_inside_and_one_grows_outside(
    level: Level, motion: Motion
) -> None:
    scenario = replace(MILD, constraints=MODELS[level])
    found = stable_spins(scenario, (0.0, 50.0), motion=motion)
    for spin in np.linspace(0.3, 49.7, 20).tolist():
        values = spectra.matrices_over_spin(scenario, motion=motion)(np.array([spin]))[0]
        inside = any(low < spin < high for low, high in found)
        assert (np.max(np.linalg.eigvals(values).real) < 0.0) == inside


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_nothing_is_stable_without_friction(constraints: ConstraintSet) -> None:
    frictionless = Scenario(constraints=constraints, friction=SmoothCoulomb(coefficient=0.0))
    assert stable_spins(frictionless, (25.0, 35.0)) == ()
