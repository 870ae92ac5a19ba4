"""What motions of either kind offer: between samples, out of Python, printed, drawn."""

import csv
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import mbs_models
from analysis import (
    LOADS,
    MODELS,
    POSSIBLE_SETS,
    ConstraintSet,
    Ending,
    Level,
    Load,
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
    load_run,
    simulate,
    simulate_to_rest,
)
from analysis.data import sampled
from analysis.data.checks import Array
from analysis.mechanics.recorded import accelerations
from tests.helpers import centre, cog, contact_arm, not_none, random_trajectory, turn_z

TIMES = np.linspace(0.0, 0.5, 51)


def every(motion: Trajectory, count: int) -> Trajectory:
    """Every so manyth sample alone."""
    names = ("times", "coordinates", "rates", "multipliers")
    return replace(motion, **{name: getattr(motion, name)[::count] for name in names})


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


@pytest.mark.parametrize("count", [10, 20, 50, 100])
def test_error_between_samples_is_within_its_estimate(count: int, fine: Trajectory) -> None:
    coarse = every(fine, count)
    between = coarse.resampled(fine.times, tolerance=1e-3)
    apart = np.abs(between.coordinates - fine.coordinates)[:, 4:].max()
    promised = not_none(between.error_estimate) - not_none(coarse.error_estimate)
    assert apart < promised + 1e-11
    assert promised < 1e-6 * (count / 100) ** 3


def test_forces_and_rates_between_samples_converge(fine: Trajectory) -> None:
    def apart(count: int) -> tuple[float, float]:
        between = every(fine, count).resampled(fine.times, tolerance=1e-3)
        force = np.abs(between.normal_force - fine.normal_force).max()
        return float(force), float(np.abs(between.rates - fine.rates).max())

    (coarse_force, coarse_rate), (fine_force, fine_rate) = apart(200), apart(100)
    assert fine_force < 0.3 * coarse_force
    assert fine_rate < 0.01 * coarse_rate


@pytest.mark.parametrize("row", [0, 1, 17, -1])
def test_state_at_a_sample_is_the_sample(row: int, motion: StoredRun) -> None:
    run = motion if isinstance(motion, Trajectory) else motion.to_trajectory()
    found = motion.at(float(motion.times[row]), tolerance=1e-3)
    turned = np.round((run.coordinates[row] - found.coordinates) / (2 * np.pi)) * 2 * np.pi
    np.testing.assert_allclose(found.coordinates + turned, run.coordinates[row], atol=1e-13)
    np.testing.assert_allclose(found.rates, run.rates[row], rtol=1e-9, atol=1e-9)


def test_attitude_between_samples_is_that_of_a_run_sampled_there(falling: SpatialMotion) -> None:
    wanted = falling.times[:-1] + 0.3 * np.diff(falling.times)
    between = falling.resampled(wanted[wanted < 0.05], tolerance=1e-6)
    other = simulate_to_rest(
        falling.scenario, float(falling.times[-1]), spacing=5e-5, tolerance=1e-6
    )
    rows = np.searchsorted(other.times, between.times - 1e-9)
    rows = rows[: between.times.size]
    np.testing.assert_allclose(other.times[rows], between.times, atol=1e-9)
    for name, tolerance in (("rotations", 2e-6), ("angular_velocities", 1e-3)):
        np.testing.assert_allclose(
            getattr(between, name), getattr(other, name)[rows], rtol=0.0, atol=tolerance
        )


def test_samples_too_far_apart_are_refused(fine: Trajectory) -> None:
    coarse = every(fine, 500)
    with pytest.raises(ToleranceError, match=r"only to .* rad, and tolerance is 1.0e-10"):
        coarse.at(0.02)
    with pytest.raises(ToleranceError, match="sample the run more closely"):
        coarse.resampled([0.01, 0.3])
    assert isinstance(coarse.at(0.02, tolerance=1.0), State)


def test_default_tolerance_is_that_asked_of_the_run(fine: Trajectory) -> None:
    coarse = every(fine, 100)
    with pytest.raises(ToleranceError, match=r"tolerance is 1.0e-10"):
        coarse.at(0.005)
    assert replace(coarse, method={"tolerance": 1e-3}).at(0.005).coordinates[4] > 0.0
    unknown = replace(coarse, method={}, error_estimate=None)
    assert unknown.resampled([0.0, 0.005]).error_estimate is None
    with pytest.raises(ToleranceError, match=f"tolerance is {sampled.UNKNOWN_TOLERANCE:.1e}"):
        replace(every(fine, 500), method={}, error_estimate=None).at(0.02)


