"""Command lines that ask for what cannot be: one line, nothing written, no warning.

That every option refuses what it cannot be by its declaration is tested over all commands.
"""

from pathlib import Path

import pytest

from tests.calls import refusal

ENGINE = "simulate --out new.npz "
SWEEP = "sweep --out new.db "
EIGENVALUES = "eigenvalues --spin "
NINE = "mu=1,2 eps=1,2 spin=1,2 alpha=0,1 beta=1,2 gamma=0,1 y=0,1 x=0,1 y-rate=0,1"
RING = "--radius 0.05 --hole-radius 0.02 --hole-distance 0.02 --thickness 0.01 --density 7700"

REFUSED = {
    # Options that do not fit each other, or the scenario.
    "scenario --law viscous --mu 1": "--mu: coefficient is unknown here; [friction] takes law",
    "scenario --law tanh,coefficient=1 --mu 2": "--law: law tells coefficient, which is told tw",
    "scenario --law tanh,foo=1": "--law: foo is unknown here; [friction] takes law, load, smooth",
    "scenario --body sphere,foo=1": "--body: foo is unknown here; [disk] takes body, radius, ma",
    "scenario --damping 1": "--damping: damping needs a penalty contact, told by its stiffness",
    "scenario --radius 1 --thickness 1 --density 1e100": "--radius: mass must be above 0 and at",
    ENGINE + "--source in-house --formulation floating": "formulation must be one of index-1",
    ENGINE + "--formulation reduced": "with source 'engine', got 'reduced' of the other one",
    "simulate --spin 1e5": "error: start needs a contact that pulls, with a normal force of -5",
    "rest --scenario run.npz": "give --stiffness and --half-thickness, or the table [co",
    "rest --model 2": "--model: contact must be left out, or constraints be those of Model 1",
    "animate run.npz --body ellipse": "--body: body belongs to none of the motions, got Ell",
    SWEEP + "spin=0:60:1000 gamma=0:1:1000 --most 999999": "--most: most allows 999999 cases",
    SWEEP + "spin=1,2 --rest --half-thickness 0": "--half-thickness: half_thickness must be pos",
    SWEEP + "spin=1,2 --scheduler tcp://here:1": "--scheduler: scheduler needs --executor dask",
    SWEEP + "spin=1,2 --spacing 1e-12": "--spacing: spacing asks for 4e+12 samples of 20",
    SWEEP + "spin=1,2 --spacing 4": "--spacing: spacing must have spacing < end, got 4 s and 4 s",
    SWEEP + "spin=1,2 --end 0.004": "--end: end must have spacing < end, got 0.005 s and",
    SWEEP + "spin=1,2 --keep spin_torque": "--keep: keep must name what Model 1 has",
    SWEEP + "spin=1,2 --executor cores": "executor must be one of",
    SWEEP + "spin=1,2 --executor os:getcwd": "must be a function that returns",
    SWEEP + "spin=1,2 --executor json:dumps": "cannot be made: TypeError: dumps() missing",
    SWEEP + "spin=1,2 mu=0.1 --plot a.png": "--plot: plot cannot be made: several axes",
    SWEEP + "mu=-1,-2": "coefficient must not be negative, got -1",
    SWEEP + "spin=40,30 --plot a.png": "--plot: plot cannot be made: axis start.spin can be drawn",
    SWEEP + f"{NINE} --layout random --number 1 --plot a.png": "plot cannot be made: at most 8 ",
    SWEEP + "spin=1,2 --rest --inclination 0.1 --plot a.png": "--plot: plot cannot be made: a pi",
    SWEEP + "inclination=0,0.2 --rest --plot a.png": "a horizontal table, got an inclination of 0",
    SWEEP + "spin=1,2 --spin 3": "--spin: spin must be left out where it varies, got 3",
    SWEEP + "spin=3:3 --layout random --number 2": "several need different ones, got 3 to 3",
    SWEEP + "spin=1:2 --layout random": "--layout: layout needs a number of points, got 'random'",
    SWEEP + "spin=1,2 --number 3": "--number: number belongs to drawn points, not to a grid",
    SWEEP + "model=1,2 --constraints contact": "--constraints: constraints must be left out",
    SWEEP + "mu=1,2 --law tanh,coefficient=3": "--law: coefficient must be left out where it vari",
    "map basins --model 2": "--model: model must be left out where it varies, got 2",
    "map rest --stiffness 1e6 --out maps": "--stiffness: half_thickness must be positive for",
    "critical --spin 30": "--spin: spin must have lowest < highest spin, got 30 to 30",
    "simulate --csv - --plot -": "--plot: plot must lead elsewhere: standard output takes one",
    "simulate --json --csv -": "--csv: csv must lead elsewhere: standard output takes one",
    EIGENVALUES + "0:50": "--spin: spin must be a value or first:last:number, of different ends",
    EIGENVALUES + "5:5:10": "--spin: spin must be a value or first:last:number, of diff",
    EIGENVALUES + "1 --formulation floating": "--formulation: formulation needs --source",
    "cycles --mu 0": "--mu: friction must have a positive gradient for periodic motions, got 0",
    "cycles --hole-distance 0": "--hole-distance: eccentricity must be positive for periodic mo",
    "map rest --inclination 2deg --cells 1 --levels 0 --end 0.1": "--inclination: a map of the fa",
    "cycles --body sphere": "--body: constraints must be those of Model 1 for a Sphere, got",
    "cycles --amplitude 1": "--amplitude: amplitude belongs to --over",
    "cycles --rotating --spin 30": "--spin: spin does not go together with rotating",
    "cycles --over mu=0.1:1:3": "--over: over needs what is held",
    "cycles --over mu=0.1:1:3 --spin 30,31": "--over: over needs what is held: one",
    "cycles --over start.spin=1,2 --amplitude 1": "--over: over must be a number of disk, fri",
    "cycles --over mu=-1:1:3 --spin 40": "--over: over gives no scenario: coefficient must not be",
    "heteroclinic --over mu=1,2 --mu 3": "--mu: coefficient must be left out where it varies, got",
    "heteroclinic --over mu=0.1:1:10001": "--over: over must have at most 10000 values, got 10",
    "passage --end 0.2": "inverts the disk",
    "passage --end 0.002 --radius 1": "--end: end must lie from 0.00942809 to 1e+09, got 0.002",
    "passage --end 1e7": "--end: end asks for 5e+09 samples",
    # Paths.
    "show cut.npz --plot a.png": "cut.npz",
    "show run.npz --law a:B,c=1": "--law: law must name the class alone, whose numbers are stored",
    "show run.npz run.npz --plot a.png": "files must be different ones, got run.npz, run.npz",
    "show run.npz link.npz": "files must be different ones, got run.npz, link.npz",
    "simulate --out run.txt": "--out: must end in .npz, got",
    "sweep spin=1,2 --out /dev/null": "--out: must be a regular file",
    "show run.npz --plot circle.png": "--plot: must lead to a file, and leads in a circle",
    f"simulate --out {'a' * 300}.npz": "--out: is no path here",
    "animate cut.npz": "'cut.html'; --out leads elsewhere",
    "report --out circle.png": "--out: must be a folder that can be written to",
    # What is not known is told before what is missing or wrong besides.
    "sweep spin=1,2 --kep x": "unrecognized arguments: --kep; did you mean --keep?",
    ENGINE + "--stop-when inverted lost": "unrecognized arguments: lost\n",
    # Sizes that no memory holds.
    "map rest --workers 99999999999 --out maps": "--workers: workers must be at most 1000, got",
    ENGINE + "--samples 1000000000000": "--samples: samples asks for 1e+12 samples of 14",
    "animate run.npz --fps 20": "--fps: fps needs a file that ends in .gif",
    "animate run.npz --out a.gif --fps 1e-300": "--fps: fps must lie from 0.01 to 50, got 1e-300",
    "animate run.npz --out a.gif --speed 1e-5": "frames, not ",
    "map spin-friction --cells 0 --out maps": "cells must lie from 1 to 10000, got 0",
    "map rest --witnesses -1 --out maps": "--witnesses: witnesses must be at least 0, got -1",
    # Motions too short for two samples.
    ENGINE + "--end 1e-300": "--end: end must lie from 1e-15 to 1e+09, got 1e-300",
    ENGINE + "--end 5e-324": "--end: end must be at least 2.23e-308, got 4.94e-324",
}

FAILED = {
    ENGINE + "--tolerance 1e-17": "tolerance 1e-17 rad cannot be reached",
}


@pytest.mark.parametrize("call", [*REFUSED, *FAILED])
def test_what_cannot_be_or_fails_is_told_in_one_line_and_writes_nothing(call: str) -> None:
    said = (REFUSED | FAILED)[call]
    Path("circle.png").symlink_to("circle.png")
    Path("link.npz").symlink_to("run.npz")
    Path("cut.html").mkdir()
    Path("cut.npz").write_bytes(Path("run.npz").read_bytes()[:700])
    assert said in refusal(call, code=1 if call in FAILED else 2)
    made = {"run.npz", "link.npz", "circle.png", "cut.html", "cut.npz"}
    assert {entry.name for entry in Path().iterdir()} == made
