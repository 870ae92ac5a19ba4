"""The numbers that the paper prints beside ours, and its misprints."""

from functools import cache
from math import nan

import pandas as pd
import pytest

from tests.helpers import failing
from validation.page.content import Content
from validation.studies import numbers
from validation.studies.stability import measured
from validation.study import frame, plain


@cache
def rows() -> dict[str, pd.DataFrame]:
    return {
        study.name: frame({"case": "paper", **row} for row in plain(study.measure(None)))
        for study in numbers.STUDIES
    }


def present(**changed: pd.DataFrame) -> Content:
    return numbers.present(
        rows() | {name.replace("_", "-"): each for name, each in changed.items()}
    )


def test_every_printed_number_comes_out_or_is_explained() -> None:
    content = present()
    assert not failing(content.checks)
    printed = pd.DataFrame(content.tables["printed"])
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
    name = "critical-speeds" if side == "unrounded disk" else "printed-numbers-engine"
    wrong = rows()[name].set_index("quantity")
    wrong.loc[numbers.LIMIT, side] *= factor
    content = numbers.present(rows() | {name: wrong.reset_index()})
    compared = {numbers.DIGITS, "engine"} if side == "unrounded disk" else {"engine"}
    assert failing(content.checks) == {f"numbers: {numbers.LIMIT}, {each}" for each in compared}


def test_a_misprint_that_is_none_or_a_correction_that_is_wrong_fails() -> None:
    table = rows()["misprints"]
    wrong = present(misprints=table.assign(**{"as printed": 0.0, "corrected": 1e-9}))
    assert failing(wrong.checks)
    assert len(failing(present(misprints=table.assign(corrected=nan)).checks)) == len(table)
    assert failing(present(misprints=table.iloc[1:]).checks) == {"misprints: corrected"}
