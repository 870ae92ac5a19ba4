"""Engine against in-house equations."""

import pytest

from validation.studies import crosscheck
from validation.studies.crosscheck import Case


def name(case: Case) -> str:
    return "-".join(map(str, case))


@pytest.mark.parametrize("case", crosscheck.cases(), ids=name)
def test_accelerations_agree_at_random_states(case: Case) -> None:
    check = crosscheck.check_accelerations(case, states=20, seed=7)
    assert check.accelerations <= crosscheck.ACCELERATION_LIMIT
    assert check.multipliers <= crosscheck.ACCELERATION_LIMIT
    assert check.passed


@pytest.mark.slow
@pytest.mark.parametrize("case", crosscheck.cases(), ids=name)
def test_accelerations_agree_at_a_thousand_random_states(case: Case) -> None:
    assert crosscheck.check_accelerations(case, states=1000).passed


QUICK: list[Case] = [
    (1, "contact-tree", "weight"),
    (1, "floating", "weight"),
    (2, "euler-tree", "contact"),
    (3, "floating-lie", "weight"),
    (4, "euler-tree", "weight"),
]


def check_trajectory(case: Case) -> None:
    check = crosscheck.check_trajectory(case)
    assert check.angles <= crosscheck.ANGLE_LIMIT
    # The difference holds the error of the in-house run as well.
    assert check.estimate + crosscheck.REFERENCE_TOLERANCE >= check.angles
    assert check.normal_force <= 2e-7
    assert check.order == pytest.approx(check.expected, abs=0.25)


@pytest.mark.parametrize("case", QUICK, ids=name)
def test_trajectories_agree(case: Case) -> None:
    check_trajectory(case)


@pytest.mark.slow
@pytest.mark.parametrize("case", [c for c in crosscheck.cases() if c not in QUICK], ids=name)
def test_trajectories_agree_for_every_other_scene(case: Case) -> None:
    check_trajectory(case)
