"""Numbers that look as if they were meant in another unit are warned of, and taken."""

from pathlib import Path

import pytest

from analysis import Scenario, load_scenario, scenario_text
from analysis.data.written import UnitWarning
from tests.validation.cli.test_refusals import RING
from validation import cli


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("--gamma=-90 --alpha 1", "gamma is in rad, and above a turn; degrees are written with"),
        (RING.replace("0.05", "40", 1), "radius is in m, and above 1 m"),
        ("--gamma 450deg --alpha 10*pi", ""),
    ],
)
def test_units_that_are_in_doubt_are_warned_of_once(
    words: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["scenario", *words.split()]) == 0
    shown = capsys.readouterr()
    lines = shown.err.splitlines()
    assert len(lines) == bool(said)
    assert all(line.startswith(f"tippedisk scenario: {said}") for line in lines)
    assert "[start]" in shown.out


def test_units_of_a_file_and_of_an_axis_are_warned_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(scenario_text(Scenario()).replace('gamma = "-pi/2 + 0.1"', "gamma = 90"))
    assert cli.main(["scenario", str(path)]) == 0
    assert "tippedisk scenario: gamma is in rad, and above a turn" in capsys.readouterr().err
    with pytest.warns(UnitWarning, match="^gamma is in rad, and above a turn"):
        assert load_scenario(path).start.gamma == 90.0  # type: ignore[union-attr]
    out = str(tmp_path / "out.db")
    # Refused before anything runs.
    assert cli.main(["sweep", "gamma=0,90,180", "--most", "1", "--out", out]) == 2
    assert capsys.readouterr().err.count("gamma is in rad, and above a turn") == 1
