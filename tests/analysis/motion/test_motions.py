"""What motions offer: their quantities, between samples too, out of Python, printed, drawn."""

import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.interpolate import CubicSpline

from analysis import (
    COORDINATES,
    ConstraintSet,
    Disk,
    Ending,
    PenaltyContact,
    Scenario,
    SmoothCoulomb,
    SpatialMotion,
    Start,
    State,
    StoredRun,
    ToleranceError,
    Trajectory,
    contact_forces,
    multiplier_names,
    simulate,
    simulate_to_rest,
)
from analysis.mechanics.recorded import accelerations
from analysis.motion.interpolation import Sampled
from tests.bodies import ELLIPSE
from tests.helpers import (
    all_sets,
    angles_apart,
    arc,
    centre,
    cog,
    contact_arm,
    not_none,
    random_trajectory,
    second_derivative,
    turn_z,
)

ARRAYS = ("times", "coordinates", "rates", "multipliers")


def every(motion: Trajectory, count: int) -> Trajectory:
    """Every so manyth sample alone."""
    return replace(motion, **{name: getattr(motion, name)[::count] for name in ARRAYS})


@pytest.fixture(scope="module")
def fine() -> Trajectory:
    return simulate(Scenario(), np.linspace(0.0, 0.5, 5001), tolerance=1e-10)


@pytest.fixture(scope="module")
def falling() -> SpatialMotion:
    scenario = Scenario.rest(start=Start(spin=5.0, beta=1.2))
    return simulate_to_rest(scenario, 0.1, spacing=5e-4)


@pytest.fixture(params=["trajectory", "spatial motion"])
def motion(request: pytest.FixtureRequest, fine: Trajectory, falling: SpatialMotion) -> StoredRun:
    return every(fine, 100) if request.param == "trajectory" else falling


# --- What it is made of --------------------------------------------------------------------------


def test_arrays_are_the_motions_own_and_cannot_be_changed() -> None:
    given = random_trajectory().coordinates.copy()
    kept = replace(random_trajectory(), coordinates=given).coordinates
    before = kept.copy()
    given += 1.0
    np.testing.assert_array_equal(kept, before)
    with pytest.raises(ValueError, match=r"read-only"):
        kept[0] = 0.0


def test_columns_are_found_by_name() -> None:
    run = random_trajectory(2)
    names = [*COORDINATES, *(f"{name}_rate" for name in COORDINATES)]
    names += multiplier_names(run.scenario.constraints)
    held = np.hstack((run.coordinates, run.rates, run.multipliers)).T
    columns = run.to_dict()
    assert list(columns)[1 : 1 + len(held)] == names
    np.testing.assert_array_equal([columns[name] for name in names], held)
    finders = {"beta": run.coordinate, "beta_rate": run.rate, "cog_force_y": run.multiplier}
    for name, finder in finders.items():
        np.testing.assert_array_equal(finder(name.removesuffix("_rate")), columns[name])
        with pytest.raises(ValueError, match=r" must be one of .*, got 'spin_torque'$"):
            finder("spin_torque")
    assert run.state(2) == State(coordinates=tuple(run.coordinates[2]), rates=tuple(run.rates[2]))


# --- Quantities that follow ----------------------------------------------------------------------


def test_heights_are_those_of_the_geometry() -> None:
    run = random_trajectory(1)
    disk = run.scenario.disk
    for row, z in enumerate(run.coordinates):
        assert run.cog_height[row] == pytest.approx(cog(disk, z)[2], rel=1e-13)
        np.testing.assert_allclose(run.cog_positions[row], cog(disk, z), atol=1e-13)
        assert run.cog_direction[row] == pytest.approx(np.sin(z[4]) * np.sin(z[5]), rel=1e-13)
        lowest = centre(z) + contact_arm(disk, z)
        np.testing.assert_allclose(run.contact_points[row], lowest, atol=1e-13)


def test_quantities_of_a_rounded_rim_are_the_same_of_either_kind(falling: SpatialMotion) -> None:
    run = falling.to_trajectory()
    for name in ("contact_points", "contact_speed", "cog_height", "face", "cog_direction_rate"):
        np.testing.assert_allclose(getattr(run, name), getattr(falling, name), atol=1e-12)


