"""Linearisation by dual numbers against printed matrices and the engine; unstable starts."""

import itertools
import math
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from analysis import (
    CENTRED_DISK,
    MODELS,
    MOTIONS,
    POSSIBLE_SETS,
    STEEL_DISK,
    AnisotropicCoulomb,
    ConstraintSet,
    Dissipation,
    Level,
    Motion,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.mechanics import paper
from analysis.problem.constraints import set_name
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import (
    ComplexArray,
    unstable_start,
)
from analysis.stability.spectra import System, eigenvalues, full_matrices
from tests.bodies import BODIES, COMPOSED, TIPPE_TOP
from tests.helpers import model, not_none, random_disk
from tests.wayward_law import Pushing

SPINS = np.array([0.0, 5.0, 30.0, 60.0])


def gap(found: ComplexArray, expected: ComplexArray) -> float:
    """Largest distance of an eigenvalue to the nearest expected one, relative to the largest."""
    nearest = np.min(np.abs(found[:, :, None] - expected[:, None, :]), axis=2)
    return float(np.max(nearest) / np.max(np.abs(expected)))


@pytest.mark.parametrize(("level", "system"), [(1, "full"), (3, "reduced"), (4, "reduced")])
@pytest.mark.parametrize("motion", MOTIONS)
def test_linearisation_has_the_eigenvalues_of_the_printed_matrices(
    motion: Motion, level: Level, system: System
) -> None:
    disks = (STEEL_DISK, CENTRED_DISK, random_disk(np.random.default_rng(0)))
    # It is as good at a spin far from those it is made of.
    for disk, spins in itertools.product(disks, (SPINS, np.array([-40.0, 2e3]))):
        numeric = eigenvalues(model(level, disk=disk), spins, "numeric", motion)
        other = model(1 if level == 1 else 4, disk=disk)
        printed = eigenvalues(other, spins, system, motion)
        assert gap(numeric, printed) < (1e-10 if level == 1 else 1e-11)


@pytest.mark.parametrize("motion", MOTIONS)
def test_on_a_hard_table_rolling_resistance_damps_the_turning_of_the_printed_system(
    motion: Motion,
) -> None:
    """Its moment on gamma is that part of the weight times r² times the rate of gamma."""
    loss, law = Dissipation(rolling_viscous=0.2, rolling_dry=1e-3), SmoothCoulomb(load="contact")
    hard = PenaltyContact.damped(1e9, STEEL_DISK)
    scenario = Scenario(contact=hard, dissipation=loss, friction=law)
    damping = (0.2 + 1e-3 / loss.rolling_smoothing) * scenario.weight * STEEL_DISK.radius**2
    mass = paper.printed_matrices(paper.paper_numbers(Scenario(), motion))["M"]
    damped = full_matrices(Scenario(), SPINS, motion)
    damped[:, 2:, 5] -= np.linalg.solve(mass, (0.0, 0.0, 0.0, damping))
    found = eigenvalues(scenario, SPINS, motion=motion)
    # Beside those of the contact, and of the drift.
    slow = np.sort_complex(np.linalg.eigvals(damped))
    nearest = np.min(np.abs(found[:, :, None] - slow[:, None, :]), axis=1)
    assert np.max(nearest) < 3e-4
    assert np.all(np.sort(np.abs(found))[:, -2:] > 1e4)


@pytest.mark.parametrize("smoothing", [1e-5, 1e-8])
def test_friction_may_bend_as_finely_as_it_likes(smoothing: float) -> None:
    scenario = Scenario(friction=SmoothCoulomb(coefficient=1e-4, smoothing=smoothing))
    # A slip of 1e-16 m/s, which rounding leaves at pi / 2, is that part of the smoothing.
    numeric, printed = (eigenvalues(scenario, SPINS, each) for each in ("numeric", "full"))
    assert gap(numeric, printed) < 1e-15 / smoothing


def test_law_without_one_slope_is_linearised_where_no_system_is_asked_for() -> None:
    law = AnisotropicCoulomb(along=0.3, across=0.3)
    expected = eigenvalues(Scenario(), SPINS, "numeric")
    assert eigenvalues(Scenario(friction=law), SPINS) == pytest.approx(expected, abs=1e-9)


SPINNING = Start.stationary(40.0)
SLIPPING: ConstraintSet = ("contact", "no-slip-across")


def test_message_names_the_motion_its_spin_and_its_growth() -> None:
    assert unstable_start(Scenario(start=SPINNING)) == (
        "start is exactly inverted spinning, which is unstable at 40 rad/s (deviations grow with "
        "0.316 1/s): rounding decides when and to which side the disk leaves it"
    )
    for scenario, words in (
        (Scenario(start=Start.stationary(0.0, "noninverted")), "noninverted spinning, which"),
        # A round disk stands at any angle.
        (
            Scenario(disk=CENTRED_DISK, start=Start(gamma=0.3, gamma_rate=0.0, spin=10.0)),
            "upright spinning, which is unstable at 10 rad/s",
        ),
    ):
        assert f"start is exactly {words}" in not_none(unstable_start(scenario))


@pytest.mark.parametrize("constraints", [MODELS[2], MODELS[4], SLIPPING], ids=set_name)
def test_message_ends_where_the_last_pair_begins_to_decay(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    (crossing,) = critical_speeds(scenario, system="numeric").crossings
    below, above = (
        unstable_start(replace(scenario, start=Start.stationary(crossing.spin + shift)))
        for shift in (-0.1, 0.1)
    )
    assert (below is None, above is None) == (False, True)


def test_same_motion_told_otherwise_elsewhere_or_on_a_penalty_contact_is_one() -> None:
    expected = unstable_start(Scenario(start=SPINNING))
    for start in (
        replace(SPINNING, gamma=5 * pi / 2),
        replace(SPINNING, alpha=2.0),
        replace(SPINNING, x=0.01, y_rate=-0.4),
        Scenario(start=SPINNING).initial_state,
    ):
        assert unstable_start(Scenario(start=start)) == expected
    for height in (None, 0.005):
        resting = Scenario.rest(start=replace(SPINNING, height=height))
        assert unstable_start(resting) == expected
    alike = AnisotropicCoulomb(along=0.3, across=0.3)
    assert unstable_start(Scenario(friction=alike, start=SPINNING)) == expected
    hard = Scenario(contact=PenaltyContact(stiffness=2e5), start=SPINNING)
    steep = SmoothCoulomb(smoothing=1e-8, load="contact")
    for scenario in (hard, Scenario(friction=steep, start=Start.stationary(5.0))):
        assert unstable_start(scenario) is not None


def test_rolling_resistance_and_a_round_rim_move_the_limit_of_stability() -> None:
    def told(loss: Dissipation, half_thickness: float, start: Start) -> str | None:
        contact = PenaltyContact.damped(1e6, STEEL_DISK, half_thickness=half_thickness)
        return unstable_start(Scenario(contact=contact, dissipation=loss, start=start))

    rolls = Dissipation(rolling_viscous=0.3, pivoting=1e-4)
    assert told(rolls, 2e-4, SPINNING) is None
    assert "at 35 rad/s" in not_none(told(rolls, 2e-4, Start.stationary(35.0)))
    # A ball whose centre of gravity is low.
    assert told(Dissipation(), STEEL_DISK.radius, Start.stationary(1.0, "noninverted")) is None


BESIDE = {"beta_rate": 1e-9, "gamma_rate": 1e-9, "x": 1e-6, "x_rate": 1e-6}
BESIDE |= dict.fromkeys(("beta", "gamma"), pi / 2 + 1e-9)
FLOATS_ALONE = Pushing(says=lambda x, y, n: (-math.fabs(n) * x, -math.fabs(n) * y))


def test_all_others_are_none() -> None:
    """Beside the motion, on a leaning table, of another body, stable, neutral, unknown or none."""
    starts = [*(replace(SPINNING, **{name: value}) for name, value in BESIDE.items()), Start()]
    others = [Scenario(start=start) for start in starts]
    others += [Scenario(disk=body, start=SPINNING) for body in (COMPOSED, TIPPE_TOP)]
    others.append(Scenario(disk=BODIES["sphere"], start=Start.stationary(1.0)))
    others.append(Scenario(constraints=MODELS[4], start=SPINNING))
    others += [Scenario(table=Table(inclination=each), start=SPINNING) for each in (1e-9, 0.1)]
    others.append(Scenario(start=Start(gamma=0.3, gamma_rate=0.0, spin=10.0)))
    others.append(Scenario(friction=FLOATS_ALONE, start=SPINNING))
    # Of an oblique axis of inertia.
    others.append(Scenario(disk=replace(STEEL_DISK, eccentricity=0.0)))
    # All eigenvalues are zero or imaginary without friction, some of them defective zeros.
    slippery, standing = SmoothCoulomb(coefficient=0.0), Start(gamma=0.3, gamma_rate=None, spin=40)
    round_disk = Scenario(disk=CENTRED_DISK, friction=slippery, start=standing)
    others += [replace(round_disk, constraints=held) for held in POSSIBLE_SETS]
    assert [unstable_start(each) for each in others] == [None] * len(others)
