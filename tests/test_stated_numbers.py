"""What the README states stands in all results, which are made from the report."""

import re
from pathlib import Path

import pytest

from tests.stated import chapter, missing, numbers, rows_below, stands, values
from validation.studies.robustness import section as robustness
from validation.studies.robustness.outcomes import CASES
from validation.study import load

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
SAID = " ".join(README.split())

AGREEMENT = "| compared | over | largest difference |"


@pytest.mark.parametrize("bullet", re.split(r"\n- ", chapter(README, "What it shows"))[1:])
def test_what_the_readme_shows_stands_in_all_results(bullet: str) -> None:
    said = bullet.partition("\n\n")[0]
    assert not missing(said, values(RESULTS))


def test_largest_differences_are_those_of_all_results() -> None:
    rows = [row for row in rows_below(README, AGREEMENT) if "SymPy" not in row[0]]
    assert len(rows) > 5
    for row in rows:
        assert not missing(row[-1], values(RESULTS)), row


@pytest.mark.parametrize(
    ("stated", "found", "expected"),
    [
        ("0.9", 0.8812, True),
        ("0.88", 0.8912, False),
        ("8e-5", 8.6e-5, False),
        ("−3", -3.0, True),
        ("5e-9", 3.2e-9, True),
        ("5e-9", 8.0e-9, False),
        ("5e-9", 5.0e-10, False),
    ],
)
def test_number_stands_to_the_digits_it_is_stated_with(
    stated: str, found: float, *, expected: bool
) -> None:
    assert stands(stated, [found]) is expected


def test_numbers_are_told_from_names() -> None:
    text = "Model 1, λ₃ at 30.92 rad/s to 1e-7, index-1, v2.0, −0.5 and 3."
    assert numbers(text) == ["30.92", "1e-7", "−0.5", "3"]


def test_hard_cases_are_those_of_the_stored_study() -> None:
    found = robustness.case_numbers(load(CASES))
    assert f"Of {found['total']} stiff and extreme cases" in SAID
    assert f"{found['without']} of the {found['total']} extreme cases" in SAID
    assert not found["broken"]
