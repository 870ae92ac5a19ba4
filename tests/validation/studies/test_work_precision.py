"""Error against run time: what its ladders, orders and cheapest ways tell, and what fails it."""

from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pandas as pd
import pytest

from validation import study as kit
from validation.studies.work_precision import measuring
from validation.studies.work_precision import section as wp
from validation.studies.work_precision.measuring import Curve, ladder_end
from validation.studies.work_precision.problems import errors, reference

FLOOR = 1e-11


@pytest.fixture(scope="module")
def rows() -> dict[str, pd.DataFrame]:
    """The stored wp."""
    return {study.name: kit.load(study) for study in wp.STUDIES}


@pytest.fixture(scope="module")
def runs(rows: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """All runs as the tables take them."""
    return wp.prepared(rows["work-precision"])


@pytest.mark.parametrize(
    ("judged", "fixed_step", "end"),
    [
        ([1e-2, 1e-5], True, None),
        ([1e-2, 9e-10], True, "goal"),
        ([inf, inf, inf], True, None),
        ([1e-2, inf, inf], True, "failure"),
        ([1e-6, 9e-7, 8e-7], True, "rounding"),
        ([1e-6, 9e-7, 8e-7], False, None),
        ([0.05, 0.06, 0.04], True, None),
    ],
)
def test_a_ladder_ends_where_finer_rungs_bring_nothing(
    judged: list[float], fixed_step: bool, end: str | None
) -> None:
    assert ladder_end(judged, fixed_step=fixed_step) == end


def rungs(exponent: Callable[[int], float], number: int = 7) -> pd.DataFrame:
    """Rungs of halved steps, each error smaller by that power of 2 than the one before."""
    sizes = 0.05 * 2.0 ** -np.cumsum([0.0, *(exponent(k) for k in range(1, number))])
    steps = 0.5 ** np.arange(number)
    return pd.DataFrame({"kind": "step", "setting": steps, "work": 1 / steps, "error": sizes})


def test_the_order_of_a_clean_ladder_is_found_and_that_of_another_is_not_told() -> None:
    assert wp.observed_order(rungs(lambda _: 4.0), FLOOR) == pytest.approx(4.0)
    assert wp.observed_order(rungs(lambda k: 2.0 + k % 2), FLOOR) == "– unsettled, 2.0 to 3.0"
    assert wp.observed_order(rungs(lambda _: 4.0, 3), FLOOR) == "– few rungs"
    assert wp.observed_order(rungs(lambda _: 4.0), 1e-4) == "– few rungs"


@pytest.mark.parametrize(
    ("formulation", "scheme", "order"),
    [
        ("contact-tree", "RK67", 6.0),
        ("euler-tree", "trapezoidal", 2.0),
    ],
)
def test_the_engines_rules_show_their_orders(
    formulation: str, scheme: str, order: float, runs: pd.DataFrame, rows: Any
) -> None:
    told = wp.orders(runs, wp.floors(rows["work-precision-references"]))
    (found,) = told.loc[told["method"] == f"{formulation}, {scheme}", "Model 1"]
    assert found == pytest.approx(order, abs=0.15)


def test_every_curve_is_stored_and_everything_stored_holds(rows: dict[str, pd.DataFrame]) -> None:
    assert set(rows["work-precision"]["case"]) == set(measuring.curves())
    assert [check for check in wp.present(rows).checks if not check.holds] == []


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [
        ("work-precision", "angle_error", 2.0),
        ("work-precision-references", "difference", 1e-8),
    ],
)
def test_a_run_that_breaks_its_tolerance_or_a_reference_in_doubt_fails(
    name: str, column: str, value: float, rows: dict[str, pd.DataFrame]
) -> None:
    table = rows[name].copy()
    where = table["kind"] == "tolerance" if "kind" in table else table["case"] == "model-2"
    table.loc[where.idxmax(), column] = value
    assert not all(check.holds for check in wp.present({**rows, name: table}).checks)


def test_an_extrapolated_run_is_better_and_counts_all_its_parts() -> None:
    curve = Curve("model-1", "contact-tree", "RK44")
    whole = measuring.measure(curve)
    last = {kind: [row for row in whole if row["kind"] == kind][-1]
            for kind in ("step", "extrapolated")}  # fmt: skip
    assert last["extrapolated"]["error"] < 0.2 * last["step"]["error"]
    rungs = sum(row["work"] for row in whole if row["kind"] == "step")
    assert last["extrapolated"]["work"] == rungs > last["step"]["work"]


def test_errors_forgive_whole_turns_and_see_everything_else() -> None:
    truth = reference("model-1")
    assert errors(truth, truth)["error"] == 0.0
    for column, shift, expected in ((5, 2 * np.pi, 0.0), (4, 1e-3, 1e-3), (3, 1e-2, None)):
        moved = truth.coordinates.copy()
        moved[:, column] += shift
        found = errors(replace(truth, coordinates=moved), truth)["error"]
        assert found > 1e-4 if expected is None else found == pytest.approx(expected, abs=1e-9)
