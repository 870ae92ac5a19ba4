"""Numbers in README and docs are those of the shipped studies, or come out anew."""

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from analysis import MODELS, Level, Scenario, simulate
from analysis.stability.critical import critical_speeds
from analysis.stability.linear_reduced import critical_speed
from tests.helpers import not_none
from validation.kit import shipped
from validation.studies.rest import creep, runs
from validation.studies.rest import section as rest
from validation.studies.robustness import stored
from validation.studies.robustness.causes import GOOD, cause

ROOT = Path(__file__).parent.parent
README = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
RESULTS = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
SENTENCES = " ".join(RESULTS.split())


def numbers(pattern: str, text: str) -> tuple[int, ...]:
    found = re.search(pattern, text)
    assert found is not None, pattern
    return tuple(map(int, found.groups()))


def test_readme_counts_the_judged_statements() -> None:
    verdicts = Counter(re.findall(r"^\| .* \| (yes|partly|no) \|$", RESULTS, re.MULTILINE))
    told = numbers(
        r"Of (\d+) statements .*?, (\d+) hold by .*?, (\d+) hold in part, and (\d+) do not", README
    )
    assert told == (verdicts.total(), verdicts["yes"], verdicts["partly"], verdicts["no"])


def test_hard_cases_are_counted_as_in_the_shipped_study() -> None:
    study = stored.shipped()
    assert study is not None
    verdicts = Counter(each.verdict for each in study.outcomes)
    causes = Counter(cause(each) for each in study.outcomes if each.verdict not in GOOD)
    assert not any(each.broken for each in study.outcomes)
    told = numbers(r"Of (\d+) cases asked .*?, (\d+) are accurate and (\d+) end", SENTENCES)
    good = verdicts["accurate"], verdicts["ends: contact would pull"]
    assert told == (len(study.outcomes), *good)
    assert numbers(r"(\d+) of the (\d+) extreme cases", README) == (told[0] - sum(good), told[0])
    assert numbers(r"Of (\d+) stiff and extreme cases, none crashes", README) == told[:1]
    assert numbers(r"(\d+) would take too many steps and in (\d+) Newton's", SENTENCES) == (
        causes["too many steps"],
        causes["Newton's iteration does not converge"],
    )


def test_critical_speeds_are_those_that_come_out() -> None:
    low, high = (crossing.spin for crossing in critical_speeds(Scenario()).hopf)
    closed = critical_speed(Scenario(constraints=MODELS[4])).spin
    assert f"critical speed of {closed:.2f} rad/s is confirmed" in README
    assert f"they are {low:.2f} and {high:.2f}, by" in README


@pytest.mark.parametrize("level", [1, 2, 3, 4])
def test_times_of_inversion_are_those_that_come_out(level: Level) -> None:
    run = simulate(
        Scenario(constraints=MODELS[level]), np.linspace(0.0, 2.0, 201), local_tolerance=1e-6
    )
    found = re.search(r"after (0\.\d\d), (0\.\d\d), (0\.\d\d) and (0\.\d\d) s", README)
    assert not_none(found)[level] == f"{run.inversion_time:.2f}"


def test_ways_to_rest_are_those_of_the_shipped_runs() -> None:
    jobs = shipped.taken("rest", rest.shipped())
    wanted = ("rest", runs.SHOWN, "engine"), ("rest creep", creep.SMOOTHINGS[0])
    found = {job.key: job.function(*job.arguments) for job in jobs if job.key in wanted}
    course, law = (found[key] for key in wanted)
    phases = course.phases
    lost, still = f"{phases.inversion_lost:.1f} s", f"{phases.rest:.1f} s"
    assert f"it inverts, falls after {lost} and lies still after {still}" in README
    told = f"inverts after {phases.inversion:.2f} s, loses the inversion after {lost}"
    assert f"{told}, and lies still after {still}" in SENTENCES
    minutes = law.time_between(creep.START, creep.START / 2) / 60.0
    hours = law.time_between(creep.START, creep.FAR) / 3600.0
    assert f"grows by {law.rate:.4f} per second" in SENTENCES
    assert f"halves from {creep.START:g} rad in {minutes:.0f} minutes" in SENTENCES
    assert f"comes to {creep.FAR:g} rad after {hours:.1f} hours" in SENTENCES
