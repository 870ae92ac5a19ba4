"""The way to rest in the engine, and either side's against the most accurate in-house one."""

from contextlib import suppress
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import analysis
import mbs_models
from analysis import (
    STEEL_DISK,
    Body,
    Disk,
    Dissipation,
    LubricatedCoulomb,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    TimeLimitError,
    ViscousFriction,
)
from analysis.problem.choices import SOURCES, Source
from analysis.simulation.to_rest import RestMethod
from mbs_models import EngineError, rest
from tests.bodies import BODIES, TIPPE_TOP
from tests.helpers import mostly_slow, not_none, reaching
from tests.scenes import rest_scene
from validation.run import run_to_rest

EVERYTHING = Dissipation(
    rolling_dry=1e-3, rolling_viscous=1e-4, pivoting=5e-5, air_drag=1.2, rolling_smoothing=0.1
)
SETTLING = Dissipation(rolling_viscous=2e-3, pivoting=2e-4)


@pytest.mark.slow
def test_fixed_steps_converge_with_order_4() -> None:
    scene = rest_scene(dissipation=EVERYTHING)
    other = analysis.simulate_to_rest(
        scene.scenario, 0.5, spacing=1e-2, method="DOP853", local_tolerance=1e-12
    )
    measured = []
    for step in (2e-4, 1e-4, 5e-5):
        found = mbs_models.simulate_to_rest(scene, 0.5, step=step, spacing=1e-2)
        apart = found.rotations - other.rotations, found.energy_residual
        taken = [motion.energy_taken("damping")[-1] for motion in (found, other)]
        measured.append([*(np.max(np.abs(each)) for each in apart), abs(taken[0] - taken[1])])
        np.testing.assert_allclose(found.positions, other.positions, atol=1e-9)
    assert measured[-1][0] < 1e-8
    np.testing.assert_allclose(found.dissipated, other.dissipated, atol=1e-9)
    assert taken[0] == pytest.approx(taken[1], rel=0.01)
    assert np.min(np.log2(np.divide(measured[:-1], measured[1:]))) > 3.5


def test_fixed_steps_are_cut_where_rolling_resistance_makes_a_nearly_flat_disk_stiff() -> None:
    start = Start(beta=2e-3, gamma=-1.57, spin=0.0)
    scene = rest_scene(dissipation=Dissipation(rolling_dry=2.5e-4, pivoting=8e-6), start=start)
    other = analysis.simulate_to_rest(scene.scenario, 0.05, local_tolerance=1e-10)
    # Steps of the length asked for are a hundred times less accurate.
    assert mbs_models.simulate_to_rest(scene, 0.05, step=3e-4).deviation(other) < 1e-5


