"""`tippedisk simulate`."""

import pytest

from analysis import Trajectory, load_run
from analysis.data.endings import INVERTED
from analysis.data.sampled import SOURCES
from tests.calls import Capture, printed
from tests.helpers import not_none

SHORT = "simulate --end 0.1 --samples 6 --tolerance 1e-6 --out new.npz"


@pytest.mark.parametrize("source", SOURCES)
def test_run_from_an_unstable_stationary_motion_says_so(source: str, capsys: Capture) -> None:
    call = f"{SHORT} --source {source} --spin 20 --gamma"
    said = "start is exactly inverted spinning, which is unstable"
    assert said in printed(capsys, call, "pi/2")
    assert said not in printed(capsys, call, "1.57")


def test_run_stops_where_it_is_told_to(capsys: Capture) -> None:
    shown = printed(capsys, "simulate --stop-when inverted --out new.npz --source in-house")
    assert "the centre of gravity is up, at 90% of its largest height" in shown
    assert not_none(load_run("new.npz", Trajectory).ending).reason == INVERTED
