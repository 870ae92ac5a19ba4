"""What README and docs state stands in the report or in the shipped results."""

import csv
import html
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from analysis import MODELS, Level, Scenario, simulate
from analysis.stability.critical import critical_speeds
from analysis.stability.linear_reduced import critical_speed
from tests.helpers import not_none
from tests.stated import chapter, missing, numbers, rows_below, stands, values, words
from validation.kit import shipped
from validation.studies.rest import creep, runs
from validation.studies.rest import section as rest
from validation.studies.robustness import stored
from validation.studies.robustness.causes import GOOD, cause
from validation.studies.work_precision import lesson
from validation.studies.work_precision import stored as work_precision

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
RESULTS = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
SAID, SENTENCES = (" ".join(each.split()) for each in (README, RESULTS))

AGREEMENT = "| compared | over | largest difference |"
VERDICTS = "| statement | measured | verdict |"


def check_report(folder: Path) -> None:
    """Compare README and docs with a report's page and tables."""
    page = (folder / "report.html").read_text(encoding="utf-8")
    box = _plain(page, "summary")
    for bullet in re.split(r"\n- ", chapter(README, "What it shows"))[1:]:
        known = values(box) + (values(_plain(page, "nonlinear")) if "for ever" in bullet else [])
        assert not missing(bullet.partition("\n\n")[0], known), bullet
    _check_agreement(_rows(folder / "agreement.csv"))
    claims = {row[1]: " ".join(row) for row in _rows(folder / "claims.csv")}
    for statement, measured, _ in rows_below(RESULTS, VERDICTS):
        assert not missing(measured, values(claims[statement])), statement
    for title, section in (
        ("The inversion", "inversion"),
        ("Linear stability", "stability"),
        ("Until the disk lies still", "rest"),
    ):
        said = chapter(RESULTS, title).partition("What the paper says about")[0]
        assert numbers(said), title
        known = values(_plain(page, section)) + values(box)
        assert not missing(said, known), title


def _check_agreement(found: list[list[str]]) -> None:
    stated = [row for row in rows_below(README, AGREEMENT) if "SymPy" not in row[0]]
    assert [list(map(words, row)) for row in stated] == [list(map(words, row)) for row in found]
    for row, made in zip(stated, found, strict=True):
        for cell, known in zip(row, made, strict=True):
            assert not missing(cell, values(known)), row


def _rows(path: Path) -> list[list[str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.reader(stream))[1:]


def _plain(page: str, section: str) -> str:
    """Text of a section of the page, without its pictures."""
    _, _, rest = page.partition(f'<h2 id="{section}">')
    text = rest.partition("<h2 id=")[0]
    part = re.sub(r"<(script|style|svg).*?</\1>", " ", text, flags=re.DOTALL)
    return html.unescape(re.sub(r"<[^>]*>", " ", part))


def test_stated_numbers_about_hard_cases_are_those_of_the_shipped_study() -> None:
    study = stored.shipped()
    assert study is not None
    verdicts = Counter[str](outcome.verdict for outcome in study.outcomes)
    found = Counter(map(cause, study.outcomes))
    accurate, pulling, *others = (verdicts[each] for each in GOOD)
    total = len(study.outcomes)
    flat = found["falls flat, where Euler angles end"] + found["singular system matrix"]
    newton = found["Newton's iteration does not converge"]
    stated = {
        f"Of {total} cases asked for": RESULTS,
        f"{accurate} are accurate and {pulling} end, accurately, where the contact would pull": (
            RESULTS
        ),
        f"{found['too many steps']} would take too many steps": RESULTS,
        f"in {newton} Newton's iteration does not converge": RESULTS,
        f"{flat} fall flat or become singular": RESULTS,
        f"{found['angles accurate, energy or constraint not']} miss their energy": RESULTS,
        f"for {found['no reference is good enough']} no reference is good enough": RESULTS,
        f"Of {total} stiff and extreme cases": README,
        f"{total - accurate - pulling - sum(others)} of the {total} extreme cases": README,
        "none crashes and none breaks its promise: that is said of these cases alone": README,
        "none of these cases crashes or breaks its promise": RESULTS,
    }
    assert not any(outcome.broken for outcome in study.outcomes)
    if any(others):
        stated[f"{sum(others)} where a condition or the table ends them"] = RESULTS
    for words_said, text in stated.items():
        assert words_said in " ".join(text.split()), words_said


@pytest.mark.parametrize(
    ("stated", "found", "expected"),
    [
        ("0.9", 0.8812, True),
        ("0.88", 0.8912, False),
        ("26", 25.99, True),
        ("8e-5", 8.3e-5, True),
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
    assert words("of 25 scenes") == "of # scenes"


def test_readme_says_how_careful_runs_to_a_tolerance_are() -> None:
    stated = not_none(
        re.search(r"more accurate than asked \((.*?)\) and take (.*?),? since", SAID)
    )
    measured = lesson.carefulness(not_none(work_precision.shipped()))
    for part in stated.groups():
        assert len(numbers(part)) >= 3
        assert not missing(part, values(measured)), measured


def test_readme_counts_the_judged_statements() -> None:
    verdicts = Counter(re.findall(r"^\| .* \| (yes|partly|no) \|$", RESULTS, re.MULTILINE))
    found = not_none(
        re.search(
            r"Of (\d+) statements .*?, (\d+) hold by .*?, (\d+) hold in part, and (\d+) do not",
            SAID,
        )
    )
    told = tuple(map(int, found.groups()))
    assert told == (verdicts.total(), verdicts["yes"], verdicts["partly"], verdicts["no"])


def test_critical_speeds_are_those_that_come_out() -> None:
    low, high = (crossing.spin for crossing in critical_speeds(Scenario()).hopf)
    closed = critical_speed(Scenario(constraints=MODELS[4])).spin
    assert f"critical speed of {closed:.2f} rad/s is confirmed" in SAID
    assert f"they are {low:.2f} and {high:.2f}, by" in SAID


@pytest.mark.parametrize("level", [1, 2, 3, 4])
def test_times_of_inversion_are_those_that_come_out(level: Level) -> None:
    run = simulate(
        Scenario(constraints=MODELS[level]), np.linspace(0.0, 2.0, 201), local_tolerance=1e-6
    )
    for text in (SAID, SENTENCES):
        found = re.search(r"after (0\.\d\d), (0\.\d\d), (0\.\d\d) and (0\.\d\d) s", text)
        assert not_none(found)[level] == f"{run.inversion_time:.2f}"


def test_ways_to_rest_are_those_of_the_shipped_runs() -> None:
    jobs = shipped.taken("rest", rest.shipped())
    wanted = ("rest", runs.SHOWN, "engine"), ("rest creep", creep.SMOOTHINGS[0])
    found = {job.key: job.function(*job.arguments) for job in jobs if job.key in wanted}
    course, law = (found[key] for key in wanted)
    phases = course.phases
    lost, still = f"{phases.inversion_lost:.1f} s", f"{phases.rest:.1f} s"
    assert f"it inverts, falls after {lost} and lies still after {still}" in SAID
    told = f"inverts after {phases.inversion:.2f} s, loses the inversion after {lost}"
    assert f"{told}, and lies still after {still}" in SENTENCES
    minutes = law.time_between(creep.START, creep.START / 2) / 60.0
    hours = law.time_between(creep.START, creep.FAR) / 3600.0
    assert f"grows by {law.rate:.4f} per second" in SENTENCES
    assert f"halves from {creep.START:g} rad in {minutes:.0f} minutes" in SENTENCES
    assert f"comes to {creep.FAR:g} rad after {hours:.1f} hours" in SENTENCES
