"""`tippedisk simulate`."""

import numpy as np
import pytest

from analysis import MODELS, Scenario, SmoothCoulomb, Start, Trajectory, load_run
from analysis.data.endings import INVERTED
from analysis.data.trajectory import SOURCES
from tests.calls import Capture, printed, run
from tests.helpers import not_none

SHORT = "simulate --end 0.1 --samples 6 --tolerance 1e-6 --out new.npz"

every_source = pytest.mark.parametrize("source", SOURCES)


@every_source
def test_simulate_stores_the_motion_and_all_parameters(source: str) -> None:
    assert run(SHORT, f"--source {source} --model 2 --mu 0.2 --eps 0.05 --spin 35") == 0
    found = load_run("new.npz", Trajectory)
    np.testing.assert_allclose(found.times, np.linspace(0.0, 0.1, 6))
    assert found.source == source
    assert found.scenario == Scenario(
        constraints=MODELS[2],
        friction=SmoothCoulomb(coefficient=0.2, smoothing=0.05),
        start=Start(spin=35.0),
    )
    assert 0 < not_none(found.error_estimate) <= 1e-6


@every_source
def test_run_from_an_unstable_stationary_motion_says_so(source: str, capsys: Capture) -> None:
    call = f"{SHORT} --source {source} --spin 20 --gamma"
    said = "start is exactly inverted spinning, which is unstable"
    assert said in printed(capsys, call, "pi/2")
    assert said not in printed(capsys, call, "1.57")


@pytest.mark.parametrize(
    ("how", "estimated"),
    [
        ("--integrator RK44 --tolerance 1e-6", True),
        ("--local-tolerance 1e-10", False),
        ("--source in-house --method Radau --tolerance 1e-6", True),
        ("--source in-house --local-tolerance 1e-9", False),
    ],
)
def test_solver_can_be_chosen(how: str, estimated: bool) -> None:
    call = "simulate --end 0.5 --samples 21 --out"
    assert run(call, "asked.npz", how) == run(call, "usual.npz") == 0
    found, known = (load_run(f"{name}.npz", Trajectory) for name in ("asked", "usual"))
    assert (found.error_estimate is not None) == estimated
    assert 0.0 < np.max(np.abs(found.coordinates - known.coordinates)) < 1e-6


@every_source
def test_run_stops_where_it_is_told_to(source: str, capsys: Capture) -> None:
    shown = printed(capsys, "simulate --stop-when inverted --out new.npz --source", source)
    assert "the centre of gravity is up, at 90% of its largest height" in shown
    assert not_none(load_run("new.npz", Trajectory).ending).reason == INVERTED
