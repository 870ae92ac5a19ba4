"""What the README states stands in all results, which are made from the report."""

import pytest

from analysis import MODELS, Scenario
from analysis.mechanics.paper import critical_speed
from analysis.stability.critical import critical_speeds
from tests.calls import ROOT
from tests.stated import chapter, missing, numbers, rows_below, stands, values
from validation.studies.robustness import section as robustness
from validation.studies.robustness.outcomes import CASES, explained
from validation.study import load

README = (ROOT / "README.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
SAID = " ".join(README.split())

AGREEMENT = "| compared | over | largest difference |"


STATED = [
    *(each.partition("\n\n")[0] for each in chapter(README, "What it shows").split("\n- ")[1:]),
    *(row[-1] for row in rows_below(README, AGREEMENT) if "SymPy" not in row[0]),
    SAID.partition("come out more accurate than asked")[2].partition("since their")[0],
]
FRONT, *SECTIONS = RESULTS.split("\n## ")
FOUND = [values(part) for part in (*FRONT.split("\n- "), *SECTIONS)]
"""Numbers of each verdict at the front, and of each section: in all of them together, most short
numbers stand somewhere."""


@pytest.mark.parametrize("said", STATED)
def test_what_the_readme_shows_stands_in_one_part_of_all_results(said: str) -> None:
    assert numbers(said)
    assert any(not missing(said, found) for found in FOUND)


def test_differences_in_the_runs_of_the_figures_are_the_largest_of_their_table() -> None:
    (head,) = (line for line in RESULTS.splitlines() if "| normal force apart in N |" in line)
    runs = rows_below(RESULTS, head)
    named = [name.strip() for name in head.strip("|").split("|")]
    (said,) = (row[-1] for row in rows_below(README, AGREEMENT) if "paper's figures" in row[0])
    for column, stated in zip(("β and γ apart", "normal force apart"), numbers(said), strict=True):
        place = next(at for at, name in enumerate(named) if name.startswith(column))
        assert stands(stated, [max(float(row[place]) for row in runs)]), column


def test_number_stands_to_the_digits_it_is_stated_with_or_if_it_is_small_to_its_size() -> None:
    right = (("0.9", 0.8812), ("−3", -3.0), ("5e-9", 3.2e-9))
    wrong = (("0.88", 0.8912), ("8e-5", 8.6e-5), ("5e-9", 8.0e-9), ("5e-9", 5.0e-10))
    assert all(stands(stated, [found]) for stated, found in right)
    assert not any(stands(stated, [found]) for stated, found in wrong)


def test_numbers_are_told_from_names() -> None:
    text = "Model 1, λ₃ at 30.92 rad/s to 1e-7, index-1, v2.0, −0.5 and 3."
    assert numbers(text) == ["30.92", "1e-7", "−0.5", "3"]


def test_hard_cases_are_those_of_the_stored_study() -> None:
    found = robustness.case_numbers(explained(load(CASES)))
    assert f"Of {found['total']} stiff and extreme cases" in SAID
    assert f"{found['without']} of the {found['total']} extreme cases" in SAID
    assert not found["broken"]


def test_critical_speeds_are_those_that_come_out() -> None:
    low, high = (crossing.spin for crossing in critical_speeds(Scenario()).hopf)
    closed = critical_speed(Scenario(constraints=MODELS[4])).spin
    assert f"critical speed of {closed:.2f} rad/s is confirmed" in SAID
    assert f"they are {low:.2f} and {high:.2f}, in" in SAID
