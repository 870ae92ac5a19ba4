"""Rolling of a centred disk: the textbook's closed forms against equations and motions."""

from dataclasses import replace
from math import log10, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from analysis import CENTRED_DISK as DISK
from analysis import GRAVITY, Dissipation, Scenario, simulate
from analysis.stability.stationary_rolling import (
    axial_spin,
    euler_disk_precession,
    fit_power_law,
    rolling_start,
    time_to_flat,
    upright_rolling_spin,
)
from tests.bodies import of_six
from tests.helpers import ROLLING, mostly_slow
from validation.studies.rest import closed_forms

CENTRED = Scenario(disk=DISK)
CASES = closed_forms.cases()


@pytest.mark.parametrize("name", mostly_slow(CASES, [*closed_forms.STAGES, "rolling"]))
def test_motions_to_rest_keep_to_the_textbook_on_friction_that_hardly_slips(name: str) -> None:
    rows = closed_forms.measure(CASES[name])
    assert rows
    for row in rows:
        assert row["value"] == pytest.approx(row["exact"], rel=closed_forms.CLOSE, abs=0.0), row


def test_closed_forms_have_the_limits_of_the_textbook() -> None:
    for beta in (0.05, 1.0):
        rate = euler_disk_precession(CENTRED, beta)
        assert axial_spin(CENTRED, beta, rate) == pytest.approx(0.0)
    r, m = 0.1, 1.0
    thin = Scenario(disk=of_six(r, m, 0.0, m * r**2 / 4, m * r**2 / 4, m * r**2 / 2))
    assert upright_rolling_spin(thin) == pytest.approx(sqrt(GRAVITY / (3 * r)))


@pytest.mark.parametrize(("beta", "rate"), [(0.4, 20.0), (1.2, -30.0)])
def test_a_disk_without_slip_rolls_on_the_textbooks_circle(beta: float, rate: float) -> None:
    spin = axial_spin(CENTRED, beta, rate)
    start = rolling_start(DISK, beta, rate, spin)
    rolling = replace(CENTRED, constraints=ROLLING, start=start)
    motion = simulate(rolling, np.linspace(0.0, 0.5, 51), tolerance=1e-10)
    np.testing.assert_allclose(motion.coordinate("beta"), beta, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(motion.rate("alpha"), rate, rtol=1e-9)
    # The centre keeps its distance from the origin, about which it circles.
    radius = np.hypot(motion.coordinate("x"), motion.coordinate("y"))
    np.testing.assert_allclose(radius, abs(DISK.radius * spin / rate), rtol=1e-8)
    np.testing.assert_allclose(motion.normal_force, CENTRED.weight, rtol=1e-8)


def test_fit_finds_the_power_law_it_was_given() -> None:
    times = np.linspace(0.0, 0.95, 200)
    law = fit_power_law(times, 0.3 * (1.0 - times) ** 0.6)
    assert law == pytest.approx((0.6, 1.0, 0.0, log10(20.0)), rel=1e-5, abs=1e-6)
    for values in ((151.0 - times) ** 0.5, np.exp(-times)):
        with pytest.raises(ArithmeticError, match="follow no power of a time to go"):
            fit_power_law(times, values)


@pytest.mark.parametrize("smoothing", [1e-6, 0.3])
def test_time_to_flat_is_that_of_the_energy_that_dry_rolling_takes(smoothing: float) -> None:
    loss = Dissipation(rolling_dry=1e-3, rolling_smoothing=smoothing)
    scenario = Scenario.rest(disk=DISK, dissipation=loss)

    def slowness(beta: float) -> float:
        contour = DISK.radius * euler_disk_precession(scenario, beta)
        power = 1e-3 * scenario.weight * contour**2 / (contour + smoothing)
        return 1.5 * scenario.weight * DISK.radius / power

    assert time_to_flat(scenario, 0.01) == pytest.approx(quad(slowness, 0.0, 0.01)[0], rel=1e-4)