def test_contact_point_is_on_the_table_and_moves_at_its_speed_and_the_cog_at_its_own() -> None:
    contact = PenaltyContact(stiffness=1e5, damping=100.0, half_thickness=5e-3)
    scenario = Scenario.rest(contact=contact, start=Start(spin=5.0, beta=0.9, beta_rate=3.0))
    ideal = simulate(Scenario(disk=ELLIPSE), np.linspace(0.0, 0.3, 301))
    np.testing.assert_allclose(ideal.contact_points[:, 2], 0.0, atol=1e-9)
    inner = slice(20, -20)
    for motion in (ideal, simulate_to_rest(scenario, 0.1, spacing=1e-3)):
        places = CubicSpline(motion.times, motion.contact_points[:, :2])(motion.times[inner], 1)
        speeds = motion.contact_speed[inner]
        np.testing.assert_allclose(speeds, np.hypot(*places.T), rtol=1e-5, atol=1e-7)
        moved = CubicSpline(motion.times, motion.cog_positions)(motion.times[inner], 1)
        np.testing.assert_allclose(motion.cog_velocities[inner], moved, rtol=1e-5, atol=1e-6)


@all_sets
def test_contact_force_moves_the_disk(constraints: ConstraintSet) -> None:
    """Newton's second law in the table: the contact and what holds the COG make up m a."""
    scenario = Scenario(constraints=constraints, friction=SmoothCoulomb(load="contact"))
    run = simulate(scenario, [0.0, 0.05, 0.1], local_tolerance=1e-10)
    for row, (z, u) in enumerate(zip(run.coordinates, run.rates, strict=True)):
        path = arc(z, u, accelerations(scenario, z, u)[0])
        moved = second_derivative(lambda t, path=path: cog(scenario.disk, path(t)))  # type: ignore[misc]
        force = contact_forces(run)[row]
        if "fixed-cog" in constraints:
            force[:2] += run.multiplier("cog_force_x")[row], run.multiplier("cog_force_y")[row]
        total = turn_z(z[3]) @ force - np.array((0.0, 0.0, scenario.weight))
        np.testing.assert_allclose(total, scenario.disk.mass * moved, atol=1e-5)


def test_lifted_disk_has_no_friction_and_a_rounded_rim_no_known_one(
    falling: SpatialMotion,
) -> None:
    contact = PenaltyContact(stiffness=2e5, damping=100.0)
    run = replace(random_trajectory(1), scenario=Scenario(contact=contact))
    run = replace(run, multipliers=np.array([[0.0], [1.0], [0.0], [2.0], [3.0]]))
    rubs = np.hypot(*contact_forces(run)[:, :2].T) > 0.0
    np.testing.assert_array_equal(rubs, [False, True, False, True, True])
    with pytest.raises(ValueError, match="must be that of a disk with a sharp rim"):
        contact_forces(falling.to_trajectory())


# --- Between samples -----------------------------------------------------------------------------


def test_error_between_samples_is_within_its_estimate_and_all_converge(fine: Trajectory) -> None:
    errors = []
    for count in (200, 100, 10):
        coarse = every(fine, count)
        between = coarse.resampled(fine.times, tolerance=1e-3)
        apart = angles_apart(between, fine)
        promised = not_none(between.error_estimate) - not_none(coarse.error_estimate)
        assert apart < promised + 1e-11
        assert promised < 1e-6 * (count / 100) ** 3 or count > 100
        found = np.column_stack((between.rates, between.normal_force))
        errors.append(np.abs(found - np.column_stack((fine.rates, fine.normal_force))).max(axis=0))
    assert np.all(errors[1][:-1] < 0.01 * errors[0][:-1].max())
    assert errors[1][-1] < 0.2 * errors[0][-1]


def test_state_at_a_sample_is_the_sample(motion: StoredRun) -> None:
    run = motion if isinstance(motion, Trajectory) else motion.to_trajectory()
    for row in (0, 17, -1):
        found = motion.at(float(motion.times[row]), tolerance=1e-3)
        apart = run.coordinates[row] - found.coordinates
        np.testing.assert_allclose(np.sin(apart / 2.0), 0.0, atol=1e-13)
        np.testing.assert_allclose(found.rates, run.rates[row], rtol=1e-9, atol=1e-9)


