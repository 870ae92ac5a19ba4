"""Rolling of a centred disk: the textbook's closed forms against equations and motions."""

from dataclasses import replace
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

from analysis import CENTRED_DISK as DISK
from analysis import (
    GRAVITY,
    ConstraintSet,
    Disk,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
    simulate,
)
from analysis.data.dissipation import Dissipation
from analysis.data.spatial_motion import SpatialMotion
from analysis.rest.final_stage import fit_power_law, precession
from analysis.rest.stationary_rolling import (
    axial_spin,
    euler_disk_energy,
    euler_disk_precession,
    rolling_start,
    time_to_flat,
    upright_rolling_spin,
)
from analysis.rest.to_rest import simulate_to_rest

WEIGHT = DISK.mass * GRAVITY
CENTRED = Scenario(disk=DISK)
ROLLING: ConstraintSet = ("contact", "no-slip-along", "no-slip-across")
STICKY = SmoothCoulomb(coefficient=2.0, smoothing=1e-3, load="contact")


def test_euler_disk_is_the_limit_without_axial_spin() -> None:
    for beta in (0.05, 1.0):
        rate = euler_disk_precession(CENTRED, beta)
        assert axial_spin(CENTRED, beta, rate) == pytest.approx(0.0)


@pytest.mark.parametrize(
    "first", [0.2, pytest.param(pi - 0.2, marks=pytest.mark.slow)], ids=["one face", "other face"]
)
def test_euler_disk_keeps_rolling_with_textbook_energy_and_contact_force(first: float) -> None:
    beta = 0.2
    rate = euler_disk_precession(CENTRED, beta)
    start = rolling_start(DISK, first, rate, 0.0)
    contact = PenaltyContact.rounded(DISK, half_thickness=2e-5)
    rest = Scenario.rest(disk=DISK, contact=contact, start=start)
    motion = simulate_to_rest(rest, 1.0, spacing=1e-2)
    np.testing.assert_allclose(motion.leaning, beta, rtol=1e-3)
    np.testing.assert_allclose(motion.normal_force, WEIGHT, rtol=5e-3)
    np.testing.assert_allclose(precession(motion), rate, rtol=1e-3)
    energy = motion.energies[:, :2].sum(axis=1)
    np.testing.assert_allclose(energy, euler_disk_energy(CENTRED, beta), rtol=1e-3)


def test_rolling_thin_disk_needs_spin_square_of_g_over_3_r() -> None:
    r, m = 0.1, 1.0
    thin = Disk(
        radius=r, mass=m, eccentricity=0.0,
        inertia_x=m * r**2 / 4, inertia_y=m * r**2 / 4, inertia_z=m * r**2 / 2,
    )  # fmt: skip
    assert upright_rolling_spin(Scenario(disk=thin)) == pytest.approx(sqrt(GRAVITY / (3 * r)))


@pytest.mark.parametrize(("part", "stable"), [(1.05, True), (0.95, False)])
def test_upright_rolling_falls_below_the_critical_spin_only(part: float, stable: bool) -> None:
    spin = part * upright_rolling_spin(CENTRED)
    start = Start(gamma=0.0, spin=0.0, gamma_rate=spin, x_rate=-DISK.radius * spin, beta_rate=1e-3)
    sliding = Scenario.rest(disk=DISK, friction=STICKY, start=start)
    # The same with the slip held at zero: another formulation, and no friction at all.
    rolling = Scenario(constraints=ROLLING, disk=DISK, start=replace(start, x_rate=None))
    held = simulate(rolling, np.linspace(0.0, 2.5, 251), tolerance=1e-9)
    for tilt in (simulate_to_rest(sliding, 2.5, spacing=1e-2).tilt, held.coordinate("beta")):
        largest = np.max(np.abs(tilt - pi / 2))
        assert largest < 2e-3 if stable else largest > 2e-2


