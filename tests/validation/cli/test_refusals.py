"""Command lines that ask for what cannot be: one line, nothing written, no warning.

That every option refuses what it cannot be by its declaration is tested over all commands.
"""

from pathlib import Path

import pytest

from tests.calls import run
from tests.helpers import random_trajectory

ENGINE = "simulate --out {folder}/new.npz "
IN_HOUSE = ENGINE + "--source in-house "
SWEEP = "sweep --out {folder}/new.db "
GIF = "animate {folder}/run.npz --out {folder}/new.gif "
RING = "--radius 0.05 --hole-radius 0.02 --hole-distance 0.02 --thickness 0.01 --density 7700"

REFUSED: list[tuple[str, str]] = [
    # Options that do not fit each other, or the scenario.
    ("scenario --disk steel-rounded --radius 0.04", "--radius: radius varies a ring"),
    (f"scenario {RING} --disk steel-rounded", "--radius: radius varies a ring alone"),
    (f"scenario {RING} --mass 1", "--mass: mass does not go together with radius, from which"),
    ("scenario --constraints glue", "--constraints: constraints must be one of contact, fixed"),
    ("scenario --constraints fixed-cog", "--constraints: constraints must hold 'contact'"),
    ("scenario --model 1 --constraints contact", "--constraints: constraints do not go togeth"),
    ("scenario --law viscous --mu 1", "--mu: coefficient is no parameter of the friction law"),
    ("scenario --law tanh,coefficient=1 --mu 2", "--law: law tells coefficient, which is told tw"),
    ("scenario --law tanh,0.4", "--law: law must hold parameter=value behind its name, got '0.4'"),
    ("scenario --law tanh,coefficient=much", "--law: coefficient must be a number, got 'much'"),
    ("scenario --law tanh,coefficient=-1", "--law: coefficient must not be negative, got -1"),
    ("scenario --damping 1", "--damping: damping needs a penalty contact, told by its stiffness"),
    ("scenario --rolling 1e-3", "dissipation acts on a penalty contact alone"),
    ("scenario --height 1", "--height: height must be 0 or left out on an ideal contact"),
    ("scenario --model 2 --stiffness 1e5", "contact must be left out, or constraints be those"),
    ("scenario --model 2 --x 1", "--x: x must be -0.000249584 in Model 2"),
    ("scenario no-such.toml", "must be a file that exists, got 'no-such.toml'"),
    (ENGINE + "--model 2 --formulation contact-tree", "exists for Model 1 alone, got Model 2"),
    (ENGINE + "--formulation reduced", "formulation must be one of floating"),
    (ENGINE + "--method Radau", "--method: method must be left out for source 'engine'"),
    (ENGINE + "--tolerance 1e-3 --step 1e-3", "--step: step must be left out for a run with its"),
    (
        ENGINE + "--load contact --formulation contact-tree",
        "has no contact constraint whose",
    ),
    (ENGINE + "--integrator RK44 --model 3", "integrator 'RK44' is explicit and cannot take"),
    (ENGINE + "--integrator DOPRI5 --tolerance 1e-6", "must be left out for integrator 'DOPRI5'"),
    (
        ENGINE + "--integrator RK44 --local-tolerance 1e-9",
        "--integrator: integrator must be DO",
    ),
    (IN_HOUSE + "--formulation euler-tree", "form must be one of index-1, reduced"),
    (IN_HOUSE + "--formulation reduced", "form 'reduced' exists for Model 4 alone"),
    (IN_HOUSE + "--step 0.01", "--step: step must be left out for source 'in-house'"),
    ("rest --step 1", "step must not exceed"),
    ("rest --half-thickness 1", "half_thickness must not exceed the radius"),
    (SWEEP + "spin=0:60:1000 gamma=0:1:1000 --most 999999", "--most: most allows 999999 cases"),
    (SWEEP + "", "axes must be at least one, such as spin=0:60:61"),
    (SWEEP + "mu=-2,-1", "coefficient must not be negative, got -2"),
    (SWEEP + "spin=1,2 --scheduler tcp://here:1", "--scheduler: scheduler needs --executor dask"),
    (SWEEP + "spin=1,2 --spacing 5", "--spacing: spacing must be less than end"),
    (SWEEP + "spin=1,2 --formulation reduced", "form 'reduced' exists for Model 4 alone"),
    (SWEEP + "spin=1,2 --local-tolerance 2", "--local-tolerance: local_tolerance must lie from"),
    (SWEEP + "spin=1,2 --rest --formulation reduced", "--formulation: formulation must be left"),
    (SWEEP + "spin=1,2 --step 1e-3", "--step: step must be left out for source 'in-house'"),
    (SWEEP + "spin=1,2 --keep beta,gama", "--keep: keep must be one of coordinates"),
    (SWEEP + "spin=1,2 --keep spin_torque", "--keep: keep must name what Model 1 has"),
    (SWEEP + "spin=1,2 --rest --keep beta", "--keep: keep must be one of position_x"),
    (SWEEP + "spin=1,2 mu=0.1 --plot {folder}/a.png", "--plot: plot cannot be made: several axes"),
    (SWEEP + "eps=1e-11,1e-12 --end 4", "s/m up to t = 4 s would take about"),
    # Paths.
    ("simulate --out {folder}/run.txt", "--out: must end in .npz, got"),
    ("simulate --out {folder}", "--out: must be a file that can be written, got"),
    ("rest --plot {folder}/run.npz/a.png", "--plot: must lie in an existing folder"),
    ("sweep spin=1,2 --out {folder}/a.csv", "--out: must end in .db"),
    ("show {folder}/missing.npz", "must be a file that exists"),
    ("show {folder}/run.toml", "must end in .npz, got"),
    # Sizes that no memory holds.
    (ENGINE + "--samples 1", "--samples: samples must be at least 2, got 1"),
    (ENGINE + "--samples 1000000000000", "--samples: samples asks for 1e+12 samples of 14"),
    (IN_HOUSE + "--model 4 --samples 99999999", "samples of 18 numbers each; at most 13888888"),
    ("eigenvalues --spin 0:1:1000000000000", "--spin: spin must be"),
    ("eigenvalues --spin 1:1:2", "--spin: spin must be"),
    ("eigenvalues --spin 0:1:1", "--spin: spin must be"),
    (GIF + "--width 1000000", "width must lie from 100 to 2000 pixels, got 1000000"),
    (GIF + "--fps 1e-300", "fps must be at least 0.01 for a GIF, got 1e-300"),
    (GIF + "--speed 1e-300", "--speed: speed must lie from 1e-06 to 1e+06, got 1e-300"),
    ("heteroclinic --over mu=0:1:1000000", "must have at most 10000 values here, got 1000000"),
    # Runs that would never end.
    (ENGINE + "--step 1e-12", "--step: step 1e-12 s up to t = 2 s would take about 2"),
    (ENGINE + "--end 1e6 --samples 3", "up to t = 1e+06 s would take about"),
    (IN_HOUSE + "--eps 1e-12", "--eps: friction gradient 3e+11 s/m up to"),
    (IN_HOUSE + "--mu 1e6 --end 10", "--mu: friction gradient 1e+07 s/m up to t = 10"),
    (IN_HOUSE + "--beta 1.1e-6 --end 10", "--beta: beta 1.1e-06 rad up to t = 10 s would take"),
    ("rest --stiffness 1e12", "--stiffness: stiffness 1e+12 N/m until end = 80"),
    ("rest --source in-house --stiffness 1e12", "--stiffness: stiffness 1e+12 N/m until end = 80"),
    # Motions too short for two samples.
    (ENGINE + "--end 5e-324", "--end: end must lie from 1e-15 to 1e+09, got 4.94066e-324"),
    (ENGINE + "--end 1e-15", "times must be 1e-15 s apart or more for the engine, got 5e-18 s"),
    ("rest --end 1e-9", "--end: end must lie from 0.002 to 1e+09, got 1e-09"),
    ("map attitude --end 1e-9 --out {folder}/maps", "--end: end must lie from 0.02 to 1e+09"),
]

