"""What is stored of any study is confirmed, and a wrong number on either side is not."""

from math import nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.helpers import failing
from validation import report
from validation import study as kit
from validation.study import Found, Row, Study

STORED = {
    study.name: study
    for name in (*report.DISK, *report.METHOD)
    for study in report.find(name).STUDIES
    if study.is_stored
}

studies = pytest.mark.parametrize("study", STORED.values(), ids=list(STORED))


def fresh(study: Study, stored: pd.DataFrame) -> Found:
    """The sample of a study as if it came out as it is stored."""
    sampled = stored.astype(object).where(stored.notna(), None)
    return {
        (study.name, label): sampled[sampled["case"] == label].to_dict("records")
        for label in study.sample
    }


@studies
def test_what_comes_out_as_it_is_stored_is_confirmed(study: Study) -> None:
    stored = kit.load(study)
    assert set(study.sample) <= set(stored["case"]) <= set(study.cases())
    assert study.confirm
    assert not failing(kit.confirm(study, fresh(study, stored), stored))


def wrong(study: Study, name: str, value: Any, planted: Any) -> Any:
    """A value that is not the stored one by more than may be."""
    if study.confirm[name] is None:
        return "another"
    far = np.add(value, 10.0 * (1.0 + np.abs(value)))
    return (far if planted == "far" else np.full(np.shape(value), planted)).tolist()


@studies
@pytest.mark.parametrize("planted", [nan, "far"])
def test_a_wrong_number_on_the_spot_or_in_the_table_fails(study: Study, planted: Any) -> None:
    stored = kit.load(study).astype(object)
    places: dict[str, tuple[Any, Row]] = {}
    for index, row in stored[stored["case"].isin(study.sample)].iterrows():
        if not row.get("failure"):
            told = [n for n in study.confirm if np.all(pd.notna(row.get(n)))]
            places |= dict.fromkeys(told, (index, row))
    assert places
    for name, (index, row) in places.items():
        table = stored.copy()
        table.at[index, name] = wrong(study, name, row[name], planted)
        assert failing(kit.confirm(study, fresh(study, stored), table)), name
        assert failing(kit.confirm(study, fresh(study, table), stored)), name