@pytest.mark.parametrize(
    ("losses", "step", "taken"),
    # Steps of a stretch that is given up count, too.
    [
        (Dissipation(rolling_viscous=5e-3, pivoting=1e-3), 3e-4, 550 * (1 + 2 + 4 + 8)),
        (Dissipation(pivoting=0.05), 1e-4, 1000 * (1 + 2 + 4)),
        pytest.param(Dissipation(pivoting=0.2), 2e-5, 5000 * (1 + 2 + 4), marks=pytest.mark.slow),
    ],
)
def test_fixed_steps_are_halved_where_a_disk_that_falls_presses_hard_on_the_table(
    losses: Dissipation, step: float, taken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = rest_scene(dissipation=losses, start=Start(beta=0.5, spin=5.0))
    other = analysis.simulate_to_rest(scene.scenario, 0.1, local_tolerance=1e-10)
    found = mbs_models.simulate_to_rest(scene, 0.1, step=step)
    assert found.deviation(other) < 2e-4
    assert found.counts["steps"] == taken
    lost = (motion.energy_taken("pivoting")[-1] for motion in (found, other))
    assert next(lost) == pytest.approx(next(lost), rel=1e-2)
    with pytest.raises(TimeLimitError):  # It is looked at before steps are halved.
        mbs_models.simulate_to_rest(scene, 0.1, step=step, time_limit=1e-3)
    monkeypatch.setattr(rest, "HALVINGS", 0)
    with pytest.raises(EngineError, match=r"the energy explodes after t = .* s: even steps of"):
        mbs_models.simulate_to_rest(scene, 0.1, step=step)


def test_halved_steps_come_to_the_condition_that_longer_ones_have_met() -> None:
    contact = PenaltyContact.damped(1e5, STEEL_DISK, half_thickness=2e-4)
    scenario = Scenario.rest(contact=contact, start=Start(spin=5.0, beta=1.2, height=0.3))
    rising = reaching("z_rate", 0.0, -1.0)
    known = analysis.simulate_to_rest(scenario, 1.0, stop_when=rising)
    # Those that touch the table are halved, once its stretch has ended.
    found = mbs_models.simulate_to_rest(
        scenario, 1.0, step=5e-4, stop_when=rising, time_limit=60.0
    )
    assert not_none(found.ending).reason == "z_rate 0.0"
    assert not_none(found.ending).time == pytest.approx(not_none(known.ending).time, abs=2e-4)


def test_steps_that_explode_are_halved_though_they_meet_a_condition_before_the_next_record() -> (
    None
):
    losses = Dissipation(rolling_viscous=5e-3, pivoting=1e-3)
    scene = rest_scene(dissipation=losses, start=Start(beta=0.5, spin=5.0))
    rising = reaching("z_rate", 3.0)
    assert analysis.simulate_to_rest(scene.scenario, 0.1, stop_when=rising).ending is None
    assert mbs_models.simulate_to_rest(scene, 0.1, step=3e-4, stop_when=rising).ending is None
    # Conditions and energies may then be asked of numbers that are none: of that, nothing warns.
    losses = Dissipation(rolling_dry=1e-2, rolling_viscous=0.05, pivoting=3e-4)
    start = Start(beta=0.2656, gamma=2.3, spin=0.73, height=1e-3)
    wild = rest_scene(dissipation=losses, friction=ViscousFriction(load="contact"), start=start)
    spun = reaching("alpha_rate", 30.0, -1.0)
    with suppress(TimeLimitError):
        mbs_models.simulate_to_rest(
            wild, 0.06, step=3.1e-4, spacing=5e-3, stop_when=spun, time_limit=1.0
        )


def test_a_time_limit_is_looked_at_within_a_stretch() -> None:
    # Ten million steps would lead to its end.
    with pytest.raises(TimeLimitError, match="before the first sample"):
        mbs_models.simulate_to_rest(rest_scene(), 1.0, step=1e-8, spacing=0.05, time_limit=0.2)


@pytest.mark.slow
def test_the_disk_comes_to_rest_as_in_house() -> None:
    settled = mbs_models.simulate_to_rest(rest_scene(dissipation=SETTLING), 30.0, step=2e-4)
    other = analysis.simulate_to_rest(settled.scenario, 30.0, local_tolerance=1e-10)
    count = min(settled.times.size, other.times.size)
    np.testing.assert_allclose(settled.tilt[:count], other.tilt[:count], atol=1e-4)
    for phase in fields(settled.phases):
        found, expected = (getattr(each.phases, phase.name) for each in (settled, other))
        assert found == pytest.approx(expected, abs=5e-3)


TOUCHING = Scenario(
    disk=TIPPE_TOP,
    friction=SmoothCoulomb(load="contact"),
    contact=PenaltyContact.rounded(TIPPE_TOP, stiffness=8.3e4),
    start=Start(beta=0.64, gamma=2.9, spin=-59.7, beta_rate=-2.1, height=0.0),
)
LIFTED = Start(beta=1.249, gamma=-0.65, spin=27.4, beta_rate=1.66, gamma_rate=33.3, height=2e-3)
FILM = Scenario.rest(
    friction=LubricatedCoulomb(load="contact", film=0.69),
    table=Table(gravity=3.0),
    contact=PenaltyContact.rounded(STEEL_DISK, stiffness=4.2e5, half_thickness=2.1e-3),
    start=LIFTED,
)
"""A sphere that only just touches at first, and a film that lets go as a disk lifts off."""


IMPACTS = Scenario.rest(start=Start(height=5e-3))
BOUNCES = Scenario.rest(start=Start(beta=0.7, gamma=0.3, spin=1.0, height=0.05))
LARGE = Disk.ring(radius=0.9, hole_radius=0.3, hole_distance=0.4, thickness=0.2, density=7700.0)
DROPPED = Scenario.rest(
    disk=LARGE,
    contact=PenaltyContact.rounded(LARGE, stiffness=4e8, half_thickness=4e-3),
    start=Start(beta=0.8, spin=5.0, height=1.0),
)


def turning(body: Body) -> Scenario:
    return Scenario(
        disk=body,
        contact=PenaltyContact.rounded(body, stiffness=2e4),
        dissipation=replace(EVERYTHING, air_drag=1.2 * body.is_round_disk),
        start=Start(beta=1.3, gamma=0.4, spin=12.0, beta_rate=0.5),
    )


CASES: list[tuple[Scenario, float, float | None]] = [
    *((scenario, 0.5, None) for scenario in (IMPACTS, BOUNCES)),
    (DROPPED, 0.6, None),
    (TOUCHING, 0.02, 1e-4),
    (FILM, 0.3, 1e-4),
    *((turning(body), 0.1, 1e-7) for body in BODIES.values()),
    *((scenario, 0.5, each) for scenario in (IMPACTS, BOUNCES) for each in (1e-2, 1e-5)),
]
"""Scenarios, ends and tolerances."""


@pytest.mark.parametrize("case", mostly_slow(range(len(CASES)), (0, *range(2, 10))))
@pytest.mark.parametrize("source", SOURCES)
def test_a_tolerance_is_met_and_estimated_through_every_attitude_and_impact(
    source: Source, case: int
) -> None:
    scenario, end, tolerance = CASES[case]
    how: dict[str, Any] = {"spacing": 5e-3, "time_limit": 60.0}
    # Of smooth ones by another method: the last run of LSODA is as tight.
    method: RestMethod = "DOP853" if tolerance == 1e-7 else "LSODA"
    best = analysis.simulate_to_rest(scenario, end, method=method, local_tolerance=1e-13, **how)
    run = run_to_rest(scenario, end, source=source, tolerance=tolerance, **how)
    assert run.ending is None
    # It does not stall where the contact opens and closes.
    assert run.counts["steps"] < 10_000
    assert run.deviation(best) <= not_none(run.error_estimate) <= (tolerance or 1e-3)
    for name in ("velocities", "contact_points", "contour_speeds", "dissipated"):
        found, right = getattr(run, name), getattr(best, name)
        np.testing.assert_allclose(found, right, rtol=0.0, atol=tolerance or 1e-3)
    # Friction takes power at every instant; sampled work only rises.
    energy = best.energies.sum(axis=1)
    assert np.max(np.abs(best.energy_residual)) < 1e-6 * energy[0]
    assert np.max(np.diff(energy)) < 1e-7 * energy[0]
    assert np.min(np.diff(best.dissipated, axis=0)) > -1e-9 * energy[0]
    assert np.min(best.normal_force) >= 0.0
