"""What is stored of any study is confirmed, and a wrong number on either side is not."""

import re
from math import nan
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from jinja2.meta import find_undeclared_variables

from tests.helpers import failing
from validation import report
from validation import study as studying
from validation.page.section import environment
from validation.parser.kinds import DISK, METHOD
from validation.study import Found, Study

STORED = {
    study.name: study
    for name in (*DISK, *METHOD)
    for study in report.find(name).STUDIES
    if study.is_stored
}


MEASURED = re.compile(r"(?<![\w.])\d[\d.e-]*\s+(?:%|rad/s|rad|m?s|m|1/s|s/m|N|spins|rows)(?!\w)")
OF_THE_PAPER = {
    "claims": {"0.5 s", "1e-2 rad", "35 rad/s", "2 s"},
    "numbers": {"100 1/s", "50 rad/s"},
}
"""What its statements say."""

texts = pytest.mark.parametrize("name", [*DISK, *METHOD])


def text_of(name: str) -> Path:
    (text,) = Path(studying.__file__).parent.glob(f"studies/**/{name.replace('-', '_')}.md")
    return text


@texts
def test_constants_that_a_text_names_stand_in_its_module(name: str) -> None:
    text = text_of(name)
    named = find_undeclared_variables(environment(text.parent).parse(text.read_text("utf-8")))
    assert not {each for each in named if each.isupper()} - vars(report.find(name)).keys()


@texts
def test_a_number_with_a_unit_comes_from_the_code(name: str) -> None:
    text = text_of(name)
    parts = environment(text.parent).lex(text.read_text("utf-8"))
    written = "".join(part if kind in ("data", "string") else "x" for _, kind, part in parts)
    found = {" ".join(each.split()) for each in MEASURED.findall(written)}
    assert found == OF_THE_PAPER.get(name, set())


def fresh(study: Study, stored: pd.DataFrame) -> Found:
    """The sample of a study as if it came out as it is stored."""
    sampled = stored.astype(object).where(stored.notna(), None)
    return {
        (study.name, label): sampled[sampled["case"] == label].to_dict("records")
        for label in study.sample
    }


@pytest.mark.parametrize("study", STORED.values(), ids=list(STORED))
def test_what_is_stored_is_confirmed_and_a_wrong_number_on_either_side_is_not(
    study: Study,
) -> None:
    stored = studying.load(study).astype(object)
    assert not failing(studying.confirm(study, fresh(study, stored), stored))
    (*_, other) = stored.loc[~stored["case"].isin(study.sample), "case"]
    missing = f"{study.name}: cases missing or too many"
    found = studying.confirm(study, fresh(study, stored), stored[stored["case"] != other])
    assert failing(found) == {missing}
    sampled = stored[stored["case"].isin(study.sample)]
    assert study.confirm
    for name, limit in study.confirm.items():
        told = [index for index, value in sampled[name].items() if np.all(pd.notna(value))]
        for index in told[-1:]:
            size = np.abs(sampled.at[index, name] if limit is not None else 0.0)
            far = np.add(11.0, 11.0 * size).tolist() if limit is not None else "another"
            for wrong in (far, np.full(np.shape(size), nan).tolist()):
                table = stored.copy()
                table.at[index, name] = wrong
                assert failing(studying.confirm(study, fresh(study, stored), table)), name
                assert failing(studying.confirm(study, fresh(study, table), stored)), name
