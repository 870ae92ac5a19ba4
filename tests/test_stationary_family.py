"""All stationary motions of an eccentric disk."""

from dataclasses import replace

import numpy as np
import pytest

from analysis import CENTRED_DISK, ConstraintSet, Scenario, Start, Table, simulate
from analysis.nonlinear.stationary import StationaryMotion, stationary_branch, stationary_motions
from analysis.stability import spectra
from analysis.stability.spectra import matrices_over_spin
from validation.studies.nonlinear.tables import stationary_table


@pytest.mark.parametrize(
    "constraints",
    [("contact",), ("contact", "constant-spin"), ("contact", "no-slip-along", "no-slip-across")],
)
def test_an_eccentric_disk_spins_upright_or_not_at_all(constraints: ConstraintSet) -> None:
    inverted, noninverted = stationary_motions(Scenario(constraints=constraints), 28.0, starts=12)
    assert inverted.gamma == pytest.approx(np.pi / 2, abs=1e-8)
    assert noninverted.gamma == pytest.approx(-np.pi / 2, abs=1e-8)
    for each in (inverted, noninverted):
        assert not each.is_tilted
        assert (each.x, each.y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert noninverted.growth is not None
    assert noninverted.growth > 1.0


@pytest.mark.parametrize(
    ("constraints", "least"),
    [
        (("contact", "constant-spin"), 49.373),
        pytest.param(("contact", "fixed-cog", "constant-spin"), 47.895, marks=pytest.mark.slow),
    ],
)
def test_tilted_motions_at_held_spin_fold_and_meet_inverted_spinning_where_it_is_neutral(
    constraints: ConstraintSet, least: float
) -> None:
    scenario = Scenario(constraints=constraints)
    tilted = stationary_motions(scenario, 60.0, starts=20)[0]
    assert tilted.is_tilted
    branch = stationary_branch(scenario, tilted, (40.0, 100.0))
    assert min(motion.spin for motion in branch) == pytest.approx(least, abs=2e-2)
    last = min(branch, key=lambda motion: abs(motion.gamma - np.pi / 2))
    # There one real eigenvalue of inverted spinning passes zero.
    below, above = (
        np.linalg.det(matrices_over_spin(scenario)(np.array([last.spin + side]))[0])
        for side in (-1.0, 1.0)
    )
    assert below * above < 0.0


def test_tilted_motions_are_those_of_the_equations_of_motion() -> None:
    scenario = Scenario(constraints=("contact", "constant-spin"))
    found = stationary_motions(scenario, 60.0, starts=20)[0]
    place = {name: getattr(found, name) for name in ("x", "y", "beta", "gamma")}
    rates = ("x_rate", "y_rate", "beta_rate", "gamma_rate")
    start = Start(spin=60.0, **place, **dict.fromkeys(rates, 0.0))
    run = simulate(replace(scenario, start=start), np.linspace(0.0, 0.05, 6))
    for name in ("x", "y", "beta", "gamma"):
        np.testing.assert_allclose(run.coordinate(name), getattr(found, name), atol=1e-6)


def test_growth_is_that_of_the_spectrum() -> None:
    inverted = stationary_motions(Scenario(), 28.0, starts=12)[0]
    values = spectra.branches(Scenario(), [28.0]).values[0]
    assert inverted.growth == pytest.approx(np.max(values.real), rel=1e-9)


def test_a_search_is_refused_where_it_means_nothing() -> None:
    for scenario, spin, message in (
        (Scenario(), 0.0, "spin must not be 0"),
        (Scenario(), np.nan, "spin must be a finite number"),
        (replace(Scenario(), disk=CENTRED_DISK), 10.0, "eccentricity must be positive"),
        (replace(Scenario(), table=Table(inclination=0.1)), 10.0, "horizontal table"),
        (Scenario.rest(), 10.0, "ideal contact"),
    ):
        with pytest.raises(ValueError, match=message):
            stationary_motions(scenario, spin)
    with pytest.raises(ValueError, match="starts must be 1 or more"):
        stationary_motions(Scenario(), 10.0, starts=0)
    upright = stationary_motions(Scenario(), 10.0, starts=1)[0]
    with pytest.raises(ValueError, match="start must be tilted"):
        stationary_branch(Scenario(), upright, (5.0, 20.0))
    tilted = replace(upright, beta=1.2)
    with pytest.raises(ValueError, match="interval of positive ones about 10 rad/s"):
        stationary_branch(Scenario(), tilted, (20.0, 30.0))


def test_the_table_names_what_is_tilted() -> None:
    one = StationaryMotion(spin=1.0, x=0.0, y=0.0, beta=1.2, gamma=0.3, growth=None)
    rows = stationary_table([("Model 1", [one])]).rows
    assert rows[0][2] == "tilted"
