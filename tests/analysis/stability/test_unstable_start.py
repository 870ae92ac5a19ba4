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
from analysis.problem.constraints import set_name
from analysis.stability.critical import critical_speeds
from analysis.stability.linearisation import unstable_start
from tests.bodies import COMPOSED, TIPPE_TOP
from tests.helpers import not_none

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
    hard = Scenario(contact=PenaltyContact(stiffness=2e5), start=SPINNING)
    steep = SmoothCoulomb(smoothing=1e-8, load="contact")
    for scenario in (hard, Scenario(friction=steep, start=Start.stationary(5.0))):
        assert unstable_start(scenario) is not None


BESIDE = {"beta_rate": 1e-9, "gamma_rate": 1e-9, "x": 1e-6, "x_rate": 1e-6}
BESIDE |= dict.fromkeys(("beta", "gamma"), pi / 2 + 1e-9)


def test_all_others_are_none() -> None:
    """Beside the motion, on a leaning table, of another body, stable or neutral, or of none."""
    starts = [*(replace(SPINNING, **{name: value}) for name, value in BESIDE.items()), Start()]
    others = [Scenario(start=start) for start in starts]
    others += [Scenario(disk=body, start=SPINNING) for body in (COMPOSED, TIPPE_TOP)]
    others.append(Scenario(constraints=MODELS[4], start=SPINNING))
    others.append(Scenario(table=Table(inclination=0.1), start=SPINNING))
    others.append(Scenario(start=Start(gamma=0.3, gamma_rate=0.0, spin=10.0)))
    # All eigenvalues are zero or imaginary without friction, some of them defective zeros.
    slippery, standing = SmoothCoulomb(coefficient=0.0), Start(gamma=0.3, gamma_rate=None, spin=40)
    round_disk = Scenario(disk=CENTRED_DISK, friction=slippery, start=standing)
    others += [replace(round_disk, constraints=held) for held in POSSIBLE_SETS]
    assert [unstable_start(each) for each in others] == [None] * len(others)
