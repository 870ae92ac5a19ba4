"""The report: every check, figure and statement in one page."""

import csv
import html
import os
import pickle
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from analysis import (
    LEVELS,
    LOADS,
    MODELS,
    Level,
    Load,
    Scenario,
    SmoothCoulomb,
    Trajectory,
    simulate,
)
from tests.test_stated_numbers import check_report
from validation.kit import figures
from validation.studies import full_report, inversion
from validation.studies.claims.claim import VERDICTS

ROOT = Path(__file__).parents[3]

FIGURES = {
    *(f"paper-fig-{number}" for number in (6, 7, 8, 9, 10, 11)),
    "snapshots",
    "pure-rolling",
    "stability-chart",
}


@cache
def run(level: Level, load: Load, end: float, tolerance: float) -> Trajectory:
    times = np.linspace(0.0, end, round(100 * end) + 1)
    scenario = Scenario(constraints=MODELS[level], friction=SmoothCoulomb(load=load))
    return simulate(scenario, times, local_tolerance=tolerance)


def pair(level: Level, load: Load, end: float) -> tuple[Trajectory, Trajectory]:
    """Two runs that can be told apart by their digits, the first in the engine's place."""
    return run(level, load, end, 1e-7), run(level, load, end, 1e-6)


def test_figures_7_to_9_show_engine_as_lines_and_in_house_as_markers() -> None:
    engine, inhouse = zip(*(pair(level, "weight", 2.0) for level in LEVELS), strict=True)
    loads = {load: pair(1, load, 2.0) for load in LOADS}
    seven = figures.figure_7(
        {load: loads[load][0] for load in LOADS}, {load: loads[load][1] for load in LOADS}
    )
    eight = figures.figure_8(engine, inhouse)
    nine = figures.figure_9(engine, inhouse)
    contact = loads["contact"]
    expected = [
        (seven[0], [each.coordinate("beta") for each in contact], (0, 1)),
        (seven[1], [each.normal_force for each in contact], (0, 1)),
        (eight[1], [each.coordinate("gamma") for each in (engine[3], inhouse[3])], (6, 7)),
        (nine, [each.rate("alpha") for each in (engine[2], inhouse[2])], (4, 5)),
    ]
    for axes, values, indices in expected:
        for index, shown in zip(indices, values, strict=True):
            line = axes.lines[index]
            np.testing.assert_array_equal(line.get_ydata(), shown)
            assert (line.get_linestyle() == "None") == (index % 2 == 1)
    weight = loads["weight"][0]
    difference = weight.coordinate("gamma") - contact[0].coordinate("gamma")
    np.testing.assert_array_equal(seven[2].lines[1].get_ydata(), difference)


@pytest.mark.slow
def test_captions_of_figures_7_to_9_hold_the_numbers_of_their_runs() -> None:
    loads = {load: (run(1, load, 2.0, 1e-6),) * 2 for load in LOADS}
    levels = [(run(level, "weight", 4.0, 1e-6),) * 2 for level in LEVELS]
    drawn = inversion.draw(loads, levels)
    assert [picture.name for picture in drawn] == [f"paper-fig-{number}" for number in (7, 8, 9)]
    assert all(picture.png.startswith(b"\x89PNG") for picture in drawn)
    assert "after 0.5 s it is 0.28 rad short" in drawn[0].caption
    assert "changes the angles by up to 2.4e-02 rad" in drawn[0].caption
    assert "34, 7, 9, 10; overshoot of γ: 0.69, 0.29, 0.48, 0.26 rad" in drawn[1].caption
    assert "47, 47, 53 % went into height" in drawn[2].caption


def test_jobs_of_all_studies_can_be_sent_to_workers() -> None:
    for study in full_report.STUDIES:
        for job in (*study.jobs(), *study.shipped()):
            assert pickle.dumps(job)


@pytest.mark.whole
def test_report_holds_every_check_and_shows_every_figure_and_statement(tmp_path: Path) -> None:
    code = "from validation.cli import main; raise SystemExit(main())"
    done = subprocess.run(
        [sys.executable, "-c", code, "report"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "All checks hold" in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["report"]
    folder = tmp_path / "report"
    page = (folder / "report.html").read_text()
    assert 'class="bad"' not in page
    pictures = sorted(folder.glob("*.png"))
    assert {path.stem for path in pictures} >= FIGURES
    assert all(f'<figure id="{path.stem}"' in page for path in pictures)
    for path in pictures:
        assert path.with_suffix(".svg").stat().st_size > 1000, path.name
        with Image.open(path) as picture:
            assert np.ptp(np.asarray(picture.convert("L"))) > 128, f"{path.name} is blank"
    with (folder / "claims.csv").open(newline="") as stream:
        claims = list(csv.DictReader(stream))
    results = (ROOT / "docs" / "results.md").read_text().splitlines()
    assert len(claims) >= 19
    for claim in claims:
        (line,) = (line for line in results if line.startswith(f"| {claim['statement']} |"))
        assert line.endswith(f"| {claim['verdict']} |")
        assert claim["verdict"] in VERDICTS
        assert all(html.escape(cell) in page for cell in claim.values())
    check_report(folder)
    # A second call takes what the first has left and makes the same page of it.
    before = (folder / "claims.csv").read_bytes()
    again = subprocess.run(
        [sys.executable, "-c", code, "report"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "nothing is to be computed" in again.stderr
    assert (folder / "claims.csv").read_bytes() == before
