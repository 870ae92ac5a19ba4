"""Many runs at once: the same as single ones, and each on its own."""

import os
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest

from analysis import Scenario, Start, State, ToleranceError, Trajectory, simulate, simulate_many
from analysis.data.endings import CONTACT_WOULD_PULL
from tests.helpers import model

TIMES = np.linspace(0.0, 0.2, 21)
SPINS = (20.0, 30.0, 40.0, 50.0, 60.0)


def spinning(spin: float) -> Scenario:
    return model(4, start=Start(spin=spin))


def test_members_are_those_of_single_runs_in_order() -> None:
    members = [spinning(spin) for spin in SPINS]
    told: list[tuple[int, int]] = []
    with ThreadPoolExecutor(2) as threads:
        outcomes = simulate_many(
            members,
            TIMES,
            form="reduced",
            method="DOP853",
            executor=threads,
            progress=lambda *counts: told.append(counts),
        )
    assert told[-1] == (5, 5)
    for member, outcome in zip(members, outcomes, strict=True):
        assert isinstance(outcome, Trajectory)
        single = simulate(member, TIMES, form="reduced")
        np.testing.assert_array_equal(outcome.coordinates, single.coordinates)
        assert outcome.scenario == member


def test_each_member_has_its_own_tolerance_and_end() -> None:
    members = [model(1), model(1), model(1, start=Start(spin=200.0))]
    fine, hopeless, pulling = simulate_many(
        members, TIMES, method="DOP853", tolerance=[1e-6, 1e-16, 1e-6], workers=1
    )
    assert isinstance(fine, Trajectory)
    assert fine.method["tolerance"] == 1e-6
    assert isinstance(hopeless, ToleranceError)
    assert isinstance(pulling, Trajectory)
    assert pulling.ending is not None
    assert pulling.ending.reason == CONTACT_WOULD_PULL


def killer(_: State) -> float:
    os._exit(1)


@pytest.mark.slow
def test_members_of_a_killed_process_say_so() -> None:
    outcomes = simulate_many([model(4)] * 3, TIMES, method="DOP853", stop_when=killer, workers=2)
    assert [type(outcome) for outcome in outcomes] == [BrokenProcessPool] * 3
