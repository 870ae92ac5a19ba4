"""Error against run time: what its ladders, orders and cheapest ways tell, and what fails it."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pandas as pd
import pytest

from tests.helpers import failing, not_none, planted
from validation import study as studying
from validation.studies.work_precision import measuring
from validation.studies.work_precision import section as wp
from validation.studies.work_precision.measuring import Curve, errors, ladder_end, reference

REFERENCES, CURVES = wp.STUDIES

FLOOR = 1e-11


@pytest.mark.parametrize(
    ("judged", "end"),
    [
        ([1e-2, 1e-5], None),
        ([1e-2, 9e-10], "goal"),
        ([inf, inf, inf], None),
        ([1e-2, inf, inf], "failure"),
    ],
)
def test_a_ladder_ends_where_finer_rungs_bring_nothing(
    judged: list[float], end: str | None
) -> None:
    assert ladder_end(judged) == end


def test_the_order_of_a_ladder_is_its_slope_where_errors_are_useful_and_measurable() -> None:
    sizes = [inf, 0.5, *(0.05 * 16.0**-k for k in range(5)), FLOOR / 2, FLOOR / 3]
    ladder = {"problem": "model-1", "formulation": "contact-tree", "scheme": "RK44"}
    runs = pd.DataFrame({**ladder, "kind": "step", "error": sizes})
    told = wp.orders(runs, {"model-1": FLOOR}).to_dict("records")
    assert [(row["pairs of rungs"], row["order"]) for row in told] == [(4, 4)]
    assert told[0]["observed"] == pytest.approx(4.0)


def test_the_fastest_ways_stand_under_the_side_that_has_taken_them() -> None:
    told = wp.ways(wp.prepared(studying.load(CURVES)))
    assert told["in the engine"].str.startswith(("contact-tree", "euler-tree", "floating")).any()
    assert told["in-house"].str.startswith(("index-1", "reduced")).any()
    assert not told["in-house"].str.contains("tree|floating").any()


def test_runs_to_a_tolerance_are_judged_by_the_cheapest_that_would_have_done() -> None:
    ladder = {"problem": "model-1", "formulation": "contact-tree", "scheme": "RK44"}
    goal, parts = measuring.GOALS[0], np.array((0.5, 2.0, 0.1, 4.0, inf))
    runs = pd.DataFrame({"kind": ["step"] * 2 + ["tolerance"] * 3, "work": [40, 10, 100, 70, 0]})
    errors = {"error": parts * goal, "angle_error": 0.5 * parts * goal}
    found = wp.asked(runs.assign(**ladder, **errors, setting=goal, failed=parts == inf))
    np.testing.assert_allclose(found["ratio"], [0.05, 2.0, nan])
    np.testing.assert_array_equal(found["excess"], [2.5, nan, nan])
    assert found["worse"].tolist() == [False, True, False]


def test_everything_stored_holds_but_for_what_is_broken_in_doubt_or_of_another_order() -> None:
    rows = {study.name: studying.load(study) for study in wp.STUDIES}
    assert set(rows["work-precision"]["case"]) == set(measuring.curves())
    content = wp.present(rows)
    assert not failing(content.checks)
    assert content.figures["fronts"]().axes
    references, runs = (rows[study.name] for study in wp.STUDIES)
    asked, doubted = runs["kind"] == "tolerance", references["case"] == "model-2"
    steeper = runs.copy()
    steeper.loc[runs["scheme"] == "trapezoidal", "error"] **= 1.5
    for study, table, check in (
        (CURVES, planted(runs, asked.idxmax(), "angle_error", 2.0), "error over tolerance"),
        (REFERENCES, planted(references, doubted.idxmax(), "difference", 1e-8), "floor of"),
        (CURVES, steeper, "order of trapezoidal"),
    ):
        found = failing(wp.present({**rows, study.name: table}).checks)
        assert {check in each for each in found} == {True}


def test_an_extrapolated_run_is_better_than_its_parts() -> None:
    curve, truth = Curve("model-1", "contact-tree", "RK44"), reference("model-1")
    runs = [(step, curve.run(step, "step")[0]) for step in (0.01, 0.005, 0.0025)]
    better, run = measuring.extrapolated(curve, runs), runs[-1][1]
    assert errors(not_none(better), truth)["error"] < 0.2 * errors(run, truth)["error"]


def test_errors_forgive_whole_turns_and_see_everything_else() -> None:
    truth = reference("model-1")
    assert errors(truth, truth)["error"] == 0.0
    for column, shift, expected in ((5, 2 * np.pi, 0.0), (4, 1e-3, 1e-3), (3, 1e-2, None)):
        moved = truth.coordinates.copy()
        moved[:, column] += shift
        found = errors(replace(truth, coordinates=moved), truth)["error"]
        assert found > 1e-4 if expected is None else found == pytest.approx(expected, abs=1e-9)
