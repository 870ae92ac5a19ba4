"""Long work says how far it is and how long it will take, also where no terminal looks on."""

import re
from itertools import count, pairwise

import pytest

from analysis.problem.limits import duration
from tests.calls import Capture, answer
from tests.sweeps import sweep, swept
from validation.display import progress
from validation.sweeps import runner

SIMULATE = "simulate --source in-house --samples 3 --tolerance 1e-5 --out new.npz --end"


@pytest.fixture(name="clock")
def _clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock by which a second passes whenever it is looked at."""
    seconds = count()
    monkeypatch.setattr("tqdm.std.time", lambda: float(next(seconds)))
    monkeypatch.setattr(progress, "monotonic", lambda: float(next(seconds)))


@pytest.mark.usefixtures("clock")
def test_long_run_tells_its_time_without_a_terminal() -> None:
    code, _, said = answer(SIMULATE, "1")
    first, *_ = said.splitlines()
    assert code == 0
    assert re.fullmatch(r"t = \S+ of 1 s, after \S+ s, some \S+ \w+ to go", first)


@pytest.mark.usefixtures("clock")
def test_lines_tell_what_is_done_and_left_and_come_the_rarer_the_longer_it_takes(
    capsys: Capture,
) -> None:
    with progress.bar(total=3000, unit="cases") as shown:
        shown.set_postfix_str("2 failed", refresh=False)
        for _ in range(3000):
            shown.update()
    lines = capsys.readouterr().err.splitlines()
    pattern = r"(\d+) of 3000 cases, 2 failed, after \S+ \w+(, some \S+ \w+ to go)?"
    found = [match for line in lines if (match := re.fullmatch(pattern, line))]
    assert 10 < len(found) == len(lines) < 60
    done = [int(match[1]) for match in found]
    steps = [after - before for before, after in pairwise(done)]
    assert steps[-1] > 5 * steps[0]
    # From less than a hundredth nothing is reckoned.
    assert [bool(match[2]) for match in found] == [number > 30 for number in done]
    # Nor where the total grows with what is done, as of a family of motions.
    with progress.bar(unit="motions") as shown:
        for number in range(300):
            shown.total = number + 1
            shown.update()
    assert "motions" in (said := capsys.readouterr().err)
    assert "to go" not in said
    assert list(progress.counted(range(3000), "runs")) == list(range(3000))
    said = capsys.readouterr().err
    counts = [
        int(each) for each in re.findall(r"^runs: (\d+) of 3000, after ", said, re.MULTILINE)
    ]
    assert len(counts) > 10
    assert 0 < counts[0] < counts[-1] < 3000


def test_times_are_told_in_the_unit_that_suits_them() -> None:
    told = [duration(seconds) for seconds in (0.1, 99.0, 101.0, 5990.0, 6010.0)]
    assert told == ["1 s", "99 s", "1.7 min", "99.8 min", "1.7 h"]


@pytest.mark.usefixtures("clock")
def test_cases_of_a_sweep_that_are_done_and_failed_are_counted(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(runner, "LARGEST_CHUNK", 1)
    for retry in (False, True):
        swept(sweep("spin=30:40:50", "mu=-0.1,-0.2"), retry=retry)
        *_, last = capsys.readouterr().err.splitlines()
        assert re.match(r"a.db: (\d+) of 100 cases, \1 failed, after ", last)
