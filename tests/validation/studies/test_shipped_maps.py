"""Maps that come with the package, and what the report makes of them."""

from pathlib import Path

import numpy as np
import pytest

from analysis import Scenario
from tests.helpers import not_none
from tests.stated import missing, rows_below, values
from validation.maps import stored
from validation.maps.problems import PROBLEMS
from validation.maps.run import Panel, panels
from validation.maps.ship import LEVELS, PAIRS, sweeps
from validation.maps.stored import Study
from validation.studies import maps
from validation.studies.claims.claim import VERDICTS

DOCS = Path(__file__).parents[3] / "docs" / "sweeps.md"
TABLE = (
    "| map, from Table 3 | runs | in place of | other side agrees | "
    "difference, median and largest in rad |"
)


@pytest.fixture(scope="module")
def study() -> Study:
    found = stored.shipped()
    return not_none(found)


def test_shipped_maps_are_those_that_the_script_makes_now(study: Study) -> None:
    assert tuple(study.panels) == tuple(LEVELS)
    assert study.pairs == PAIRS
    for name, found in study.panels.items():
        assert [panel.sweep for panel in found] == sweeps(name)


def test_table_of_the_docs_is_that_of_the_shipped_maps(study: Study) -> None:
    stated = rows_below(DOCS.read_text(encoding="utf-8"), TABLE)
    assert [row[0].partition(",")[0] for row in stated] == list(study.panels)
    for row, found in zip(stated, study.panels.values(), strict=True):
        seen = [each for panel in found for each in panel.witnesses.values()]
        apart = [each.difference for each in seen]
        known: list[list[float]] = [
            [sum(len(panel.classes) for panel in found)],
            [sum(int(np.prod(panel.shape)) for panel in found)],
            [sum(each.alike for each in seen), len(seen)],
            [float(np.median(apart)), max(apart)],
        ]
        for cell, numbers in zip(row[1:], known, strict=True):
            assert values(cell)
            assert not missing(cell, numbers), row


def test_sample_is_of_every_panel_and_of_what_is_decided(study: Study) -> None:
    jobs = maps.jobs()
    assert len({job.key for job in jobs}) == len(jobs) >= 16
    for found in study.panels.values():
        for panel in found:
            chosen = [panel.classes[number] for number in maps.sample(panel)]
            assert len(set(chosen)) == len(chosen) == 2
            assert not {"failed", "refused", "not decided"} & {*chosen}


def toy(**classes: str) -> Panel:
    """The grid of a map of 3 by 3 cases, in which some are of these classes."""
    (sweep,) = panels(PROBLEMS["attitude"], Scenario(), cells=2, levels=0, end=1.0, witnesses=0)
    every = dict.fromkeys(range(9), "inverted") | {
        int(name[1:]): value for name, value in classes.items()
    }
    return Panel(
        problem=PROBLEMS["attitude"], sweep=sweep, classes=every, times={}, witnesses={},
        seconds=0.0,
    )  # fmt: skip


def test_models_agree_where_both_invert_or_neither_does() -> None:
    first, other = toy(_0="flat", _4="lost"), toy(_0="not inverted", _5="flat")
    assert maps.agreement([first, other, first], 1.0) == [pytest.approx(8 / 9), 1.0]
    # Upright is the row in the middle.
    assert maps.agreement([first, other], 0.1) == [pytest.approx(2 / 3)]


def test_least_spin_is_measured_from_the_second_critical_speed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    points = [[-2.0, 0.8], [-1.0, 0.8], [1.5, 0.8], [-2.0, 3.0], [-1.0, 3.0], [1.5, 3.0]]
    monkeypatch.setattr(maps, "critical_points", lambda *_: np.array(points))
    panel = toy(_0="flat", _3="flat", _6="flat", _7="flat", _8="lost")
    # In place of spins, gamma is -pi/2, 0 and pi/2; the last row does not invert anywhere.
    np.testing.assert_allclose(maps.above_critical(panel, 0.8), [1.0, 1.0])
    np.testing.assert_allclose(maps.above_critical(panel, 1.5), [1.0])


@pytest.mark.slow
def test_section_shows_what_is_shipped_and_repeated_and_stays_small(study: Study) -> None:
    jobs = maps.jobs()
    kept = [panel.classes[number] for _, panel, number in maps._cases(study)]
    results = {
        job.key: maps.Repetition(engine=name, inhouse=name, difference=0.0)
        for job, name in zip(jobs, kept, strict=True)
    }
    # The report itself repeats all of them.
    results |= {job.key: job.function(*job.arguments) for job in jobs[::5]}
    section = maps.section(results)
    verdicts, models, _, repeated = section.tables
    said, summed_up = (
        " ".join(page.read_text(encoding="utf-8").split())
        for page in (DOCS, DOCS.with_name("results.md"))
    )
    for row in verdicts.rows[:2]:
        assert str(row[3]).removesuffix(" more") in said
    far = [f"{row[-1]:.0f}" for row in models.rows]
    for text in (said, summed_up):
        assert f"{far[0]} and {far[1]} % of the starts, and Model 4 for {far[2]} %" in text
    assert {row[-1] for row in verdicts.rows} <= {*VERDICTS}
    assert len(repeated.rows) == len(jobs)
    assert all(row[-1] is True for row in repeated.rows)
    shown = [png for each in section.pictures for png in (each.panels or [each.png])]
    assert sum(map(len, shown)) < 100_000
