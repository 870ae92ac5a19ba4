"""The end of the cycles: its spin from motions, from cycles and from the slow manifold."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from analysis import ROUNDED_STEEL_DISK, Scenario, SmoothCoulomb, Table, TanhCoulomb
from analysis.mechanics import reduced
from analysis.mechanics.paper import critical_speed
from analysis.nonlinear import heteroclinic
from analysis.nonlinear.families import cycle_family
from analysis.nonlinear.heteroclinic import (
    NoConnectionError,
    fall,
    heteroclinic_connection,
    period_growth,
)
from analysis.nonlinear.slow_manifold import needed_friction, slow_connection, slow_cycle
from analysis.stability.spectra import eigenvalues
from tests.bodies import of_six
from tests.helpers import model, mostly_slow

PAPER = model(4)
TO_THE_END = np.append((1.0, 2.0, 2.7, 3.0), np.pi - np.append(np.geomspace(9e-3, 9e-5, 4), 1e-6))

BEYOND_PI = (0.5, 1.0, 1.5, 2.0, 2.5, 2.8, 3.0, 3.14, 3.2)


def with_smoothing(smoothing: float) -> Scenario:
    return replace(PAPER, friction=SmoothCoulomb(smoothing=smoothing))


def with_eccentricity(part: float) -> Scenario:
    """A disk whose centre of gravity lies this part of its radius off its middle."""
    radius, mass = 0.045, 0.4
    offset = (part * radius) ** 2
    moments = (0.3 * radius**2, 0.25 * radius**2 + offset, 0.5 * radius**2 + offset)
    disk = of_six(radius, mass, part * radius, *(mass * each for each in moments))
    return replace(PAPER, disk=disk, friction=SmoothCoulomb(smoothing=0.01))


BESIDE = (
    (PAPER, 30.120961805),
    (replace(PAPER, disk=ROUNDED_STEEL_DISK), 30.084842472),
    (with_smoothing(1.0), 29.528215473),
)


@pytest.mark.parametrize(("scenario", "spin"), BESIDE, ids=["steel", "rounded", "saddle focus"])
def test_motions_fall_to_different_sides_of_the_connection(
    scenario: Scenario, spin: float
) -> None:
    assert fall(scenario, spin - 1e-6).side > 0.0 > fall(scenario, spin + 1e-6).side


@pytest.mark.parametrize("smoothing", mostly_slow([1e-4, 5e-5], [1e-4]))
def test_stiff_motions_fall_to_different_sides_as_near_to_it(smoothing: float) -> None:
    # It nears that on the slow manifold with the square of the smoothing.
    limit = slow_connection(PAPER).spin
    spin, scenario = limit - 11.239 * smoothing**2, with_smoothing(smoothing)
    assert fall(scenario, spin - 2e-8).side > 0.0 > fall(scenario, spin + 2e-8).side


@pytest.mark.slow
def test_cycles_end_in_the_connection() -> None:
    found = heteroclinic_connection(PAPER)
    family = cycle_family(PAPER, TO_THE_END)
    assert family.reason is None
    assert family.motions[-1].spin == pytest.approx(found.spin, abs=1e-9)
    assert found.below <= found.spin <= found.above <= found.below + 1e-10
    growth = period_growth(family.motions, found)
    assert growth["by_amplitude"] == pytest.approx(growth["predicted_by_amplitude"], rel=1e-4)
    assert found.saddle_index == -found.slow / found.growing > 1.0
    assert family.motions[-1].multiplier < 1e-3


@pytest.mark.parametrize("side", [-1e-6, 1e-6])
def test_swing_and_tilt_are_those_of_much_finer_steps(side: float) -> None:
    scenario, spin = with_smoothing(1.0), 29.528215473 + side
    found = fall(scenario, spin)
    rates = reduced.right_hand_side(scenario, spin)
    how: dict[str, Any] = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    path = solve_ivp(rates, (0.0, 5.0), found.states[0], dense_output=True, **how).sol
    beta, gamma, _ = path(np.linspace(0.0, 5.0, 500_001))
    passed = np.flatnonzero(gamma > 1.5 * np.pi)[0] + np.arange(-1, 1)
    tilt = np.interp(1.5 * np.pi, gamma[passed], beta[passed]) - np.pi / 2
    assert found.tilt == pytest.approx(tilt, abs=1e-8)
    # Back where it came from, or a turn further, and beyond the saddle before it turns back.
    assert found.states[-1, 1] == pytest.approx((0.5 if side > 0.0 else 2.5) * np.pi)
    if side > 0.0:
        assert found.swing == pytest.approx(np.max(gamma) - np.pi / 2, abs=1e-8)


LEANING = replace(PAPER, disk=replace(PAPER.disk, eccentricity=0.013))

TO_BEYOND = (1.0, 2.0, 2.7, 3.0, np.pi)
FAR: dict[str, tuple[Scenario, Any, float, Any, float]] = {
    "saddle focus": (with_smoothing(1.0), BEYOND_PI, 0.1, np.geomspace(0.03, 1e-4, 5), 1e-5),
    "large eccentricity": (with_eccentricity(0.5), TO_BEYOND, 0.3, (4e-3, 4e-4), 1e-4),
    "leaning saddle": (LEANING, None, 0.0, (), 1e-6),
}
"""Scenario, amplitudes, how far the last one is beyond pi, amplitudes before it, and accuracy."""


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=getattr(pytest.mark, "whole" if "large" in name else "slow"))
        for name in FAR
    ],
)
def test_cycles_may_swing_beyond_the_saddle_and_end_in_the_connection(name: str) -> None:
    scenario, amplitudes, beyond, before, close = FAR[name]
    found = heteroclinic_connection(scenario)
    last = found.last_amplitude
    assert last >= np.pi + beyond
    if amplitudes is not None:
        amplitudes = np.append(amplitudes, last - np.array(before))
    family = cycle_family(scenario, amplitudes)
    assert family.reason is None
    assert family.motions[-1].spin == pytest.approx(found.spin, abs=close)
    assert family.motions[-1].stable == (name != "large eccentricity")
    (told,) = eigenvalues(scenario, np.array([found.spin]), "reduced", "noninverted")
    others = found.slow + 1j * found.winding, found.strong - 1j * found.winding
    assert told == pytest.approx([found.growing, *others])


@pytest.mark.slow
def test_cycles_of_steep_friction_are_followed() -> None:
    assert cycle_family(with_smoothing(1e-3), np.linspace(0.2, 1.6, 8)).reason is None


def test_a_connection_may_lie_far_below_the_critical_speed() -> None:
    # Near the critical speed, a motion winds about inverted spinning for a hundred time constants.
    scenario = with_eccentricity(0.9)
    assert critical_speed(scenario).spin == pytest.approx(56.1063, abs=1e-4)
    falls = [fall(scenario, spin) for spin in (56.1063, 30.0, 29.471985041 + 1e-6, 29.47)]
    assert [way.side for way in falls] == [-1.0, -1.0, -1.0, 1.0]
    assert falls[2].distances.min() < 0.02 < falls[1].distances.min()


ODD = {
    # Nearer to the critical speed, motions that go over begin to fall flat.
    "beyond a fall": (
        of_six(1.040817403, 0.2145438, 6.550906455e-3, 0.07137841579, 0.170269711, 0.1169874976),
        TanhCoulomb(coefficient=0.1915908193, smoothing=0.220027975),
        16.50975476,
        5.6335293,
    ),
    # Motions come near to it as slowly as the difference in spin to the power of 0.047.
    "small saddle index": (
        of_six(
            7.69624729e-3, 0.21645421, 1.0903589962e-4, 2.9848115e-6, 6.7456629e-7, 2.7815848e-6
        ),
        TanhCoulomb(coefficient=0.4069870705, smoothing=0.04486668503),
        0.1775623744,
        13.9508499,
    ),
}
"""Disk, friction, gravity, and spin by runs of other equations."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ODD)
def test_connection_of_an_odd_disk_is_found(name: str) -> None:
    disk, friction, gravity, spin = ODD[name]
    scenario = model(4, disk=disk, friction=friction, table=Table(gravity=gravity))
    assert heteroclinic_connection(scenario).spin == pytest.approx(spin, rel=1e-7)


