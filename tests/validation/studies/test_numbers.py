"""The numbers that the paper prints beside ours, and its misprints."""

from math import nan

import pandas as pd
import pytest

from tests.faults import GONE, Rows, faults
from tests.helpers import failing
from validation.studies import numbers
from validation.studies.stability import measured
from validation.study import rows_of


@pytest.fixture(scope="module")
def rows() -> Rows:
    return {
        study.name: pd.DataFrame({"case": "paper", **row} for row in rows_of(study.measure, None))
        for study in numbers.STUDIES
    }


def test_every_printed_number_comes_out_or_is_explained(rows: Rows) -> None:
    content = numbers.present(rows)
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


BOTH = tuple(f"numbers: {measured.LIMIT}, {each}" for each in ("engine", numbers.DIGITS))
LEFT = "left over when corrected"
OFF = (lambda number: 1.001 * number, nan)

test_a_number_that_is_wrong_on_one_side_and_a_misprint_that_is_none_fail = faults(
    numbers.present,
    [
        ("critical-speeds", measured.LIMIT, "engine", BOTH[0], *OFF),
        ("critical-speeds", measured.LIMIT, "unrounded disk", BOTH, *OFF),
        *(("misprints", at, "corrected", LEFT, 1.0, nan) for at in range(len(numbers.PLACES))),
        ("misprints", 0, "as printed", LEFT, 0.0),
        ("misprints", 0, "", "misprints: corrected", GONE),
    ],
)