FAILED: list[tuple[str, str]] = [
    (ENGINE + "--tolerance 1e-17", "tolerance 1e-17 rad cannot be reached"),
    (
        ENGINE + "--step 1 --end 4 --samples 3 --formulation euler-tree",
        "engine run stopped at t =",
    ),
]

CALLS = [(2, *each) for each in REFUSED] + [(1, *each) for each in FAILED]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder with a stored motion of five samples."""
    random_trajectory().save(tmp_path / "run.npz")
    return tmp_path


@pytest.mark.parametrize(("code", "call", "message"), CALLS, ids=[each[1] for each in CALLS])
def test_what_cannot_be_is_one_line_and_writes_nothing(
    code: int, call: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(call.format(folder=folder)) == code
    shown = capsys.readouterr()
    assert message in shown.err
    assert (shown.out, shown.err.count("\n")) == ("", 1)
    assert [entry.name for entry in folder.iterdir()] == ["run.npz"]


@pytest.mark.parametrize(
    "content", [b"not an archive", b"", "half"], ids=["text", "empty", "truncated"]
)
def test_unreadable_run_is_told_by_its_name(
    content: bytes | str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "run.npz"
    path.write_bytes(path.read_bytes()[:700] if isinstance(content, str) else content)
    assert run(f"show {path} --plot {folder}/picture.png") == 2
    shown = capsys.readouterr()
    assert "run.npz" in shown.err
    assert shown.err.count("\n") == 1
    assert [entry.name for entry in folder.iterdir()] == ["run.npz"]
