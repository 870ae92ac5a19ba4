"""Starts on a rounded rim: in touch with the table, whatever the tilt and its rate."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from analysis import STEEL_DISK, PenaltyContact, Scenario, Start
from analysis.problem.choices import SOURCES, Source
from validation.run import run_to_rest

SIDES = pytest.mark.parametrize("source", SOURCES)


@SIDES
def test_start_in_touch_carries_the_weight_and_does_not_move_from_the_table(
    source: Source,
) -> None:
    random = np.random.default_rng(7)
    for half_thickness in (2e-4, 5e-3, STEEL_DISK.radius):
        rim = PenaltyContact.rounded(STEEL_DISK, half_thickness=half_thickness)
        # The damper tells the rate of the gap to the last digits.
        contact = replace(rim, damping=50.0 * rim.damping)
        for beta in (0.005, 0.02, *random.uniform(0.1, pi - 0.1, 4)):
            start = Start(
                beta=float(beta),
                gamma=float(random.uniform(-pi, pi)),
                spin=float(random.uniform(-40.0, 40.0)),
                beta_rate=float(random.uniform(-20.0, 20.0)),
            )
            scenario = Scenario.rest(contact=contact, start=start)
            motion = run_to_rest(scenario, 2e-4, source=source, spacing=1e-4, tolerance=1e-2)
            assert motion.normal_force[0] == pytest.approx(scenario.weight, rel=1e-7), start


@SIDES
def test_tilting_start_on_a_rounded_rim_does_not_open_the_contact(source: Source) -> None:
    start = Start(beta=0.005, gamma=-pi / 2, spin=0.0, beta_rate=1.5)
    motion = run_to_rest(Scenario.rest(start=start), 2e-3, source=source, spacing=1e-4)
    assert motion.normal_force.min() > 0.0
