"""The command `rest`."""

import re
from pathlib import Path

import pytest

from analysis import SpatialMotion, load_run
from tests.helpers import mostly_slow
from validation.cli import main


@pytest.mark.parametrize("source", mostly_slow(["engine", "in-house"], ["in-house"]))
def test_command_simulates_stores_and_draws(
    source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, plot = tmp_path / "rest.npz", tmp_path / "rest.png"
    arguments = ["rest", "--source", source, "--rolling-viscous", "2e-3", "--pivoting", "2e-4"]
    assert main([*arguments, "--end", "1.6", "--out", str(out), "--plot", str(plot)]) == 0
    motion = load_run(out, SpatialMotion)
    assert motion.source == source
    assert motion.times[-1] == pytest.approx(1.6)
    assert plot.stat().st_size > 1000
    printed = capsys.readouterr().out
    assert re.search(r"^inversion +0\.4", printed, re.MULTILINE)
    assert re.search(r"^estimated error +\d", printed, re.MULTILINE)
    assert "not at rest after 1.6 s" in printed
    assert "not decided" not in printed


def test_command_says_when_the_inversion_is_not_decided(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["rest", "--source", "in-house", "--end", "0.8"]) == 0
    assert "inversion not decided" in capsys.readouterr().out


def test_command_drops_the_disk_from_a_height(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "drop.npz"
    arguments = ["rest", "--source", "in-house", "--height", "5e-3", "--end", "0.1"]
    assert main([*arguments, "--out", str(out)]) == 0
    motion = load_run(out, SpatialMotion)
    assert motion.positions[0, 2] - motion.scenario.disk.radius == pytest.approx(5e-3)
    assert motion.normal_force[0] == 0.0
    assert motion.energy_taken("damping")[-1] > 0.01
    assert "estimated error" in capsys.readouterr().out


def test_command_says_that_a_time_limit_ended_it(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["rest", "--step", "1e-4", "--end", "0.5", "--time-limit", "1e-9"]
    assert main(arguments) == 0
    printed = capsys.readouterr().out
    assert "ended at t = 0.1 s: time limit" in printed
    assert "not at rest" not in printed


def test_command_says_that_its_start_is_an_unstable_motion(
    capsys: pytest.CaptureFixture[str],
) -> None:
    call = ["rest", "--source", "in-house", "--end", "0.02", "--gamma", "pi/2", "--spin", "20"]
    assert main(call) == 0
    assert "start is exactly inverted spinning, which is unstable" in capsys.readouterr().out


def test_command_names_only_the_losses_that_are_lacking(
    capsys: pytest.CaptureFixture[str],
) -> None:
    call = ["rest", "--source", "in-house", "--end", "0.02", "--rolling-viscous", "5e-3"]
    assert main(call) == 0
    shown = capsys.readouterr().out
    assert "lying still needs --pivoting" in shown
    assert "lying flat" not in shown
