"""The command `rest` and its part of the report."""

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from analysis import STEEL_DISK, Scenario, SpatialMotion, load_run
from analysis.data.checks import Array
from analysis.data.trajectory import SOURCES
from tests.calls import refusal
from tests.helpers import mostly_slow
from validation.cli import main
from validation.kit import shipped
from validation.studies.rest import confirm as rest_confirm
from validation.studies.rest import contact as rest_contact
from validation.studies.rest import creep as rest_creep
from validation.studies.rest import final_stage as rest_final
from validation.studies.rest import rolling as rest_rolling
from validation.studies.rest import runs as rest
from validation.studies.rest import section as rest_section
from validation.studies.rest import starts as rest_starts


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
    assert plot.read_bytes().startswith(b"\x89PNG")
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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--rolling", "-1"], "rolling_dry must not be negative, got -1"),
        (["--stiffness", "nan"], "stiffness must be a finite number, got nan"),
        (["--half-thickness", "1"], "half_thickness must not exceed the radius"),
        (["--step", "1"], "step must not exceed"),
        (
            ["--step", "1e-4", "--tolerance", "1"],
            "--step: step must be left out for a run with",
        ),
        (["--step", "1e-4", "--source", "in-house"], "--step: step must be left out for source"),
        (["--height", "-1"], "height must not be negative, got -1"),
        (["--tolerance", "0"], "tolerance must be positive, got 0"),
        (["--out", "rest.txt"], "--out: must end in .npz, got 'rest.txt'"),
        (["--plot", "nowhere/rest.png"], "--plot: must lie in an existing folder"),
    ],
)
def test_wrong_calls_answer_in_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refusal(capsys, "rest", *arguments)


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


@pytest.mark.slow
def test_final_stage_table_holds_the_predicted_exponents() -> None:
    results = {job.key: job.function(*job.arguments) for job in rest_final.jobs()}
    for row in rest_final.table(results).rows:
        for theory, fitted in ((row[1], row[2]), (row[3], row[4])):
            assert fitted == pytest.approx(float(Fraction(str(theory))), abs=0.005)
    assert rest_final.draw(results).png


@pytest.mark.slow
def test_centred_disk_rolls_as_the_textbook_says_in_engine_and_in_house() -> None:
    results = {job.key: job.function(*job.arguments) for job in rest_rolling.jobs()}
    *rolling, faster, slower = rest_rolling.textbook(results).rows
    for row in rolling:
        assert isinstance(row[-1], float)
        assert row[-1] < 1e-2
    for source in (2, 3):
        assert faster[source] < 1e-2 < slower[source]  # type: ignore[operator]
    assert [row[2] for row in rolling] == pytest.approx([row[3] for row in rolling], rel=1e-3)


def test_fit_finds_the_law_and_its_deviation() -> None:
    times: Array = np.arange(6001, dtype=float) * 1e-2
    tilts = (10.0 + 0.02 * times) ** -0.5
    tilts[times >= rest_creep.TIMES[1]] *= 1.01
    zeros = np.zeros((times.size, 3))
    scenario = Scenario.rest()
    height = 1.5 * scenario.weight * STEEL_DISK.radius * np.sin(tilts)
    motion = SpatialMotion(
        times=times,
        positions=zeros,
        quaternions=np.column_stack((np.ones(times.size), zeros)),
        velocities=zeros,
        angular_velocities=zeros,
        contact_points=zeros,
        slip_speeds=zeros[:, 0],
        contour_speeds=zeros[:, 0],
        normal_force=zeros[:, 0],
        energies=np.column_stack((zeros[:, 0], height, zeros[:, 0])),
        dissipated=np.zeros((times.size, 6)),
        scenario=scenario,
        source="in-house",
    )
    found = rest_creep.fit(motion)
    assert found.rate == pytest.approx(0.02, rel=1e-3)
    assert found.offset == pytest.approx(10.0, rel=1e-3)
    assert found.error == pytest.approx(0.01, rel=1e-3)
    assert found.time_between(10.0**-0.5, 11.0**-0.5) == pytest.approx(50.0, rel=1e-3)


@pytest.mark.slow
def test_step_is_no_part_of_the_deviation_from_the_ideal_contact() -> None:
    runs = rest_contact.measure(1e6, 2e-4)
    for run in runs:
        assert run.step_error < 1e-2 * run.law_error
        assert run.law_error < 1e-4
    coarse, _, fine = runs
    assert fine.step_error < 1e-2 * coarse.step_error


@pytest.mark.slow
def test_small_changes_of_the_start_grow_in_proportion_until_rest() -> None:
    base, small, large = (
        rest.run_in_house(rest.SHOWN, 1e6, 2e-4, 40.0 + change) for change in (0.0, 1e-6, 1e-3)
    )
    changes = [np.max(course.apart(base)) for course in (small, large)]
    assert changes[1] / changes[0] == pytest.approx(1000.0, rel=0.05)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("Table 3 at 10 rad/s", marks=pytest.mark.slow),
        pytest.param("Table 3 at 20 rad/s", marks=pytest.mark.slow),
        pytest.param("Table 3 at 28 rad/s", marks=pytest.mark.slow),
        "random, seed 1",
        "random, seed 7",
    ],
)
def test_other_starts_come_to_rest(name: str) -> None:
    outcome = rest_starts.run(name, rest_starts.starts(8)[name])
    assert outcome.rest is not None
    assert outcome.lowest_force >= 0.0
    assert outcome.residual < 1e-7


def test_shipped_run_that_departs_from_the_one_on_the_spot_is_not_confirmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    jobs = shipped.taken("rest", rest_section.shipped())
    results = {job.key: job.function(*job.arguments) for job in jobs}
    engine, inhouse = (results["rest", rest.SHOWN, source] for source in SOURCES)
    law = results["rest creep", rest_creep.SMOOTHINGS[0]]
    results |= {
        ("rest fresh", "coarser"): engine,
        ("rest fresh", "in-house"): None,
        ("rest fresh", "begin"): replace(engine, tilt=engine.tilt[:10]),
        ("rest fresh", "creep"): (law.times[:4], law.tilts[:4]),
        ("rest fresh", "contact"): results[("rest contact", *rest_confirm.CONTACT)],
    }

    def confirmed(found: rest.Course) -> list[bool]:
        monkeypatch.setattr(rest.Course, "of", lambda _: found)
        return [each.agrees for each in rest_confirm.samples(results) if each.agrees is not None]

    assert confirmed(inhouse) == [True] * 6
    tilt = inhouse.tilt.copy()
    tilt[700] += 2e-5
    assert confirmed(replace(inhouse, tilt=tilt)) == [False, *[True] * 5]
    results["rest creep", rest_creep.SMOOTHINGS[0]] = replace(law, tilts=law.tilts + 1e-5)
    results["rest fresh", "begin"] = replace(engine, tilt=engine.tilt[1:])
    assert confirmed(inhouse) == [True, True, True, False, False, True]
