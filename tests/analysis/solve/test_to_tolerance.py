"""Runs are made with smaller and smaller errors in a step until two of them agree."""

import numpy as np
import pytest

from analysis import Scenario, ToleranceError
from analysis.motion.endings import TIME_LIMIT
from analysis.problem.checks import Array
from analysis.problem.elementary import Rows
from analysis.simulation.formulations import pose
from analysis.simulation.request import TIGHTEST_LOCAL_TOLERANCE
from analysis.solve.stepping import Run
from analysis.solve.to_tolerance import Runs, agree, estimated_errors, run_to, tighter_and_tighter

TIMES = np.linspace(0.0, 0.6, 7)


@pytest.mark.parametrize("first", [1e-3, 1e-13, 1e-16])
def test_compared_runs_share_neither_their_local_tolerance_nor_their_longest_step(
    first: float,
) -> None:
    # Two runs of nearly the same one agree without being right.
    used: list[tuple[float, float]] = []

    def never_agree(*how: float) -> Run:
        used.append(how)  # type: ignore[arg-type]
        return Run(TIMES, np.full((TIMES.size, 12), float(len(used))), 1, None, ())

    rungs = tighter_and_tighter(first, TIGHTEST_LOCAL_TOLERANCE)
    problem, _ = pose(Scenario(), "index-1", {})
    message = r"^tolerance 1e-06 rad cannot be reached with none: .* is 2\.0e\+00 rad$"
    with pytest.raises(ToleranceError, match=message):
        run_to(never_agree, problem, TIMES, 1e-6, rungs, method="none")
    local, longest = np.transpose(used)
    assert local[-1] == TIGHTEST_LOCAL_TOLERANCE
    assert np.min(local[:-1] / local[1:]) >= 3.0
    assert np.max(longest[1:] / longest[:-1]) <= 0.9


def test_every_member_keeps_the_run_that_agreed_with_the_one_before() -> None:
    # Of three members one agrees at once, one later and one never.
    errors = {1e-9: (1e-5, 1e-3, 1e-3), 1e-12: (0.0, 1e-5, 1e-3)}

    def run(members: Rows, _: float, longest: float) -> tuple[Runs, dict[int, Exception]]:
        runs = Runs.empty(members.size, TIMES, 1)
        runs.states[:], runs.steps[:] = longest, 1
        return runs, {}

    def estimated(fine: Runs, _: Runs, members: Rows) -> Array:
        return np.array(errors[float(fine.local_tolerances[0])])[members]

    found, failures = agree(run, estimated, 3, 1e-4, (1e-6, *errors), method="none")
    assert found.local_tolerances[:2].tolist() == [*errors]
    assert found.steps[:2].tolist() == [2, 3]
    assert found.states[1, 0, 0] < found.states[0, 0, 0] < 1.0
    assert {member: type(error) for member, error in failures.items()} == {2: ToleranceError}


def test_a_run_out_of_time_is_judged_by_what_both_have_beyond_the_start() -> None:
    fine, coarse = (Runs.empty(3, TIMES, 2) for _ in range(2))
    for each, error in ((fine, 0.0), (coarse, 1e-7)):
        each.states[:] = each.last[:] = error
    fine.reasons[:], fine.ends[:], coarse.ends[2] = TIME_LIMIT, TIMES[:3], TIMES[1]
    found = estimated_errors(fine, coarse, slice(None), lambda each: each.last)
    assert found.tolist() == [np.inf, pytest.approx(2e-7), np.inf]


def test_a_run_cut_to_its_samples_has_pulled_no_longer_than_that() -> None:
    runs = Runs.empty(1, TIMES, 1)
    runs.ends[0], runs.pulling[0] = 0.38, ((0.1, 0.2), (0.25, 0.34), (0.36, 0.38))
    runs.cut_to_samples(np.array([True]))
    assert runs.run(0).pulling == ((0.1, 0.2), (0.25, TIMES[3]))