@pytest.mark.whole
def test_where_all_motions_turn_back_there_is_no_connection() -> None:
    with pytest.raises(NoConnectionError, match="turns back at all spins tried"):
        heteroclinic_connection(with_eccentricity(0.97))


def test_steep_friction_brings_the_cycle_to_that_on_the_slow_manifold() -> None:
    missing = []
    for smoothing in (0.01, 0.005):
        scenario = with_smoothing(smoothing)
        cycle = cycle_family(scenario, (0.5, 1.0)).motions[-1]
        slow = slow_cycle(scenario, 1.0)
        missing.append(cycle.spin - slow.spin)
        assert cycle.period == pytest.approx(slow.period, rel=1e-5)
    assert np.log(missing[0] / missing[1]) / np.log(2.0) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("coefficient", mostly_slow([0.0578, 0.06, 0.068, 0.3], [0.0578, 0.3]))
def test_connection_on_the_slow_manifold_loses_no_height_however_weak_friction_is(
    coefficient: float,
) -> None:
    scenario = replace(PAPER, friction=SmoothCoulomb(coefficient=coefficient))
    found, disk = slow_connection(scenario), scenario.disk
    low = disk.radius - disk.eccentricity

    def gain(turn: float, spin: float) -> float:
        """Slip over sin(beta), from where the centre of gravity is highest on."""
        lever = disk.radius + disk.eccentricity * np.cos(turn)
        beta = np.pi - np.arcsin(low / lever)
        (asked,) = needed_friction(scenario, spin, np.array([beta]), np.array([np.pi / 2 + turn]))
        left = coefficient - abs(asked)
        return float(asked / left / np.sin(beta)) if left > 0.0 else np.nan

    def gained(spin: float) -> float:
        # Next to its start, where friction hardly suffices, it has a peak.
        ends = (0.0, 1e-4, 1e-3, 1e-2, 0.1, np.pi)
        return sum(quad(gain, *piece, (spin,), limit=500)[0] for piece in pairwise(ends))

    spin = found.spin
    assert gained(spin - 1e-5) * gained(spin + 1e-5) < 0.0
    turns = np.linspace(0.0, np.pi, 2001)
    tilts = np.pi - np.arcsin(low / (disk.radius + disk.eccentricity * np.cos(turns)))
    asked = needed_friction(scenario, spin, tilts, np.pi / 2 + turns)
    assert coefficient > found.friction == pytest.approx(np.max(np.abs(asked)), rel=1e-6)


@pytest.mark.parametrize(
    "smoothing",
    [
        pytest.param(2e-3, marks=pytest.mark.slow),
        # By the method for stiff motions.
        pytest.param(1e-3, marks=pytest.mark.whole),
    ],
)
def test_steep_friction_brings_the_connection_to_that_on_the_slow_manifold(
    smoothing: float,
) -> None:
    # Next to the latter, two motions fall to the same side but for the error of their runs.
    found = [heteroclinic_connection(with_smoothing(each)) for each in (smoothing, smoothing / 2)]
    missing = [slow_connection(PAPER).spin - each.spin for each in found]
    assert np.log2(missing[0] / missing[1]) == pytest.approx(2.0, abs=0.01)
    assert [each.last_amplitude for each in found] == [np.pi, np.pi]


def test_a_motion_that_has_not_left_says_how_long_it_was_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(heteroclinic, "_LONGEST", 1.0)
    with pytest.raises(NoConnectionError, match=r"goes over within 0\.\d+ s: The solver"):
        fall(PAPER, 30.0)