def test_attitude_between_samples_is_that_of_a_run_sampled_there(falling: SpatialMotion) -> None:
    wanted = falling.times[:-1] + 0.3 * np.diff(falling.times)
    between = falling.resampled(wanted[wanted < 0.05], tolerance=1e-6)
    for rest, told in ((0.02, 0.02), (0.06, None)):
        motion = replace(falling, rest_time=rest).resampled([0.0, 0.05], tolerance=1.0)
        assert motion.rest_time == told
    other = simulate_to_rest(
        falling.scenario, float(falling.times[-1]), spacing=5e-5, tolerance=1e-6
    )
    rows = np.searchsorted(other.times, between.times - 1e-9)
    np.testing.assert_allclose(other.times[rows], between.times, atol=1e-9)
    named = (("rotations", 2e-6), ("angular_velocities", 1e-3), ("contact_points", 1e-7))
    for name, tolerance in named:
        np.testing.assert_allclose(
            getattr(between, name), getattr(other, name)[rows], rtol=0.0, atol=tolerance
        )


def test_samples_too_far_apart_for_the_runs_own_tolerance_are_refused(fine: Trajectory) -> None:
    coarse = every(fine, 500)
    again = coarse.resampled(coarse.times)
    assert again.error_estimate == coarse.error_estimate
    np.testing.assert_allclose(again.coordinates, coarse.coordinates, rtol=1e-14, atol=1e-14)
    with pytest.raises(ToleranceError, match=r"only to .* rad, and tolerance is 1.0e-10: sample"):
        coarse.at(0.02)
    assert isinstance(replace(coarse, method={"tolerance": 1.0}).at(0.02), State)
    unknown = replace(coarse, method={}, error_estimate=None)
    with pytest.raises(ToleranceError, match=r"tolerance is 1.0e-06: sample the run more closely"):
        unknown.resampled([0.01, 0.3])
    assert unknown.resampled([0.0, 0.005], tolerance=1.0).error_estimate is None


@pytest.mark.parametrize("spacing", [0.02, 0.1])
def test_disk_that_stays_in_its_place_stays_there_between_samples_however_fast_the_frame_turns(
    spacing: float,
) -> None:
    start = replace(Start.stationary(60.0), x=0.2, y_rate=-12.0)
    run = simulate(Scenario(start=start), np.arange(0.0, 1.01, spacing))
    between = run.resampled(np.linspace(0.0, 0.9, 91))
    np.testing.assert_allclose(between.cog_positions[:, :2], [(0.2, 0.0)] * 91, atol=1e-7)
    np.testing.assert_allclose(between.cog_velocities, 0.0, atol=1e-5)


def test_place_between_samples_is_told_to_a_hundred_times_the_tolerance_in_radii() -> None:
    times, shaken = np.linspace(0.0, 1.0, 11), np.zeros((11, 6))
    shaken[:, 0] = 1e-4 * (-1.0) ** np.arange(11)
    upright = simulate(Scenario(start=Start.stationary(60.0)), times)
    run = replace(upright, coordinates=upright.coordinates + shaken)
    assert run.at(0.45, tolerance=1e-3)
    with pytest.raises(ToleranceError):
        run.at(0.45, tolerance=1e-5)


def test_an_attitude_between_samples_is_told_alike_on_disks_of_any_size(
    falling: SpatialMotion,
) -> None:
    small = Disk.ring(radius=4e-3, hole_radius=1e-3, hole_distance=1e-3)
    wanted = falling.times[:100] + 2e-4
    other = replace(falling, scenario=Scenario.rest(disk=small))
    one, two = (motion.resampled(wanted, tolerance=1.0) for motion in (falling, other))
    assert one.error_estimate == two.error_estimate


def test_ending_is_that_of_the_last_sample_alone(motion: StoredRun) -> None:
    last, ending = float(motion.times[-1]), Ending(reason="low", time=1.0, value=0.0)
    ended = replace(motion, ending=ending)
    for end, kept in ((last, ending), (0.9 * last, None)):
        assert ended.resampled([0.0, end], tolerance=1.0).ending == kept


def test_times_of_pulling_are_those_of_the_part_that_is_sampled(fine: Trajectory) -> None:
    whole = replace(fine, pulling=((0.0, 0.1), (0.15, 0.2), (0.3, 0.4)))
    part = whole.resampled([0.1, 0.15, 0.35], tolerance=1.0)
    assert part.pulling == ((0.15, 0.2), (0.3, 0.35))


def test_extremes_between_samples_are_those_of_a_parabola_and_half_as_much_again() -> None:
    # Up by a quarter of a unit between samples of the same height, and down by as much.
    rates = np.array([[1.0, -1.0], [-1.0, 1.0]])
    least, most = Sampled(np.array([[0.0, 1.0]] * 2), np.full((2, 2), 3.0), rates).extremes()
    np.testing.assert_allclose([least[:, 0], most[:, 0]], [[3.0, 2.625], [3.375, 3.0]])