@pytest.mark.parametrize(("beta", "rate"), [(0.4, 20.0), (1.2, -30.0)])
def test_a_disk_without_slip_rolls_on_the_textbooks_circle(beta: float, rate: float) -> None:
    spin = axial_spin(CENTRED, beta, rate)
    start = rolling_start(DISK, beta, rate, spin)
    rolling = Scenario(constraints=ROLLING, disk=DISK, start=start)
    motion = simulate(rolling, np.linspace(0.0, 0.5, 51), tolerance=1e-10)
    np.testing.assert_allclose(motion.coordinate("beta"), beta, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(motion.rate("alpha"), rate, rtol=1e-9)
    # The centre keeps its distance from the origin, about which it circles.
    radius = np.hypot(motion.coordinate("x"), motion.coordinate("y"))
    np.testing.assert_allclose(radius, abs(DISK.radius * spin / rate), rtol=1e-8)
    np.testing.assert_allclose(motion.normal_force, WEIGHT, rtol=1e-8)


def final_stage(dissipation: Dissipation, end: float) -> SpatialMotion:
    beta = 0.1
    contact = PenaltyContact.rounded(DISK, half_thickness=2e-5)
    start = rolling_start(DISK, beta, euler_disk_precession(CENTRED, beta), 0.0)
    rest = Scenario.rest(disk=DISK, contact=contact, dissipation=dissipation, start=start)
    return simulate_to_rest(rest, end, spacing=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dissipation", "tilting", "turning"),
    [
        (Dissipation(rolling_viscous=2e-4), 1 / 2, -1 / 4),
        (Dissipation(rolling_dry=1e-3), 2 / 3, -1 / 3),
    ],
    ids=["viscous", "dry"],
)
def test_rolling_resistance_ends_in_its_power_law(
    dissipation: Dissipation, tilting: float, turning: float
) -> None:
    motion = final_stage(dissipation, 1.2)
    # The fit spans 0.08 > beta > 0.02: small angles, well above half_thickness / radius.
    leaning = motion.leaning
    part = slice(int(np.argmax(leaning < 0.08)), int(np.argmax(leaning < 0.02)))
    law = fit_power_law(motion.times[part], leaning[part])
    rate_law = fit_power_law(motion.times[part], precession(motion)[part], law.end)
    assert law.exponent == pytest.approx(tilting, abs=0.005)
    assert rate_law.exponent == pytest.approx(turning, abs=0.003)
    # The start does not sink yet, which leaves a little nutation.
    assert law.end == pytest.approx(time_to_flat(motion.scenario, 0.1), rel=0.01)
    assert law.error < 0.01
    assert law.decades > 0.8


@pytest.mark.slow
def test_pivoting_friction_alone_ends_in_no_finite_time() -> None:
    motion = final_stage(Dissipation(pivoting=1e-3), 6.0)
    width = 100
    count = motion.times.size // width * width
    beta = motion.leaning[:count].reshape(-1, width).mean(axis=1)
    rate, middle = np.diff(beta), 0.5 * (beta[1:] + beta[:-1])
    # The rate goes with a power of beta of at least one: no end.
    power = np.polyfit(np.log(middle), np.log(-rate), 1)[0]
    assert power > 1.4
    assert motion.rest_time is None
    assert motion.leaning.min() > 0.03


def test_fit_finds_the_power_law_it_was_given() -> None:
    times = np.linspace(0.0, 0.95, 200)
    law = fit_power_law(times, 0.3 * (1.0 - times) ** 0.6)
    assert (law.exponent, law.end, law.scale) == pytest.approx((0.6, 1.0, 0.3), rel=1e-5)
    with pytest.raises(ValueError, match="values must be positive, got 0"):
        fit_power_law(times, times)
    with pytest.raises(ValueError, match="end must lie behind the last time"):
        fit_power_law(times, times + 1.0, end=0.5)


LEANING = replace(CENTRED, table=Table(inclination=0.1))
BOTH = Scenario.rest(disk=DISK, dissipation=Dissipation(rolling_dry=1e-3, rolling_viscous=1e-3))


@pytest.mark.parametrize(
    ("closed_form", "given", "message"),
    [
        (euler_disk_precession, (Scenario(), 0.1), "disk must be centred"),
        (euler_disk_energy, (LEANING, 0.3), "needs a horizontal table"),
        (euler_disk_energy, (CENTRED, 0.0), "beta must lie in"),
        (axial_spin, (CENTRED, 0.3, 0.0), "precession must not be zero"),
        (time_to_flat, (BOTH, 0.1), "either rolling_dry or rolling_viscous"),
    ],
)
def test_closed_forms_refuse_what_they_do_not_hold_for(
    closed_form: Any, given: Any, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        closed_form(*given)