def test_samples_next_to_an_ending_do_not_amplify_rounding(fine: Trajectory) -> None:
    close = np.r_[0:4001:100, 4001]
    names = ("times", "coordinates", "rates", "multipliers")
    run = replace(fine, **{name: getattr(fine, name)[close] for name in names})
    times = run.times.copy()
    times[-1] = times[-2] + 1e-10
    coordinates, rates = run.coordinates.copy(), run.rates.copy()
    coordinates[-1], rates[-1] = coordinates[-2], rates[-2]
    ended = replace(run, times=times, coordinates=coordinates, rates=rates)
    found = np.array(ended.at(0.395, tolerance=1e-6).coordinates)
    assert np.abs(found - fine.coordinates[3950])[4:].max() < 1e-7


@pytest.mark.parametrize("time", [-1e-6, 0.6])
def test_time_outside_the_samples_is_refused(time: float, motion: StoredRun) -> None:
    with pytest.raises(ValueError, match=r"^times must lie within the samples, from 0 to 0\.\d"):
        motion.at(time)


def test_rest_time_is_kept_where_it_lies_within(falling: SpatialMotion) -> None:
    rested = replace(falling, rest_time=0.05)
    assert rested.resampled([0.0, 0.06], tolerance=1e-3).rest_time == 0.05
    assert rested.resampled([0.0, 0.04], tolerance=1e-3).rest_time is None


def test_heights_are_those_of_the_geometry() -> None:
    run = random_trajectory(1)
    disk = run.scenario.disk
    for row, z in enumerate(run.coordinates):
        assert run.cog_height[row] == pytest.approx(cog(disk, z)[2], rel=1e-13)
        lowest = centre(z) + contact_arm(disk, z)
        np.testing.assert_allclose(run.contact_points[row], lowest, atol=1e-13)


def test_contact_point_of_a_rounded_rim_is_that_of_the_motion(falling: SpatialMotion) -> None:
    run = falling.to_trajectory()
    np.testing.assert_allclose(run.contact_points, falling.contact_points, atol=1e-12)
    np.testing.assert_allclose(run.cog_height, falling.cog_height, atol=1e-13)


@pytest.mark.parametrize("constraints", POSSIBLE_SETS, ids="+".join)
@pytest.mark.parametrize("load", LOADS)
def test_contact_force_moves_the_disk(constraints: ConstraintSet, load: Load) -> None:
    """Newton's second law in the table: the contact and what holds the COG make up m a."""
    scenario = Scenario(constraints=constraints, friction=SmoothCoulomb(load=load))
    run = simulate(scenario, TIMES[:11], local_tolerance=1e-10)
    forces = contact_forces(run)
    disk = scenario.disk
    for z, u, force, row in zip(run.coordinates, run.rates, forces, range(11), strict=True):
        a, _ = accelerations(scenario, z, u)
        step = 1e-3
        places = [cog(disk, z + t * u + t * t / 2 * a) for t in (-step, 0.0, step)]
        moved = disk.mass * (places[0] - 2 * places[1] + places[2]) / step**2
        held = np.zeros(3)
        if "fixed-cog" in constraints:
            held[:2] = run.multiplier("cog_force_x")[row], run.multiplier("cog_force_y")[row]
        total = turn_z(z[3]) @ (force + held) - np.array((0.0, 0.0, scenario.weight))
        np.testing.assert_allclose(total, moved, atol=2e-3 * scenario.weight)


def test_contact_force_of_a_rounded_rim_is_refused(falling: SpatialMotion) -> None:
    with pytest.raises(ValueError, match="must be that of a disk with a sharp rim"):
        contact_forces(falling.to_trajectory())


def test_lifted_disk_has_no_friction() -> None:
    contact = PenaltyContact.critical(2e5) if hasattr(PenaltyContact, "critical") else None
    contact = contact or PenaltyContact(stiffness=2e5, damping=100.0)
    run = replace(random_trajectory(1), scenario=Scenario(contact=contact))
    run = replace(run, multipliers=np.array([[0.0], [1.0], [0.0], [2.0], [3.0]]))
    rubs = np.hypot(*contact_forces(run)[:, :2].T) > 0.0
    np.testing.assert_array_equal(rubs, [False, True, False, True, True])


def test_columns_hold_every_number_once_with_its_unit(motion: StoredRun) -> None:
    columns, units = motion.to_dict(), motion.units
    assert list(columns) == list(units)
    assert next(iter(columns)) == "time"
    assert all(values.shape == motion.times.shape for values in columns.values())
    assert set(units.values()) <= {"s", "m", "rad", "m/s", "rad/s", "N", "N m", "J", ""}
    np.testing.assert_array_equal(columns["normal_force"], motion.normal_force)
    np.testing.assert_array_equal(columns["cog_height"], motion.cog_height)


@pytest.mark.parametrize("level", [1, 2, 3, 4])
def test_columns_of_a_trajectory_are_those_of_its_model(level: Level) -> None:
    run = random_trajectory(level)
    columns = run.to_dict()
    for name in ("x", "gamma"):
        np.testing.assert_array_equal(columns[name], run.coordinate(name))
        np.testing.assert_array_equal(columns[f"{name}_rate"], run.rate(name))
    assert ("spin_torque" in columns) == (level == 4)
    assert run.units["x_rate"] == "m/s"
    assert run.units["alpha_rate"] == "rad/s"


