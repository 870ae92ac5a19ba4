"""Command lines that ask for what cannot be: one line, code 2, nothing written, no warning."""

from pathlib import Path

import pytest

from tests.calls import refusal
from tests.helpers import random_trajectory

SIMULATE = "simulate --out {folder}/new.npz "
IN_HOUSE = SIMULATE + "--source in-house "
EIGENVALUES = "eigenvalues --spin "
GIF = "animate {folder}/run.npz --out {folder}/new.gif "

CALLS = [
    # Sizes that no memory holds.
    (
        SIMULATE + "--samples 1000000000000",
        "--samples: samples asks for 1e+12 samples of 14",
    ),
    (SIMULATE + "--samples 1e12", "argument --samples: invalid int value: '1e12'"),
    (IN_HOUSE + "--model 4 --samples 99999999", "samples of 18 numbers each; at most 13888888"),
    (EIGENVALUES + "0:1:1000000000000", "at least 2 and at most 100000 spins, got"),
    (GIF + "--width 1000000", "width must lie from 100 to 2000 pixels, got 1000000"),
    (GIF + "--speed 1e-300", "--speed: speed must lie from 1e-06 to 1e+06, got 1e-300"),
    # Runs that would never end.
    (
        SIMULATE + "--step 1e-12",
        "--step: step 1e-12 s up to t = 2 s would take about 2",
    ),
    (SIMULATE + "--end 1e6 --samples 3", "up to t = 1e+06 s would take about"),
    (IN_HOUSE + "--end 1e6 --samples 3", "up to t = 1e+06 s would take about"),
    (
        IN_HOUSE + "--eps 1e-12",
        "--eps: friction gradient 3e+11 s/m up to",
    ),
    (IN_HOUSE + "--mu 1e6 --end 10", "--mu: friction gradient 1e+07 s/m up to t = 10"),
    (IN_HOUSE + "--beta 1.1e-6 --end 10", "--beta: beta 1.1e-06 rad up to t = 10 s would take"),
    ("rest --stiffness 1e12", "--end: end = 80 s with steps of 2.0e-07 s, at stiffness 1e+12 N/m"),
    ("rest --source in-house --stiffness 1e12", "--stiffness: stiffness 1e+12 N/m until end = 80"),
    ("rest --eps 1e-9", "and friction gradient 3e+08 s/m, would take about"),
    ("heteroclinic --over mu=0:1:1000000", "must have at most 10000 values here, got 1000000"),
    # Motions too short for two samples.
    (SIMULATE + "--end 5e-324", "--end: end must lie from 1e-15 to 1e+09, got 4.94066e-324"),
    (SIMULATE + "--end 1e-15", "times must be 1e-15 s apart or more for the engine, got 5e-18 s"),
    ("rest --end 1e-9", "--end: end must lie from 0.002 to 1e+09, got 1e-09"),
    (
        "map attitude --end 1e-9 --out {folder}/maps",
        "--end: end must lie from 0.02 to 1e+09",
    ),
    # Numbers whose squares or quotients overflow.
    (SIMULATE + "--mu 1e300", "--mu: coefficient must lie from 0 to 1e+09, got 1e+300"),
    (SIMULATE + "--eps 1e-300", "--eps: smoothing must lie from 1e-12 to 1e+09, got 1e-300"),
    (IN_HOUSE + "--spin=-1e300", "--spin: spin must lie from -100000 to 100000, got -1e+300"),
    (SIMULATE + "--gamma 1e300", "--gamma: gamma must lie from -1e+06 to 1e+06, got 1e+300"),
    (SIMULATE + "--beta-rate 1e300", "--beta-rate: beta_rate must lie from -100000 to"),
    (SIMULATE + "--beta 1e-9", "--beta: beta must keep 1e-06 rad from 0 and pi"),
    (SIMULATE + "--end 1e300", "--end: end must lie from 1e-15 to 1e+09, got 1e+300"),
    (SIMULATE + "--step 1e-300", "--step: step must lie from 1e-15 to inf, got 1e-300"),
    ("check --end 0", "--end: end must be positive, got 0"),
    (EIGENVALUES + "1e300", "--spin: spins must lie from -100000 to 100000, got 1e+300"),
    ("critical --spin 0:1e300", "--spin: spins must lie from -100000 to 100000, got 1e+300"),
    (SIMULATE + "--law tanh,coefficient=-1", "--law: coefficient must not be negative, got -1"),
    ("scene --stiffness 1e300", "--stiffness: stiffness must lie from 0 to 1e+12, got 1e+300"),
    ("rest --half-thickness 1e-300", "--half-thickness: half_thickness must be 0 or at least"),
    ("rest --rolling 1e6", "--rolling: rolling_dry must lie from 0 to 1, got 1e+06"),
    ("rest --air-drag 1e300", "--air-drag: air_drag must lie from 0 to 10000, got 1e+300"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder with a stored motion of five samples."""
    random_trajectory().save(tmp_path / "run.npz")
    return tmp_path


@pytest.mark.parametrize(("call", "message"), CALLS, ids=[call for call, _ in CALLS])
def test_bad_call_is_refused_in_one_line(
    call: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refusal(capsys, call.format(folder=folder))
    assert [entry.name for entry in folder.iterdir()] == ["run.npz"]
