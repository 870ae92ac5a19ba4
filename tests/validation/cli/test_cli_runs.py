"""The commands `simulate` and `rest`."""

import re
from pathlib import Path

import pytest

from analysis import Dissipation, SpatialMotion, load_run, scenario_text
from tests.calls import printed

SIMULATE = "simulate --samples 6 --end 0.1 --tolerance 1e-6"
SHORT = "rest --source in-house --end 0.02"


def test_command_simulates_stores_and_draws() -> None:
    call = "rest --source in-house --rolling-viscous 2e-3 --pivoting 2e-4 --end 1.6"
    shown = printed(call, "--out rest.npz --plot rest.png")
    motion = load_run("rest.npz", SpatialMotion)
    assert motion.scenario.dissipation == Dissipation(rolling_viscous=2e-3, pivoting=2e-4)
    assert printed("scenario rest.npz") == scenario_text(motion.scenario)
    assert motion.source == "in-house"
    assert motion.times[-1] == pytest.approx(1.6)
    assert Path("rest.png").stat().st_size > 1000
    assert re.search(r"^inverted_at +0\.4\d+ +s$", shown, re.MULTILINE)
    assert re.search(r"^taken_sliding +0\.0\d+ +J$", shown, re.MULTILINE)
    assert "not at rest after 1.6 s" in shown
    assert "not decided" not in shown


SAID = {
    f"{SIMULATE} --spin 20 --gamma pi/2": "exactly inverted spinning, which is unstable",
    f"{SIMULATE} --spin 20 --gamma 1.57": "6 samples of Model 1",
    "simulate --stop-when inverted": "the centre of gravity is up, at 90% of its",
    "rest --source in-house --end 0.8": "inversion not decided",
    "rest --step 1e-4 --end 0.5 --time-limit 1e-9": "0.1 s: time limit",
    f"{SHORT} --gamma pi/2 --spin 20": "exactly inverted spinning, which is unstable",
    # What the disk has is not asked for.
    f"{SHORT} --rolling-viscous 5e-3": " rad; lying still needs --pivoting",
}


@pytest.mark.parametrize("call", SAID)
def test_command_says_how_far_it_came_and_what_it_lacks(call: str) -> None:
    shown = printed(call)
    assert SAID[call] in shown
    assert ("unstable" in shown) == ("unstable" in SAID[call])