def test_csv_gives_back_every_number(motion: StoredRun, tmp_path: Path) -> None:
    motion.to_csv(tmp_path / "run.csv")
    with (tmp_path / "run.csv").open(newline="") as stream:
        head, *rows = csv.reader(stream)
    columns = motion.to_dict()
    assert head == list(columns)
    np.testing.assert_array_equal(np.array(rows, dtype=float).T, list(columns.values()))


def test_data_frame_and_data_set_hold_the_columns(motion: StoredRun) -> None:
    columns = motion.to_dict()
    frame, dataset = motion.to_dataframe(), motion.to_xarray()
    assert isinstance(frame, pd.DataFrame)
    assert isinstance(dataset, xr.Dataset)
    np.testing.assert_array_equal(frame.index, motion.times)
    np.testing.assert_array_equal(dataset["time"], motion.times)
    for name, unit in motion.units.items():
        assert dataset[name].attrs["units"] == unit
        np.testing.assert_array_equal(dataset[name], columns[name])
        if name != "time":
            np.testing.assert_array_equal(frame[name], columns[name])
    assert frame.attrs["units"] == motion.units
    assert dataset.attrs["scenario"] == "Model 1"


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_missing_package_says_what_to_install(
    package: str, motion: StoredRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    export: Callable[[], object] = motion.to_dataframe if package == "pandas" else motion.to_xarray
    with pytest.raises(ImportError, match=rf"needs {package}, .*tippedisk\[export\]") as found:
        export()
    assert "\n" not in str(found.value)


def test_motion_prints_in_one_line(motion: StoredRun) -> None:
    text = repr(replace(motion, ending=Ending(reason="inverted", time=0.25, value=0.0)))
    assert "\n" not in text
    assert len(text) < 300
    for part in (type(motion).__name__, "in-house", "Model 1", "from 0 to 0.", "0.25 s"):
        assert part in text
    assert f"{motion.error_estimate:.1e}" in text
    assert "ending: complete" in repr(motion)
    assert "error: not estimated" in repr(replace(motion, error_estimate=None))


def test_motion_in_a_notebook_is_a_table_with_its_text_escaped(motion: StoredRun) -> None:
    named = replace(motion, ending=Ending(reason="<b> & co", time=0.25, value=0.0))
    page = named._repr_html_()
    assert page.startswith("<table>")
    assert "&lt;b&gt; &amp; co" in page
    assert "<b>" not in page
    assert "Model 1" in page


def test_engine_run_offers_the_same(tmp_path: Path) -> None:
    times = np.linspace(0.0, 0.2, 101)
    scene = mbs_models.Scene(Scenario(constraints=MODELS[3]))
    run = mbs_models.simulate(scene, times, tolerance=1e-6)
    check = simulate(scene.scenario, np.array([0.0, 0.1234]))
    np.testing.assert_allclose(
        run.at(0.1234).coordinates[4:], check.coordinates[-1, 4:], rtol=0.0, atol=2e-6
    )
    run.save(tmp_path / "run.npz")
    assert repr(load_run(tmp_path / "run.npz")) == repr(run)


def test_kind_that_a_file_does_not_hold_is_refused(motion: StoredRun, tmp_path: Path) -> None:
    motion.save(tmp_path / "run.npz")
    assert type(load_run(tmp_path / "run.npz", type(motion))) is type(motion)
    other = SpatialMotion if isinstance(motion, Trajectory) else Trajectory
    with pytest.raises(ValueError, match=r"is not a readable .*: lacks"):
        load_run(tmp_path / "run.npz", other)


def drawn(axes: object) -> list[Array]:
    return [line.get_ydata() for line in axes.get_lines()]  # type: ignore[attr-defined]


def test_plot_draws_into_given_axes_and_returns_them(motion: StoredRun) -> None:
    axes = motion.plot("cog_height", label="first")
    again = motion.plot(ax=axes, label="second")
    assert again is axes
    for values in drawn(axes):
        np.testing.assert_array_equal(values, motion.cog_height)
    assert [line.get_label() for line in axes.get_lines()] == ["first", "second"]
    assert axes.get_xlabel() == "time in s"
    assert axes.get_ylabel() == "cog height in m"


def test_plot_leaves_no_global_figure(motion: StoredRun) -> None:
    import matplotlib.pyplot as plt  # noqa: PLC0415

    before = plt.get_fignums()
    motion.plot("contact_x", "contact_y")
    assert plt.get_fignums() == before


def test_plot_refuses_what_does_not_fit(motion: StoredRun) -> None:
    with pytest.raises(
        ValueError, match=r"^names must be one of time, .*, got 'height'; did you mean cog_"
    ):
        motion.plot("height")
    with pytest.raises(ValueError, match="names must have one unit, got cog_height in m and norm"):
        motion.plot("cog_height", "normal_force")
