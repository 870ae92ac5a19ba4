"""Long work says how far it is and how long it will take, also where no terminal looks on."""

import re
from itertools import count, pairwise
from pathlib import Path

import pytest

from tests.calls import run
from validation.kit import progress

SIMULATE = "simulate --source in-house --samples 3 --tolerance 1e-5"


@pytest.fixture(name="clock")
def _clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock by which a second passes whenever it is looked at."""
    seconds = count()
    monkeypatch.setattr("tqdm.std.time", lambda: float(next(seconds)))
    monkeypatch.setattr(progress, "monotonic", lambda: float(next(seconds)))


def test_short_work_is_silent(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run(SIMULATE, "--end 0.02 --out", str(tmp_path / "run.npz")) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.usefixtures("clock")
def test_lines_tell_what_is_done_and_what_is_left_and_come_the_rarer_the_longer_it_takes(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for _ in progress.counted(range(3000), "cases"):
        pass
    lines = capsys.readouterr().err.splitlines()
    found = [
        re.fullmatch(r"cases: (\d+) of 3000, after \S+ \w+(, some \S+ \w+ to go)?", line)
        for line in lines
    ]
    done = [int(match[1]) for match in found if match]
    assert len(done) == len(lines) > 10
    assert len(lines) < 60
    steps = [after - before for before, after in pairwise(done)]
    assert steps[-1] > 5 * steps[0]
    # From less than a hundredth nothing is reckoned.
    assert [bool(match[2]) for match in found if match] == [number > 30 for number in done]


@pytest.mark.usefixtures("clock")
def test_long_run_tells_its_time_without_a_terminal(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run(SIMULATE, "--end 1 --out", str(tmp_path / "run.npz")) == 0
    first, *_ = capsys.readouterr().err.splitlines()
    assert re.fullmatch(r"t = \S+ of 1 s, after \S+ s, some \S+ \w+ to go", first)


@pytest.mark.usefixtures("clock")
def test_failed_cases_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.bar(total=100, unit="cases") as shown:
        shown.set_postfix_str("2 failed", refresh=False)
        for _ in range(40):
            shown.update()
    first, *_ = capsys.readouterr().err.splitlines()
    assert re.fullmatch(r"\d+ of 100 cases, 2 failed, after .*", first)
