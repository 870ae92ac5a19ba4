"""Spins at which the spinning is stable as a whole."""

import numpy as np
import pytest

from analysis import STEEL_DISK, SmoothCoulomb
from analysis.stability import linear_reduced, spectra
from analysis.stability.linear_full import Motion
from analysis.stability.spectra import SYSTEMS, System
from analysis.stability.stable_spins import stable_spins
from validation import cli

PAPER = SmoothCoulomb()
MILD = SmoothCoulomb(smoothing=0.2)
"""With this friction inverted spinning is stable somewhere in the full system."""


def test_inverted_spinning_is_stable_nowhere_in_the_full_system() -> None:
    assert stable_spins("full", STEEL_DISK, PAPER) == ()


def test_inverted_spinning_is_stable_above_the_closed_form_in_the_reduced_system() -> None:
    closed = linear_reduced.critical_speed(STEEL_DISK).spin
    ((low, high),) = stable_spins("reduced", STEEL_DISK, PAPER)
    assert low == pytest.approx(closed, abs=1e-6)
    assert high == 60.0


@pytest.mark.parametrize("system", ["full", "model2", "reduced"])
@pytest.mark.parametrize("motion", ["inverted", "noninverted"])
def test_every_eigenvalue_decays_inside_and_one_grows_outside(
    system: System, motion: Motion
) -> None:
    found = stable_spins(system, STEEL_DISK, MILD, (0.0, 50.0), motion)
    for spin in np.linspace(0.3, 49.7, 20).tolist():
        values = spectra.relevant_matrices(system, STEEL_DISK, MILD, spin, motion)[0]
        inside = any(low < spin < high for low, high in found)
        assert (np.max(np.linalg.eigvals(values).real) < 0.0) == inside


def test_full_system_has_an_interval_between_two_pairs() -> None:
    ((low, high),) = stable_spins("full", STEEL_DISK, MILD)
    assert 0.0 < low < high < 60.0
    inside = spectra.eigenvalues("full", STEEL_DISK, MILD, [low + 0.01, high - 0.01])
    # The drift pair lies on the axis by definition.
    assert np.all(np.sort(inside.real, axis=1)[:, :-2] < 0.0)


@pytest.mark.parametrize("system", SYSTEMS)
def test_nothing_is_stable_without_friction(system: System) -> None:
    frictionless = SmoothCoulomb(coefficient=0.0)
    assert stable_spins(system, STEEL_DISK, frictionless, (25.0, 35.0)) == ()


@pytest.mark.parametrize("interval", [(5.0, 5.0), (-1.0, 5.0), (0.0, np.inf)])
def test_empty_interval_is_refused(interval: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="interval must"):
        stable_spins("full", STEEL_DISK, PAPER, interval)


def test_critical_calls_stable_only_what_is_so_as_a_whole(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert cli.main(["critical", "--system", "full", "--spin", "20:40"]) == 0
    crossings, _, models = capsys.readouterr().out.partition("\nWhere inverted spinning is stable")
    assert "26.8736" in crossings
    assert "stable" not in crossings
    assert [" ".join(line.split()) for line in models.splitlines()[-4:]] == [
        "Model 1 nowhere",
        "Model 2 29.889 to 40",
        "Model 3 30.9168 to 40",
        "Model 4 30.9168 to 40",
    ]
