"""Starts that lie exactly on an unstable stationary motion are told from all others."""

from dataclasses import replace
from math import pi

import pytest

from analysis import (
    CENTRED_DISK,
    MODELS,
    POSSIBLE_SETS,
    ConstraintSet,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    Start,
    Table,
)
from analysis.data.constraint_set import set_name
from analysis.stability.critical import critical_speeds
from analysis.stability.unstable_start import unstable_start
from tests.bodies import COMPOSED, TIPPE_TOP
from tests.helpers import mostly_slow

SPINNING = Start.stationary(40.0)


def test_message_names_the_motion_its_spin_and_its_growth() -> None:
    assert unstable_start(Scenario(start=SPINNING)) == (
        "start is exactly inverted spinning, which is unstable at 40 rad/s (deviations grow with "
        "0.316 1/s): rounding decides when and to which side the disk leaves it"
    )
    message = unstable_start(Scenario(start=Start.stationary(0.0, "noninverted")))
    assert message is not None
    assert message.startswith("start is exactly noninverted spinning, which is unstable at 0")


@pytest.mark.parametrize("constraints", mostly_slow(POSSIBLE_SETS, MODELS.values()), ids=set_name)
def test_message_ends_where_the_last_pair_begins_to_decay(constraints: ConstraintSet) -> None:
    scenario = Scenario(constraints=constraints)
    crossings = critical_speeds(scenario, system="numeric").crossings
    for crossing in crossings:
        if crossing.stable_side == "above" and len(crossings) == 1:
            below, above = (
                unstable_start(replace(scenario, start=Start.stationary(crossing.spin + shift)))
                for shift in (-0.1, 0.1)
            )
            assert below is not None
            assert above is None


def test_start_beside_the_stationary_motion_is_none() -> None:
    assert unstable_start(Scenario()) is None
    least = {"beta_rate": 1e-9, "gamma_rate": 1e-9, "x": 1e-6, "x_rate": 1e-6}
    angles = dict.fromkeys(("beta", "gamma"), pi / 2 + 1e-9)
    for name, value in (angles | least).items():
        assert unstable_start(Scenario(start=replace(SPINNING, **{name: value}))) is None


def test_same_motion_told_otherwise_or_elsewhere_is_one() -> None:
    for start in (
        replace(SPINNING, gamma=5 * pi / 2),
        replace(SPINNING, alpha=2.0),
        replace(SPINNING, x=0.01, y_rate=-0.4),
        Scenario(start=SPINNING).initial_state,
    ):
        assert unstable_start(Scenario(start=start)) == unstable_start(Scenario(start=SPINNING))


def test_start_on_a_penalty_contact_is_one_at_any_height() -> None:
    for height in (None, 0.005):
        resting = Scenario.rest(start=replace(SPINNING, height=height))
        assert unstable_start(resting) == unstable_start(Scenario(start=SPINNING))
    hard = Scenario(contact=PenaltyContact(stiffness=2e5), start=SPINNING)
    assert unstable_start(hard) is not None


def test_stable_motion_leaning_table_and_another_body_are_none() -> None:
    assert unstable_start(Scenario(constraints=MODELS[4], start=SPINNING)) is None
    assert unstable_start(Scenario(table=Table(inclination=0.1), start=SPINNING)) is None
    for body in (COMPOSED, TIPPE_TOP):
        assert unstable_start(Scenario(disk=body, start=SPINNING)) is None


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids=set_name)
def test_neutral_motion_of_a_round_disk_is_none(constraints: ConstraintSet) -> None:
    """All eigenvalues are zero or imaginary without friction, some of them defective zeros."""
    scenario = Scenario(
        constraints=constraints,
        disk=CENTRED_DISK,
        friction=SmoothCoulomb(coefficient=0.0),
        start=Start(gamma=0.3, gamma_rate=None, spin=40.0),
    )
    assert unstable_start(scenario) is None


def test_round_disk_stands_at_any_angle() -> None:
    start = Start(gamma=0.3, gamma_rate=0.0, spin=10.0)
    message = unstable_start(Scenario(disk=CENTRED_DISK, start=start))
    assert message is not None
    assert message.startswith("start is exactly upright spinning, which is unstable at 10 rad/s")
    assert unstable_start(Scenario(start=start)) is None


def test_friction_however_fine_is_taken() -> None:
    friction = SmoothCoulomb(smoothing=1e-8, load="contact")
    assert unstable_start(Scenario(friction=friction, start=Start.stationary(5.0))) is not None