def test_samples_next_to_an_ending_do_not_amplify_rounding(fine: Trajectory) -> None:
    close = np.append(np.arange(0, 4001, 100), 4000)
    arrays = {name: getattr(fine, name)[close].copy() for name in ARRAYS}
    arrays["times"][-1] += 1e-10
    found = np.array(replace(fine, **arrays).at(0.395, tolerance=1e-6).coordinates)
    assert np.abs(found - fine.coordinates[3950])[4:].max() < 1e-7


def test_flat_disk_has_no_state_in_angles(falling: SpatialMotion) -> None:
    attitudes = np.tile((1.0, 0.0, 0.0, 0.0), (falling.times.size, 1))
    still: Any = {"quaternions": attitudes, "angular_velocities": 0.0 * falling.angular_velocities}
    with pytest.raises(ValueError, match=r"^beta must lie in the open interval \(0, pi\), in "):
        replace(falling, **still).at(0.01, tolerance=1.0)


# --- Out of Python -------------------------------------------------------------------------------


def test_every_way_out_holds_every_column_with_its_unit(motion: StoredRun, tmp_path: Path) -> None:
    columns, units = motion.to_dict(), motion.units
    assert list(columns) == list(units)
    assert set(units.values()) <= {"s", "m", "rad", "m/s", "rad/s", "N", "N m", "J", ""}
    motion.to_csv(tmp_path / "run.csv")
    written = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    assert list(written.dtype.names or ()) == list(columns)
    frame, dataset = motion.to_dataframe(), motion.to_xarray()
    assert isinstance(frame, pd.DataFrame)
    assert isinstance(dataset, xr.Dataset)
    for name, unit in units.items():
        for found in (written, frame.reset_index(), dataset):
            np.testing.assert_array_equal(found[name], columns[name])
        assert dataset[name].attrs["units"] == unit
    assert frame.attrs["units"] == units
    assert dataset.attrs["scenario"] == "Model 1"


@pytest.mark.parametrize("name", ["xarray", "pandas", "matplotlib.figure"])
def test_missing_package_is_named_and_an_extra_only_where_it_installs_it(
    name: str, motion: StoredRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    leave = {"xarray": motion.to_xarray, "pandas": motion.to_dataframe}.get(name, motion.plot)
    with pytest.raises(ImportError, match=name) as found:
        leave()
    assert ("pip install 'tippedisk[export]'" in str(found.value)) == (name == "xarray")
    assert "\n" not in str(found.value)


def test_motion_prints_in_one_line_and_in_a_notebook(motion: StoredRun) -> None:
    named = replace(motion, ending=Ending(reason="<b> & co", time=0.25, value=0.0))
    kind, error = type(motion).__name__, f"{motion.error_estimate:.1e}"
    parts = rf"{kind}\(.*in-house.*Model 1.*from 0 to 0\..*{error}.*0.25 s: <b> & co.*"
    assert re.fullmatch(parts, repr(named))
    unknown = repr(replace(motion, error_estimate=None))
    assert "error: not estimated, ending: complete" in unknown
    table = named._repr_html_()
    assert re.fullmatch(r"<table>.*&lt;b&gt; &amp; co.*</table>", table)
    for name, value in motion.method.items():
        said = f"{value:.6g}" if isinstance(value, float) else value
        assert (f"{name} {said}" in table) == (value is not None)


def test_plot_draws_into_given_axes_alone(motion: StoredRun) -> None:
    import matplotlib.pyplot as plt  # noqa: PLC0415

    axes = motion.plot("cog_height", label="first")
    assert motion.plot(ax=axes, label="second") is axes
    assert plt.get_fignums() == []
    for line, label in zip(axes.get_lines(), ("first", "second"), strict=True):
        np.testing.assert_array_equal(line.get_ydata(), motion.cog_height)
        assert line.get_label() == label
    assert axes.get_xlabel() == "time in s"
    assert axes.get_ylabel() == "cog height in m"
    assert axes.get_legend() is None
    assert len(motion.plot("cog_height", "contact_x").get_legend().get_texts()) == 2
    with pytest.raises(ValueError, match=r"^names must be .* got 'height'; did you mean cog_"):
        motion.plot("height")
    with pytest.raises(ValueError, match="names must have one unit, got cog_height in m and norm"):
        motion.plot("cog_height", "normal_force")
