"""`tippedisk show`: how far stored motions are apart, and their picture; `tippedisk play`."""

import os
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

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
from tests.calls import printed, run
from tests.helpers import not_none, random_trajectory
from validation import cli
from validation.kit.animation.play import page
from validation.kit.differences import difference_table, fields_table
from validation.kit.tables import show


@cache
def falling() -> SpatialMotion:
    return simulate_to_rest(Scenario.rest(start=Start(spin=5.0, beta=1.2)), 0.1)


def test_difference_is_the_largest_and_the_root_mean_square() -> None:
    one = random_trajectory()
    shift = np.zeros_like(one.coordinates)
    shift[2, 4] = 3e-3
    other = replace(one, coordinates=one.coordinates + shift)
    table = difference_table([("one", one), ("other", other)])
    rows = {row[1]: row for row in table.rows}
    assert rows["beta"][3:] == pytest.approx([3e-3, one.times[2], 3e-3 / np.sqrt(one.times.size)])
    assert rows["gamma"][3] == 0.0
    assert rows["beta"][2] == "rad"
    assert not table.note


def test_runs_sampled_at_other_times_are_interpolated_and_said_to_be() -> None:
    one, other = (
        simulate(Scenario(), np.linspace(0.0, end, count))
        for end, count in ((0.4, 101), (0.3, 149))
    )
    table = difference_table([("one", one), ("other", other)])
    largest = {str(row[1]): row[3] for row in table.rows}
    assert 0.0 < float(str(largest["beta"])) < 1e-7
    assert "other is interpolated between its samples, to " in table.note
    assert "other is compared from 0 to 0.3 s alone" in table.note


def test_runs_that_cannot_be_compared_say_why() -> None:
    coarse = simulate(Scenario(), np.linspace(0.0, 2.0, 9))
    fine = simulate(Scenario(), np.linspace(0.0, 0.1, 11))
    table = difference_table([("fine", fine), ("coarse", coarse)])
    assert not table.rows
    assert re.match(r"coarse is not compared: the samples around t = .* determine", table.note)
    later = replace(fine, times=fine.times + 5.0)
    assert "no time in common" in difference_table([("fine", fine), ("later", later)]).note


@pytest.mark.parametrize("first", ["rest", "run"])
def test_rest_files_are_shown_beside_trajectories(
    first: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    motions: dict[str, SpatialMotion | Trajectory] = {
        "rest": falling(),
        "run": falling().to_trajectory(),
    }
    order = sorted(motions, key=lambda name: name != first)
    for name in order:
        motions[name].save(tmp_path / f"{name}.npz")
    files = [str(tmp_path / f"{name}.npz") for name in order]
    shown = printed(capsys, "show", *files, "--plot", str(tmp_path / "both.png"))
    assert "rest: SpatialMotion(" in shown
    assert "run: Trajectory(" in shown
    found = re.search(r"cog_height +m +(\S+)", shown)
    assert float(not_none(found)[1]) < 1e-12
    assert "quaternion" not in shown


def test_without_a_screen_the_numbers_are_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mpl.use("agg")
    random_trajectory().save(tmp_path / "run.npz")
    shown = printed(capsys, "show", str(tmp_path / "run.npz"))
    assert shown.startswith("run: Trajectory(")
    assert "--plot PICTURE draws" in shown


@pytest.mark.parametrize("name", ["a$_{$b", "$x", os.fsdecode(b"odd\xff"), "new\nline\x07"])
def test_any_name_of_a_file_can_be_shown_and_played(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"{name}.npz"
    try:
        random_trajectory().save(file)
    except OSError:
        pytest.skip("no such name here")
    for command, option, made in (
        ("show", "--plot", "made.svg"),
        ("animate", "--out", "made.html"),
    ):
        assert cli.main([command, str(file), option, str(tmp_path / made)]) == 0
        assert capsys.readouterr().err == ""
    if "$" in name:
        assert name in (tmp_path / "made.svg").read_text(encoding="utf-8")


def test_motions_of_different_problems_are_told_apart_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = simulate(Scenario(), [0.0, 0.1], local_tolerance=1e-6)
    friction = SmoothCoulomb(coefficient=0.2)
    start = Start(gamma=float(np.nextafter(Start().gamma, 0.0)))
    other = replace(one, scenario=replace(one.scenario, friction=friction, start=start))
    files = [str(tmp_path / f"{name}.npz") for name in ("one", "other")]
    one.save(files[0])
    other.save(files[1])
    shown = printed(capsys, "show", *files, "--plot", str(tmp_path / "both.png"))
    first, _, _, *lines = shown.partition("\n\n")[0].splitlines()
    assert first == "What differs"
    cells = {line.split()[0]: line.split()[1:] for line in lines}
    assert cells["friction.coefficient"] == ["0.3", "0.2"]
    # What six digits do not tell apart is shown with all of them.
    assert list(map(float, cells["start.gamma"])) == [Start().gamma, start.gamma]
    assert len(cells) == 2


def test_runs_that_differ_in_their_source_alone_are_compared_at_once() -> None:
    one = random_trajectory()
    assert not fields_table([("one", one), ("other", replace(one, source="engine"))]).rows
    stricter = replace(one, method={**one.method, "tolerance": 1e-12})
    (row,) = fields_table([("one", one), ("other", stricter)]).rows
    assert row == ["method.tolerance", show(one.method.get("tolerance")), "1.00e-12"]


def test_differences_or_the_samples_of_one_motion_are_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, out = random_trajectory(), str(tmp_path / "out.csv")
    files = [str(tmp_path / f"{name}.npz") for name in ("one", "other")]
    one.save(files[0])
    replace(one, coordinates=one.coordinates + 1e-3).save(files[1])
    assert "no screen" not in printed(capsys, "show", *files, "--csv", out)
    table = difference_table([("one", one), ("other", load_run(files[1]))])
    assert Path(out).read_text() == table.to_csv()
    assert run("show", files[0], "--csv", out) == 0
    one.to_csv(tmp_path / "samples.csv")
    assert Path(out).read_text() == (tmp_path / "samples.csv").read_text()


@pytest.mark.parametrize(("words", "name"), [("", "play.html"), ("--out own.html", "own.html")])
def test_page_to_spin_the_disk_by_hand_is_written(
    words: str,
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    said = printed(capsys, "play", words)
    assert said.startswith(f"{name}: ")
    assert said.count("\n") == 1
    assert [each.name for each in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text(encoding="utf-8") == page()
