"""Wrong values in what a section is made of, and the checks that they fail."""

from collections.abc import Callable
from typing import Any

import pandas as pd
import pytest

from tests.helpers import failing, planted
from validation.study import Content

Rows = dict[str, pd.DataFrame]

GONE = object()
"""In place of a value: the row is left out."""


def faults(present: Callable[[Rows], Content], told: list[tuple[Any, ...]]) -> Any:
    """A test that what is wrong in the fixture `rows`, in which all holds, fails its checks alone.

    Told are a table, one of its rows by its place or by a cell, a column, a part of the name of
    the check that fails, or one for each of several, and what is planted, one after the other.
    """

    @pytest.mark.parametrize("fault", told, ids=lambda fault: "-".join(map(str, fault[:4])))
    def test(fault: tuple[Any, ...], rows: Rows) -> None:
        study, place, column, check, *values = fault
        parts = check if isinstance(check, tuple) else (check,)
        table = rows[study]
        is_place = isinstance(place, int)
        at = table.index[place] if is_place else table.isin([place]).any(axis=1).idxmax()
        for value in values:
            wrong = table.drop(at) if value is GONE else planted(table, at, column, value)
            found = failing(present({**rows, study: wrong}).checks)
            assert all(any(part in name for name in found) for part in parts), found
            assert all(any(part in name for part in parts) for name in found), found

    return test
