"""Disks that fall: they end flat when they lie flat, or pass nearly flat and go on."""

from collections.abc import Callable
from math import cos, sin, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import analysis
import mbs_models
from analysis import CENTRED_DISK, STEEL_DISK, Level, Scenario, SmoothCoulomb, Start, Trajectory
from analysis.data import limits
from analysis.data.endings import FLAT
from analysis.data.limits import LEAST_TILT
from mbs_models import Formulation, Integrator, Scene
from tests.helpers import model, not_none

Run = Callable[..., Trajectory]


def engine(formulation: Formulation) -> Run:
    return lambda scenario, *given, **how: mbs_models.simulate(
        Scene(scenario, formulation), *given, **how
    )


RUNS: dict[str, Run] = {
    "in-house": analysis.simulate,
    "contact-tree": engine("contact-tree"),
    "euler-tree": engine("euler-tree"),
}

FALLS = {
    name: Scenario(disk=disk, friction=SmoothCoulomb(coefficient=0.0), start=start)
    for name, disk, start in (
        ("centred", CENTRED_DISK, Start(spin=0.0, beta=0.1)),
        ("low", STEEL_DISK, Start(spin=0.0, beta=0.1, gamma=-np.pi / 2)),
        ("high", STEEL_DISK, Start(spin=0.0, beta=1.0, gamma=-np.pi / 2)),
    )
}
"""Without friction and spin, and with the centre of gravity right above the contact's edge."""

HIDDEN = Scenario(start=Start(spin=0.0, beta=0.1))
"""It seems to fall flat, passes within 1.4e-4 rad of it and rises again."""


def time_of_fall(scenario: Scenario) -> float:
    """Time in s in which a disk falls flat without turning, from its energy, by quadrature."""
    disk, gravity = scenario.disk, scenario.table.gravity
    first = scenario.initial_state.coordinates[4]
    arm = disk.radius - disk.eccentricity
    inertia = disk.inertia_about_cog[1 if disk.eccentricity else 0] / disk.mass

    def slowness(root: float) -> float:
        tilt = first - root**2
        drop = sin(first) - sin(tilt)
        return 2.0 * root * sqrt((inertia + (arm * cos(tilt)) ** 2) / (2.0 * gravity * arm * drop))

    found = quad(slowness, 0.0, sqrt(first - LEAST_TILT), epsabs=1e-13, epsrel=1e-13)
    return float(found[0])


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
@pytest.mark.parametrize("scenario", FALLS.values(), ids=FALLS)
@pytest.mark.parametrize("times", [[0.0, 1.0], np.linspace(0.0, 1.0, 201)], ids=len)
def test_disk_ends_flat_when_it_lies_flat(run: Run, scenario: Scenario, times: Any) -> None:
    ending = not_none(run(scenario, times).ending)
    assert ending.reason == FLAT
    assert ending.time == pytest.approx(time_of_fall(scenario), abs=1e-7)


def test_disk_that_passes_nearly_flat_goes_on_alike_on_both_sides() -> None:
    sides = {"in-house": 1e-6, "contact-tree": 1e-4}
    found = [RUNS[side](HIDDEN, [0.0, 0.05], tolerance=asked) for side, asked in sides.items()]
    assert [run.ending for run in found] == [None, None]
    assert np.abs(found[0].coordinates - found[1].coordinates)[:, 4:].max() < 2e-6


@pytest.mark.parametrize("level", [1, 2, 3])
def test_rates_that_grow_near_flat_are_in_the_way_of_no_tolerance(level: Level) -> None:
    low = model(level, start=Start(spin=0.0, beta=0.1))
    coarse, fine = (
        analysis.simulate(low, [0.0, 0.1], tolerance=tolerance) for tolerance in (1e-5, 1e-9)
    )
    assert fine.counts["right_hand_sides"] < 100_000
    assert coarse.ending is None is fine.ending
    assert np.abs(coarse.coordinates - fine.coordinates)[:, 4:].max() < 1e-5


DOPRI5 = Integrator(name="DOPRI5", local_tolerance=1e-12)


@pytest.mark.parametrize(
    ("side", "how"), [("in-house", {}), ("contact-tree", {"integrator": DOPRI5})]
)
def test_run_that_takes_far_more_steps_than_expected_says_where_and_alike_each_time(
    side: str, how: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limits, "SPARE_SECONDS", 1e-3)
    said = []
    for _ in range(2):
        with pytest.raises(ArithmeticError, match=r"steps, far more than expected") as caught:
            RUNS[side](HIDDEN, [0.0, 0.05], **how)
        said.append(str(caught.value))
    assert said[0] == said[1]
    assert "at t = 0.0" in said[0]
    if side == "in-house":
        # A time limit lets it take more.
        assert analysis.simulate(HIDDEN, [0.0, 0.05], time_limit=1e6).ending is None
