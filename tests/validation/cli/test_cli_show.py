"""`tippedisk show`: how far stored motions are apart, and their picture."""

import json
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt

from analysis import (
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Start,
    Trajectory,
    load_run,
    simulate,
    simulate_to_rest,
)
from tests.calls import Capture, printed
from tests.helpers import not_none, random_trajectory, short_run
from validation import cli
from validation.comparison.differences import difference_table


def stored(**motions: Trajectory | SpatialMotion) -> list[str]:
    """Files of motions by their names."""
    for name, motion in motions.items():
        motion.save(f"{name}.npz")
    return [f"{name}.npz" for name in motions]


def test_largest_and_root_mean_square_differences_or_samples_of_one_motion_are_written() -> None:
    one = random_trajectory()
    shift = np.zeros_like(one.coordinates)
    shift[2, 4] = 3e-3
    files = stored(one=one, other=replace(one, coordinates=one.coordinates + shift))
    table = difference_table([("one", one), ("other", load_run(files[1]))])
    rows = {row[1]: row for row in table.rows}
    assert rows["beta"][2] == "rad"
    assert rows["beta"][3:] == pytest.approx([3e-3, one.times[2], 3e-3 / np.sqrt(one.times.size)])
    assert rows["gamma"][3] == 0.0
    assert not table.note
    # Nothing is printed that is written.
    assert printed("show", *files, "--csv out.csv") == ""
    table.to_csv(Path("table.csv"))
    assert Path("out.csv").read_text() == Path("table.csv").read_text()
    assert printed("show one.npz --csv out.csv") == ""
    one.to_csv(Path("samples.csv"))
    assert Path("out.csv").read_text() == Path("samples.csv").read_text()


def test_runs_sampled_at_other_times_are_interpolated_or_not_compared_and_said_to_be() -> None:
    fine, other, coarse = (
        simulate(Scenario(), np.linspace(0.0, end, count))
        for end, count in ((0.4, 101), (0.3, 149), (2.0, 9))
    )
    table = difference_table([("one", fine), ("other", other)])
    largest = {str(row[1]): row[3] for row in table.rows}
    assert 0.0 < float(str(largest["beta"])) < 1e-7
    assert "other is interpolated between its samples, to " in table.note
    assert "other is compared from 0 to 0.3 s alone" in table.note
    table = difference_table([("fine", fine), ("coarse", coarse)])
    assert not table.rows
    assert re.match(r"coarse is not compared: the samples around t = .* determine", table.note)
    files = stored(fine=fine, coarse=coarse)
    assert "coarse is not compared" in printed("show", *files, "--csv out.csv")
    assert json.loads(printed("show", *files, "--json"))["note"] == table.note
    later = replace(fine, times=fine.times + 5.0)
    assert "no time in common" in difference_table([("fine", fine), ("later", later)]).note


def test_motions_are_shown_in_a_window_where_there_is_a_screen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    windows: list[int] = []
    monkeypatch.setattr(plt, "show", lambda: windows.append(len(plt.gcf().axes)))
    for backend, told, opened in (("agg", True, []), ("QtAgg", False, [4])):
        monkeypatch.setattr(plt, "get_backend", lambda name=backend: name)
        assert ("no screen to open a window on" in printed("show run.npz")) == told
        assert windows == opened
    plt.close("all")


def test_rest_files_are_shown_beside_trajectories() -> None:
    rest = simulate_to_rest(Scenario.rest(start=Start(spin=5.0, beta=1.2)), 0.02)
    files = stored(rest=rest, run=rest.to_trajectory())
    shown = printed("show", *files, "--plot both.png")
    assert "rest: SpatialMotion(" in shown
    assert "run: Trajectory(" in shown
    found = re.search(r"cog_height +m +(\S+)", shown)
    assert float(not_none(found)[1]) < 1e-12
    assert "quaternion" not in shown


@pytest.mark.parametrize("name", ["a$_{$b", "$x", os.fsdecode(b"odd\xff"), "new\nline\x07"])
def test_any_name_of_a_file_can_be_shown_and_played(name: str, capsys: Capture) -> None:
    try:
        (file,) = stored(**{name: short_run()})
    except OSError:
        pytest.skip("no such name here")
    for call in (["show", file, "--plot", "made.svg"], ["animate", file, "--out", "made.html"]):
        assert cli.main(call) == 0
    assert capsys.readouterr().err == ""
    if "$" in name:
        assert name in Path("made.svg").read_text(encoding="utf-8")


def test_files_of_one_name_are_told_apart_by_their_folders() -> None:
    for folder, coefficient in (("one", 0.1), ("other", 0.2)):
        Path(folder).mkdir()
        friction = SmoothCoulomb(coefficient=coefficient)
        one = random_trajectory()
        replace(one, scenario=replace(one.scenario, friction=friction)).save(f"{folder}/run.npz")
    # A name may also be that of a column.
    shutil.copy("one/run.npz", "field.npz")
    found = json.loads(printed("show field.npz other/run.npz --json"))
    assert {each["field"]: each["values"]["field"] for each in found["fields"]} == {
        "friction.coefficient": 0.1
    }
    found = json.loads(printed("show one/run.npz other/run.npz --json"))
    names = [str(Path(folder) / "run.npz") for folder in ("one", "other")]
    assert [*found["runs"]] == names
    (row,) = (each for each in found["fields"] if each["field"] == "friction.coefficient")
    assert row["values"] == dict(zip(names, [0.1, 0.2], strict=True))


def test_problems_and_ways_that_differ_are_told_first() -> None:
    one, other = (simulate(Scenario(), [0.0, 0.1], local_tolerance=tol) for tol in (1e-6, 1e-8))
    friction = SmoothCoulomb(coefficient=0.2)
    start = Start(gamma=float(np.nextafter(Start().gamma, 0.0)))
    other = replace(other, scenario=replace(one.scenario, friction=friction, start=start))
    shown = printed("show", *stored(one=one, other=other))
    first, _, _, *lines = shown.partition("\n\n")[0].splitlines()
    assert first == "What differs"
    assert {name: [*map(float, cells)] for name, *cells in map(str.split, lines)} == {
        "friction.coefficient": [0.3, 0.2],
        # What six digits do not tell apart is shown with all of them.
        "start.gamma": [Start().gamma, start.gamma],
        "method.local_tolerance": [1e-6, 1e-8],
    }
