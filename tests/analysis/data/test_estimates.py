"""How sharp the error estimate of the engine's runs can be."""

import pytest

from validation.studies.robustness.estimates import Halved, Rung, halved, table
from validation.studies.robustness.random_scenarios import draws

# Errors a tenth of their estimates, but once, where they are nine tenths.
TYPICAL = Halved([Rung(100, 1e-2, 1e-3), Rung(300, 1e-4, 1e-5), Rung(700, 1e-6, 1e-7)], 1e-12)
HARD = Halved([Rung(100, 1e-2, 1e-3), Rung(300, 1e-4, 9e-5), Rung(700, 1e-6, 1e-7)], 1e-12)


def test_rung_is_accepted_by_its_estimate_over_the_factor_or_by_its_error() -> None:
    tolerance = 2e-5
    found = [TYPICAL.accepted(tolerance, factor) for factor in (1.0, 4.0, 8.0, None)]
    assert [rung.steps for rung in found if rung] == [700, 700, 300, 300]
    assert TYPICAL.accepted(1e-8, None) is None


def test_sharper_estimate_breaks_the_promise_of_the_motion_whose_error_comes_close_to_it() -> None:
    rows = {row[0]: row[1:] for row in table([TYPICAL, HARD]).rows}
    assert [rows[each][1] for each in ("1", "4", "16", "error known")] == [0, 1, 2, 0]
    assert rows["1"][3] == 1.0
    steps = [rows[each][3] for each in ("1", "2", "4", "16")]
    assert steps == sorted(steps, key=lambda mean: -float(mean or 0.0))


def test_promise_is_broken_also_where_the_present_estimate_makes_none() -> None:
    late = Halved([*TYPICAL.rungs[:2], Rung(700, 1e-6, 9e-7)], 1e-12)
    rows = {row[0]: row[1:] for row in table([late]).rows}
    assert [rows[each][1] for each in ("1", "4")] == [0, 1]


def test_doubtful_reference_is_not_asked_about_finer_tolerances() -> None:
    doubtful = Halved(TYPICAL.rungs, doubt=1e-6)
    assert table([doubtful]).rows[0][1] < table([TYPICAL]).rows[0][1]  # type: ignore[operator]


@pytest.mark.slow
def test_estimates_of_a_random_motion_are_no_smaller_than_its_errors() -> None:
    motions = [motion for motion in map(halved, draws(4, 1)) if motion is not None]
    rungs = [(rung, motion.doubt) for motion in motions for rung in motion.rungs]
    assert len(rungs) > 4
    assert all(rung.error <= rung.estimate + doubt for rung, doubt in rungs)
