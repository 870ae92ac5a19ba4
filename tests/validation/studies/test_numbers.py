"""The numbers that the paper prints beside ours, and its misprints."""

from functools import cache
from math import nan

import pandas as pd
import pytest

from tests.helpers import failing
from validation.studies import numbers
from validation.studies.stability import measured
from validation.study import Content, rows_of


@cache
def rows() -> dict[str, pd.DataFrame]:
    return {
        study.name: pd.DataFrame({"case": "paper", **row} for row in rows_of(study.measure, None))
        for study in numbers.STUDIES
    }


def present(study: str = "misprints", table: pd.DataFrame | None = None) -> Content:
    return numbers.present(rows() if table is None else rows() | {study: table})


def test_every_printed_number_comes_out_or_is_explained() -> None:
    content = present()
    assert not failing(content.checks)
    printed = content.tables["printed"]
    assert len(printed) == len(numbers.DISK) + len(measured.IN_PAPER)
    assert (printed[numbers.DIGITS] == "yes").sum() == content.numbers["agree"] == 10
    assert content.numbers["density"] == pytest.approx(7700.0)
    low, high = content.numbers["gravity"]
    assert low < 9.81 < high
    for row in content.numbers["sharp"]:
        # Table 1 does not give the printed results.
        assert measured.rounds_to(row["unrounded disk"], row["printed"].split()[0])
        assert not measured.rounds_to(row["Table 1"], row["printed"].split()[0])


@pytest.mark.parametrize("factor", [1.001, nan])
@pytest.mark.parametrize("side", ["unrounded disk", "engine"])
def test_a_number_that_is_wrong_on_one_side_fails(side: str, factor: float) -> None:
    wrong = rows()["critical-speeds"].set_index("quantity")
    wrong.loc[measured.LIMIT, side] *= factor
    content = present("critical-speeds", wrong.reset_index())
    compared = {numbers.DIGITS, "engine"} if side == "unrounded disk" else {"engine"}
    assert failing(content.checks) == {f"numbers: {measured.LIMIT}, {each}" for each in compared}


def test_a_misprint_that_is_none_or_a_correction_that_is_wrong_fails() -> None:
    table = rows()["misprints"]
    wrong = table.assign(**{"as printed": 0.0, "corrected": 1e-9})
    assert failing(present(table=wrong).checks)
    assert len(failing(present(table=table.assign(corrected=nan)).checks)) == len(table)
    assert failing(present(table=table.iloc[1:]).checks) == {"misprints: corrected"}
